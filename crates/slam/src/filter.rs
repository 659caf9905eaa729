//! The Rao-Blackwellised particle filter (Doucet et al., UAI 2000; for grids Grisetti, Stachniss and Burgard 2007).

use std::collections::BTreeMap;
use std::sync::Arc;

use grid::GridSpec;
use mapper::{Mapper, Model, Sensors};
use rand::RngExt as _;
use rand_distr::StandardNormal;
use rayon::prelude::*;
use sensor::{FeatureCamera, FeatureReading, Pose, Scan, Step};

use crate::features::{Association, Beside, FeatureOptionsError, Landmark, confirmed};
use crate::motion::Motion;
use crate::options::{Options, OptionsError};
use crate::particle::{MOST, Particle, Shared};
use crate::random::{ALL, stream};
use crate::resampling::{effective, low_variance, normalised};
use crate::sight::{Mounted, Sight};
use crate::surfaces::Surfaces;
use crate::trajectory::{self, Row};

/// Points round a match from which its Gaussian is made; for each, there is the one on the other side.
const PAIRS: usize = 12;

/// The robot counts as carried away where its map predicts so many updates in a row worse than a map that has seen nothing ...
const LOST: usize = 3;

/// ... or one by so much, nats per reading. A scan that fits has some 4 more than nothing, one from elsewhere some 3 less.
const COLLAPSE: f64 = -1.0;

/// Scans in a row that are passed over where each by itself would say that the robot was carried away. Odometry that is late by a tenth of
/// a second while the robot turns fast puts a scan tens of degrees off, and the next one fits again.
const PATIENCE: usize = 4;

/// What an update of the filter came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Update {
    /// Time of the scan, s.
    pub time_s: f64,
    /// Pose of the heaviest particle.
    pub pose: Pose,
    /// `N_eff` before resampling.
    pub effective: f64,
    /// Whether particles were drawn anew.
    pub resampled: bool,
    /// Standard deviation of the particles' places, m.
    pub spread_m: f64,
    /// Share of the readings that ended on surfaces as the heaviest particle was matched, 0 to 1.
    pub matched: f64,
    /// How much better the map of the heaviest particle predicts the scan than one that has seen nothing, nats per reading; none of a map
    /// that does not predict.
    pub gain: Option<f64>,
    /// The robot is not where the map says: the map has predicted this scan far worse than one that has seen nothing would, or some
    /// updates in a row worse. Said once, and again only after a scan has fitted.
    pub carried_away: bool,
}

/// Where the robot went, and its map.
pub struct Outcome {
    /// Time, s, and pose of every scan.
    pub trajectory: Vec<(f64, Pose)>,
    /// The map of the particle with the largest weight over the whole way.
    pub map: Box<dyn Mapper>,
    /// The updates.
    pub updates: Vec<Update>,
    /// Times of the scans that were passed over, s: the map contradicted them, and one that came soon after fitted.
    pub passed_over: Vec<f64>,
    /// The confirmed landmarks of that particle, where features were looked at ([`Slam::beside`]).
    pub landmarks: Vec<Landmark>,
}

/// Trajectory and map together, scan by scan.
pub struct Slam {
    options: Options,
    motion: Arc<dyn Motion>,
    grid: GridSpec,
    sensors: Sensors,
    /// What features are looked at with, and how.
    features: Option<(FeatureCamera, Association)>,
    /// The map that has seen nothing.
    unseen: Box<dyn Mapper>,
    particles: Vec<Particle>,
    rows: Vec<Row>,
    /// The odometry at the last update that was matched or drawn, and at the last in which each sensor took part.
    last: Pose,
    taken: BTreeMap<usize, Pose>,
    /// The odometry at the last update with a sensor whose readings can be matched.
    matched: Option<Pose>,
    updates: Vec<Update>,
    /// Updates in a row that the map explains worse than none.
    unexplained: usize,
    /// Times of the scans that were passed over, s, and how many of them are the last in a row.
    passed_over: Vec<f64>,
    in_a_row: usize,
    /// Whether it was said that the robot was carried away, and no scan has fitted since.
    away: bool,
}

