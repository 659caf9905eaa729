//! What continuity across rays must keep: cells that nothing connects, and free space that is looked at again and again.

use std::sync::Arc;

use grid::GridSpec;
use mapper::{FastVisibility, Lateral, Mapper as _, Model, Prior, Visibility};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use sensor::{Matcher, Pose, Scan, Stereo};

const GRID: GridSpec = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 100, height: 90 };

/// A wall at x = 4.5 m from (0.5, 2.25), seen by so many rays.
fn scan(rays: usize, seed: u64) -> Scan {
    let matcher = Matcher { stereo: Stereo::default(), ..Matcher::default() };
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let bearings_rad: Vec<f64> = (0..rays).map(|k| 0.8 * ((k as f64 + 0.5) / rays as f64 - 0.5)).collect();
    let wall_m = |bearing: f64| 4.0 / bearing.cos();
    let readings =
        bearings_rad.iter().map(|bearing| matcher.sample(wall_m(*bearing), *bearing, 1.0, &mut rng)).collect();
    Scan { sensor: 0, time_s: 0.0, pose: Pose { x_m: 0.5, y_m: 2.25, theta_rad: 0.0 }, bearings_rad, readings }
}

/// Which cells the rays with readings cross.
fn on_rays(scan: &Scan) -> Vec<bool> {
    let mut on_rays = vec![false; GRID.cells()];
    let mut line = grid::DigitalLine::default();
    for ray in scan.rays().filter(|ray| ray.reading.is_some()) {
        line.trace(&GRID, ray.origin_m, ray.direction, f64::INFINITY);
        line.cells().iter().for_each(|cell| on_rays[*cell] = true);
    }
    on_rays
}

#[test]
fn without_correlation_cells_on_no_ray_learn_nothing() {
    let prior = Prior { correlation: 0.0, ..Prior::default() };
    let setup = Model { prior, ..Model::new(GRID, Arc::new(Stereo::default())) };
    let scan = scan(9, 1);
    let on_rays = on_rays(&scan);
    let (mut reference, mut fast) =
        (Visibility::lateral(&setup, Lateral::default()), FastVisibility::lateral(&setup, Lateral::default()));
    reference.integrate(&scan);
    fast.integrate(&scan);
    for (cell, on_ray) in on_rays.iter().enumerate() {
        let (exact, single) = (reference.occupancy()[cell], fast.occupancy()[cell]);
        if !on_ray {
            assert!((exact - 0.1).abs() < 1e-15 && (single - 0.1).abs() < 1e-8, "cell {cell}: {exact} {single}");
        }
    }
    assert!(on_rays.iter().zip(fast.occupancy().values()).any(|(on, p)| *on && *p < 0.05));
}

#[test]
fn with_it_they_do() {
    let setup = Model::new(GRID, Arc::new(Stereo::default()));
    let scan = scan(18, 1);
    let on_rays = on_rays(&scan);
    // Between rays, well before the wall, where the method of the paper knows nothing.
    let between = |cell: &usize| {
        let [x, y] = GRID.centre(*cell);
        !on_rays[*cell] && (2.0..2.5).contains(&x) && (y - 2.25).abs() < 0.3 * (x - 0.5)
    };
    let cells: Vec<usize> = (0..GRID.cells()).filter(between).collect();
    let mean = |mut mapper: FastVisibility| {
        mapper.integrate(&scan);
        cells.iter().map(|cell| mapper.occupancy()[*cell]).sum::<f64>() / cells.len() as f64
    };
    let (along, across) =
        (mean(FastVisibility::visibility(&setup)), mean(FastVisibility::lateral(&setup, Lateral::default())));
    assert!(
        cells.len() > 20 && (along - 0.1).abs() < 1e-6 && across < 0.098,
        "{} cells: {along}, {across}",
        cells.len()
    );
}

#[test]
fn free_space_stays_free_however_often_the_same_scan_comes() {
    let setup = Model::new(GRID, Arc::new(Stereo::default()));
    for seed in 0..3 {
        let scan = scan(110, seed);
        let mut mapper = FastVisibility::lateral(&setup, Lateral::default());
        for _ in 0..1000 {
            mapper.integrate(&scan);
        }
        // The wedge of the rays up to 2.5 m, an outlier's distance before the wall.
        for cell in 0..GRID.cells() {
            let [x, y] = GRID.centre(cell);
            if (0.7..2.0).contains(&x) && (y - 2.25).abs() < 0.35 * (x - 0.5) {
                assert!(mapper.occupancy()[cell] < 0.2, "seed {seed}: {} at {x}, {y}", mapper.occupancy()[cell]);
            }
        }
    }
}
