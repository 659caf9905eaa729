//! A particle: one way that the robot may have gone, with the map that belongs to it.

use mapper::Mapper;
use nalgebra::{Matrix3, Vector3};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use sensor::{Pose, Step, wrapped_rad};

use crate::features::{Beside, Landmarks};
use crate::field::Field;
use crate::frame::{Frame, turned};
use crate::gaussian::Gaussian;
use crate::matcher::{Window, coarse, moved, uphill};
use crate::motion::Motion;
use crate::options::{NOWHERE, Options, Proposal, Weight};
use crate::sight::{End, Sight};
use crate::surfaces::Surfaces;

/// The matcher looks at poses up to so many standard deviations of the odometry away ...
const SIGMAS: f64 = 3.0;

/// ... and so far, m and rad, whatever the odometry says ...
const LEAST: [f64; 2] = [0.15, 0.05];

/// ... but no farther than this.
pub(crate) const MOST: [f64; 2] = [1.0, 0.5];

/// So far beyond the window the way uphill and points round its end may lead, m and rad.
const BEYOND: [f64; 2] = [0.2, 0.02];

/// Steps of the differences from which the curvature at the best match is taken, m and rad.
const STEPS: [f64; 3] = [0.015, 0.015, 0.006];

/// Points round the best match are drawn from a Gaussian so much wider than the curvature says.
const WIDER: f64 = 1.5;

/// A nat for a reading that is on a surface, before it is multiplied by the power: what the coarse matcher goes by.
const GAIN: f64 = 2.0;

/// One way that the robot may have gone.
pub(crate) struct Particle {
    pub(crate) map: Box<dyn Mapper>,
    pub(crate) surfaces: Surfaces,
    /// The landmarks beside the map, and what the last update would make of them; empty where features are not looked at.
    pub(crate) landmarks: Landmarks,
    updated: Option<Landmarks>,
    /// Where the odometry's frame lies.
    pub(crate) frame: Frame,
    /// Poses at the scans that updated the filter, and the last of them that was matched or drawn.
    pub(crate) path: Vec<Pose>,
    anchor: Pose,
    /// Logarithm of the weight since the last resampling, and since the start.
    pub(crate) log_weight: f64,
    pub(crate) log_total: f64,
    /// What the last update found.
    pub(crate) found: Found,
}

/// What an update of a particle found.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Found {
    /// The next pose.
    pub(crate) pose: Pose,
    /// Logarithm of what the scan weighs the particle by.
    pub(crate) log_weight: f64,
    /// `ln P(readings | map)` of the rays that the map is asked about, at the particle's pose; none of a map that does not predict.
    pub(crate) evidence: Option<f64>,
    /// Mean worth of the readings as matched, 0 to 1; 0 where nothing was matched.
    pub(crate) matched: f64,
}

/// What all particles of an update share.
pub(crate) struct Shared<'a> {
    pub(crate) options: &'a Options,
    pub(crate) motion: &'a dyn Motion,
    pub(crate) sight: &'a Sight,
    /// The features that were read with the scan, where they are looked at.
    pub(crate) beside: Option<Beside<'a>>,
    pub(crate) odometry: Pose,
    /// The way by the odometry since the last update that was matched or drawn.
    pub(crate) step: Step,
    /// Whether the pose is to follow the odometry, until it can be matched.
    pub(crate) follows: bool,
    /// Standard normal points, the same for all particles, so that weights do not differ by the luck of their points.
    pub(crate) points: &'a [[f64; 3]],
}

impl Particle {
    /// The first one, at the odometry's pose.
    pub(crate) fn first(map: Box<dyn Mapper>, surfaces: Surfaces) -> Self {
        Self {
            map,
            surfaces,
            landmarks: Landmarks::default(),
            updated: None,
            frame: Frame::SAME,
            path: Vec::new(),
            anchor: Pose::default(),
            log_weight: 0.0,
            log_total: 0.0,
            found: Found::default(),
        }
    }

    /// Another that goes on from here with no weight yet; none of a map that cannot be copied.
    pub(crate) fn fork(&self) -> Option<Self> {
        Some(Self {
            map: self.map.fork()?,
            surfaces: self.surfaces.clone(),
            landmarks: self.landmarks.clone(),
            updated: None,
            path: self.path.clone(),
            log_weight: 0.0,
            ..*self
        })
    }