/// Why there is no filter.
#[derive(Debug, Clone, PartialEq)]
pub enum SlamError {
    /// An option makes no sense.
    Option(OptionsError),
    /// The mapper cannot be copied.
    NoCopies,
    /// Particles are to be weighed by evidence, and the mapper does not predict readings.
    NoEvidence,
}

impl std::fmt::Display for SlamError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Option(error) => error.fmt(f),
            Self::NoCopies => f.write_str("the mapper cannot be copied, and every particle needs a map of its own"),
            Self::NoEvidence => {
                f.write_str("the mapper does not predict readings, so that its evidence cannot weigh particles")
            }
        }
    }
}

impl std::error::Error for SlamError {}

impl Slam {
    /// A filter with a mapper that has seen nothing, and the model that it was made from.
    ///
    /// # Errors
    /// Options that make no sense, a mapper that cannot be copied, or that does not predict readings where its evidence is wanted.
    pub fn new(
        mapper: Box<dyn Mapper>,
        model: &Model,
        motion: Arc<dyn Motion>,
        options: Options,
    ) -> Result<Self, SlamError> {
        options.check().map_err(SlamError::Option)?;
        let first = Particle::first(mapper.fork().ok_or(SlamError::NoCopies)?, Surfaces::new(model.grid));
        let middle = model.grid.centre(model.grid.cells() / 2);
        let anywhere = Scan { pose: Pose { x_m: middle[0], y_m: middle[1], theta_rad: 0.0 }, ..Scan::default() };
        if matches!(options.weight, crate::Weight::Evidence { .. }) && mapper.evidence(&anywhere).is_none() {
            return Err(SlamError::NoEvidence);
        }
        Ok(Self {
            options,
            motion,
            grid: model.grid,
            sensors: model.sensors.clone(),
            features: None,
            unseen: mapper,
            particles: vec![first],
            rows: Vec::new(),
            last: Pose::default(),
            taken: BTreeMap::new(),
            matched: None,
            updates: Vec::new(),
            unexplained: 0,
            passed_over: Vec::new(),
            in_a_row: 0,
            away: false,
        })
    }

    /// The same with landmarks beside the grid: every particle has both maps, and its weight is the product of what the scan says of the one
    /// and the features of the other, which err independently of each other given the pose. To be said before the first scan.
    ///
    /// # Errors
    /// The first number out of its bounds.
    pub fn beside(mut self, camera: FeatureCamera, rules: Association) -> Result<Self, FeatureOptionsError> {
        rules.check(&camera)?;
        self.features = Some((camera, rules));
        Ok(self)
    }

    /// Takes the next scan of a robot with one sensor, with the pose of the sensor by the odometry; the pose of the scan does not matter.
    /// Tells what came of it, if it was one that updates the filter.
    ///
    /// # Panics
    /// If the scan names a sensor that the model does not have.
    pub fn take(&mut self, scan: &Scan, odometry: Pose) -> Option<Update> {
        self.take_with(scan, &[], odometry)
    }

    /// As [`take`](Self::take), with the features that the camera read there; they count where they are looked at
    /// ([`beside`](Self::beside)), of the scans that update the filter.
    ///
    /// # Panics
    /// As [`take`](Self::take).
    pub fn take_with(&mut self, scan: &Scan, readings: &[FeatureReading], odometry: Pose) -> Option<Update> {
        self.take_together(&[Mounted { scan, mount: Pose::default() }], readings, odometry)
    }

