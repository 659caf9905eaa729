//! FastSLAM: particles that are ways, each with its own landmarks.

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use sensor::{FeatureCamera, FeatureReading, FeatureScan, OdometryNoise, Pose, Step};

use super::known_poses::confirmed;
use super::landmark::Landmark;
use super::map::{Map, Meant};
use super::options::{FeatureOptions, FeatureOptionsError, FeatureProposal};
use super::proposal::{Belief, Measured, after};
use crate::moments::Moments;
use crate::random::{ALL, stream};
use crate::resampling::{effective, low_variance, normalised};

/// Particles are drawn anew once fewer than this share of them count.
const RESAMPLED_BELOW: f64 = 0.5;

/// A particle filter over ways and landmarks: FastSLAM 1.0 and 2.0 with unknown or known association (Montemerlo et al. 2002, 2003; Thrun
/// et al. 2004).
///
/// It is given scan after scan with the odometry's pose. The way begins at the odometry's first pose.
#[derive(Debug)]
pub struct FastSlam {
    camera: FeatureCamera,
    noise: OdometryNoise,
    options: FeatureOptions,
    particles: Vec<Particle>,
    odometry: Option<Pose>,
    /// What every particle did at every scan.
    steps: Vec<Vec<Did>>,
    beliefs: Vec<PoseBelief>,
}

#[derive(Debug, Clone)]
struct Particle {
    map: Map,
    pose: Pose,
    log_weight: f64,
    /// Since the start.
    log_total: f64,
    /// Number of the particle that it was at the scan before.
    parent: u32,
}

/// What a particle did at a scan.
#[derive(Debug, Clone)]
struct Did {
    parent: u32,
    pose: Pose,
    meant: Vec<Meant>,
}

/// Where the particles are after a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseBelief {
    /// Weighted mean of their poses.
    pub mean: Pose,
    /// Weighted covariance: x (m), y (m) and heading (rad).
    pub covariance: [[f64; 3]; 3],
    /// `N_eff` before drawing anew, 1 to the number of particles.
    pub effective: f64,
    /// Whether they were drawn anew.
    pub resampled: bool,
    /// Landmarks of the heaviest particle, those not yet confirmed among them.
    pub landmarks: usize,
}

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub struct FeatureOutcome {
    /// The pose at every scan, of the way that has most of the weight at the end.
    pub way: Vec<Pose>,
    /// Its confirmed landmarks.
    pub landmarks: Vec<Landmark>,
    /// What it took the readings of every scan for.
    pub meant: Vec<Vec<Meant>>,
    /// Where the particles were after every scan, by the readings up to it.
    pub beliefs: Vec<PoseBelief>,
}

impl FastSlam {
    /// Particles with empty maps.
    ///
    /// # Errors
    /// The first number out of its bounds.
    pub fn new(
        camera: FeatureCamera,
        noise: OdometryNoise,
        options: FeatureOptions,
    ) -> Result<Self, FeatureOptionsError> {
        options.check(&camera)?;
        noise.check().map_err(FeatureOptionsError::Odometry)?;
        Ok(Self {
            camera,
            noise,
            options,
            particles: Vec::new(),
            odometry: None,
            steps: Vec::new(),
            beliefs: Vec::new(),
        })
    }

