//! The readings of a drive.

mod beside;
mod standing;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use rayon::prelude::*;
use sensor::{Pose, Scan, SensorKind, Surface};

pub use self::beside::{BesideScan, Look};
use self::beside::{Sieve, Things};
use crate::{Drive, Obstacle, Scene, TimedPose, World};

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
    /// What the sensors beside the camera read at the same time, in the order of their numbers.
    pub beside: Vec<BesideScan>,
}

impl SimulatedScan {
    /// All that was read at the time, in the order of the sensors' numbers: the camera's scan, unless there is no camera, and those of the sensors
    /// beside it.
    pub fn together(&self) -> Vec<Scan> {
        let camera = Some(&self.scan).filter(|scan| !scan.bearings_rad.is_empty());
        camera.into_iter().chain(self.beside.iter().map(|beside| &beside.scan)).cloned().collect()
    }

    /// Has the robot stand elsewhere, by what is recorded: readings stay.
    pub fn move_to(&mut self, pose: Pose) {
        self.scan.pose = pose;
        for beside in &mut self.beside {
            beside.scan.pose = beside.mounted_on(pose);
        }
    }
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
/// Odometry, where the scene has one, and sensors beside the camera read streams of their own; what the camera read stays the same. Of
/// things that not every reading ends on ([`SeenBy`](crate::SeenBy)), whether a ray does is drawn for every scan, ray and thing. While the
/// robot stands, images of stereo cameras beside the camera repeat as its own do; what other sensors read is fresh.
///
/// Scans are shared out over the threads of rayon's pool. Memory is asked for by scans, never by rays.
pub fn simulate(scene: &Scene, world: &World, drive: &Drive, seed: u64) -> Simulation {
    let bearings_rad = scene.camera.bearings_rad();
    let passes = |obstacle: &Obstacle| obstacle.seen_by.share(SensorKind::Stereo) < 1.0;
    let passed = scene.obstacles.iter().any(passes);
    let eye = Eye { scene, world, drive, bearings_rad: &bearings_rad, passed, seed };
    let mut scans: Vec<SimulatedScan> = if standing::any(drive) {
        standing::scans(&eye)
    } else {
        let scans = 0..drive.poses.len();
        scans.into_par_iter().map(|i| eye.scan(i, &eye.look(i), |_| i, None)).collect()
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
    /// Whether the camera looks past anything.
    passed: bool,
    seed: u64,
}

impl Eye<'_> {
    /// What is there at a scan.
    fn things(&self, scan: usize) -> Things<'_> {
        let motion = &self.drive.motion;
        let shapes = || motion.shapes_at(scan).map(|(_, shape)| shape.clone()).collect();
        Things { eye: self, moving: (!motion.is_empty()).then(|| World::of(shapes())) }
    }

    /// What the camera's rays of a scan end on: an obstacle, or something that moves where that is nearer.
    fn look(&self, scan: usize) -> Vec<End> {
        let (pose, things) = (self.drive.poses[scan].pose, self.things(scan));
        self.bearings_rad.iter().map(|&bearing| things.cast(pose, bearing, |_| true)).collect()
    }

    /// What they end on for the camera, where not every reading ends on all that is there.
    fn look_past(&self, scan: usize) -> Option<Vec<End>> {
        let sieve = Sieve { eye: self, kind: SensorKind::Stereo, sensor: 0, scan };
        self.passed.then(|| {
            let (pose, things) = (self.drive.poses[scan].pose, self.things(scan));
            let rays = self.bearings_rad.iter().enumerate();
            rays.map(|(ray, &bearing)| things.cast(pose, bearing, |obstacle| sieve.sees(ray, obstacle))).collect()
        })
    }

    /// The readings of a scan. `image(ray)` is the scan in which the ray's edge and mismatch were drawn, `beside` the same of the cameras beside.
    fn scan(
        &self,
        scan: usize,
        ends: &[End],
        image: impl Fn(usize) -> usize,
        beside: Option<&beside::Images>,
    ) -> SimulatedScan {
        let base = ChaCha8Rng::seed_from_u64(self.seed);
        let stream = |scan: usize, ray: usize| {
            let mut rng = base.clone();
            rng.set_stream(scan as u64);
            rng.set_word_pos(ray as u128 * WORDS_PER_RAY);
            rng
        };
        let fresh = |ray: usize| (image(ray) != scan).then(|| stream(scan, ray));
        let matcher = &self.scene.matcher;
        let past = self.look_past(scan);
        let seen = past.as_deref().unwrap_or(ends);
        let readings = matcher.scan_again(self.bearings_rad, seen, |ray| stream(image(ray), ray), fresh);
        let TimedPose { time_s, pose } = self.drive.poses[scan];
        let true_ranges_m = ends.iter().map(|surface| surface.map(|s| s.range_m)).collect();
        let beside = beside::scans(self, scan, pose, beside);
        let scan = Scan { sensor: 0, time_s, pose, bearings_rad: self.bearings_rad.to_vec(), readings };
        SimulatedScan { scan, true_ranges_m, odometry: None, beside }
    }
}

#[cfg(test)]
mod tests;
