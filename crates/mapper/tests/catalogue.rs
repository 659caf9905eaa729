//! What every mapper by name must do, whatever it is.

use std::sync::Arc;

use grid::{GridSpec, Raster};
use mapper::catalogue::{Entry, Kind, MAPPERS};
use mapper::{EPSILON, Mapper, Model, Prior, Reconciliation};
use proptest::prelude::*;
use sensor::{Pose, Scan, Stereo};

const BEARINGS: [f64; 5] = [-0.5, -0.2, 0.0, 0.1, 0.5];

/// The camera of every scan that must change nothing.
const INSIDE: Pose = Pose { x_m: 0.02, y_m: 0.03, theta_rad: 0.3 };

fn setup(width: usize, height: usize, occupancy: f64, correlation: f64, reconciliation: Reconciliation) -> Model {
    let grid = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width, height };
    let prior = Prior { occupancy, correlation, ..Prior::default() };
    Model { prior, reconciliation, ..Model::new(grid, Arc::new(Stereo::default())) }
}

fn scan(pose: Pose, readings: Vec<Option<f64>>) -> Scan {
    Scan { sensor: 0, time_s: 0.0, pose, bearings_rad: BEARINGS.to_vec(), readings }
}

/// The map after the given scans, settled once at the end.
fn mapped(entry: &Entry, setup: &Model, scans: &[Scan]) -> (Box<dyn Mapper>, Raster<f64>) {
    let mut mapper = (entry.build)(setup);
    scans.iter().for_each(|scan| mapper.integrate(scan));
    mapper.settle();
    let map = mapper.occupancy().clone();
    (mapper, map)
}

fn scans() -> impl Strategy<Value = Vec<Scan>> {
    let readings =
        prop::collection::vec(prop::option::weighted(0.8, prop_oneof![9 => 0.1f64..60.0, 1 => Just(0.0)]), 5);
    let scan = (-0.2f64..1.6, -0.2f64..1.2, 0.0f64..std::f64::consts::TAU, readings)
        .prop_map(|(x_m, y_m, theta_rad, readings)| scan(Pose { x_m, y_m, theta_rad }, readings));
    prop::collection::vec(scan, 0..8)
}

/// Probabilities with their bounds.
fn share() -> impl Strategy<Value = f64> {
    prop_oneof![6 => 0.0f64..1.0, 1 => Just(0.0), 1 => Just(1.0)]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn maps_are_probabilities_repeat_and_keep_still(
        (width, height) in (1usize..=14, 1usize..=10), scans in scans(), occupancy in share(), correlation in share(), touched: bool,
    ) {
        let rule = if touched { Reconciliation::Touched } else { Reconciliation::AllEdges };
        let setup = setup(width, height, occupancy, correlation, rule);
        for entry in MAPPERS {
            let (mut mapper, map) = mapped(entry, &setup, &scans);
            for (cell, p) in map.values().iter().enumerate() {
                prop_assert!((EPSILON..=1.0 - EPSILON).contains(p), "{}: cell {cell} is {p}", entry.name);
            }
            prop_assert_eq!(&mapped(entry, &setup, &scans).1, &map, "{} twice", entry.name);
            // Nothing seen, nothing changed: no ray, no reading, a camera outside the map.
            let outside = Pose { x_m: -0.05, ..INSIDE };
            for silent in [Scan::default(), scan(INSIDE, vec![None; 5]), scan(outside, vec![Some(10.0); 5])] {
                mapper.integrate(&silent);
                mapper.settle();
                prop_assert_eq!(mapper.occupancy(), &map, "{}", entry.name);
            }
        }
    }

    #[test]
    fn a_batch_mapper_solves_for_the_scans_not_for_the_calls(scans in scans()) {
        let setup = setup(12, 9, 0.1, 0.8, Reconciliation::AllEdges);
        for entry in MAPPERS.iter().filter(|entry| entry.kind == Kind::Batch) {
            let mut mapper = (entry.build)(&setup);
            for scan in &scans {
                mapper.integrate(scan);
                mapper.settle();
                mapper.settle();
            }
            prop_assert_eq!(mapper.occupancy(), &mapped(entry, &setup, &scans).1, "{}", entry.name);
        }
    }
}

#[test]
fn an_unseen_map_is_the_prior() {
    for entry in MAPPERS {
        let (_, map) = mapped(entry, &setup(5, 4, 0.3, 0.8, Reconciliation::AllEdges), &[]);
        assert!(map.values().iter().all(|p| (p - 0.3).abs() < 1e-7), "{}", entry.name);
    }
}

#[test]
fn every_mapper_but_the_prior_sees_a_wall() {
    let pose = Pose { x_m: 0.05, y_m: 0.52, theta_rad: 0.0 };
    let readings = [Some(15.0 / 0.99); 5];
    for entry in MAPPERS {
        let setup = setup(14, 10, 0.1, 0.8, Reconciliation::AllEdges);
        let (_, map) = mapped(entry, &setup, &vec![scan(pose, readings.to_vec()); 5]);
        // The wall stands at x = 1.04 m, in column 10.
        let [wall, before] = [1.04, 0.55].map(|x| map[setup.grid.locate([x, 0.52]).expect("inside")]);
        if entry.name == "prior" {
            assert!((wall - 0.1).abs() < 1e-15 && (before - 0.1).abs() < 1e-15);
        } else {
            // The conventional likelihoods on a chain do worst: the free cells in front pull the wall down.
            assert!(
                wall > 0.25 && before < 0.5 && wall > before + 0.2,
                "{}: wall {wall}, before it {before}",
                entry.name
            );
        }
    }
}

#[test]
fn names_are_unique() {
    for (i, entry) in MAPPERS.iter().enumerate() {
        assert!(MAPPERS[..i].iter().all(|other| other.name != entry.name), "{}", entry.name);
    }
}
