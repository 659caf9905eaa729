//! `visibility`, fast, against its reference: one scan after the other from the same map.

use std::sync::Arc;

use crate::difference::difference;
use grid::GridSpec;
use mapper::{FastVisibility, Lateral, Mapper as _, Model, Prior, Reconciliation, Visibility};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use sensor::{Laser, Pose, Scan, SensorModel, Stereo};

/// A scan from a random place: readings of walls, at random, and none.
fn scan(rng: &mut ChaCha8Rng, spec: &GridSpec, columns: usize, stereo: &Stereo) -> Scan {
    let size = [spec.width as f64 * spec.cell_m, spec.height as f64 * spec.cell_m];
    let on_line = rng.random::<f64>() < 0.1;
    let place = |size: f64, rng: &mut ChaCha8Rng| {
        let at = size * rng.random::<f64>();
        if on_line { (at / spec.cell_m).floor() * spec.cell_m } else { at }
    };
    let pose = Pose { x_m: place(size[0], rng), y_m: place(size[1], rng), theta_rad: 7.0 * rng.random::<f64>() };
    let wall = size[0] * rng.random::<f64>();
    let field = if rng.random::<f64>() < 0.1 { 6.2 } else { 1.4 };
    let bearings_rad: Vec<f64> = (0..columns).map(|k| field * ((k as f64 + 0.5) / columns as f64 - 0.5)).collect();
    let reading = |bearing: f64, rng: &mut ChaCha8Rng| match rng.random::<f64>() {
        p if p < 0.15 => None,
        p if p < 0.35 => Some(stereo.max_disparity * rng.random::<f64>()),
        _ => Some((stereo.disparity(wall, bearing) + 0.5 * rng.random::<f64>()).clamp(0.0, stereo.max_disparity)),
    };
    let readings = bearings_rad.iter().map(|bearing| reading(*bearing, rng)).collect();
    Scan { sensor: 0, time_s: 0.0, pose, bearings_rad, readings }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn a_scan_differs_from_the_reference_by_less_than_a_hundred_thousandth(
        seed: u64, width in 1usize..90, height in 1usize..90, columns in 1usize..120, cell_m in 0.02f64..0.3,
        occupancy in 0.01f64..0.6, correlation in 0.0f64..0.99, touched: bool, continuity: bool,
        sigma in 0.1f64..2.0, correct_match in 0.2f64..0.99,
    ) {
        let grid = GridSpec { cell_m, origin_m: [0.0; 2], width, height };
        let stereo = Stereo { disparity_sigma: sigma, correct_match, ..Stereo::default() };
        let prior = Prior { occupancy, correlation, ..Prior::default() };
        let reconciliation = if touched { Reconciliation::Touched } else { Reconciliation::AllEdges };
        let setup = Model { prior, reconciliation, ..Model::new(grid, Arc::new(stereo)) };
        let mut fast = if continuity { FastVisibility::visibility(&setup) } else { FastVisibility::independent(&setup) };
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        for _ in 0..6 {
            let mut reference = if continuity { Visibility::exact(&setup) } else { Visibility::independent(&setup) };
            reference.set_pairs(fast.pairs());
            let scan = scan(&mut rng, &grid, columns, &stereo);
            fast.integrate(&scan);
            reference.integrate(&scan);
            let found = difference(&fast.pairs(), reference.pairs());
            prop_assert!(found < 1e-5, "{found} at {:?}", scan.pose);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn with_continuity_across_rays_too(
        seed: u64, width in 1usize..90, height in 1usize..90, columns in 1usize..120, cell_m in 0.02f64..0.3,
        occupancy in 0.01f64..0.6, correlation in 0.0f64..0.99, rays: bool, edges: bool,
        learnt in 0.0f64..4.0, before in 0.1f64..4.0, sigma in 0.1f64..2.0, correct_match in 0.2f64..0.99,
    ) {
        let grid = GridSpec { cell_m, origin_m: [0.0; 2], width, height };
        let stereo = Stereo { disparity_sigma: sigma, correct_match, ..Stereo::default() };
        let prior = Prior { occupancy, correlation, ..Prior::default() };
        let setup = Model { prior, ..Model::new(grid, Arc::new(stereo)) };
        let lateral = Lateral { rays, edges, learnt, before };
        let mut fast = FastVisibility::lateral(&setup, lateral);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        for _ in 0..6 {
            let mut reference = Visibility::lateral(&setup, lateral);
            reference.set_pairs(fast.pairs());
            let scan = scan(&mut rng, &grid, columns, &stereo);
            fast.integrate(&scan);
            reference.integrate(&scan);
            let found = difference(&fast.pairs(), reference.pairs());
            prop_assert!(found < 1e-5, "{found} at {:?}", scan.pose);
        }
    }
}

#[test]
fn the_map_does_not_depend_on_the_threads() {
    let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 150, height: 120 };
    let setup = Model::new(grid, Arc::new(Stereo::default()));
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let scans: Vec<Scan> = (0..5).map(|_| scan(&mut rng, &grid, 1500, &Stereo::default())).collect();
    let lateral = |setup: &Model| FastVisibility::lateral(setup, Lateral::default());
    for unseen in [FastVisibility::visibility, lateral] {
        let on = |threads: usize| {
            let mut mapper = unseen(&setup);
            scans.iter().for_each(|scan| mapper.integrate_on(scan, threads));
            mapper.pairs()
        };
        let one = on(1);
        assert_ne!(one, unseen(&setup).pairs());
        for threads in [2, 3, 7] {
            assert!(on(threads) == one, "{threads} threads");
        }
    }
}

/// More rays than its counters can hold: every second ray makes a scan of its own.
#[test]
fn a_scan_of_too_many_rays_is_taken_in_passes() {
    let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 30, height: 3 };
    let setup = Model::new(grid, Arc::new(Stereo::default()));
    let rays = FastVisibility::MOST_RAYS + 7;
    let pose = Pose { x_m: 0.01, y_m: 0.07, theta_rad: 0.0 };
    let bearings_rad: Vec<f64> = (0..rays).map(|k| 1e-7 * k as f64).collect();
    let readings: Vec<Option<f64>> = (0..rays).map(|k| Some(11.0 + (k % 5) as f64)).collect();
    let whole = Scan { sensor: 0, time_s: 0.0, pose, bearings_rad, readings };
    let half = |first: usize| {
        let every = |k: &usize| k % 2 == first;
        let of = |k: usize| (whole.bearings_rad[k], whole.readings[k]);
        let (bearings_rad, readings) = (0..rays).filter(every).map(of).unzip();
        Scan { bearings_rad, readings, ..whole.clone() }
    };
    let [mut once, mut twice] = [(); 2].map(|()| FastVisibility::visibility(&setup));
    once.integrate(&whole);
    [half(0), half(1)].iter().for_each(|scan| twice.integrate(scan));
    assert_eq!(once.pairs(), twice.pairs());
    assert!(once.occupancy()[grid.locate([0.5, 0.07]).expect("inside")] < 0.01);
    assert_eq!(once.work().cells, twice.work().cells);
}

