//! What must hold after every update, whatever the readings.

use std::sync::Arc;

use grid::GridSpec;
use mapper::catalogue;
use mapper::{EPSILON, FastVisibility, Lateral, Mapper, Model, Prior, Reconciliation, Visibility};
use proptest::prelude::*;
use sensor::{Pose, Scan, Stereo};

fn setup(width: usize, height: usize, prior: Prior, reconciliation: Reconciliation, stereo: Stereo) -> Model {
    let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width, height };
    Model { prior, reconciliation, ..Model::new(grid, Arc::new(stereo)) }
}

fn scan(x_m: f64, y_m: f64, theta_rad: f64, bearings: &[f64], reading: f64) -> Scan {
    let readings = bearings.iter().map(|_| Some(reading)).collect();
    Scan { sensor: 0, time_s: 0.0, pose: Pose { x_m, y_m, theta_rad }, bearings_rad: bearings.to_vec(), readings }
}

/// Every mapper over a pairwise grid: the references, and the fast ones.
fn mappers(setup: &Model) -> Vec<(&'static str, Box<dyn Mapper>)> {
    let lateral = Lateral::default();
    vec![
        ("exact", Box::new(Visibility::exact(setup)) as Box<dyn Mapper>),
        ("as printed", Box::new(Visibility::as_printed(setup))),
        ("independent", Box::new(Visibility::independent(setup))),
        ("lateral", Box::new(Visibility::lateral(setup, lateral))),
        ("fast", Box::new(FastVisibility::visibility(setup))),
        ("fast independent", Box::new(FastVisibility::independent(setup))),
        ("fast lateral", Box::new(FastVisibility::lateral(setup, lateral))),
    ]
}

/// The invariants of a map: marginals off 0 and 1, joints that the marginals allow.
fn check(mapper: &dyn Mapper) -> Result<(), String> {
    if let Some(p) = mapper.occupancy().values().iter().find(|p| !(EPSILON..=1.0 - EPSILON).contains(*p)) {
        return Err(format!("a cell has probability {p}"));
    }
    mapper.pairwise().map_or(Ok(()), |pairs| pairs.check().map_err(|broken| broken.to_string()))
}

const BEARINGS: [f64; 7] = [-0.6, -0.3, -0.1, 0.0, 0.1, 0.3, 0.6];
const RULES: [Reconciliation; 2] = [Reconciliation::AllEdges, Reconciliation::Touched];

#[test]
fn thousands_of_identical_readings() {
    for rule in RULES {
        for reading in [6.0, 15.0, 0.0] {
            let setup = setup(60, 40, Prior::default(), rule, Stereo::default());
            // The reference with continuity across rays takes as long as the map is large.
            for (name, mut mapper) in mappers(&setup).into_iter().filter(|(name, _)| *name != "lateral") {
                for _ in 0..2000 {
                    mapper.integrate(&scan(0.31, 1.02, 0.05, &BEARINGS, reading));
                }
                check(&*mapper).unwrap_or_else(|broken| panic!("{name} {rule:?} {reading}: {broken}"));
            }
        }
    }
}

#[test]
fn priors_and_correlations_at_their_bounds() {
    for occupancy in [0.0, 1e-9, 0.5, 1.0] {
        for correlation in [0.0, 0.999_999, 1.0] {
            for rule in RULES {
                let prior = Prior { occupancy, correlation, ..Prior::default() };
                for (name, mut mapper) in mappers(&setup(30, 20, prior, rule, Stereo::default())) {
                    for reading in [10.0, 30.0, 3.0, 0.0, 60.0] {
                        mapper.integrate(&scan(0.3, 0.5, 0.0, &BEARINGS, reading));
                        check(&*mapper).unwrap_or_else(|b| panic!("{name} {occupancy} {correlation} {rule:?}: {b}"));
                    }
                }
            }
        }
    }
}