    /// As [`take_with`](Self::take_with), of what several sensors read at one time, in the order of their numbers, with the pose of the
    /// robot by the odometry: one scan, which updates the filter once the robot has moved far enough since one of its sensors took part in
    /// an update. Readings of rays are matched and weigh particles; those of cones ([`Kernel::width_rad`](sensor::Kernel::width_rad)) weigh
    /// them by the map's evidence, and are not matched, since nobody knows at which bearing they ended.
    ///
    /// # Panics
    /// As [`take`](Self::take), and where there is no scan.
    pub fn take_together(&mut self, scans: &[Mounted], readings: &[FeatureReading], odometry: Pose) -> Option<Update> {
        assert!(!scans.is_empty(), "at least one sensor has read");
        let step = Step::between(self.last, odometry);
        let is_near = |sensor: usize| {
            let Some(taken) = self.taken.get(&sensor) else { return false };
            let step = Step::between(*taken, odometry);
            step.distance_m.abs() < self.options.update_move_m && step.turn_rad().abs() < self.options.update_turn_rad
        };
        let time_s = scans[0].scan.time_s;
        if scans.iter().all(|mounted| is_near(mounted.scan.sensor)) {
            let updates = self.updates.len();
            self.rows.push(Row { time_s, odometry, updates });
            return None;
        }
        let sight = Sight::new(scans, &self.sensors, &self.options);
        let update = if self.rows.is_empty() {
            Some(self.begin(&sight, readings, odometry))
        } else {
            self.update(&sight, readings, odometry, step)
        };
        if update.is_some() {
            if !self.follows(&sight, odometry) {
                self.last = odometry;
            }
            if sight.can_match {
                self.matched = Some(odometry);
            }
            self.taken.extend(scans.iter().map(|mounted| (mounted.scan.sensor, odometry)));
        }
        self.updates.extend(update);
        self.rows.push(Row { time_s, odometry, updates: self.updates.len() });
        update
    }

    /// Whether poses follow the odometry at an update that cannot be matched, since one was matched not far back: what is drawn between two matches
    /// the second could not take back, and what is not drawn it can look for.
    fn follows(&self, sight: &Sight, odometry: Pose) -> bool {
        !sight.can_match
            && self.matched.is_some_and(|matched| {
                let step = Step::between(matched, odometry);
                step.distance_m.abs() < MOST[0] && step.turn_rad().abs() < MOST[1]
            })
    }

    /// The first scan: all particles are where the odometry says, and share one map.
    fn begin(&mut self, sight: &Sight, readings: &[FeatureReading], odometry: Pose) -> Update {
        self.particles.truncate(1);
        let first = &mut self.particles[0];
        if let Some((camera, rules)) = &self.features {
            Beside { camera, rules, readings }.take(&mut first.landmarks, odometry);
        }
        first.take(sight, odometry, odometry);
        let copies: Vec<Particle> = (1..self.options.particles).filter_map(|_| self.particles[0].fork()).collect();
        self.particles.extend(copies);
        Update {
            time_s: sight.time_s,
            pose: odometry,
            effective: self.particles.len() as f64,
            resampled: false,
            spread_m: 0.0,
            matched: 0.0,
            gain: None,
            carried_away: false,
        }
    }

    fn update(&mut self, sight: &Sight, readings: &[FeatureReading], odometry: Pose, step: Step) -> Option<Update> {
        let number = self.updates.len() as u32;
        let seed = self.options.seed;
        let mut random = stream(seed, number, ALL);
        let points: Vec<[f64; 3]> = (0..PAIRS)
            .map(|_| std::array::from_fn(|_| random.sample::<f64, _>(StandardNormal)))
            .flat_map(|point: [f64; 3]| [point, point.map(|value| -value)])
            .collect();
        let beside = self.features.as_ref().map(|(camera, rules)| Beside { camera, rules, readings });
        let (options, motion) = (&self.options, &*self.motion);
        let follows = self.follows(sight, odometry);
        let shared = Shared { options, motion, sight, beside, odometry, step, follows, points: &points };
        self.particles.par_iter_mut().enumerate().for_each(|(k, particle)| {
            particle.find(&shared, &mut stream(seed, number, k as u32));
        });
        let logs: Vec<f64> =
            self.particles.iter().map(|particle| particle.log_weight + particle.found.log_weight).collect();
        let weights = normalised(&logs);
        let heaviest = heaviest(&logs);
        let best = &self.particles[heaviest];
        let (pose, matched) = (best.found.pose, best.found.matched);
        let unseen = sight.evidence(&*self.unseen, pose);
        let gain = best.found.evidence.zip(unseen).filter(|_| sight.asked() > 0);
        let gain = gain.map(|(known, unknown)| (known - unknown) / sight.asked() as f64);
        if gain.is_some_and(|gain| gain < COLLAPSE) && self.in_a_row < PATIENCE {
            self.in_a_row += 1;
            self.passed_over.push(sight.time_s);
            return None;
        }
        self.in_a_row = 0;
        self.particles.par_iter_mut().for_each(|particle| particle.accept(sight, odometry, follows));
        let carried_away = self.is_carried_away(gain);
        let effective = effective(&weights);
        let resampled = effective < 0.5 * self.particles.len() as f64;
        let update = Update {
            time_s: sight.time_s,
            pose,
            effective,
            resampled,
            spread_m: spread_m(&self.particles, &weights),
            matched,
            gain,
            carried_away,
        };
        if resampled {
            self.resample(&low_variance(&weights, random.random()));
        }
        Some(update)
    }

