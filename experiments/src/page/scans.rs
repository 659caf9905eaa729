//! The scans that a page draws: where they were taken, what they read, and how far their rays went.

use grid::{DigitalLine, Raster};
use scene::SimulatedScan;
use score::NUDGE_M;
use sensor::Scan;

use crate::worlds::ground::Ground;

/// What readings are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ReadingUnit {
    /// Disparities of a stereo camera, px; focal length times baseline, px·m.
    Disparity(f64),
    /// Ranges, m.
    Range,
}

/// Scans of one world, in order of time.
#[derive(Debug, Clone)]
pub struct Scans {
    /// What readings are.
    pub unit: ReadingUnit,
    /// The scans.
    pub scans: Vec<Scan>,
    /// Of simulated ones, what is true of every ray.
    pub truth: Option<Vec<Vec<TrueRay>>>,
}

/// What is true of a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrueRay {
    /// Range of the first hit, m; none where there is none.
    pub range_m: Option<f64>,
    /// Number of cells from the camera to the last one that the ray looked at, both counted, as
    /// [`Sightings::looks`](score::Sightings::looks) counts.
    pub reach: u32,
}

impl Scans {
    /// Those of a simulation on this ground.
    pub fn simulated(scans: &[SimulatedScan], ground: &Ground) -> Self {
        let mut line = DigitalLine::default();
        let mut ray = |scan: &Scan, bearing: f64, range_m: Option<f64>, truth: &Raster<Option<bool>>| {
            let hit = range_m.unwrap_or(f64::INFINITY);
            line.trace(truth.spec(), scan.pose.position_m(), scan.pose.direction(bearing), hit + NUDGE_M);
            TrueRay { range_m, reach: reach(&line, hit, truth) }
        };
        // From where the robot truly stood: the recorded pose may jitter.
        let scans: Vec<(Scan, &SimulatedScan)> = (ground.drive.poses.iter().zip(scans))
            .map(|(timed, simulated)| (Scan { pose: timed.pose, ..simulated.scan.clone() }, simulated))
            .collect();
        let of_scan = |(number, (scan, simulated)): (usize, &(Scan, &SimulatedScan))| {
            let truth = ground.truth_after(number + 1);
            let rays = scan.bearings_rad.iter().zip(&simulated.true_ranges_m);
            rays.map(|(bearing, range_m)| ray(scan, *bearing, *range_m, &truth)).collect()
        };
        Self {
            unit: ReadingUnit::Disparity(ground.scene.matcher.stereo.focal_baseline),
            truth: Some(scans.iter().enumerate().map(of_scan).collect()),
            scans: scans.into_iter().map(|(scan, _)| scan).collect(),
        }
    }
}

/// The cells of a line up to the last that is looked at: crossed before the hit, or the surface that is hit.
fn reach(line: &DigitalLine, hit: f64, truth: &Raster<Option<bool>>) -> u32 {
    let mut last = 0;
    for (k, (&cell, chord)) in line.cells().iter().zip(line.ranges().windows(2)).enumerate() {
        let crossed = chord[1].min(hit) - chord[0] > NUDGE_M;
        let hits = chord[1] >= hit + NUDGE_M;
        if crossed || hits && truth[cell] == Some(true) {
            last = k + 1;
        }
        if hits {
            break;
        }
    }
    last as u32
}
