//! The readings of a drive.

mod standing;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use rayon::prelude::*;
use sensor::{Pose, Scan, Surface};

use crate::{Drive, Hit, Scene, TimedPose, World};

/// Words of the random stream set apart for each ray, so that what one ray draws shifts no other.
/// A reading draws about ten.
const WORDS_PER_RAY: u128 = 64;

/// What a simulated drive gave.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulation {
    /// The scans, in order of time.
    pub scans: Vec<SimulatedScan>,
    /// The stages, in order of time.
    pub stages: Vec<Stage>,
}

/// A scan and what a perfect sensor would have measured.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedScan {
    /// What the camera read.
    pub scan: Scan,
    /// True range of every ray, m; `None` where it ends on nothing.
    pub true_ranges_m: Vec<Option<f64>>,
    /// Where the robot is by its odometry, which begins at the true pose; `None` in a scene without odometry.
    pub odometry: Option<Pose>,
}

/// A moment at which the maps are looked at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stage {
    /// Its name.
    pub name: String,
    /// It comes after this many scans.
    pub scans: usize,
}

/// Simulates the readings of a drive. The same seed gives the same readings, whatever the number
/// of threads: scan `i` reads stream `i` of the seed, and every ray has its place in the stream.
/// With clustered mismatches a ray's reading depends on the rays before it in its scan too.
///
/// While the robot stands, a ray that ends as it did at an earlier scan from there has the edge and the mismatch of that scan
/// again, and fresh noise; the recorded pose jitters, by the scene's robot, about the true one.
///
/// Odometry, where the scene has one, reads streams of its own; what the camera read stays the same.
///
/// Scans are shared out over the threads of rayon's pool. Memory is asked for by scans, never by rays.
pub fn simulate(scene: &Scene, world: &World, drive: &Drive, seed: u64) -> Simulation {
    let bearings_rad = scene.camera.bearings_rad();
    let eye = Eye { scene, world, drive, bearings_rad: &bearings_rad, seed };
    let mut scans: Vec<SimulatedScan> = if standing::any(drive) {
        standing::scans(&eye)
    } else {
        let scans = 0..drive.poses.len();
        scans.into_par_iter().map(|i| eye.scan(i, &eye.look(i), |_| i)).collect()
    };
    if let Some(odometry) = &scene.odometry {
        let poses: Vec<Pose> = drive.poses.iter().map(|timed| timed.pose).collect();
        for (scan, measured) in scans.iter_mut().zip(odometry.measure(&poses, seed)) {
            scan.odometry = Some(measured);
        }
    }
    let stages = drive.stage_ends.iter().map(|(name, scans)| Stage { name: name.clone(), scans: *scans }).collect();
    Simulation { scans, stages }
}

/// What a ray ends on, if on anything.
type End = Option<Surface>;

/// The camera on a drive.
struct Eye<'a> {
    scene: &'a Scene,
    world: &'a World,
    drive: &'a Drive,
    bearings_rad: &'a [f64],
    seed: u64,
}

impl Eye<'_> {
    /// What the rays of a scan end on: an obstacle, or something that moves where that is nearer.
    fn look(&self, scan: usize) -> Vec<End> {
        let pose = self.drive.poses[scan].pose;
        let still = |hit: Hit| Surface { range_m: hit.range_m, texture: self.scene.obstacles[hit.obstacle].texture };
        let motion = &self.drive.motion;
        if motion.is_empty() {
            let cast = |&bearing: &f64| self.world.cast(pose.position_m(), pose.direction(bearing)).map(still);
            return self.bearings_rad.iter().map(cast).collect();
        }
        let things = World::of(motion.shapes_at(scan).map(|(_, shape)| shape.clone()).collect());
        let moving = |hit: Hit| Surface { range_m: hit.range_m, texture: motion.texture(hit.obstacle) };
        let cast = |&bearing: &f64| {
            let (origin, direction) = (pose.position_m(), pose.direction(bearing));
            let (fixed, thing) = (self.world.cast(origin, direction), things.cast(origin, direction));
            match (fixed, thing) {
                (Some(fixed), Some(thing)) if thing.range_m < fixed.range_m => Some(moving(thing)),
                (None, Some(thing)) => Some(moving(thing)),
                (fixed, _) => fixed.map(still),
            }
        };
        self.bearings_rad.iter().map(cast).collect()
    }

    /// The readings of a scan. `image(ray)` is the scan in which the ray's edge and mismatch were drawn.
    fn scan(&self, scan: usize, ends: &[End], image: impl Fn(usize) -> usize) -> SimulatedScan {
        let base = ChaCha8Rng::seed_from_u64(self.seed);
        let stream = |scan: usize, ray: usize| {
            let mut rng = base.clone();
            rng.set_stream(scan as u64);
            rng.set_word_pos(ray as u128 * WORDS_PER_RAY);
            rng
        };
        let fresh = |ray: usize| (image(ray) != scan).then(|| stream(scan, ray));
        let matcher = &self.scene.matcher;
        let readings = matcher.scan_again(self.bearings_rad, ends, |ray| stream(image(ray), ray), fresh);
        let TimedPose { time_s, pose } = self.drive.poses[scan];
        let true_ranges_m = ends.iter().map(|surface| surface.map(|s| s.range_m)).collect();
        let scan = Scan { sensor: 0, time_s, pose, bearings_rad: self.bearings_rad.to_vec(), readings };
        SimulatedScan { scan, true_ranges_m, odometry: None }
    }
}

#[cfg(test)]
mod tests;