    /// Whether the robot is found to be carried away now, and was not before.
    fn is_carried_away(&mut self, gain: Option<f64>) -> bool {
        let Some(gain) = gain else { return false };
        self.unexplained = if gain < 0.0 { self.unexplained + 1 } else { 0 };
        let collapsed = gain < COLLAPSE || self.unexplained >= LOST;
        let news = collapsed && !self.away;
        self.away = collapsed || self.away && gain < 0.0;
        news
    }

    /// Goes on with copies of the chosen particles; whoever is chosen goes on itself, and is copied for the others.
    fn resample(&mut self, chosen: &[usize]) {
        let mut next: Vec<Particle> = Vec::with_capacity(chosen.len());
        let mut before: Vec<Option<Particle>> = self.particles.drain(..).map(Some).collect();
        for (k, which) in chosen.iter().enumerate() {
            // Equal numbers stand together.
            let again = k > 0 && chosen[k - 1] == *which;
            let particle = if again { next[k - 1].fork() } else { before[*which].take() };
            next.extend(particle);
        }
        next.iter_mut().for_each(|particle| particle.log_weight = 0.0);
        self.particles = next;
    }

    /// Number of scans so far.
    pub fn scans(&self) -> usize {
        self.rows.len()
    }

    /// Poses of all particles with their weights, which add up to one.
    pub fn particles(&self) -> Vec<(Pose, f64)> {
        let logs: Vec<f64> = self.particles.iter().map(|particle| particle.log_weight).collect();
        let poses = self.particles.iter().filter_map(|particle| particle.path.last().copied());
        poses.zip(normalised(&logs)).collect()
    }

    /// The ways of all particles, a pose for every update, with their weights, which add up to one.
    pub fn paths(&self) -> Vec<(&[Pose], f64)> {
        let logs: Vec<f64> = self.particles.iter().map(|particle| particle.log_weight).collect();
        self.particles.iter().map(|particle| &particle.path[..]).zip(normalised(&logs)).collect()
    }

    /// Memory of the particles, bytes: what several share, each holds its share of.
    pub fn bytes(&self) -> Vec<usize> {
        self.particles.iter().map(|particle| particle.map.work().bytes + particle.surfaces.bytes()).collect()
    }

    /// The cells of the maps.
    pub fn grid(&self) -> &GridSpec {
        &self.grid
    }

    /// The end: the way and the map of the particle with the largest weight over the whole way.
    pub fn finish(mut self) -> Outcome {
        let totals: Vec<f64> = self.particles.iter().map(|particle| particle.log_total).collect();
        let mut best = self.particles.swap_remove(heaviest(&totals));
        best.map.settle();
        Outcome {
            trajectory: trajectory::poses(&self.rows, &best.path),
            map: best.map,
            updates: self.updates,
            passed_over: self.passed_over,
            landmarks: confirmed(best.landmarks.landmarks()),
        }
    }
}

/// The first of those with the largest weight.
fn heaviest(logs: &[f64]) -> usize {
    (0..logs.len()).rev().max_by(|a, b| logs[*a].total_cmp(&logs[*b])).unwrap_or(0)
}

/// Standard deviation of the particles' places, m.
fn spread_m(particles: &[Particle], weights: &[f64]) -> f64 {
    let places = || particles.iter().filter_map(|particle| particle.path.last()).map(Pose::position_m).zip(weights);
    let mean = [0, 1].map(|k| places().map(|(at, weight)| weight * at[k]).sum::<f64>());
    let squared = |at: [f64; 2]| (0..2).map(|k| (at[k] - mean[k]) * (at[k] - mean[k])).sum::<f64>();
    places().map(|(at, weight)| weight * squared(at)).sum::<f64>().sqrt()
}
