//! Where a particle's pose is drawn from, in the space of the odometry's errors: three standard normal numbers `e`, so that the step
//! driven is the one measured plus `sigma e`. The motion model is exactly `N(0, 1)` there, whatever its standard deviations, 0 among
//! them.

use nalgebra::{Matrix2x3, Matrix3, Vector2, Vector3};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use sensor::{FeatureCamera, FeatureReading, OdometryNoise, Pose, Step};

use super::association::{Candidate, Pair, pairs};
use super::landmark::{gaussian, vector};
use super::map::Map;
use super::options::{Association, Identity};

/// A step as the odometry measured it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Measured {
    step: Step,
    sigmas: [f64; 3],
}

impl Measured {
    pub(crate) fn new(step: Step, noise: &OdometryNoise) -> Self {
        Self { step, sigmas: noise.sigmas(&step) }
    }

    /// The step with errors `e`.
    fn driven(&self, e: Vector3<f64>) -> Step {
        Step {
            first_turn_rad: self.step.first_turn_rad + self.sigmas[0] * e.x,
            distance_m: self.step.distance_m + self.sigmas[1] * e.y,
            second_turn_rad: self.step.second_turn_rad + self.sigmas[2] * e.z,
        }
    }

    /// The pose that errors `e` lead to from the last one.
    pub(crate) fn pose(&self, last: Pose, e: Vector3<f64>) -> Pose {
        self.driven(e).end(last)
    }

    /// Its derivative by `e`: x and y (m) and heading (rad).
    pub(crate) fn derivative(&self, last: Pose, e: Vector3<f64>) -> Matrix3<f64> {
        let step = self.driven(e);
        let (sin, cos) = libm::sincos(last.theta_rad + step.first_turn_rad);
        let [a, b, c] = self.sigmas;
        Matrix3::new(-step.distance_m * sin * a, cos * b, 0.0, step.distance_m * cos * a, sin * b, 0.0, a, 0.0, c)
    }
}

/// A Gaussian over the odometry's errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Belief {
    pub(crate) mean: Vector3<f64>,
    pub(crate) covariance: Matrix3<f64>,
}

impl Belief {
    /// The motion model.
    pub(crate) const ODOMETRY: Self = Self {
        mean: Vector3::new(0.0, 0.0, 0.0),
        covariance: Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
    };

    /// Takes a reading whose landmark is known, with the landmark's own covariance in that of the reading: Eqs. (14) to (19) of FastSLAM 2.0
    /// (Montemerlo et al. 2003), as a Kalman update. `by` is the derivative of the reading by the errors.
    pub(super) fn take(&mut self, candidate: &Candidate, by: &Matrix2x3<f64>, off: Vector2<f64>) {
        let innovation = by * self.covariance * by.transpose() + candidate.innovation;
        let Some(inverse) = innovation.try_inverse() else { return };
        let gain = self.covariance * by.transpose() * inverse;
        self.mean += gain * off;
        let rest = Matrix3::identity() - gain * by;
        let kept = rest * self.covariance * rest.transpose() + gain * candidate.innovation * gain.transpose();
        self.covariance = 0.5 * (kept + kept.transpose());
    }

    /// Errors drawn, with the logarithm of how much likelier the motion model makes them than this.
    pub(crate) fn draw(&self, random: &mut ChaCha8Rng) -> (Vector3<f64>, f64) {
        let normal = Vector3::from_fn(|_, _| random.sample::<f64, _>(StandardNormal));
        let Some(factor) = self.covariance.cholesky() else { return (normal, 0.0) };
        let factor = factor.l();
        let drawn = self.mean + factor * normal;
        let scale: f64 = factor.diagonal().iter().map(|value| libm::log(*value)).sum();
        (drawn, 0.5 * (normal.norm_squared() - drawn.norm_squared()) + scale)
    }
}

/// So many first pairs are tried. Where the pose is vague, a reading has several landmarks within its gate, and the first pair decides about
/// all others.
const FIRST: usize = 4;

