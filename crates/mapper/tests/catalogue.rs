//! What every mapper by name must do, whatever it is.

use std::sync::Arc;

use grid::{GridSpec, Raster};
use mapper::catalogue::{Entry, Kind, MAPPERS};
use mapper::{EPSILON, Mapper, Model, Prior, Reconciliation, Sensors};
use proptest::prelude::*;
use sensor::{Laser, Pose, Scan, SensorModel, Stereo};

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

/// Sampling takes a thousand times as long as the others on such small maps: it has fewer cases.
fn samples(entry: &&Entry) -> bool {
    entry.name.starts_with("gibbs")
}

/// Probabilities, the same twice, and unmoved by what says nothing.
fn is_a_map_that_keeps_still(entry: &Entry, setup: &Model, scans: &[Scan]) -> Result<(), TestCaseError> {
    let (mut mapper, map) = mapped(entry, setup, scans);
    for (cell, p) in map.values().iter().enumerate() {
        prop_assert!((EPSILON..=1.0 - EPSILON).contains(p), "{}: cell {cell} is {p}", entry.name);
    }
    prop_assert_eq!(&mapped(entry, setup, scans).1, &map, "{} twice", entry.name);
    // Nothing seen, nothing changed: no ray, no reading, a camera outside the map.
    let outside = Pose { x_m: -0.05, ..INSIDE };
    for silent in [Scan::default(), scan(INSIDE, vec![None; 5]), scan(outside, vec![Some(10.0); 5])] {
        mapper.integrate(&silent);
        mapper.settle();
        prop_assert_eq!(mapper.occupancy(), &map, "{}", entry.name);
    }
    Ok(())
}

/// However often it is called, a batch mapper solves for the scans.
fn solves_for_the_scans(entry: &Entry, setup: &Model, scans: &[Scan]) -> Result<(), TestCaseError> {
    let mut mapper = (entry.build)(setup);
    for scan in scans {
        mapper.integrate(scan);
        mapper.settle();
        mapper.settle();
    }
    prop_assert_eq!(mapper.occupancy(), &mapped(entry, setup, scans).1, "{}", entry.name);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_samples_does_so_too(
        (width, height) in (1usize..=9, 1usize..=7), scans in scans(), occupancy in share(), correlation in share(),
    ) {
        let setup = setup(width, height, occupancy, correlation, Reconciliation::AllEdges);
        for entry in MAPPERS.iter().filter(samples) {
            is_a_map_that_keeps_still(entry, &setup, &scans)?;
            solves_for_the_scans(entry, &setup, &scans[..scans.len().min(3)])?;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn maps_are_probabilities_repeat_and_keep_still(
        (width, height) in (1usize..=14, 1usize..=10), scans in scans(), occupancy in share(), correlation in share(), touched: bool,
    ) {
        let rule = if touched { Reconciliation::Touched } else { Reconciliation::AllEdges };
        let setup = setup(width, height, occupancy, correlation, rule);
        for entry in MAPPERS.iter().filter(|entry| !samples(entry)) {
            is_a_map_that_keeps_still(entry, &setup, &scans)?;
        }
    }

    #[test]
    fn a_batch_mapper_solves_for_the_scans_not_for_the_calls(scans in scans()) {
        let setup = setup(12, 9, 0.1, 0.8, Reconciliation::AllEdges);
        for entry in MAPPERS.iter().filter(|entry| entry.kind == Kind::Batch && !samples(entry)) {
            solves_for_the_scans(entry, &setup, &scans)?;
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
        // Hit counts say nothing of a cell after few looks.
        let looks = if entry.name.starts_with("hit-count") { 30 } else { 5 };
        let (_, map) = mapped(entry, &setup, &vec![scan(pose, readings.to_vec()); looks]);
        // The wall stands at x = 1.04 m, in column 10.
        let at = |x| map[setup.grid.locate([x, 0.52]).expect("inside")];
        // wavemap takes a surface to be three sigma thick, from the reading on.
        let behind = if entry.name.starts_with("wavemap") { 1.25f64 } else { 1.04 };
        let (wall, before) =
            ([1.04, 1.15, 1.25].into_iter().filter(|x| *x <= behind).map(at).fold(0.0, f64::max), at(0.55));
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

/// A copy goes on like the mapper that it was made from, and neither changes the other.
#[test]
fn a_fork_goes_on_by_itself() {
    let pose = |x_m: f64| Pose { x_m, y_m: 0.52, theta_rad: 0.2 };
    let scans: Vec<Scan> = [0.05, 0.15, 0.31, 0.4].map(|x_m| scan(pose(x_m), vec![Some(15.0); 5])).to_vec();
    for entry in MAPPERS {
        let setup = setup(14, 10, 0.1, 0.8, Reconciliation::AllEdges);
        let (mut mapper, before) = mapped(entry, &setup, &scans[..2]);
        let mut fork = mapper.fork().unwrap_or_else(|| panic!("{} can be copied", entry.name));
        scans[2..].iter().for_each(|scan| fork.integrate(scan));
        fork.settle();
        assert_eq!(mapper.occupancy(), &before, "{}: the original is left alone", entry.name);
        assert_eq!(fork.occupancy(), &mapped(entry, &setup, &scans).1, "{}: as without a fork", entry.name);
        scans[2..].iter().for_each(|scan| mapper.integrate(scan));
        mapper.settle();
        assert_eq!(mapper.occupancy(), fork.occupancy(), "{}: the same way", entry.name);
        assert_eq!(mapper.work().cells, fork.work().cells, "{}", entry.name);
    }
}

/// Scans are taken for the sensor that they name: with two, the map is that of either alone where all scans are its own.
#[test]
fn a_scan_names_its_sensor() {
    let (stereo, laser): (Arc<dyn SensorModel>, Arc<dyn SensorModel>) =
        (Arc::new(Stereo::default()), Arc::new(Laser { max_range_m: 5.0, ..Laser::default() }));
    let one = |sensor: &Arc<dyn SensorModel>| {
        let setup = setup(14, 10, 0.1, 0.8, Reconciliation::AllEdges);
        Model { sensors: Sensors::one(Arc::clone(sensor)), ..setup }
    };
    let both = Model { sensors: Sensors::new(vec![Arc::clone(&stereo), Arc::clone(&laser)]), ..one(&stereo) };
    let pose = Pose { x_m: 0.05, y_m: 0.52, theta_rad: 0.0 };
    for entry in MAPPERS {
        for (number, (sensor, reading)) in [(&stereo, 15.0), (&laser, 1.0)].into_iter().enumerate() {
            let alone = scan(pose, vec![Some(reading); 5]);
            let named = Scan { sensor: number, ..alone.clone() };
            let expected = mapped(entry, &one(sensor), &[alone]).1;
            assert_eq!(mapped(entry, &both, &[named]).1, expected, "{} {number}", entry.name);
        }
    }
}

#[test]
#[should_panic(expected = "a scan of sensor 1: the model has 1, numbered from 0")]
fn a_sensor_that_is_not_there_is_refused() {
    let mut mapper = mapper::FastVisibility::visibility(&setup(14, 10, 0.1, 0.8, Reconciliation::AllEdges));
    mapper.integrate(&Scan { sensor: 1, ..scan(INSIDE, vec![Some(15.0); 5]) });
}
