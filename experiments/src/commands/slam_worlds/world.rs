//! One world: driven with odometry that drifts, mapped and scored.

use std::sync::Arc;

use mapper::catalogue::Entry;
use mapper::{Model, Sensors};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use scene::{BesideScan, Family, Look, Odometry, SimulatedScan};
use score::trajectory::{Pair, absolute, aligned};
use score::{Region, Scorer, Sightings};
use sensor::{FeatureCamera, FeatureScan, Laser, Pose, Scan};
use slam::features::{FastSlam, PoseBelief};
use slam::{Moments, Slam, Weight};

use super::options::{Sensing, SlamWorldsOptions, Weighed};
use crate::failure::Failure;
use crate::worlds::carried::{carried, mounted};
use crate::worlds::condition::AS_BELIEVED;
use crate::worlds::landmarks;
use crate::worlds::site::{Assumptions, Site, WorldId};
use crate::worlds::track::{consistency, plain};
use crate::worlds::witness::Witness;

/// Random stream of a laser's readings, far from those of the camera.
const LASER: u64 = 1 << 40;

/// Beams of the laser, a degree apart.
const BEAMS: u32 = 181;

/// How a world went.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outcome {
    pub(super) family: String,
    pub(super) seed: u64,
    pub(super) sensor: Sensing,
    pub(super) weighed: Weighed,
    /// Root mean square error of the places after alignment, m: found, and by the odometry.
    pub(super) ate_m: f64,
    pub(super) odometry_ate_m: f64,
    /// Log loss of the map, nats per cell: from the poses found, aligned with the true ones as a rigid body, and from the true poses.
    pub(super) log_loss: f64,
    pub(super) true_log_loss: f64,
    /// Mean of `N_eff`, and how often particles were drawn anew.
    pub(super) effective: f64,
    pub(super) resampled: usize,
    /// Normalised squared error of the last pose by the spread of the particles; none where they do not spread in all of x, y and heading.
    pub(super) nees: Option<f64>,
}

/// A way that was found.
struct Way {
    /// The pose at every scan.
    poses: Vec<Pose>,
    /// `N_eff` of every update, of which there is one at least, and how often particles were drawn anew.
    effective: Vec<f64>,
    resampled: usize,
    nees: Option<f64>,
}

/// A world with its readings, before any filter.
pub(super) struct Drive {
    family: String,
    seed: u64,
    sensing: Sensing,
    site: Site,
    scans: Vec<SimulatedScan>,
    odometry: Vec<Pose>,
    /// What the camera reads of features at every scan.
    camera: FeatureCamera,
    features: Vec<FeatureScan>,
    /// What its rays can see.
    seen: Sightings,
}

impl Drive {
    /// Drives through a world of a family.
    pub(super) fn of(family: &Family, seed: u64, sensing: Sensing) -> Result<Self, Failure> {
        let condition = AS_BELIEVED.name.to_owned();
        let world = WorldId { family: family.name.clone(), condition, cell_um: None, seed };
        let mut site = Site::of_family(family, &world, &Assumptions::default())?;
        if site.ground.moves() {
            return Err(Failure::BadInput(format!(
                "--families: {}: things move in it, and slam takes worlds at rest",
                family.name
            )));
        }
        let driven: Vec<Pose> = site.ground.drive.poses.iter().map(|timed| timed.pose).collect();
        let odometry = Odometry { noise: SlamWorldsOptions::NOISE, ..Odometry::default() }.measure(&driven, seed);
        if sensing != Sensing::Own {
            site.ground.scene.sensors.clear();
        }
        let found = scene::features(&site.ground.scene);
        let camera = landmarks::camera(&site.ground.scene);
        let observed =
            scene::observe(&site.ground.scene, &site.ground.world, &site.ground.drive, &found, &camera, seed);
        let features = observed.into_iter().map(|observed| observed.scan).collect();
        let mut scans = scene::simulate(&site.ground.scene, &site.ground.world, &site.ground.drive, seed).scans;
        let laser = Laser::default();
        match sensing {
            Sensing::Stereo | Sensing::Own => {}
            Sensing::Laser => {
                site.setup = Model { prior: site.setup.prior, ..Model::new(site.setup.grid, Arc::new(laser)) };
                for (number, scan) in scans.iter_mut().enumerate() {
                    let (read, true_ranges_m) = look(&site, &laser, (seed, number), scan.scan.clone());
                    (scan.scan, scan.true_ranges_m) = (read, true_ranges_m);
                }
            }
            Sensing::Both => {
                let camera = site.setup.sensors.of(&Scan::default()).clone();
                site.setup.sensors = Sensors::new(vec![camera, Arc::new(laser)]);
                for (number, scan) in scans.iter_mut().enumerate() {
                    let (read, true_ranges_m) = look(&site, &laser, (seed, number), scan.scan.clone());
                    scan.beside = vec![beside(read, true_ranges_m, &laser)];
                }
            }
        }
        if scans.iter().any(|simulated| simulated.together().is_empty()) {
            return Err(Failure::BadInput(format!(
                "--families: {}: its robot reads nothing at some times; give it [camera], or a sensor without every",
                family.name
            )));
        }
        let mut witness = Witness::new(&site.ground);
        scans.iter().enumerate().try_for_each(|(number, scan)| witness.look(&site.ground, number, scan))?;
        let (family, seen) = (family.name.clone(), witness.seen);
        Ok(Self { family, seed, sensing, site, scans, odometry, camera, features, seen })
    }

