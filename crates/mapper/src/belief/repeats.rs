//! When a reading is like one before it from the same view: see `rules/repeats.rs` for what follows from that.

use sensor::{Pose, SensorModel};

/// When a reading is taken for a repetition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repeats {
    /// Distance over which views share their errors, m; above 0.
    pub distance_m: f64,
    /// Angle over which they do, rad; above 0.
    pub angle_rad: f64,
    /// Probability that what a ray ends on changes from one scan to the next, 0 to 1.
    pub change: f64,
    /// How often readings that repeat are taken; at least 1.
    pub looks: u32,
}

impl Repeats {
    /// Chosen by hand: less than a robot moves from scan to scan, more than one that stands jitters; and the looks after which the log
    /// loss of a robot that stands was least.
    pub const CHOSEN: Self = Self { distance_m: 0.03, angle_rad: 0.015, change: 0.01, looks: 3 };

    /// Whether two poses share their view.
    pub(crate) fn is_same_view(&self, a: Pose, b: Pose) -> bool {
        let apart = libm::hypot(a.x_m - b.x_m, a.y_m - b.y_m) / self.distance_m;
        let turned = libm::remainder(a.theta_rad - b.theta_rad, std::f64::consts::TAU) / self.angle_rad;
        // The exponent of one half.
        apart * apart + turned * turned < 2.0 * std::f64::consts::LN_2
    }

    /// Whether a reading is like the one that its run began with.
    ///
    /// Both scatter about what the surface would give, so that they differ by `sqrt(2)` as much as one does: of a Gaussian, the
    /// likelihood of one reading about the other is the square of what it is worth. It is weighed against a
    /// change, after which any reading may come.
    pub(crate) fn is_like(&self, sensor: &dyn SensorModel, bearing: f64, reading: f64, first: f64) -> bool {
        let Some(range_m) = sensor.range_of(first, bearing) else {
            return sensor.range_of(reading, bearing).is_none();
        };
        let likelihood = |reading: f64, range_m: f64| {
            let mut likelihood = [0.0];
            sensor.likelihood(reading, bearing, &[range_m, range_m], &mut likelihood);
            likelihood[0]
        };
        // What comes of things in front, or of false matches, whatever stands there.
        let stray = likelihood(reading, FAR_M);
        let like = (likelihood(reading, range_m) - stray).max(0.0);
        let most = likelihood(first, range_m) - likelihood(first, FAR_M);
        let share = if most > 0.0 { libm::sqrt(like / most) } else { 0.0 };
        (1.0 - self.change) * share * most > self.change * stray
    }
}

/// A surface so far away gives no reading of its own, m.
const FAR_M: f64 = 1e6;