    /// Finds the next pose and weighs it.
    pub(crate) fn find(&mut self, shared: &Shared, random: &mut ChaCha8Rng) {
        let guess = self.frame.pose(shared.odometry);
        let sigmas = shared.motion.sigmas(&shared.step);
        let exact = sigmas.iter().all(|sigma| *sigma <= 0.0);
        let (pose, log_weight) = match shared.options.proposal {
            _ if shared.follows => {
                self.found.matched = 0.0;
                (guess, 0.0)
            }
            Proposal::Odometry => self.by_odometry(shared, (guess, exact), random),
            Proposal::Matched => match self.by_matching(shared, guess, sigmas, random) {
                Some(matched) => matched,
                None => self.by_odometry(shared, (guess, exact), random),
            },
        };
        let rays = shared.sight.evidence_of_rays(&*self.map, pose);
        let cones = shared.sight.evidence_of_cones(&*self.map, pose);
        self.found.evidence = rays.zip(cones).map(|(rays, cones)| rays + cones);
        let log_weight = log_weight + self.weight_of_cones(shared, pose, cones);
        (self.found.pose, self.found.log_weight) = (pose, log_weight + self.look(shared.beside, pose));
    }

    /// `ln p(features | pose, landmarks)`; what they make of the landmarks is kept until the pose is taken for true.
    fn look(&mut self, beside: Option<Beside>, pose: Pose) -> f64 {
        let Some(beside) = beside else { return 0.0 };
        let mut updated = self.landmarks.clone();
        let log_likelihood = beside.take(&mut updated, pose);
        self.updated = Some(updated);
        log_likelihood
    }

    /// Takes what was found for true, and maps the scan from there.
    pub(crate) fn accept(&mut self, sight: &Sight, odometry: Pose, follows: bool) {
        self.log_weight += self.found.log_weight;
        self.log_total += self.found.log_weight;
        self.landmarks = self.updated.take().unwrap_or_default();
        let anchor = self.anchor;
        self.take(sight, odometry, self.found.pose);
        if follows {
            self.anchor = anchor;
        }
    }

    /// Maps the scans of one time from a pose.
    pub(crate) fn take(&mut self, sight: &Sight, odometry: Pose, pose: Pose) {
        self.frame = Frame::taking(odometry, pose);
        self.path.push(pose);
        self.anchor = pose;
        self.map.integrate_together(&sight.from(pose));
        for end in &sight.ends {
            self.surfaces.add(placed(pose, end));
        }
    }

    /// A pose drawn from the odometry, and the logarithm of what the scan says of it.
    fn by_odometry(&mut self, shared: &Shared, (guess, exact): (Pose, bool), random: &mut ChaCha8Rng) -> (Pose, f64) {
        self.found.matched = 0.0;
        // A single particle stays in the middle of what the odometry allows, where its sensors cannot tell better.
        let alone = shared.options.particles == 1 && !shared.sight.can_match;
        let pose = if exact || alone { guess } else { shared.motion.draw(&shared.step, random).end(self.anchor) };
        let log_weight = match shared.options.weight {
            Weight::Field { power } => {
                let field = self.field(shared, pose, [0.0; 2], false);
                power * worth_of_ends(&field, shared.sight, pose)
            }
            Weight::Evidence { power, .. } => power * self.evidence(shared.sight, pose),
        };
        (pose, log_weight)
    }

    /// A pose from the Gaussian round the best match, and the logarithm of the scan's likelihood over all poses that the odometry
    /// allows; none where there is nothing to match.
    fn by_matching(
        &mut self,
        shared: &Shared,
        guess: Pose,
        sigmas: [f64; 3],
        random: &mut ChaCha8Rng,
    ) -> Option<(Pose, f64)> {
        if shared.sight.ends.is_empty() {
            return None;
        }
        let sigmas: [f64; 3] = std::array::from_fn(|k| sigmas[k].max(shared.options.least_sigmas[k]));
        let half = |sigma: f64, k: usize| (SIGMAS * sigma).clamp(LEAST[k], MOST[k]);
        let search = Search { guess, sigmas, half: [half(sigmas[0].max(sigmas[1]), 0), half(sigmas[2], 1)] };
        let field = self.field(shared, guess, search.margins(), true);
        if field.surfaces == 0 {
            return None;
        }
        let found = search.best(&field, shared);
        self.found.matched = found.matched;
        let power = shared.options.sharpness.power;
        let height = |pose: Pose| search.height(&field, shared, pose);
        let around = Around::new((found.top, found.most), sigmas, shared.points, height);
        let log_weight = match shared.options.weight {
            Weight::Field { power: weighed } => weighed / power * around.log_integral,
            Weight::Evidence { power: weighed, .. } => {
                around.log_mean(|at| weighed * self.evidence(shared.sight, moved(found.top, at)))
            }
        };
        let normal = std::array::from_fn(|_| random.sample::<f64, _>(StandardNormal));
        let normal = if shared.options.particles == 1 { [0.0; 3] } else { normal };
        Some((moved(found.top, around.gaussian.point(&normal)), log_weight))
    }

