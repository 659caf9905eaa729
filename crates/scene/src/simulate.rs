//! The readings of a drive.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use rayon::prelude::*;
use sensor::{Scan, Surface};

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
/// Scans are shared out over the threads of rayon's pool. Memory is asked for by scans, never by rays.
pub fn simulate(scene: &Scene, world: &World, drive: &Drive, seed: u64) -> Simulation {
    let bearings_rad = scene.camera.bearings_rad();
    let scans = drive.poses.par_iter().enumerate();
    let scans = scans.map(|(i, pose)| scan(scene, world, pose, &bearings_rad, seed, i as u64)).collect();
    let stages = drive.stage_ends.iter().map(|(name, scans)| Stage { name: name.clone(), scans: *scans }).collect();
    Simulation { scans, stages }
}

fn scan(scene: &Scene, world: &World, at: &TimedPose, bearings_rad: &[f64], seed: u64, stream: u64) -> SimulatedScan {
    let surface = |hit: Hit| Surface { range_m: hit.range_m, texture: scene.obstacles[hit.obstacle].texture };
    let cast = |&bearing: &f64| world.cast(at.pose.position_m(), at.pose.direction(bearing)).map(surface);
    let surfaces: Vec<Option<Surface>> = bearings_rad.iter().map(cast).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(stream);
    let readings = scene.matcher.scan(bearings_rad, &surfaces, |ray| {
        let mut rng = rng.clone();
        rng.set_word_pos(ray as u128 * WORDS_PER_RAY);
        rng
    });
    let true_ranges_m = surfaces.iter().map(|surface| surface.map(|s| s.range_m)).collect();
    let scan = Scan { sensor: 0, time_s: at.time_s, pose: at.pose, bearings_rad: bearings_rad.to_vec(), readings };
    SimulatedScan { scan, true_ranges_m }
}

#[cfg(test)]
mod tests;