    /// How it goes by every weight; what does not depend on it is found once.
    pub(super) fn outcomes(
        &self,
        entry: &Entry,
        weighed: &[Weighed],
        options: &SlamWorldsOptions,
    ) -> Result<Vec<Outcome>, Failure> {
        let (odometry_ate_m, _) = self.aligned(&self.odometry)?;
        let driven: Vec<Pose> = self.site.ground.drive.poses.iter().map(|timed| timed.pose).collect();
        let true_log_loss = self.log_loss(entry, &driven)?;
        let outcome = |weighed: &Weighed| {
            let way = match weighed.weight {
                Some(weight) => self.by_grid(entry, weight, weighed.with_landmarks(), options)?,
                None => self.by_landmarks(options)?,
            };
            let (ate_m, aligned) = self.aligned(&way.poses)?;
            Ok(Outcome {
                family: self.family.clone(),
                seed: self.seed,
                sensor: self.sensing,
                weighed: *weighed,
                ate_m,
                odometry_ate_m,
                log_loss: self.log_loss(entry, &aligned)?,
                true_log_loss,
                effective: way.effective.iter().sum::<f64>() / way.effective.len() as f64,
                resampled: way.resampled,
                nees: way.nees,
            })
        };
        weighed.iter().map(outcome).collect()
    }

    /// Finds the way with a grid to every particle, and with landmarks beside it where they are asked for.
    fn by_grid(
        &self,
        entry: &Entry,
        weight: Weight,
        with_landmarks: bool,
        options: &SlamWorldsOptions,
    ) -> Result<Way, Failure> {
        let Site { ground, setup } = &self.site;
        let noise = Arc::new(SlamWorldsOptions::NOISE);
        let mut filter = Slam::new(entry.mapper(setup), setup, noise, options.filter(self.seed, weight))
            .map_err(|error| Failure::BadInput(format!("--mapper {}: {error}", entry.name)))?;
        if with_landmarks {
            let rules = options.features(self.seed).association;
            filter = filter.beside(self.camera, rules).map_err(Failure::internal)?;
        }
        for ((scan, features), odometry) in self.scans.iter().zip(&self.features).zip(&self.odometry) {
            filter.take_together(&mounted(&carried(scan)), &features.readings, *odometry);
        }
        let last = ground.drive.poses.last().map(|timed| timed.pose);
        let nees = last.zip(Moments::of(filter.particles())).and_then(|(last, moments)| consistency(&moments, last));
        let outcome = filter.finish();
        Ok(Way {
            poses: outcome.trajectory.iter().map(|(_, pose)| *pose).collect(),
            effective: outcome.updates.iter().map(|update| update.effective).collect(),
            resampled: outcome.updates.iter().filter(|update| update.resampled).count(),
            nees,
        })
    }

