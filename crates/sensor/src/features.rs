//! Point features: what a stereo camera measures of a vertical edge that it matches.

use std::f64::consts::PI;

use rand::{Rng, RngExt as _};
use rand_distr::StandardNormal;

use crate::{Camera, Matcher, Pose, Stereo};

/// What the camera measured of one point feature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeatureReading {
    /// Angle to the optical axis, rad, counter-clockwise, between -pi/2 and pi/2.
    pub bearing_rad: f64,
    /// Disparity, px, above 0.
    pub disparity_px: f64,
    /// Number of the feature, where the camera can tell it from others.
    pub identity: Option<u32>,
}

/// The features of one moment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FeatureScan {
    /// Time, s.
    pub time_s: f64,
    /// Where the camera stood, where that is known.
    pub pose: Option<Pose>,
    /// Where it stood by the odometry, where there is any.
    pub odometry: Option<Pose>,
    /// What was measured, in the order of the image.
    pub readings: Vec<FeatureReading>,
}

/// A stereo camera that finds point features: bearing and disparity are Gaussian where the match is right; where it fails, the disparity
/// is any from 0 to the largest searched.
///
/// A feature in the field of view no deeper than `most_depth_m`, that nothing hides, is found with probability `detection` (times the
/// texture of what it is on), and then matched with probability [`Stereo::correct_match`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeatureCamera {
    /// Geometry, and noise of disparities.
    pub stereo: Stereo,
    /// Standard deviation of a bearing, rad, above 0.
    pub bearing_sigma_rad: f64,
    /// Full horizontal field of view, rad, above 0 and below pi.
    pub field_of_view_rad: f64,
    /// Features beyond this depth are not looked for, m, above 0.
    pub most_depth_m: f64,
    /// Probability that a feature in view is found, above 0, at most 1.
    pub detection: f64,
}

/// A number of [`FeatureCamera`] out of its bounds.
#[derive(Debug, Clone, PartialEq)]
pub struct FeatureCameraError {
    /// Its name.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// What it must be.
    pub bound: &'static str,
}

impl std::fmt::Display for FeatureCameraError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} is {}; must be {}", self.name, self.value, self.bound)
    }
}

impl std::error::Error for FeatureCameraError {}

/// Half a pixel: edges are placed in the image with as much of an error as disparities are, the differences of two such places.
const COLUMN_SIGMA: f64 = 0.5;

/// Disparities of the deepest feature are so many standard deviations above 0, where no depth is asked for.
const LEAST_SIGMAS: f64 = 3.0;

impl FeatureCamera {
    /// The camera that makes scans by `camera` and `matcher`: a bearing is off by half a column in the middle of the image, and features
    /// are found down to a disparity of three standard deviations.
    pub fn of(camera: &Camera, matcher: &Matcher) -> Self {
        let half_width = libm::tan(0.5 * camera.field_of_view_rad);
        let least = LEAST_SIGMAS * matcher.stereo.disparity_sigma;
        Self {
            stereo: matcher.stereo,
            bearing_sigma_rad: COLUMN_SIGMA * 2.0 * half_width / camera.columns as f64,
            field_of_view_rad: camera.field_of_view_rad,
            most_depth_m: matcher.stereo.focal_baseline / least,
            detection: matcher.detection_rate,
        }
    }

    /// Whether all numbers are within their bounds; the first that is not, otherwise.
    ///
    /// # Errors
    /// That number.
    pub fn check(&self) -> Result<(), FeatureCameraError> {
        let above = |value: f64| value.is_finite() && value > 0.0;
        let Stereo { focal_baseline, disparity_sigma, correct_match, max_disparity } = self.stereo;
        let positive = "above 0 and finite";
        let share = "above 0, at most 1";
        [
            ("focal_baseline", focal_baseline, positive, above(focal_baseline)),
            ("disparity_sigma", disparity_sigma, positive, above(disparity_sigma)),
            ("max_disparity", max_disparity, positive, above(max_disparity)),
            ("correct_match", correct_match, share, correct_match > 0.0 && correct_match <= 1.0),
            ("bearing_sigma_rad", self.bearing_sigma_rad, positive, above(self.bearing_sigma_rad)),
            (
                "field_of_view_rad",
                self.field_of_view_rad,
                "above 0, below pi",
                self.field_of_view_rad > 0.0 && self.field_of_view_rad < PI,
            ),
            ("most_depth_m", self.most_depth_m, positive, above(self.most_depth_m)),
            ("detection", self.detection, share, self.detection > 0.0 && self.detection <= 1.0),
        ]
        .into_iter()
        .find(|(.., fine)| !fine)
        .map_or(Ok(()), |(name, value, bound, _)| Err(FeatureCameraError { name, value, bound }))
    }

    /// Probability that a feature in view is found and matched right.
    pub fn seen(&self) -> f64 {
        self.detection * self.stereo.correct_match
    }

    /// Density of a reading that is of nothing known, 1/(rad px): one per scan, anywhere in the image.
    pub fn anywhere(&self) -> f64 {
        1.0 / (self.field_of_view_rad * self.stereo.max_disparity)
    }

    /// Noise-free bearing (rad) and disparity (px) of a point seen from a pose; none behind the image plane.
    pub fn expected(&self, pose: Pose, point_m: [f64; 2]) -> Option<[f64; 2]> {
        let [dx, dy] = [point_m[0] - pose.x_m, point_m[1] - pose.y_m];
        let (sin, cos) = libm::sincos(pose.theta_rad);
        let (depth, left) = (cos * dx + sin * dy, cos * dy - sin * dx);
        (depth > 0.0).then(|| [libm::atan2(left, depth), self.stereo.focal_baseline / depth])
    }

