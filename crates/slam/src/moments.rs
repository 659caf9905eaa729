//! Mean and covariance of weighted poses.

use nalgebra::{Matrix3, Vector3};
use sensor::{Pose, wrapped_rad};

/// Mean and covariance of weighted poses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// Weighted mean; the heading is that of the shorter turns from the first pose.
    pub mean: Pose,
    /// Weighted covariance: x (m), y (m) and heading (rad).
    pub covariance: [[f64; 3]; 3],
}

impl Moments {
    /// Those of poses with weights that add up to one; none of no pose.
    pub fn of(particles: impl IntoIterator<Item = (Pose, f64), IntoIter: Clone>) -> Option<Self> {
        let particles = particles.into_iter();
        let (round, _) = particles.clone().next()?;
        let off = |pose: Pose| {
            Vector3::new(pose.x_m - round.x_m, pose.y_m - round.y_m, wrapped_rad(pose.theta_rad - round.theta_rad))
        };
        let mean: Vector3<f64> = particles.clone().map(|(pose, weight)| weight * off(pose)).sum();
        let square = |(pose, weight): (Pose, f64)| {
            let off = off(pose) - mean;
            weight * off * off.transpose()
        };
        let covariance: Matrix3<f64> = particles.map(square).sum();
        Some(Self {
            mean: Pose {
                x_m: round.x_m + mean.x,
                y_m: round.y_m + mean.y,
                theta_rad: wrapped_rad(round.theta_rad + mean.z),
            },
            covariance: std::array::from_fn(|row| std::array::from_fn(|column| covariance[(row, column)])),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_of_a_box_have_its_sides_as_standard_deviations() {
        let corner = |k: usize| {
            let side = |bit: usize| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
            (Pose { x_m: 2.0 + 0.1 * side(0), y_m: 1.0 + 0.2 * side(1), theta_rad: 3.13 + 0.05 * side(2) }, 0.125)
        };
        let Moments { mean, covariance } = Moments::of((0..8).map(corner)).expect("poses");
        assert!((mean.x_m - 2.0).abs() + (mean.y_m - 1.0).abs() + (mean.theta_rad - 3.13).abs() < 1e-12);
        for (row, variances) in covariance.iter().zip([[0.01, 0.0, 0.0], [0.0, 0.04, 0.0], [0.0, 0.0, 0.0025]]) {
            assert!(row.iter().zip(variances).all(|(found, expected)| (found - expected).abs() < 1e-12), "{row:?}");
        }
        assert_eq!(Moments::of(std::iter::empty()), None);
    }
}
