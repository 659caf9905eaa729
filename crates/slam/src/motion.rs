//! What odometry says of the way between two scans.

use rand_chacha::ChaCha8Rng;
use sensor::{OdometryNoise, Step};

/// A motion model: how the robot may have driven where its odometry measured a step.
pub trait Motion: Send + Sync {
    /// Draws a step that may have been driven.
    fn draw(&self, measured: &Step, random: &mut ChaCha8Rng) -> Step;

    /// Standard deviations of the place along and across the way, m, and of the heading, rad, that a measured step leads to; all 0
    /// of odometry that is exact.
    fn sigmas(&self, measured: &Step) -> [f64; 3];
}

impl Motion for OdometryNoise {
    fn draw(&self, measured: &Step, random: &mut ChaCha8Rng) -> Step {
        self.sample(measured, random)
    }

    fn sigmas(&self, measured: &Step) -> [f64; 3] {
        let [first, distance, second] = OdometryNoise::sigmas(self, measured);
        [distance, measured.distance_m.abs() * first, libm::hypot(first, second)]
    }
}
