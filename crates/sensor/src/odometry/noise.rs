//! How far odometry may be from the way that was driven.

use rand::{Rng, RngExt as _};
use rand_distr::StandardNormal;

use super::{Step, wrapped_rad};

/// Standard deviations of the three parts of a [`Step`], by how far the robot turned and drove in it.
///
/// With turns `a`, `b` and distance `d` of the step, the first turn is off by `N(0, (rad_per_rad a)^2 + (rad_per_m
/// d)^2)`, the second likewise with `b`, and the distance by `N(0, (m_per_m d)^2 + (m_per_rad a)^2 + (m_per_rad b)^2)`:
/// Table 5.6, lines 5 to 7, whose `alpha_1` to `alpha_4` are the squares of these four numbers. The errors of steps are
/// independent, so that the same way in twice as many steps drifts `sqrt(1/2)` as far.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OdometryNoise {
    /// Error of a turn per turn, rad per rad; at least 0.
    pub rad_per_rad: f64,
    /// Error of each turn per distance, rad per m; at least 0.
    pub rad_per_m: f64,
    /// Error of the distance per distance, m per m; at least 0.
    pub m_per_m: f64,
    /// Error of the distance per turn, m per rad; at least 0.
    pub m_per_rad: f64,
}

/// A way shorter than this (m) has no direction to speak of: the robot turns on the spot, and what its odometry says of
/// the way is the rounding of its numbers. Only its whole turn then counts as turned.
const ON_THE_SPOT_M: f64 = 0.01;

/// An error (rad or m) that is none: what rounding leaves of the way between two poses.
const ROUNDING: f64 = 1e-9;

impl OdometryNoise {
    /// Odometry without an error.
    pub const NONE: Self = Self { rad_per_rad: 0.0, rad_per_m: 0.0, m_per_m: 0.0, m_per_rad: 0.0 };

    /// The standard case: 10 % of the distance, 5 degrees per 90 turned, 1 degree per m; and 1 cm per radian turned,
    /// for a wheel that does not stand on the spot while it turns.
    pub const STANDARD: Self =
        Self { rad_per_rad: 5.0 / 90.0, rad_per_m: std::f64::consts::PI / 180.0, m_per_m: 0.1, m_per_rad: 0.01 };

    /// The same noise, every standard deviation times `factor` (at least 0).
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            rad_per_rad: factor * self.rad_per_rad,
            rad_per_m: factor * self.rad_per_m,
            m_per_m: factor * self.m_per_m,
            m_per_rad: factor * self.m_per_rad,
        }
    }

    /// Whether all four numbers are finite and not below 0; the first that is not, otherwise.
    pub fn check(&self) -> Result<(), OdometryNoiseError> {
        let named = [
            ("rad_per_rad", self.rad_per_rad),
            ("rad_per_m", self.rad_per_m),
            ("m_per_m", self.m_per_m),
            ("m_per_rad", self.m_per_rad),
        ];
        named.into_iter().try_for_each(|(name, value)| {
            if value.is_finite() && value >= 0.0 { Ok(()) } else { Err(OdometryNoiseError { name, value }) }
        })
    }

    /// Standard deviations of first turn (rad), distance (m) and second turn (rad) of a step that odometry measured as
    /// `step`.
    pub fn sigmas(&self, step: &Step) -> [f64; 3] {
        let distance_m = step.distance_m.abs();
        let [first, second] = if distance_m < ON_THE_SPOT_M {
            [0.0, step.turn_rad().abs()]
        } else {
            [step.first_turn_rad.abs(), step.second_turn_rad.abs()]
        };
        [
            libm::hypot(self.rad_per_rad * first, self.rad_per_m * distance_m),
            libm::hypot(self.m_per_m * distance_m, self.m_per_rad * libm::hypot(first, second)),
            libm::hypot(self.rad_per_rad * second, self.rad_per_m * distance_m),
        ]
    }

    /// A step that may have been driven where odometry measured `step` (Table 5.6, lines 5 to 7); three normal numbers
    /// are drawn, whatever the noise.
    pub fn sample(&self, step: &Step, rng: &mut impl Rng) -> Step {
        let [first, distance, second] = self.sigmas(step);
        let mut off = |sigma: f64| sigma * rng.sample::<f64, _>(StandardNormal);
        Step {
            first_turn_rad: step.first_turn_rad + off(first),
            distance_m: step.distance_m + off(distance),
            second_turn_rad: step.second_turn_rad + off(second),
        }
    }

    /// Natural logarithm of the density (1/(rad m rad)) with which [`OdometryNoise::sample`] draws `driven` where
    /// odometry measured `measured`; turns are compared on the circle.
    ///
    /// The standard deviations are those of `measured`, as in sampling; Table 5.5 takes them at `driven`, which is no
    /// density of `driven`. A part without noise adds nothing where it is as measured, to 1e-9, and makes the density
    /// zero (`-inf`) where it is not.
    pub fn log_density(&self, driven: &Step, measured: &Step) -> f64 {
        let [first, distance, second] = self.sigmas(measured);
        log_normal(wrapped_rad(driven.first_turn_rad - measured.first_turn_rad), first)
            + log_normal(driven.distance_m - measured.distance_m, distance)
            + log_normal(wrapped_rad(driven.second_turn_rad - measured.second_turn_rad), second)
    }
}

/// Logarithm of the normal density of `error` about 0 with standard deviation `sigma`, which may be 0.
fn log_normal(error: f64, sigma: f64) -> f64 {
    if sigma > 0.0 {
        let z = error / sigma;
        -0.5 * z * z - libm::log(sigma * libm::sqrt(std::f64::consts::TAU))
    } else if error.abs() <= ROUNDING {
        0.0
    } else {
        f64::NEG_INFINITY
    }
}

/// A number of [`OdometryNoise`] that is no standard deviation.
#[derive(Debug, Clone, PartialEq)]
pub struct OdometryNoiseError {
    /// Its name.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
}

impl std::fmt::Display for OdometryNoiseError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { name, value } = self;
        write!(f, "{name} is {value}; a standard deviation is finite and at least 0 (0 for none)")
    }
}

impl std::error::Error for OdometryNoiseError {}