/// Range (m) from a place in a room to its walls.
fn to_the_walls(spec: &GridSpec, pose: &Pose, bearing: f64, margin_m: f64) -> f64 {
    let (at, along) = (pose.position_m(), pose.direction(bearing));
    let size = [spec.width, spec.height].map(|cells| cells as f64 * spec.cell_m);
    let to = |k: usize| {
        let wall = if along[k] > 0.0 { size[k] - margin_m } else { margin_m };
        if along[k] == 0.0 { f64::INFINITY } else { (wall - at[k]) / along[k] }
    };
    to(0).min(to(1))
}

/// A room that is looked at until its floor is settled, and then by readings that fit and others that do not. Rays leap over
/// what is settled and are as far from the reference as where they do not.
#[test]
fn leaps_over_settled_space_change_nothing() {
    let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 130, height: 90 };
    let (stereo, laser) = (Stereo::default(), Laser::default());
    type Reading<'a> = &'a dyn Fn(f64, f64) -> f64;
    let kinds: [(Arc<dyn SensorModel>, Reading); 2] =
        [(Arc::new(stereo), &|range, bearing| stereo.disparity(range, bearing)), (Arc::new(laser), &|range, _| range)];
    for (sensor, reading) in kinds {
        let model = Model::new(grid, sensor);
        for continuity in [true, false] {
            let unseen = if continuity { FastVisibility::visibility } else { FastVisibility::independent };
            let mut rng = ChaCha8Rng::seed_from_u64(7);
            let mut fast = unseen(&model);
            let mut skipped = 0;
            for number in 0..60 {
                let uniform = |rng: &mut ChaCha8Rng| rng.random::<f64>();
                let (x_m, y_m) = (1.5 + 3.5 * uniform(&mut rng), 1.0 + 2.5 * uniform(&mut rng));
                let pose = Pose { x_m, y_m, theta_rad: 7.0 * uniform(&mut rng) };
                let bearings_rad: Vec<f64> = (0..150).map(|k| 0.012 * (f64::from(k) - 74.5)).collect();
                let surprises = if number < 40 { 0.0 } else { 0.2 };
                let range = |bearing: f64, rng: &mut ChaCha8Rng| {
                    let range = to_the_walls(&grid, &pose, bearing, 0.4);
                    if uniform(rng) < surprises { range * (0.1 + 1.3 * uniform(rng)) } else { range }
                };
                let readings = bearings_rad.iter().map(|b| Some(reading(range(*b, &mut rng), *b).min(59.0))).collect();
                let scan = Scan { sensor: 0, time_s: 0.0, pose, bearings_rad, readings };
                let before = (number >= 40).then(|| fast.pairs());
                let leapt = fast.skipped();
                fast.integrate(&scan);
                if let Some(before) = before {
                    let mut reference =
                        if continuity { Visibility::exact(&model) } else { Visibility::independent(&model) };
                    reference.set_pairs(before);
                    reference.integrate(&scan);
                    let found = difference(&fast.pairs(), reference.pairs());
                    assert!(found < 1e-5, "{found} at {pose:?}, continuity {continuity}");
                    skipped += fast.skipped() - leapt;
                }
            }
            assert!(skipped > 20_000, "{skipped} cells were leapt over");
        }
    }
}