    /// The surfaces round the readings as they end from a pose, and from those up to a distance (m) and a turn (rad) away.
    fn field(&self, shared: &Shared, round: Pose, [far_m, turn_rad]: [f64; 2], bounds: bool) -> Field {
        let (mut low, mut high, mut reach_m) = (round.position_m(), round.position_m(), 0.0f64);
        for end in &shared.sight.ends {
            let at = placed(round, end);
            (low, high) = ([0, 1].map(|k| low[k].min(at[k])), [0, 1].map(|k| high[k].max(at[k])));
            reach_m = reach_m.max(libm::hypot(end.at[0], end.at[1]));
        }
        let margin_m = far_m + reach_m * turn_rad;
        let corners = [low.map(|at| at - margin_m), high.map(|at| at + margin_m)];
        Field::new(&self.surfaces, &*self.map, shared.options.sharpness, corners, bounds)
    }

    /// What cones, which the pose was not drawn by, weigh it by: the map's evidence there, also where all else is weighed by a field. Nothing of
    /// a map that does not predict, nor where there are none.
    fn weight_of_cones(&self, shared: &Shared, pose: Pose, evidence: Option<f64>) -> f64 {
        let power = match shared.options.weight {
            Weight::Evidence { power, .. } => power,
            Weight::Field { .. } => Weight::EVIDENCE.power(),
        };
        match evidence {
            Some(evidence) => power * evidence,
            None if shared.sight.cones_begin_in(self.surfaces.spec(), pose) => 0.0,
            None => f64::NEG_INFINITY,
        }
    }

    /// `ln P(readings | map)` of the rays that the map is asked about; of a map that does not predict, nothing.
    fn evidence(&self, sight: &Sight, pose: Pose) -> f64 {
        sight.evidence_of_rays(&*self.map, pose).unwrap_or(f64::NEG_INFINITY)
    }
}

/// Where a match is looked for.
#[derive(Clone, Copy)]
struct Search {
    /// The pose by the odometry.
    guess: Pose,
    /// How far that may be off, along, across and in the heading, m, m and rad.
    sigmas: [f64; 3],
    /// Half of the window, m and rad.
    half: [f64; 2],
}

/// The best match.
struct Match {
    top: Pose,
    /// Its height.
    most: f64,
    /// Mean worth of the readings.
    matched: f64,
}

impl Search {
    /// How far poses that are looked at may lie from the guess, m and rad.
    fn margins(&self) -> [f64; 2] {
        [0, 1].map(|k| self.half[k] + BEYOND[k])
    }

    /// `ln p(z | m, x) p(x | x', u)` of a pose, up to what is the same for all particles.
    fn height(&self, field: &Field, shared: &Shared, pose: Pose) -> f64 {
        let [along, across] = turned([pose.x_m - self.guess.x_m, pose.y_m - self.guess.y_m], -self.guess.theta_rad);
        let off = [along, across, wrapped_rad(pose.theta_rad - self.guess.theta_rad)];
        let prior = -0.5 * (0..3).map(|k| (off[k] / self.sigmas[k]) * (off[k] / self.sigmas[k])).sum::<f64>();
        shared.options.sharpness.power * worth_of_ends(field, shared.sight, pose) + prior
    }

    fn best(&self, field: &Field, shared: &Shared) -> Match {
        let window = Window {
            around: self.guess,
            half_m: self.half[0],
            half_rad: self.half[1],
            sigmas: [self.sigmas[0].max(self.sigmas[1]), self.sigmas[2]],
            gain: GAIN * shared.options.sharpness.power,
        };
        let ends = &shared.sight.ends;
        let start = coarse(field, &window, ends);
        let (top, most) = uphill(start, |pose| self.height(field, shared, pose));
        let worth = |end: &End| end.share * field.worth(placed(top, end));
        let all = ends.iter().map(|end| end.share).sum::<f64>();
        Match { top, most, matched: ends.iter().map(worth).sum::<f64>() / all }
    }
}