#[test]
fn sensors_that_are_always_or_never_right() {
    for correct_match in [0.0, 1.0] {
        for disparity_sigma in [1e-6, 0.5, 100.0] {
            let stereo = Stereo { correct_match, disparity_sigma, ..Stereo::default() };
            for (name, mut mapper) in mappers(&setup(30, 20, Prior::default(), Reconciliation::AllEdges, stereo)) {
                for reading in [10.0, 25.0, 10.0, 0.0, 60.0] {
                    mapper.integrate(&scan(0.3, 0.5, 0.0, &BEARINGS, reading));
                    check(&*mapper).unwrap_or_else(|b| panic!("{name} {correct_match} {disparity_sigma}: {b}"));
                }
            }
        }
    }
}

#[test]
fn a_map_of_one_cell() {
    for rule in RULES {
        let setup = setup(1, 1, Prior::default(), rule, Stereo::default());
        for (name, mut mapper) in mappers(&setup) {
            mapper.integrate(&scan(0.02, 0.03, 0.4, &[0.0], 10.0));
            check(&*mapper).unwrap_or_else(|broken| panic!("{name}: {broken}"));
        }
    }
}

#[test]
fn rays_of_one_cell_speak_for_their_cell() {
    // From the last cell towards the border: all there is to say is that it is free.
    let setup = setup(5, 5, Prior::default(), Reconciliation::Touched, Stereo::default());
    let mut mapper = Visibility::exact(&setup);
    mapper.integrate(&scan(0.24, 0.12, 0.0, &[0.0], 1.0));
    let p = mapper.occupancy()[setup.grid.locate([0.24, 0.12]).expect("inside")];
    assert!(p < 0.09, "{p}");
}

#[test]
fn outside_the_map_and_without_readings_nothing_changes() {
    let setup = setup(10, 10, Prior::default(), Reconciliation::AllEdges, Stereo::default());
    for entry in catalogue::MAPPERS {
        let mut mapper = (entry.build)(&setup);
        let before = mapper.occupancy().clone();
        mapper.integrate(&scan(-1.0, 0.2, 0.0, &BEARINGS, 10.0));
        mapper.integrate(&Scan { readings: vec![None; 7], ..scan(0.2, 0.2, 0.0, &BEARINGS, 10.0) });
        mapper.integrate(&Scan::default());
        assert_eq!(mapper.occupancy(), &before, "{}", entry.name);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_invariant_after_every_scan(
        scans in prop::collection::vec((0.0f64..2.0, 0.0f64..1.5, 0usize..16, 0.0f64..60.0, any::<bool>(), any::<bool>()), 1..30),
        occupancy in 0.01f64..0.9,
        correlation in 0.0f64..1.0,
        all_edges: bool,
    ) {
        let rule = RULES[usize::from(!all_edges)];
        let prior = Prior { occupancy, correlation, ..Prior::default() };
        for (name, mut mapper) in mappers(&setup(40, 30, prior, rule, Stereo::default())) {
            for &(x, y, turn, reading, corner, along) in &scans {
                // Cameras at cell corners, rays along grid lines and through corners.
                let snap = |v: f64| if corner { (v / 0.05).floor() * 0.05 } else { v };
                let theta = std::f64::consts::FRAC_PI_8 * turn as f64;
                let theta = if along { theta } else { theta + 0.1234 };
                mapper.integrate(&scan(snap(x), snap(y), theta, &BEARINGS, reading));
                prop_assert_eq!(check(&*mapper), Ok(()), "{}", name);
            }
        }
    }

    #[test]
    fn the_order_of_rays_does_not_matter(order in Just((0..7).collect::<Vec<usize>>()).prop_shuffle(), reading in 2.0f64..40.0) {
        let setup = setup(40, 30, Prior::default(), Reconciliation::AllEdges, Stereo::default());
        let straight = scan(0.2, 0.7, 0.1, &BEARINGS, reading);
        let shuffled = Scan { bearings_rad: order.iter().map(|&i| BEARINGS[i]).collect(), ..straight.clone() };
        let mut maps = [straight, shuffled].map(|scan| {
            let mut mapper = Visibility::exact(&setup);
            mapper.integrate(&scan);
            mapper
        });
        let [a, b] = &mut maps;
        for (p, q) in a.occupancy().values().iter().zip(b.occupancy().values()) {
            prop_assert!((p - q).abs() < 1e-12);
        }
    }
}
