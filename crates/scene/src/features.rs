//! Point features of a scene, and what a camera measures of them along a drive.

mod corners;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use rayon::prelude::*;
use sensor::{FeatureCamera, FeatureScan, Pose};

pub use corners::{Feature, features};

use crate::{Drive, Scene, World};

/// Random streams of the seed: a feature's place in a scan is a word of the stream.
const IMAGES: u64 = 1 << 40;
const NOISE: u64 = 1 << 41;

/// Words of the random stream set apart for each feature.
const WORDS: u128 = 64;

/// A scan of features, with the truth beside it.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservedFeatures {
    /// What the camera measured; no reading says which feature it is of.
    pub scan: FeatureScan,
    /// For each reading, which feature it is of and whether it was matched right.
    pub truth: Vec<FeatureTruth>,
}

/// What is true of a reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FeatureTruth {
    /// Index into [`features`].
    pub feature: usize,
    /// Whether the match is right; the disparity says nothing otherwise.
    pub matched: bool,
}

/// What a camera measures of the features along a drive, a scan per pose.
///
/// A feature is in view where its bearing and disparity are ([`FeatureCamera::views`]) and no obstacle, or thing that moves, is on the
/// ray to it. The same seed gives the same readings, whatever the number of threads; the streams are other ones than those of
/// [`simulate`](crate::simulate). From a pose where the robot stands still, the same features are found and the same matches fail again,
/// with fresh noise. The odometry is the one that [`simulate`](crate::simulate) has of the seed.
pub fn observe(
    scene: &Scene,
    world: &World,
    drive: &Drive,
    features: &[Feature],
    camera: &FeatureCamera,
    seed: u64,
) -> Vec<ObservedFeatures> {
    let poses: Vec<Pose> = drive.poses.iter().map(|timed| timed.pose).collect();
    let odometry = scene.odometry.map(|odometry| odometry.measure(&poses, seed));
    let mut first = 0;
    let firsts: Vec<usize> = (0..poses.len())
        .map(|scan| {
            if scan > 0 && poses[scan] != poses[scan - 1] {
                first = scan;
            }
            first
        })
        .collect();
    let eye = Eye { world, drive, features, camera, seed };
    let of = |scan: usize| {
        let (pose, time_s) = (poses[scan], drive.poses[scan].time_s);
        let odometry = odometry.as_ref().map(|measured| measured[scan]);
        let scan = FeatureScan { time_s, pose: Some(pose), odometry, ..FeatureScan::default() };
        (scan, pose)
    };
    (0..poses.len())
        .into_par_iter()
        .map(|number| {
            let (mut scan, pose) = of(number);
            let mut truth = Vec::new();
            for (reading, known) in eye.readings(number, firsts[number], pose) {
                scan.readings.push(reading);
                truth.push(known);
            }
            ObservedFeatures { scan, truth }
        })
        .collect()
}

/// The features that nothing hides from a pose, with their noise-free bearing (rad) and disparity (px), in the order of their numbers.
///
/// # Panics
/// If something moves and the drive has no such scan.
pub fn in_view(
    world: &World,
    drive: &Drive,
    features: &[Feature],
    camera: &FeatureCamera,
    scan: usize,
) -> Vec<(usize, [f64; 2])> {
    let pose = drive.poses[scan].pose;
    let things = (!drive.motion.is_empty())
        .then(|| World::of(drive.motion.shapes_at(scan).map(|(_, shape)| shape.clone()).collect()));
    let seen = |(number, feature): (usize, &Feature)| {
        let expected = camera.expected(pose, feature.at_m).filter(|expected| camera.views(*expected))?;
        let hidden = |world: &World, own: Option<usize>| {
            let [dx, dy] = [feature.aim_m[0] - pose.x_m, feature.aim_m[1] - pose.y_m];
            let range_m = libm::hypot(dx, dy);
            let hit = world.cast(pose.position_m(), [dx / range_m, dy / range_m]);
            hit.is_some_and(|hit| hit.range_m < range_m && Some(hit.obstacle) != own)
        };
        let by_obstacles = hidden(world, feature.is_post.then_some(feature.obstacle));
        let by_things = things.as_ref().is_some_and(|things| hidden(things, None));
        (!by_obstacles && !by_things).then_some((number, expected))
    };
    features.iter().enumerate().filter_map(seen).collect()
}

/// The camera on a drive.
struct Eye<'a> {
    world: &'a World,
    drive: &'a Drive,
    features: &'a [Feature],
    camera: &'a FeatureCamera,
    seed: u64,
}

impl Eye<'_> {
    /// Readings from left to right of the image, each with its truth; `image` is the scan at which the robot came to stand here.
    fn readings(&self, scan: usize, image: usize, pose: Pose) -> Vec<(sensor::FeatureReading, FeatureTruth)> {
        let base = ChaCha8Rng::seed_from_u64(self.seed);
        let stream = |number: u64, feature: usize| {
            let mut rng = base.clone();
            rng.set_stream(number);
            rng.set_word_pos(feature as u128 * WORDS);
            rng
        };
        debug_assert_eq!(self.drive.poses[scan].pose, pose);
        let views = in_view(self.world, self.drive, self.features, self.camera, scan);
        let read = |(feature, expected): (usize, [f64; 2])| {
            let (mut look, mut noise) = (stream(IMAGES + image as u64, feature), stream(NOISE + scan as u64, feature));
            let sampled = self.camera.sample(expected, self.features[feature].texture, &mut look, &mut noise);
            sampled.map(|(reading, matched)| (reading, FeatureTruth { feature, matched }))
        };
        let mut readings: Vec<_> = views.into_iter().filter_map(read).collect();
        readings.sort_by(|a, b| b.0.bearing_rad.total_cmp(&a.0.bearing_rad));
        readings
    }
}

#[cfg(test)]
mod tests;
