//! Cost of a ray over settled space against its length: what is left of it is where the ray begins and ends.
//!
//! `cargo bench -p mapper --bench settled`. A laser looks down a corridor that it has driven up, over 1,000 to 10,000 cells. The time is
//! that of a scan of 32 rays; from length to length it must hardly grow.

use std::sync::Arc;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use grid::GridSpec;
use mapper::{FastVisibility, Model};
use sensor::{Laser, Pose, Scan};

const CELL_M: f64 = 0.05;
/// Cells across the corridor, all of which are seen.
const ROWS: usize = 64;
const RAYS: usize = 32;
/// From where to where the robot drives, m, and how far it goes between two scans.
const START_M: f64 = 0.51;
const STEP_M: f64 = 10.0;

/// A scan from a row of cells, to the wall at the end.
fn scan(row: usize, x_m: f64, wall_m: f64) -> Scan {
    let y_m = 0.023 + CELL_M * row as f64;
    let (far_m, across_m) = (wall_m - x_m, CELL_M * (ROWS - 1) as f64 / (RAYS - 1) as f64);
    let towards = |ray: usize| libm::atan((0.02 + across_m * ray as f64 - y_m) / far_m);
    let bearings_rad: Vec<f64> = (0..RAYS).map(towards).collect();
    let readings = bearings_rad.iter().map(|bearing| Some(far_m / libm::cos(*bearing))).collect();
    Scan { sensor: 0, time_s: 0.0, pose: Pose { x_m, y_m, theta_rad: 0.0 }, bearings_rad, readings }
}

fn corridors(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("32 rays over settled space");
    for cells in [1_000usize, 2_000, 4_000, 10_000] {
        let grid = GridSpec { cell_m: CELL_M, origin_m: [0.0; 2], width: cells + 40, height: ROWS };
        let laser = Laser { max_range_m: 1000.0, early_per_m: 0.0, ..Laser::default() };
        let mut mapper = FastVisibility::visibility(&Model::new(grid, Arc::new(laser)));
        let wall_m = START_M + CELL_M * cells as f64;
        // What lies beyond a range of some 20 m of unseen space is not believed, so that the far end is mapped first.
        for step in 1..=(CELL_M * cells as f64 / STEP_M).ceil() as usize {
            let x_m = (wall_m - STEP_M * step as f64).max(START_M);
            (0..2 * ROWS).for_each(|scans| mapper.integrate_on(&scan(scans % ROWS, x_m, wall_m), 1));
        }
        (0..3 * ROWS).for_each(|scans| mapper.integrate_on(&scan(scans % ROWS, START_M, wall_m), 1));
        let mut row = 0;
        group.bench_function(BenchmarkId::from_parameter(cells), |bencher| {
            bencher.iter(|| {
                row = (row + 1) % ROWS;
                mapper.integrate_on(&scan(row, START_M, wall_m), 1);
            });
        });
    }
    group.finish();
}

criterion_group!(benches, corridors);
criterion_main!(benches);
