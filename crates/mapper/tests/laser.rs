//! Mappers with a laser: the same rules with another kernel, and beams without echo.

use std::sync::Arc;

use crate::difference::difference;
use crate::quick::quick;
use grid::{GridSpec, Raster};
use mapper::catalogue::{Entry, MAPPERS, find};
use mapper::{EPSILON, FastVisibility, Mapper as _, Model, Prior, Reconciliation, Visibility};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use sensor::{Kernel as _, Laser, Pose, Scan};

const NO_ECHO: f64 = f64::INFINITY;

/// A laser that reaches 3 m.
const SHORT: Laser = Laser { range_sigma_m: 0.02, max_range_m: 3.0, hit: 0.93, no_echo: 0.05, early_per_m: 0.002 };

fn lasers() -> impl Strategy<Value = Laser> {
    (0.005f64..0.2, 1.0f64..30.0, 0.2f64..0.98, 0.0f64..1.0, 0.0f64..0.1).prop_map(
        |(range_sigma_m, max_range_m, hit, share, early_per_m)| {
            // At least a hundredth of the pulses are outliers.
            Laser { range_sigma_m, max_range_m, hit, no_echo: (0.99 - hit) * share, early_per_m }
        },
    )
}

/// A scan from a random place: of a straight wall, with outliers, beams without echo, and beams that say nothing.
fn scan(rng: &mut ChaCha8Rng, spec: &GridSpec, beams: usize, laser: &Laser) -> Scan {
    let [width_m, height_m] = [spec.width, spec.height].map(|cells| cells as f64 * spec.cell_m);
    let pose = Pose {
        x_m: width_m * rng.random::<f64>(),
        y_m: height_m * rng.random::<f64>(),
        theta_rad: 7.0 * rng.random::<f64>(),
    };
    let wall_m = 1.2 * width_m.max(height_m) * rng.random::<f64>();
    let field = if rng.random::<f64>() < 0.2 { 6.2 } else { 3.1 };
    let bearings_rad: Vec<f64> = (0..beams).map(|k| field * ((k as f64 + 0.5) / beams as f64 - 0.5)).collect();
    let reading = |bearing: f64, rng: &mut ChaCha8Rng| {
        let cosine = libm::cos(bearing);
        let surface_m = (cosine > 0.0).then(|| wall_m / cosine);
        match rng.random::<f64>() {
            p if p < 0.05 => None,
            p if p < 0.25 => Some(NO_ECHO),
            _ => Some(laser.sample(surface_m, rng)),
        }
    };
    let readings = bearings_rad.iter().map(|bearing| reading(*bearing, rng)).collect();
    Scan { sensor: 0, time_s: 0.0, pose, bearings_rad, readings }
}

/// A row of cells of 10 cm and a beam along it from the first.
fn row(width: usize, laser: Laser) -> Model {
    let grid = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width, height: 1 };
    Model::new(grid, Arc::new(laser))
}

fn beam(reading: f64) -> Scan {
    let pose = Pose { x_m: 0.03, y_m: 0.05, theta_rad: 0.0 };
    Scan { sensor: 0, time_s: 0.0, pose, bearings_rad: vec![0.0], readings: vec![Some(reading)] }
}

fn range(k: usize) -> f64 {
    (0.1 * k as f64 - 0.03).max(0.0)
}