/// Where a reading ended as seen from a pose, m.
fn placed(pose: Pose, end: &End) -> [f64; 2] {
    moved(pose, [end.at[0], end.at[1], 0.0]).position_m()
}

/// The sum of the likelihood field over the readings of a scan, nats.
fn worth_of_ends(field: &Field, sight: &Sight, pose: Pose) -> f64 {
    let worth = |end: &End| {
        let worth = field.worth(placed(pose, end));
        end.share * libm::log((1.0 - NOWHERE) * worth + NOWHERE)
    };
    sight.ends.iter().map(worth).sum()
}

/// Points round the top of a logarithm of a density times a constant, drawn from a Gaussian of the curvature there. Each counts for what
/// it is worth over how densely points were drawn there.
struct Around {
    /// Points, along and across the pose of the top and turned, with their weights.
    points: Vec<([f64; 3], f64)>,
    /// The Gaussian that has their moments.
    gaussian: Gaussian,
    /// Logarithm of the integral over all poses.
    log_integral: f64,
}

impl Around {
    fn new((top, most): (Pose, f64), sigmas: [f64; 3], normals: &[[f64; 3]], height: impl Fn(Pose) -> f64) -> Self {
        let shape = curvature(top, most, sigmas, &height);
        let drawn = shape.wider(WIDER);
        let weighted = |normal: &[f64; 3]| {
            let at = drawn.point(normal);
            (at, libm::exp((height(moved(top, at)) - most - drawn.log_density(normal)).min(300.0)))
        };
        let points: Vec<([f64; 3], f64)> = normals.iter().map(weighted).collect();
        let mean = points.iter().map(|(_, weight)| weight).sum::<f64>() / points.len() as f64;
        let gaussian = Gaussian::of_points(&points).unwrap_or(shape);
        Self { points, gaussian, log_integral: most + libm::log(mean.max(f64::MIN_POSITIVE)) }
    }

    /// Logarithm of the mean over the points of what has the logarithms given.
    fn log_mean(&self, log: impl Fn([f64; 3]) -> f64) -> f64 {
        let logs: Vec<f64> = self.points.iter().map(|(at, _)| log(*at)).collect();
        let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if most == f64::NEG_INFINITY {
            return most;
        }
        let sum: f64 = self.points.iter().zip(&logs).map(|((_, weight), log)| weight * libm::exp(log - most)).sum();
        most + libm::log(sum / self.points.iter().map(|(_, weight)| weight).sum::<f64>())
    }
}

/// The Gaussian of the curvature at a top, no wider along any axis than the odometry allows.
fn curvature(top: Pose, most: f64, sigmas: [f64; 3], height: impl Fn(Pose) -> f64) -> Gaussian {
    let at = |by: Vector3<f64>| height(moved(top, by.into()));
    let step = |k: usize| Vector3::ith(k, STEPS[k]);
    let second = |k: usize| -(at(step(k)) + at(-step(k)) - 2.0 * most) / (STEPS[k] * STEPS[k]);
    let own = [0, 1, 2].map(|k| second(k).max(1.0 / (sigmas[k] * sigmas[k])));
    let mixed = |r: usize, c: usize| {
        let [plus, minus] = [step(r) + step(c), step(r) - step(c)];
        -(at(plus) + at(-plus) - at(minus) - at(-minus)) / (4.0 * STEPS[r] * STEPS[c])
    };
    let [a, b, c] = [mixed(0, 1), mixed(0, 2), mixed(1, 2)];
    let whole = Gaussian::of_precision(Matrix3::new(own[0], a, b, a, own[1], c, b, c, own[2]));
    let narrow = |of: &Gaussian| (0..3).all(|k| of.factor.row(k).norm_squared() <= 1.5 * sigmas[k] * sigmas[k]);
    let alone = Vector3::from(own.map(|precision| 1.0 / precision.sqrt()));
    whole.filter(narrow).unwrap_or(Gaussian { mean: Vector3::zeros(), factor: Matrix3::from_diagonal(&alone) })
}