    /// Whether a bearing (rad) and a disparity (px) are within the field of view and the depth.
    pub fn views(&self, [bearing_rad, disparity_px]: [f64; 2]) -> bool {
        bearing_rad.abs() <= 0.5 * self.field_of_view_rad
            && disparity_px * self.most_depth_m >= self.stereo.focal_baseline
            && disparity_px <= self.stereo.max_disparity
    }

    /// What is measured of a feature with this bearing and disparity, on a surface of a texture (0 to 1): none where it is not found;
    /// whether the match is right. `image` decides whether the feature is found and of what a match that fails is, `noise` what is Gaussian.
    ///
    /// A disparity that is not within 0 and the largest searched is none.
    pub fn sample(
        &self,
        [bearing_rad, disparity_px]: [f64; 2],
        texture: f64,
        image: &mut impl Rng,
        noise: &mut impl Rng,
    ) -> Option<(FeatureReading, bool)> {
        let Stereo { disparity_sigma, correct_match, max_disparity, .. } = self.stereo;
        let found = image.random::<f64>() < self.detection * texture;
        let matched = image.random::<f64>() < correct_match;
        let elsewhere = max_disparity * image.random::<f64>();
        let [across, along] = [0, 1].map(|_| noise.sample::<f64, _>(StandardNormal));
        let disparity_px = if matched { disparity_px + disparity_sigma * along } else { elsewhere };
        let bearing_rad = bearing_rad + self.bearing_sigma_rad * across;
        let within = disparity_px > 0.0 && disparity_px <= max_disparity && bearing_rad.abs() < 0.5 * PI;
        (found && within).then_some((FeatureReading { bearing_rad, disparity_px, identity: None }, matched))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng as _};

    fn camera() -> FeatureCamera {
        let matcher = Matcher { detection_rate: 0.9, ..Matcher::default() };
        FeatureCamera::of(&Camera { columns: 200, field_of_view_rad: 1.2 }, &matcher)
    }

    #[test]
    fn a_camera_takes_its_numbers_from_its_columns() {
        let camera = camera();
        assert_eq!(camera.check(), Ok(()));
        // The ray half a column beside the axis.
        let half = Camera { columns: 200, field_of_view_rad: 1.2 }.bearings_rad()[100];
        assert!(
            (camera.bearing_sigma_rad - libm::tan(half)).abs() < 1e-12 && (camera.most_depth_m - 10.0).abs() < 1e-12
        );
        for (name, broken) in [
            ("bearing_sigma_rad", FeatureCamera { bearing_sigma_rad: 0.0, ..camera }),
            ("field_of_view_rad", FeatureCamera { field_of_view_rad: 3.2, ..camera }),
            ("most_depth_m", FeatureCamera { most_depth_m: f64::NAN, ..camera }),
            ("detection", FeatureCamera { detection: 1.1, ..camera }),
        ] {
            assert_eq!(broken.check().expect_err("out of bounds").name, name);
        }
    }

    #[test]
    fn samples_have_the_moments_and_shares_of_the_model() {
        let (camera, mut image, mut noise) = (camera(), ChaCha8Rng::seed_from_u64(1), ChaCha8Rng::seed_from_u64(2));
        let n = 50_000;
        let all: Vec<_> = (0..n).filter_map(|_| camera.sample([0.2, 20.0], 0.8, &mut image, &mut noise)).collect();
        let share = all.len() as f64 / f64::from(n);
        assert!((share - 0.72).abs() < 0.01, "found {share}");
        let right: Vec<_> = all.iter().filter(|(_, matched)| *matched).map(|(reading, _)| reading).collect();
        let matched = right.len() as f64 / all.len() as f64;
        assert!((matched - 0.8).abs() < 0.01, "matched {matched}");
        let spread = |of: &dyn Fn(&FeatureReading) -> f64| {
            let mean = right.iter().map(|reading| of(reading)).sum::<f64>() / right.len() as f64;
            (mean, (right.iter().map(|r| (of(r) - mean).powi(2)).sum::<f64>() / right.len() as f64).sqrt())
        };
        let (bearing, disparity) = (spread(&|r| r.bearing_rad), spread(&|r| r.disparity_px));
        assert!((bearing.0 - 0.2).abs() < 1e-4 && (bearing.1 / camera.bearing_sigma_rad - 1.0).abs() < 0.02);
        assert!((disparity.0 - 20.0).abs() < 0.02 && (disparity.1 - 0.5).abs() < 0.01);
        let wrong: Vec<f64> = all.iter().filter(|(_, matched)| !matched).map(|(r, _)| r.disparity_px).collect();
        let mean = wrong.iter().sum::<f64>() / wrong.len() as f64;
        assert!((mean - 30.0).abs() < 0.9, "uniform over the search: {mean}");
    }

    proptest! {
        #[test]
        fn what_is_expected_is_where_the_point_is(
            x in -5.0f64..5.0, y in -5.0f64..5.0, theta in -3.0f64..3.0, depth in 0.3f64..9.0, bearing in -0.59f64..0.59,
        ) {
            let pose = Pose { x_m: x, y_m: y, theta_rad: theta };
            let [dx, dy] = pose.direction(bearing);
            let range = depth / bearing.cos();
            let camera = camera();
            let found = camera.expected(pose, [x + range * dx, y + range * dy]).expect("in front");
            prop_assert!((found[0] - bearing).abs() < 1e-9 && (found[1] - 15.0 / depth).abs() < 1e-6);
            prop_assert!((camera.stereo.disparity(range, bearing) - found[1]).abs() < 1e-6);
            prop_assert!(camera.views(found));
            prop_assert!(camera.expected(pose, [x - range * dx, y - range * dy]).is_none());
        }
    }
}