fn mapped(entry: &Entry, setup: &Model, scans: &[Scan]) -> Raster<f64> {
    let mut mapper = (entry.build)(setup);
    scans.iter().for_each(|scan| mapper.integrate(scan));
    mapper.settle();
    mapper.occupancy().clone()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_scan_differs_from_the_reference_by_less_than_a_hundred_thousandth(
        seed: u64, width in 1usize..90, height in 1usize..90, beams in 1usize..120, cell_m in 0.02f64..0.3,
        occupancy in 0.01f64..0.6, correlation in 0.0f64..0.99, touched: bool, continuity: bool, laser in lasers(),
    ) {
        let grid = GridSpec { cell_m, origin_m: [0.0; 2], width, height };
        let prior = Prior { occupancy, correlation, ..Prior::default() };
        let reconciliation = if touched { Reconciliation::Touched } else { Reconciliation::AllEdges };
        let setup = Model { prior, reconciliation, ..Model::new(grid, Arc::new(laser)) };
        let mut fast = if continuity { FastVisibility::visibility(&setup) } else { FastVisibility::independent(&setup) };
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        for _ in 0..6 {
            let mut reference = if continuity { Visibility::exact(&setup) } else { Visibility::independent(&setup) };
            reference.set_pairs(fast.pairs());
            let scan = scan(&mut rng, &grid, beams, &laser);
            fast.integrate(&scan);
            reference.integrate(&scan);
            let found = difference(&fast.pairs(), reference.pairs());
            prop_assert!(found < 1e-5, "{found} at {:?}", scan.pose);
        }
    }

    /// The sum over all states of the row, and over what lies beyond it cell by cell.
    #[test]
    fn a_beam_is_the_sum_over_all_states(
        n in 1usize..=11, occupancy in 0.02f64..0.6, correlation in 0.0f64..0.95, laser in lasers(), share in 0.0f64..1.3,
    ) {
        let prior = Prior { occupancy, correlation, ..Prior::default() };
        let setup = Model { prior, ..row(n, laser) };
        let reading = if share < 1.0 { share * laser.max_range_m.min(2.0) } else { NO_ECHO };
        let correlation = prior.neighbour_correlation(0.1);
        // Transitions of a stationary two-state chain.
        let (stays, begins) = (occupancy + correlation * (1.0 - occupancy), occupancy * (1.0 - correlation));
        let likelihood = |k: usize| {
            let mut out = [0.0];
            laser.likelihood(reading, 0.0, &[range(k), range(k + 1)], &mut out);
            out[0]
        };
        let (mut none, mut mass) = (0.0, 1.0);
        for k in n.. {
            none += mass * begins * likelihood(k);
            mass *= 1.0 - begins;
            if mass < 1e-13 {
                break;
            }
        }
        let (mut evidence, mut marginals) = (0.0, vec![0.0; n]);
        for states in 0..1u32 << n {
            let occupied = |k: usize| states >> k & 1 == 1;
            let mut weight = if occupied(0) { occupancy } else { 1.0 - occupancy };
            for k in 1..n {
                let onto = if occupied(k - 1) { stays } else { begins };
                weight *= if occupied(k) { onto } else { 1.0 - onto };
            }
            weight *= (0..n).find(|&k| occupied(k)).map_or(none, likelihood);
            evidence += weight;
            (0..n).filter(|&k| occupied(k)).for_each(|k| marginals[k] += weight);
        }
        let mut mapper = Visibility::exact(&setup);
        mapper.integrate(&beam(reading));
        for (p, weight) in mapper.occupancy().values().iter().zip(&marginals) {
            let expected = (weight / evidence).clamp(EPSILON, 1.0 - EPSILON);
            prop_assert!((p - expected).abs() < 1e-9, "{p} {expected}");
        }
    }

    #[test]
    fn every_mapper_takes_a_laser(seed: u64, width in 1usize..20, height in 1usize..14, laser in lasers(), certain: bool) {
        let laser = if certain { Laser { hit: 1.0, no_echo: 0.0, ..laser } } else { laser };
        let grid = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width, height };
        let setup = Model::new(grid, Arc::new(laser));
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let scans: Vec<Scan> = (0..4).map(|_| scan(&mut rng, &grid, 12, &laser)).collect();
        for entry in quick() {
            let map = mapped(entry, &setup, &scans);
            for (cell, p) in map.values().iter().enumerate() {
                prop_assert!((EPSILON..=1.0 - EPSILON).contains(p), "{}: cell {cell} is {p}", entry.name);
            }
        }
    }
}

