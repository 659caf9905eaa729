//! A landmark: a Kalman filter in the disparity space of the pose that it was first seen from.
//!
//! There a point is `(u, d)`: the tangent of its bearing, and its disparity. Its errors are Gaussian there at any distance, which they are
//! not in metres (Suppes, Suhling and Hötter, DAGM 2001; with an anchor, Montiel, Civera and Davison, RSS 2006). Seen from elsewhere it is
//! a projective map: with `w = R(a) (1, u) - d / fB (x - a)`, the anchor `a`, and the camera at `x`, the point lies along `w` and
//! `v = R(x)^T w` is its direction in the image, so that bearing and disparity are `atan2(v_y, v_x)` and `d / v_x`. Points at any
//! distance, infinity among them, are alike.

use nalgebra::{Matrix2, Matrix2x3, Vector2};
use sensor::{FeatureCamera, FeatureReading, Pose};

/// A landmark with its covariance, and how sure it is that it exists.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Landmark {
    /// Its number.
    pub number: u32,
    /// Which feature it is, where the camera can tell.
    pub identity: Option<u32>,
    /// The pose that it was first seen from.
    pub anchor: Pose,
    /// Tangent of its bearing, and its disparity (px), from there.
    pub mean: Vector2<f64>,
    /// Covariance of these.
    pub covariance: Matrix2<f64>,
    /// Logarithm of the odds that it exists.
    pub log_odds: f64,
    /// Where the camera stood when it was last seen, m.
    pub seen_from_m: [f64; 2],
    /// How often it was seen.
    pub sightings: u32,
}

/// What a landmark leads to expect of a reading, linearised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// Bearing, rad, and disparity, px.
    pub reading: Vector2<f64>,
    /// Derivative by the landmark's `(u, d)`.
    pub by_landmark: Matrix2<f64>,
    /// Derivative by the camera's pose, x and y (m) and heading (rad).
    pub by_pose: Matrix2x3<f64>,
}

impl Landmark {
    /// A landmark out of one reading.
    pub fn first(number: u32, camera: &FeatureCamera, pose: Pose, reading: &FeatureReading, log_odds: f64) -> Self {
        let u = libm::tan(reading.bearing_rad);
        // Of the tangent: its derivative is 1 + u^2.
        let across = camera.bearing_sigma_rad * (1.0 + u * u);
        let along = camera.stereo.disparity_sigma;
        Self {
            number,
            identity: reading.identity,
            anchor: pose,
            mean: Vector2::new(u, reading.disparity_px),
            covariance: Matrix2::new(across * across, 0.0, 0.0, along * along),
            log_odds,
            seen_from_m: pose.position_m(),
            sightings: 1,
        }
    }

    /// The reading to be expected from a pose; none where the landmark is not before the image plane.
    pub fn expected(&self, camera: &FeatureCamera, pose: Pose) -> Option<Expected> {
        let (sin_a, cos_a) = libm::sincos(self.anchor.theta_rad);
        let (sin, cos) = libm::sincos(pose.theta_rad);
        let (u, d) = (self.mean.x, self.mean.y);
        let focal_baseline = camera.stereo.focal_baseline;
        let inverse_depth = d / focal_baseline;
        let off = [pose.x_m - self.anchor.x_m, pose.y_m - self.anchor.y_m];
        let into = |[x, y]: [f64; 2]| [cos * x + sin * y, cos * y - sin * x];
        let v = into([cos_a - u * sin_a - inverse_depth * off[0], sin_a + u * cos_a - inverse_depth * off[1]]);
        if v[0] <= 1e-9 {
            return None;
        }
        let square = v[0] * v[0] + v[1] * v[1];
        let by = |dv: [f64; 2], dd: f64| {
            Vector2::new((v[0] * dv[1] - v[1] * dv[0]) / square, (dd - d / v[0] * dv[0]) / v[0])
        };
        let by_d = into([-off[0] / focal_baseline, -off[1] / focal_baseline]);
        let by_landmark = Matrix2::from_columns(&[by(into([-sin_a, cos_a]), 0.0), by(by_d, 1.0)]);
        let by_pose = Matrix2x3::from_columns(&[
            by([-inverse_depth * cos, inverse_depth * sin], 0.0),
            by([-inverse_depth * sin, -inverse_depth * cos], 0.0),
            by([v[1], -v[0]], 0.0),
        ]);
        Some(Expected { reading: Vector2::new(libm::atan2(v[1], v[0]), d / v[0]), by_landmark, by_pose })
    }