    /// Takes a scan, made where the odometry has the pose `odometry`.
    ///
    /// The same seed gives the same bits on any number of threads: each particle has a stream of random numbers per scan.
    pub fn take(&mut self, scan: &FeatureScan, odometry: Pose) {
        let update = self.steps.len() as u32;
        if self.particles.is_empty() {
            let first = Particle { map: Map::default(), pose: odometry, log_weight: 0.0, log_total: 0.0, parent: 0 };
            self.particles =
                (0..self.options.particles as u32).map(|parent| Particle { parent, ..first.clone() }).collect();
        }
        let step = Step::between(self.odometry.unwrap_or(odometry), odometry);
        let measured = Measured::new(step, &self.noise);
        self.odometry = Some(odometry);
        let (camera, options) = (&self.camera, &self.options);
        let did: Vec<Did> = self
            .particles
            .par_iter_mut()
            .enumerate()
            .map(|(number, particle)| {
                let mut random = stream(options.seed, update, number as u32);
                particle.update(camera, options, &measured, &scan.readings, &mut random)
            })
            .collect();
        self.steps.push(did);
        let logs: Vec<f64> = self.particles.iter().map(|particle| particle.log_weight).collect();
        let weights = normalised(&logs);
        let effective = effective(&weights);
        let resampled = self.particles.len() > 1 && effective < RESAMPLED_BELOW * self.particles.len() as f64;
        let heaviest = self.heaviest();
        let poses = self.particles.iter().zip(&weights).map(|(particle, weight)| (particle.pose, *weight));
        let landmarks = self.particles[heaviest].map.len();
        self.beliefs.extend(Moments::of(poses).map(|Moments { mean, covariance }| PoseBelief {
            mean,
            covariance,
            effective,
            resampled,
            landmarks,
        }));
        if resampled {
            let share = stream(options.seed, update, ALL).random();
            let copy = |which: usize| {
                let particle = self.particles[which].clone();
                Particle { parent: which as u32, log_weight: 0.0, ..particle }
            };
            self.particles = low_variance(&weights, share).into_iter().map(copy).collect();
        } else {
            self.particles.iter_mut().enumerate().for_each(|(number, particle)| particle.parent = number as u32);
        }
    }

    /// Where the particles are after the last scan.
    pub fn belief(&self) -> Option<&PoseBelief> {
        self.beliefs.last()
    }

    /// The way and the landmarks of the particle that is the heaviest.
    pub fn finish(self) -> FeatureOutcome {
        if self.particles.is_empty() {
            return FeatureOutcome { way: Vec::new(), landmarks: Vec::new(), meant: Vec::new(), beliefs: Vec::new() };
        }
        let best = &self.particles[self.heaviest()];
        let (mut way, mut meant, mut number) = (Vec::new(), Vec::new(), best.parent as usize);
        for step in self.steps.iter().rev() {
            let did = &step[number];
            way.push(did.pose);
            meant.push(did.meant.clone());
            number = did.parent as usize;
        }
        way.reverse();
        meant.reverse();
        FeatureOutcome { way, landmarks: confirmed(best.map.landmarks()), meant, beliefs: self.beliefs }
    }

    /// The particle with most of the weight; of equal ones, the one that has explained most since the start, then the first.
    fn heaviest(&self) -> usize {
        let key = |particle: &Particle| (particle.log_weight, particle.log_total);
        let mut best = 0;
        for (number, particle) in self.particles.iter().enumerate() {
            let ((weight, total), (most, most_total)) = (key(particle), key(&self.particles[best]));
            if weight > most || (weight >= most && total > most_total) {
                best = number;
            }
        }
        best
    }
}

impl Particle {
    fn update(
        &mut self,
        camera: &FeatureCamera,
        options: &FeatureOptions,
        measured: &Measured,
        readings: &[FeatureReading],
        random: &mut ChaCha8Rng,
    ) -> Did {
        let rules = &options.association;
        let proposed = match options.proposal {
            FeatureProposal::Odometry => Belief::ODOMETRY,
            FeatureProposal::Latest => after(&self.map, camera, rules, (self.pose, measured), readings),
        };
        let (errors, log_ratio) = proposed.draw(random);
        self.pose = measured.pose(self.pose, errors);
        let taken = self.map.take(camera, rules, self.pose, readings);
        let log_weight = taken.log_likelihood + log_ratio;
        self.log_weight += log_weight;
        self.log_total += log_weight;
        Did { parent: self.parent, pose: self.pose, meant: taken.landmarks }
    }
}
