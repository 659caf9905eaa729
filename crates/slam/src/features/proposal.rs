//! Where a particle's pose is drawn from, in the space of the odometry's errors: three standard normal numbers `e`, so that the step
//! driven is the one measured plus `sigma e`. The motion model is exactly `N(0, 1)` there, whatever its standard deviations, 0 among
//! them.

use nalgebra::{Matrix2x3, Matrix3, Vector2, Vector3};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use sensor::{FeatureCamera, FeatureReading, OdometryNoise, Pose, Step};

use super::association::{Candidate, pairs};
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

/// The odometry's errors after a scan: the likeliest pairs of readings and landmarks are taken one by one, each from where the ones before
/// it put the pose, then once more those that were out of the gate while the pose was vaguer.
///
/// Landmarks that are rather not there than there have no say in it.
pub(crate) fn after(
    map: &Map,
    camera: &FeatureCamera,
    rules: &Association,
    (last, measured): (Pose, &Measured),
    readings: &[FeatureReading],
) -> Belief {
    let mut belief = Belief::ODOMETRY;
    let mut used = vec![false; readings.len()];
    let mut slots: Vec<usize> = Vec::new();
    for _ in 0..2 {
        let pose = measured.pose(last, belief.mean);
        let mut candidates = match rules.identity {
            Identity::Unknown => map.candidates(camera, pose),
            Identity::Known => readings.iter().filter_map(|r| map.known(r.identity, camera, pose)).collect(),
        };
        candidates.retain(|candidate| candidate.landmark.log_odds >= 0.0);
        let covariance = |candidate: &Candidate| {
            let by = candidate.expected.by_pose * measured.derivative(last, belief.mean);
            by * belief.covariance * by.transpose() + candidate.innovation
        };
        let found = pairs(readings, &candidates, rules.gate, covariance);
        for pair in found {
            let candidate = &candidates[pair.candidate];
            let identity = readings[pair.reading].identity;
            let other =
                rules.identity == Identity::Known && identity.map(|identity| identity as usize) != Some(candidate.slot);
            if used[pair.reading] || slots.contains(&candidate.slot) || other {
                continue;
            }
            let at = measured.pose(last, belief.mean);
            let Some(now) = Candidate::of(candidate.slot, &candidate.landmark, camera, at) else { continue };
            let by = now.expected.by_pose * measured.derivative(last, belief.mean);
            let off = vector(&readings[pair.reading]) - now.expected.reading;
            let innovation = by * belief.covariance * by.transpose() + now.innovation;
            let within = gaussian(off, &innovation).is_some_and(|[square, _]| square <= rules.gate);
            if within {
                used[pair.reading] = true;
                slots.push(candidate.slot);
                belief.take(&now, &by, off);
            }
        }
    }
    belief
}
