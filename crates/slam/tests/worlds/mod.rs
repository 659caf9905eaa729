//! Worlds for tests: one of 3 x 3 cells that is summed over exactly, and a room.
#![allow(unreachable_pub)]

use std::sync::{Arc, OnceLock};

use grid::{GridSpec, Raster};
use mapper::{Belief, Mapper, Model, Predictive};
use sensor::{Laser, Pose, Scan};
use slam::{Options, Weight};

/// A laser that is as coarse as the cells of the small world.
pub const COARSE: Laser = Laser { range_sigma_m: 0.3, max_range_m: 8.0, hit: 0.85, no_echo: 0.05, early_per_m: 0.02 };

/// A filter of few particles, quick enough for a test.
pub const FEW: Options = Options {
    particles: 6,
    seed: 3,
    weight: Weight::FIELD,
    proposal: slam::Proposal::Matched,
    sharpness: slam::Sharpness { sigma_m: 0.07, occupied: 0.3, power: 1.0 },
    update_move_m: 0.3,
    update_turn_rad: 0.3,
    least_sigmas: Options::OF_LOGS,
    reach_m: 20.0,
};

/// Probability that a cell of the small world is occupied, and that one beyond it begins an obstacle.
const OCCUPIED: f64 = 0.3;

/// The small world: 3 x 3 cells of 1 m.
pub fn small() -> GridSpec {
    GridSpec { cell_m: 1.0, origin_m: [0.0; 2], width: 3, height: 3 }
}

/// All 512 worlds.
fn cells() -> &'static [Raster<f64>] {
    static CELLS: OnceLock<Vec<Raster<f64>>> = OnceLock::new();
    let world = |world: u32| Raster::new(small(), (0..9).map(|cell| f64::from(world >> cell & 1)).collect());
    CELLS.get_or_init(|| (0..512).map(world).collect())
}

/// Probability, per unit of the readings, of all rays of a scan in each of the 512 worlds.
pub fn likelihoods(scan: &Scan) -> Vec<f64> {
    let mut all = vec![1.0; 512];
    let mut predictive = Predictive::new(small(), &COARSE, OCCUPIED);
    for ray in scan.rays() {
        if predictive.take(&ray) {
            let of = |world| (-predictive.log_loss(Belief::Cells(world))).exp();
            all.iter_mut().zip(cells()).for_each(|(p, world)| *p *= of(world));
        }
    }
    all
}

/// Prior probability of a world.
pub fn prior(world: usize) -> f64 {
    (0..9).map(|cell| if world >> cell & 1 == 1 { OCCUPIED } else { 1.0 - OCCUPIED }).product()
}

/// The sum over all 512 worlds.
#[derive(Clone)]
pub struct Exact {
    /// Probability of every world.
    pub worlds: Vec<f64>,
    occupancy: Raster<f64>,
}

impl Exact {
    pub fn new() -> Self {
        let worlds = (0..512).map(prior).collect();
        Self { worlds, occupancy: Raster::filled(small(), OCCUPIED) }
    }
}

impl Mapper for Exact {
    fn integrate(&mut self, scan: &Scan) {
        self.worlds.iter_mut().zip(likelihoods(scan)).for_each(|(p, likelihood)| *p *= likelihood);
        let sum: f64 = self.worlds.iter().sum();
        self.worlds.iter_mut().for_each(|p| *p /= sum);
        for cell in 0..9 {
            let occupied = self.worlds.iter().enumerate().filter(|(world, _)| world >> cell & 1 == 1);
            self.occupancy[cell] = occupied.map(|(_, p)| p).sum();
        }
    }

    fn occupancy(&self) -> &Raster<f64> {
        &self.occupancy
    }

    fn evidence(&self, scan: &Scan) -> Option<f64> {
        small().locate(scan.pose.position_m())?;
        Some(self.worlds.iter().zip(likelihoods(scan)).map(|(p, likelihood)| p * likelihood).sum::<f64>().ln())
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(self.clone()))
    }
}

/// A room of 12 m x 8 m with a pillar and a niche, its corner at (0, 0); the grid has 2 m more on every side.
pub fn room() -> Model {
    let grid = GridSpec { cell_m: 0.05, origin_m: [-2.0; 2], width: 320, height: 240 };
    Model::new(grid, Arc::new(Laser::default()))
}

/// Rectangles of the room that stop beams, each by its corners, m.
const WALLS: [[f64; 4]; 6] = [
    [-0.5, -0.5, 12.5, 0.0],
    [-0.5, 8.0, 12.5, 8.5],
    [-0.5, 0.0, 0.0, 8.0],
    [12.0, 0.0, 12.5, 8.0],
    [4.0, 3.0, 5.0, 4.0],
    [8.5, 6.5, 12.0, 8.0],
];

/// What a laser of 180 beams sees of the room; `number` gives the noise, of 1 cm.
pub fn seen(pose: Pose, number: usize) -> Scan {
    let bearings_rad: Vec<f64> = (0..180).map(|k| (f64::from(k) - 89.5).to_radians()).collect();
    let noise = |k: usize| 0.01 * (12.9898 * k as f64 + 78.233 * number as f64).sin();
    let reading = |(k, bearing): (usize, &f64)| {
        let direction = pose.direction(*bearing);
        let at = pose.position_m();
        let hit = |wall: &[f64; 4]| {
            let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
            for axis in 0..2 {
                let ends = [wall[axis], wall[axis + 2]].map(|edge| (edge - at[axis]) / direction[axis]);
                (enter, leave) = (enter.max(ends[0].min(ends[1])), leave.min(ends[0].max(ends[1])));
            }
            (enter <= leave).then_some(enter)
        };
        let range = WALLS.iter().filter_map(hit).fold(f64::INFINITY, f64::min);
        Some(range + noise(k))
    };
    let readings = bearings_rad.iter().enumerate().map(reading).collect();
    Scan { sensor: 0, time_s: 0.2 * number as f64, pose, bearings_rad, readings }
}

/// Round the pillar, so many scans: the true poses.
pub fn way(scans: usize) -> Vec<Pose> {
    let along = |k: usize| {
        let angle = 0.05 * k as f64;
        let (sin, cos) = angle.sin_cos();
        Pose {
            x_m: 5.0 + 2.8 * cos,
            y_m: 3.6 + 2.2 * sin,
            theta_rad: sensor::wrapped_rad((2.2 * cos).atan2(-2.8 * sin)),
        }
    };
    (0..scans).map(along).collect()
}