/// The same in a hall, over the middle of whose floor rays leap in one, by a laser.
#[test]
fn leaps_over_squares_of_settled_space_change_nothing() {
    let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 400, height: 400 };
    let model = Model::new(grid, Arc::new(Laser::default()));
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let mut scan = |surprises: f64| {
        let mut uniform = || rng.random::<f64>();
        let pose = Pose { x_m: 6.0 + 7.0 * uniform(), y_m: 6.0 + 7.0 * uniform(), theta_rad: 7.0 * uniform() };
        let bearings_rad: Vec<f64> = (0..720).map(|k| 0.0087 * f64::from(k)).collect();
        let reading = |bearing: &f64| {
            let range = to_the_walls(&grid, &pose, *bearing, 0.4);
            Some(if uniform() < surprises { range * uniform() } else { range })
        };
        let readings = bearings_rad.iter().map(reading).collect();
        Scan { sensor: 0, time_s: 0.0, pose, bearings_rad, readings }
    };
    let mut settled = FastVisibility::visibility(&model);
    (0..100).for_each(|_| settled.integrate(&scan(0.0)));
    // Cells 128 to 255 either way are a square, of which every cell is settled.
    let middle = (128..256).flat_map(|row| (128..256).map(move |column| 400 * row + column));
    assert!(middle.map(|cell| settled.occupancy()[cell]).fold(0.0, f64::max) <= 4e-6);
    let mut skipped = 0;
    for surprises in [0.0, 0.0, 0.1, 0.1] {
        let scan = scan(surprises);
        let (mut fast, mut reference) = (settled.fork().expect("a copy"), Visibility::exact(&model));
        reference.set_pairs(settled.pairs());
        fast.integrate(&scan);
        reference.integrate(&scan);
        let found = difference(&fast.pairwise().expect("joints"), reference.pairs());
        assert!(found < 1e-5, "{found} at {:?}", scan.pose);
        skipped += fast.skipped() - settled.skipped();
    }
    assert!(skipped > 200_000, "{skipped} cells were leapt over");
}

/// A box that appears in settled space: it is found after no more looks than the reference needs, which leaps over nothing.
#[test]
fn what_appears_in_settled_space_is_found_as_soon() {
    let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 110, height: 60 };
    let laser = Laser::default();
    let model = Model::new(grid, Arc::new(laser));
    let scan = |number: usize, face_m: f64| {
        let drawn = |factor: f64| (factor * number as f64).fract();
        let (x_m, y_m) = (0.5 + 1.2 * drawn(0.618_034), 1.0 + drawn(0.754_878));
        let pose = Pose { x_m, y_m, theta_rad: 0.4 * drawn(0.569_84) - 0.2 };
        let bearings_rad: Vec<f64> = (0..121).map(|k| 0.005 * (f64::from(k) - 60.0)).collect();
        let range = |bearing: &f64| {
            let wall = to_the_walls(&grid, &pose, *bearing, 0.4);
            let [along_x, along_y] = pose.direction(*bearing);
            let to_face = (face_m - pose.x_m) / along_x;
            if (pose.y_m + to_face * along_y - 1.5).abs() < 0.2 { wall.min(to_face) } else { wall }
        };
        let readings = bearings_rad.iter().map(|bearing| Some(range(bearing))).collect();
        Scan { sensor: 0, time_s: 0.0, pose, bearings_rad, readings }
    };
    let (mut fast, mut reference) = (FastVisibility::visibility(&model), Visibility::exact(&model));
    for number in 0..30 {
        fast.integrate(&scan(number, f64::INFINITY));
        reference.integrate(&scan(number, f64::INFINITY));
    }
    assert!(fast.skipped() > 10_000, "{} cells were leapt over", fast.skipped());
    let face = grid.locate([3.02, 1.52]).expect("inside");
    let looks = |mapper: &mut dyn mapper::Mapper| {
        assert!(mapper.occupancy()[face] < 4e-6);
        (1..100).find(|look| {
            mapper.integrate(&scan(30 + look, 3.01));
            mapper.occupancy()[face] > 0.5
        })
    };
    let [found, expected] = [looks(&mut fast), looks(&mut reference)];
    // Which of the two is first, the last digits of the joints at their bounds decide.
    assert!(found.is_some() && found <= expected, "{found:?} looks, of the reference {expected:?}");
}