/// A wall at 1.17 m, in cell 12, read five times.
#[test]
fn every_mapper_but_the_prior_sees_a_wall() {
    for entry in MAPPERS.iter().filter(|entry| entry.name != "prior") {
        // Hit counts say nothing of a cell after few looks, nor do blocks of 3 x 3 cells of a single row, where a reading counts in part.
        let many = ["hit-count", "gibbs", "visibility-window"].iter().any(|name| entry.name.starts_with(name));
        let looks = if many { 30 } else { 5 };
        let map = mapped(entry, &row(29, SHORT), &vec![beam(1.22); looks]);
        // wavemap takes a surface to be three sigma thick, from the reading on.
        let thick = if entry.name.starts_with("wavemap") { 15 } else { 13 };
        let (before, behind) = (map[6], map[19]);
        let wall = map.values()[12..thick].iter().copied().fold(0.0, f64::max);
        let slow = ["log-odds", "octomap", "wavemap"].iter().any(|name| entry.name.starts_with(name));
        assert!(before < 0.1 || slow, "{}: before it {before}", entry.name);
        assert!(wall > 0.25 && wall > before + 0.2, "{}: wall {wall}, before it {before}", entry.name);
        // What lies behind a surface is as occupied as the surface, up to a truncation or some sigma.
        let solid = ["tsdf", "wavemap"].iter().any(|name| entry.name.starts_with(name)) && behind < 0.65;
        assert!(solid || behind < 0.6 * wall && behind > 0.05, "{}: wall {wall}, behind it {behind}", entry.name);
    }
}

/// By evidence: the less so the more pulses are lost, and not at all if all are. (The conventional rule takes a sensor
/// that is wrong more often than right for one that says the opposite.)
#[test]
fn a_beam_without_echo_clears_up_to_the_largest_range_and_says_nothing_beyond() {
    for name in
        ["visibility", "visibility-reference", "independent", "conventional", "conventional-tuned", "mrf", "forward-em"]
    {
        let entry = find(name).expect("in the catalogue");
        let map = |laser: Laser| mapped(entry, &row(60, laser), &[beam(NO_ECHO)]);
        let seen = map(SHORT);
        assert!(seen.values()[..30].iter().all(|p| *p < 0.07), "{name}: {:?}", seen.values());
        // Cell 30 holds the end of the range; what comes after it depends on it by the prior alone.
        let beyond = if name.starts_with("visibility") || name == "mrf" { 40 } else { 31 };
        assert!(seen.values()[beyond..].iter().all(|p| (p - 0.1).abs() < 0.02), "{name}: {:?}", seen.values());
        let unreliable = map(Laser { hit: 0.7, no_echo: 0.29, ..SHORT });
        assert!(unreliable[15] > seen[15] && unreliable[15] < 0.1, "{name}: {} {}", unreliable[15], seen[15]);
        if !name.starts_with("conventional") {
            let blind = map(Laser { hit: 0.0, no_echo: 0.98, ..SHORT });
            assert!(blind[15] > 0.09, "{name}: {}", blind[15]);
        }
    }
}

/// With 80 m to go beyond a small map, something is hit: a beam without echo is a lost pulse.
#[test]
fn in_a_small_map_a_long_beam_without_echo_is_a_lost_pulse() {
    let entry = find("visibility").expect("in the catalogue");
    let map = mapped(entry, &row(60, Laser::default()), &[beam(NO_ECHO)]);
    assert!(map.values().iter().all(|p| (p - 0.1).abs() < 1e-3), "{:?}", map.values());
}

#[test]
fn an_echo_after_the_border_clears_the_map() {
    let entry = find("visibility").expect("in the catalogue");
    let map = mapped(entry, &row(20, Laser::default()), &[beam(12.0)]);
    assert!(map.values().iter().all(|p| *p < 0.05), "{:?}", map.values());
}