/// The odometry's errors after a scan: the likeliest pairs of readings and landmarks are taken one by one, each from where the ones before
/// it put the pose, then once more those that were out of the gate while the pose was vaguer. Of several first pairs, the one is kept after which
/// all readings together are the likeliest.
///
/// Landmarks that are rather not there than there have no say in it.
pub(crate) fn after(
    map: &Map,
    camera: &FeatureCamera,
    rules: &Association,
    (last, measured): (Pose, &Measured),
    readings: &[FeatureReading],
) -> Belief {
    let pose = measured.pose(last, Vector3::zeros());
    let mut candidates = match rules.identity {
        Identity::Unknown => map.candidates(camera, pose),
        Identity::Known => readings.iter().filter_map(|reading| map.known(reading.identity, camera, pose)).collect(),
    };
    candidates.retain(|candidate| candidate.landmark.log_odds >= 0.0);
    let look = Look { camera, rules, last, measured, readings, candidates: &candidates };
    let mut found = look.pairs(&candidates, &Belief::ODOMETRY);
    let mut best = Hypothesis::none(readings.len(), candidates.len());
    let mut most = f64::NEG_INFINITY;
    for _ in 0..FIRST {
        let mut tried = Hypothesis::none(readings.len(), candidates.len());
        let Some(first) = look.complete(&found, &mut tried) else { break };
        if tried.log > most {
            (most, best) = (tried.log, tried);
        }
        // Another first pair: one that this try did not take.
        found.retain(|pair| *pair != first);
        let Some(next) = found.iter().position(|pair| best.of[pair.reading] != Some(pair.candidate)) else { break };
        found[..=next].rotate_right(1);
    }
    best.belief
}

/// What a particle looks at.
struct Look<'a> {
    camera: &'a FeatureCamera,
    rules: &'a Association,
    last: Pose,
    measured: &'a Measured,
    readings: &'a [FeatureReading],
    candidates: &'a [Candidate],
}

/// Which landmark each reading is of, and where that puts the pose.
#[derive(Debug, Clone)]
struct Hypothesis {
    belief: Belief,
    /// For each reading its candidate.
    of: Vec<Option<usize>>,
    used: Vec<bool>,
    /// Logarithm of how much likelier the readings are than strays.
    log: f64,
}

impl Hypothesis {
    fn none(readings: usize, candidates: usize) -> Self {
        Self { belief: Belief::ODOMETRY, of: vec![None; readings], used: vec![false; candidates], log: 0.0 }
    }
}

impl Look<'_> {
    /// Pairs within the gate of a belief, the likeliest first; candidates are as seen from its mean.
    fn pairs(&self, candidates: &[Candidate], belief: &Belief) -> Vec<Pair> {
        let derivative = self.measured.derivative(self.last, belief.mean);
        let covariance = |candidate: &Candidate| {
            let by = candidate.expected.by_pose * derivative;
            by * belief.covariance * by.transpose() + candidate.innovation
        };
        let mut found = pairs(self.readings, candidates, self.rules.gate, covariance);
        if self.rules.identity == Identity::Known {
            let own = |pair: &Pair| {
                let identity = self.readings[pair.reading].identity.map(|identity| identity as usize);
                identity == Some(candidates[pair.candidate].slot)
            };
            found.retain(own);
        }
        found
    }

    /// Takes pairs in their order, then those that are within the gate of where these put the pose; gives the first that was taken.
    fn complete(&self, found: &[Pair], tried: &mut Hypothesis) -> Option<Pair> {
        let mut first = None;
        for pair in found {
            if self.take(pair, tried) && first.is_none() {
                first = Some(*pair);
            }
        }
        let pose = self.measured.pose(self.last, tried.belief.mean);
        let seen = |candidate: &Candidate| Candidate::of(candidate.slot, &candidate.landmark, self.camera, pose);
        let again: Vec<Candidate> = self.candidates.iter().map(|c| seen(c).unwrap_or(*c)).collect();
        for pair in self.pairs(&again, &tried.belief) {
            self.take(&pair, tried);
        }
        first
    }

    /// Takes a pair if both are free and it is within the gate of where the ones before put the pose.
    fn take(&self, pair: &Pair, tried: &mut Hypothesis) -> bool {
        if tried.of[pair.reading].is_some() || tried.used[pair.candidate] {
            return false;
        }
        let candidate = &self.candidates[pair.candidate];
        let at = self.measured.pose(self.last, tried.belief.mean);
        let Some(now) = Candidate::of(candidate.slot, &candidate.landmark, self.camera, at) else { return false };
        let by = now.expected.by_pose * self.measured.derivative(self.last, tried.belief.mean);
        let off = vector(&self.readings[pair.reading]) - now.expected.reading;
        let innovation = by * tried.belief.covariance * by.transpose() + now.innovation;
        let Some([square, log]) = gaussian(off, &innovation) else { return false };
        if square > self.rules.gate {
            return false;
        }
        let seen = self.camera.seen() * candidate.landmark.existence() * libm::exp(log);
        tried.log += libm::log(1.0 + seen / self.camera.anywhere());
        tried.of[pair.reading] = Some(pair.candidate);
        tried.used[pair.candidate] = true;
        tried.belief.take(&now, &by, off);
        true
    }
}