    /// Finds the way by landmarks alone.
    fn by_landmarks(&self, options: &SlamWorldsOptions) -> Result<Way, Failure> {
        let mut filter = FastSlam::new(self.camera, SlamWorldsOptions::NOISE, options.features(self.seed))
            .map_err(Failure::internal)?;
        for (features, odometry) in self.features.iter().zip(&self.odometry) {
            filter.take(features, *odometry);
        }
        let outcome = filter.finish();
        let last = outcome.beliefs.last().zip(self.site.ground.drive.poses.last());
        Ok(Way {
            poses: outcome.way,
            effective: outcome.beliefs.iter().map(|belief| belief.effective).collect(),
            resampled: outcome.beliefs.iter().filter(|belief| belief.resampled).count(),
            nees: last.and_then(|(belief, last)| {
                let &PoseBelief { mean, covariance, .. } = belief;
                consistency(&Moments { mean, covariance }, last.pose)
            }),
        })
    }

    /// The absolute error of poses, m, after alignment with the true ones, and the poses aligned.
    fn aligned(&self, poses: &[Pose]) -> Result<(f64, Vec<Pose>), Failure> {
        let pair = |(pose, timed): (&Pose, &scene::TimedPose)| Pair {
            time_s: timed.time_s,
            estimate: plain(*pose),
            reference: plain(timed.pose),
        };
        let pairs: Vec<Pair> = poses.iter().zip(&self.site.ground.drive.poses).map(pair).collect();
        let moved = aligned(&pairs).map_err(Failure::internal)?;
        let errors = absolute(&moved).map_err(Failure::internal)?;
        let back = |pair: &Pair| {
            let score::trajectory::Pose { x_m, y_m, theta_rad } = pair.estimate;
            Pose { x_m, y_m, theta_rad }
        };
        Ok((errors.translation_m.rmse, moved.iter().map(back).collect()))
    }

    /// Log loss of the map of all scans from poses, nats per cell that could be seen.
    fn log_loss(&self, entry: &Entry, poses: &[Pose]) -> Result<f64, Failure> {
        let Site { ground, setup } = &self.site;
        let mut mapper = entry.mapper(setup);
        for (scan, pose) in self.scans.iter().zip(poses) {
            let mut moved = scan.clone();
            moved.move_to(*pose);
            mapper.integrate_together(&moved.together());
        }
        mapper.settle();
        let scorer = Scorer::new(&ground.truth, self.seen.surface())?;
        let scores = scorer.scores(mapper.occupancy(), &self.seen.mask(Region::Observable))?;
        let nothing = || Failure::Internal(format!("{} seed {}: nothing could be seen", self.family, self.seed));
        scores.log_loss.value.ok_or_else(nothing)
    }
}

/// What a laser measures where and when a scan was made, and the true ranges, m.
fn look(site: &Site, laser: &Laser, (seed, number): (u64, usize), at: Scan) -> (Scan, Vec<Option<f64>>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(LASER + number as u64);
    let bearings_rad: Vec<f64> = (0..BEAMS).map(|beam| (f64::from(beam) - 90.0).to_radians()).collect();
    let cast = |bearing: &f64| {
        site.ground.world.cast(at.pose.position_m(), at.pose.direction(*bearing)).map(|hit| hit.range_m)
    };
    let true_ranges_m: Vec<Option<f64>> = bearings_rad.iter().map(cast).collect();
    let readings = true_ranges_m.iter().map(|range_m| Some(laser.sample(*range_m, &mut random))).collect();
    (Scan { bearings_rad, readings, ..at }, true_ranges_m)
}

/// The same as of a sensor beside the camera, in the middle of the robot.
fn beside(scan: Scan, true_ranges_m: Vec<Option<f64>>, laser: &Laser) -> BesideScan {
    let rays = scan.bearings_rad.iter().zip(&true_ranges_m);
    let looks =
        rays.map(|(&bearing_rad, &range_m)| Look { bearing_rad, range_m, reach_m: laser.max_range_m }).collect();
    BesideScan { scan: Scan { sensor: 1, ..scan }, mount: Pose::default(), true_ranges_m, looks }
}
