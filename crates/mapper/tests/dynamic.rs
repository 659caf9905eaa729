//! `visibility-dynamic`, fast, against its reference, and what it makes of a world that changes.

use std::sync::Arc;

use grid::GridSpec;
use mapper::{Dynamic, FastVisibility, Mapper as _, Model, PairwiseGrid, Prior, Renewal};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use sensor::{Pose, Scan, Stereo};

const RENEWAL: Renewal =
    Renewal { rates_per_s: [3e-5, 3e-3, 0.5], shares: [0.9, 0.08, 0.02], turnover_per_s: 1e-3, step_s: 0.0 };

/// Side of a tile of the fast map, cells: the unit for which time passes.
const TILE_SIDE: usize = 16;

/// Largest difference of any marginal or joint. Joints across the border of two tiles do not count: where these were brought to a time
/// one after the other, what covers both is renewed at either end alone.
fn difference(a: &PairwiseGrid, b: &PairwiseGrid) -> f64 {
    let spec = *a.spec();
    let tile = |cell: usize| [cell % spec.width / TILE_SIDE, cell / spec.width / TILE_SIDE];
    let mut largest = 0.0f64;
    for cell in 0..spec.cells() {
        largest = largest.max((a.marginals()[cell] - b.marginals()[cell]).abs());
        for n in spec.neighbours(cell).filter(|n| tile(n.cell) == tile(cell)) {
            largest = largest.max((a.joint(cell, n.cell).ee - b.joint(cell, n.cell).ee).abs());
        }
    }
    largest
}

/// A scan of walls and false matches from a random place.
fn scan(rng: &mut ChaCha8Rng, spec: &GridSpec, time_s: f64) -> Scan {
    let size = [spec.width as f64 * spec.cell_m, spec.height as f64 * spec.cell_m];
    let [x_m, y_m] = size.map(|size| size * rng.random::<f64>());
    let (wall, stereo) = (size[0] * rng.random::<f64>(), Stereo::default());
    let bearings_rad: Vec<f64> = (0..40).map(|k| 0.03 * (f64::from(k) - 19.5)).collect();
    let reading = |bearing: f64, rng: &mut ChaCha8Rng| match rng.random::<f64>() {
        p if p < 0.1 => None,
        p if p < 0.3 => Some(stereo.max_disparity * rng.random::<f64>()),
        _ => Some((stereo.disparity(wall, bearing) + 0.5 * rng.random::<f64>()).clamp(0.0, stereo.max_disparity)),
    };
    let readings = bearings_rad.iter().map(|bearing| reading(*bearing, rng)).collect();
    let pose = Pose { x_m, y_m, theta_rad: 7.0 * rng.random::<f64>() };
    Scan { sensor: 0, time_s, pose, bearings_rad, readings }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    #[test]
    fn it_is_the_reference_after_two_scans(
        seed: u64, width in 1usize..70, height in 1usize..70, cell_m in 0.03f64..0.3, occupancy in 0.02f64..0.5,
        correlation in 0.0f64..0.97, seconds in 0.0f64..20.0, first_s in -5.0f64..1e6, rate in 0.01f64..2.0, share in 0.001f64..0.5,
        step_s in prop_oneof![Just(0.0), 0.1f64..9.0],
    ) {
        let grid = GridSpec { cell_m, origin_m: [0.0; 2], width, height };
        let prior = Prior { occupancy, correlation, ..Prior::default() };
        let setup = Model { prior, ..Model::new(grid, Arc::new(Stereo::default())) };
        let renewal = Renewal { rates_per_s: [3e-5, 3e-3, rate], shares: [0.92 - share, 0.08, share], step_s, ..RENEWAL };
        let (mut fast, mut reference) = (FastVisibility::dynamic(&setup, renewal), Dynamic::new(&setup, renewal));
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        for number in 0..2 {
            // Time alone, then a scan: what time leaves apart, a reading may drive farther apart.
            let scan = scan(&mut rng, &grid, first_s + f64::from(number) * seconds);
            for scan in [Scan { bearings_rad: Vec::new(), readings: Vec::new(), ..scan.clone() }, scan] {
                fast.integrate(&scan);
                reference.integrate(&scan);
                let found = difference(&fast.pairs(), reference.pairs());
                prop_assert!(found < 1e-5, "{found} after scan {number} of {} rays", scan.readings.len());
                reference.set_pairs(fast.pairs());
            }
        }
    }
}

/// What is not looked at costs nothing, and is what it would be if its time had passed at every scan.
#[test]
fn late_is_never_too_late() {
    let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 150, height: 120 };
    let setup = Model::new(grid, Arc::new(Stereo::default()));
    let (mut lazy, mut eager) = (FastVisibility::dynamic(&setup, RENEWAL), Dynamic::new(&setup, RENEWAL));
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let first = scan(&mut rng, &grid, 0.0);
    lazy.integrate(&first);
    eager.integrate(&first);
    eager.set_pairs(lazy.pairs());
    // Scans into a corner, away from the rest, and their time.
    for number in 0..30 {
        let mut scan = scan(&mut rng, &grid, 2.0 + 0.5 * f64::from(number));
        scan.pose = Pose { x_m: 0.3, y_m: 0.3, theta_rad: -2.356 };
        lazy.integrate(&scan);
        eager.pass(scan.time_s);
    }
    let (lazy, eager) = (lazy.occupancy(), eager.pairs().marginals());
    let apart = (0..grid.cells()).filter(|cell| grid.centre(*cell).iter().sum::<f64>() > 2.0);
    let moved = apart.clone().filter(|cell| (lazy[*cell] - 0.1).abs() > 0.01).count();
    let most = apart.map(|cell| (lazy[cell] - eager[cell]).abs()).fold(0.0, f64::max);
    assert!(most < 1e-5 && moved > 100, "{most} of {moved}");
}