    /// Takes a reading that was made from a pose which is known, by `expected` there: the Kalman update, in the form that keeps the
    /// covariance symmetric and positive (Joseph).
    pub fn take(&mut self, camera: &FeatureCamera, expected: &Expected, reading: Vector2<f64>) {
        let h = expected.by_landmark;
        let innovation = expected.innovation(camera, self);
        let Some(inverse) = innovation.try_inverse() else { return };
        let gain = self.covariance * h.transpose() * inverse;
        self.mean += gain * (reading - expected.reading);
        let rest = Matrix2::identity() - gain * h;
        let kept = rest * self.covariance * rest.transpose() + gain * noise(camera) * gain.transpose();
        self.covariance = 0.5 * (kept + kept.transpose());
    }

    /// Where it is, m, with the covariance there (m²); far away where its disparity is hardly above 0.
    pub fn place(&self, camera: &FeatureCamera) -> ([f64; 2], [[f64; 2]; 2]) {
        let (sin, cos) = libm::sincos(self.anchor.theta_rad);
        let d = self.mean.y.max(camera.stereo.focal_baseline / FARTHEST_M);
        let depth = camera.stereo.focal_baseline / d;
        let u = self.mean.x;
        let at = [self.anchor.x_m + depth * (cos - u * sin), self.anchor.y_m + depth * (sin + u * cos)];
        let by_d = -depth / d;
        let by = Matrix2::new(-depth * sin, by_d * (cos - u * sin), depth * cos, by_d * (sin + u * cos));
        let p = by * self.covariance * by.transpose();
        (at, [[p[(0, 0)], p[(0, 1)]], [p[(1, 0)], p[(1, 1)]]])
    }

    /// Probability that it exists.
    pub fn existence(&self) -> f64 {
        1.0 / (1.0 + libm::exp(-self.log_odds))
    }
}

/// Landmarks are not placed beyond this, m.
const FARTHEST_M: f64 = 1e4;

impl Expected {
    /// Covariance of a reading about what is expected, where the pose is known.
    pub fn innovation(&self, camera: &FeatureCamera, landmark: &Landmark) -> Matrix2<f64> {
        self.by_landmark * landmark.covariance * self.by_landmark.transpose() + noise(camera)
    }
}

/// Covariance of a reading.
pub(super) fn noise(camera: &FeatureCamera) -> Matrix2<f64> {
    let [a, b] = [camera.bearing_sigma_rad, camera.stereo.disparity_sigma];
    Matrix2::new(a * a, 0.0, 0.0, b * b)
}

/// A reading as a vector.
pub(super) fn vector(reading: &FeatureReading) -> Vector2<f64> {
    Vector2::new(reading.bearing_rad, reading.disparity_px)
}

/// Squared Mahalanobis distance, and logarithm of the Gaussian density, of what is off by `off`; none of a covariance that is none.
pub(super) fn gaussian(off: Vector2<f64>, covariance: &Matrix2<f64>) -> Option<[f64; 2]> {
    let determinant = covariance.determinant();
    if determinant.is_nan() || determinant <= 0.0 {
        return None;
    }
    let [a, b, c] = [covariance[(0, 0)], covariance[(0, 1)], covariance[(1, 1)]];
    let square = (c * off.x * off.x - 2.0 * b * off.x * off.y + a * off.y * off.y) / determinant;
    Some([square, -0.5 * (square + libm::log(determinant)) - libm::log(std::f64::consts::TAU)])
}
