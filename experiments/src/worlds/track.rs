//! Poses as the scores of trajectories take them.

use score::trajectory::{self, Believed, Stamped, nees};
use sensor::Pose;
use slam::Moments;

/// A pose and its time.
pub fn stamped(time_s: f64, pose: Pose) -> Stamped {
    Stamped { time_s, pose: plain(pose) }
}

/// A pose as scores take it.
pub fn plain(pose: Pose) -> trajectory::Pose {
    trajectory::Pose { x_m: pose.x_m, y_m: pose.y_m, theta_rad: pose.theta_rad }
}

/// A matrix of correlations with a smaller determinant is that of particles in a plane, but for rounding: three of them always are.
const LEAST_DETERMINANT: f64 = 1e-9;

/// The squared error of the particles' mean in units of their covariance (NEES); none where they do not spread in all of x, y and heading.
pub fn consistency(particles: &Moments, truth: Pose) -> Option<f64> {
    let Moments { mean, covariance } = *particles;
    let [[xx, xy, xt], [_, yy, yt], [_, _, tt]] = covariance;
    let determinant = xx * (yy * tt - yt * yt) - xy * (xy * tt - yt * xt) + xt * (xy * yt - yy * xt);
    if determinant <= LEAST_DETERMINANT * xx * yy * tt {
        return None;
    }
    let believed = Believed { estimate: plain(mean), covariance, reference: plain(truth) };
    nees(&[believed]).ok().map(|nees| nees.mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn consistency_is_the_squared_error_in_standard_deviations() {
        let mean = Pose { x_m: 2.0, y_m: 1.0, theta_rad: 3.13 };
        let particles = Moments { mean, covariance: [[0.01, 0.0, 0.0], [0.0, 0.04, 0.0], [0.0, 0.0, 0.0025]] };
        // 2, 1 and 1 of them, the heading by the shorter turn.
        let truth = Pose { x_m: 2.2, y_m: 0.8, theta_rad: 3.18 - std::f64::consts::TAU };
        assert!(consistency(&particles, truth).is_some_and(|nees| (nees - 6.0).abs() < 1e-9));
        assert_eq!(consistency(&Moments { covariance: [[0.0; 3]; 3], ..particles }, truth), None);
        let at = |k: usize| {
            let k = k as f64;
            (Pose { x_m: 0.1 * k, y_m: 0.01 * k * k, theta_rad: 0.3 - 0.02 * k }, 1.0 / 3.0)
        };
        let plane = Moments::of((0..3).map(at)).expect("poses");
        assert_eq!(consistency(&plane, truth), None, "three particles span no space");
    }
}
