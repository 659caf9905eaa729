//! The readings of a drive.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use rayon::prelude::*;
use sensor::Scan;

use crate::{Drive, Scene, TimedPose, World};

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
pub fn simulate(scene: &Scene, world: &World, drive: &Drive, seed: u64) -> Simulation {
    let bearings_rad = scene.camera.bearings_rad();
    let scans = drive.poses.par_iter().enumerate();
    let scans = scans.map(|(i, pose)| scan(scene, world, pose, &bearings_rad, seed, i as u64)).collect();
    let stages = drive.stage_ends.iter().map(|(name, scans)| Stage { name: name.clone(), scans: *scans }).collect();
    Simulation { scans, stages }
}

fn scan(scene: &Scene, world: &World, at: &TimedPose, bearings_rad: &[f64], seed: u64, stream: u64) -> SimulatedScan {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(stream);
    let mut readings = Vec::with_capacity(bearings_rad.len());
    let mut true_ranges_m = Vec::with_capacity(bearings_rad.len());
    for (ray, &bearing) in bearings_rad.iter().enumerate() {
        let hit = world.cast(at.pose.position_m(), at.pose.direction(bearing));
        rng.set_word_pos(ray as u128 * WORDS_PER_RAY);
        readings.push(hit.and_then(|hit| {
            let texture = scene.obstacles[hit.obstacle].texture;
            scene.matcher.sample(hit.range_m, bearing, texture, &mut rng)
        }));
        true_ranges_m.push(hit.map(|hit| hit.range_m));
    }
    let scan = Scan { time_s: at.time_s, pose: at.pose, bearings_rad: bearings_rad.to_vec(), readings };
    SimulatedScan { scan, true_ranges_m }
}

#[cfg(test)]
mod tests;
