//! Gaussians over pose: along, across (m) and turn (rad).

use nalgebra::{Matrix3, Vector3};

/// A Gaussian over three numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gaussian {
    pub(crate) mean: Vector3<f64>,
    /// Lower triangle with `factor factor^T` the covariance.
    pub(crate) factor: Matrix3<f64>,
}

impl Gaussian {
    /// From its mean and covariance; none where that is not positive definite.
    pub(crate) fn new(mean: Vector3<f64>, covariance: Matrix3<f64>) -> Option<Self> {
        Some(Self { mean, factor: covariance.cholesky()?.l() })
    }

    /// Round zero, from the inverse of its covariance; none where that is not positive definite.
    pub(crate) fn of_precision(precision: Matrix3<f64>) -> Option<Self> {
        Self::new(Vector3::zeros(), precision.cholesky()?.inverse())
    }

    /// The same, so much wider along each axis.
    pub(crate) fn wider(&self, by: f64) -> Self {
        Self { factor: by * self.factor, ..*self }
    }

    /// The point to which three standard normal numbers belong.
    pub(crate) fn point(&self, normal: &[f64; 3]) -> [f64; 3] {
        (self.mean + self.factor * Vector3::from(*normal)).into()
    }

    /// Logarithm of the density where three standard normal numbers belong to.
    pub(crate) fn log_density(&self, normal: &[f64; 3]) -> f64 {
        let scale: f64 = self.factor.diagonal().iter().map(|value| libm::log(*value)).sum();
        -0.5 * Vector3::from(*normal).norm_squared() - scale - 1.5 * libm::log(std::f64::consts::TAU)
    }

    /// The Gaussian with the mean and the covariance of weighted points; none where these lie in a plane.
    pub(crate) fn of_points(points: &[([f64; 3], f64)]) -> Option<Self> {
        let sum: f64 = points.iter().map(|(_, weight)| weight).sum();
        let mean = points.iter().map(|(at, weight)| *weight * Vector3::from(*at)).sum::<Vector3<f64>>() / sum;
        let moment = |(at, weight): &([f64; 3], f64)| {
            let off = Vector3::from(*at) - mean;
            *weight * off * off.transpose()
        };
        Self::new(mean, points.iter().map(moment).sum::<Matrix3<f64>>() / sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn points_at_one_sigma_have_the_covariance(a in prop::array::uniform3(0.2f64..1.0), b in prop::array::uniform3(-0.5f64..0.5)) {
            let factor = Matrix3::new(a[0], 0.0, 0.0, b[0], a[1], 0.0, b[1], b[2], a[2]);
            let gaussian = Gaussian { mean: b.into(), factor };
            let points: Vec<_> = (0..6)
                .map(|k| {
                    let mut normal = [0.0; 3];
                    normal[k / 2] = if k % 2 == 0 { 3f64.sqrt() } else { -3f64.sqrt() };
                    (gaussian.point(&normal), 0.7)
                })
                .collect();
            let found = Gaussian::of_points(&points).expect("they span the space");
            prop_assert!((found.mean - gaussian.mean).norm() < 1e-12 && (found.factor - factor).norm() < 1e-9);
            let inverse = (factor * factor.transpose()).try_inverse().expect("positive definite");
            prop_assert!((Gaussian::of_precision(inverse).expect("positive definite").factor - factor).norm() < 1e-6);
        }

        /// The textbook's formula, from the covariance.
        #[test]
        fn the_density_is_that_of_the_covariance(a in prop::array::uniform3(0.2f64..1.0), normal in prop::array::uniform3(-2.0f64..2.0)) {
            let factor = Matrix3::new(a[0], 0.0, 0.0, 0.3, a[1], 0.0, -0.2, 0.1, a[2]);
            let gaussian = Gaussian { mean: Vector3::new(0.4, -1.0, 2.0), factor };
            let covariance = factor * factor.transpose();
            let off = Vector3::from(gaussian.point(&normal)) - gaussian.mean;
            let exponent = (off.transpose() * covariance.try_inverse().expect("positive definite") * off)[0];
            let expected = -0.5 * exponent - 0.5 * ((std::f64::consts::TAU).powi(3) * covariance.determinant()).ln();
            prop_assert!((gaussian.log_density(&normal) - expected).abs() < 1e-9);
        }
    }

    #[test]
    fn what_is_not_positive_definite_is_none() {
        assert!(Gaussian::of_precision(Matrix3::new(1.0, 2.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0, 1.0)).is_none());
        assert!(Gaussian::of_points(&[([1.0; 3], 1.0), ([2.0; 3], 1.0)]).is_none());
    }
}
