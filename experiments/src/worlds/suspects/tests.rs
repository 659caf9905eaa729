use std::path::Path;
use std::sync::LazyLock;

use sensor::{Pose, Scan};

use super::*;
use crate::worlds::condition::AS_BELIEVED;
use crate::worlds::site::{Assumptions, Site};

/// What the sensors of a scene read on its drive.
fn driven(text: &str) -> (Model, Vec<Scan>) {
    let scene = Scene::parse(text, Path::new("scene.toml"), None).expect("a scene");
    let Site { ground, setup } = Site::of(scene, &AS_BELIEVED, &Assumptions::default()).expect("a site");
    let simulation = scene::simulate(&ground.scene, &ground.world, &ground.drive, 1);
    (setup, simulation.scans.iter().flat_map(SimulatedScan::together).collect())
}

/// An office with glass, seen by a camera (sensor 0) and a laser (sensor 1).
static OFFICE: LazyLock<(Model, Vec<Scan>)> =
    LazyLock::new(|| driven(include_str!("../../../../scenes/office-glass.toml")));

/// A room, heard by a ring of 16 sonars (sensor 1) and seen by a laser (sensor 2).
static RING: LazyLock<(Model, Vec<Scan>)> = LazyLock::new(|| {
    let ring =
        include_str!("../../../../scenes/sonar-ring.toml").replace("scan_interval = 1.0", "scan_interval = 0.25");
    driven(&(ring + "\n[[sensor]]\nkind = \"laser\"\nbeams = 90\nfield_of_view_deg = 180.0\nmax_range = 30.0\n"))
});

/// What is found in the office where the scans of one sensor are changed, the number of the scan being given.
fn found(sensor: usize, change: impl Fn(usize, &mut Scan)) -> Vec<Suspect> {
    let sensors = ["camera", "laser"].into_iter().enumerate();
    let sensors: Vec<Named> =
        sensors.map(|(number, called)| Named { numbers: vec![number], called: called.to_owned() }).collect();
    judged(&OFFICE.0, &sensors, &changed(&OFFICE.1, sensor, change))
}

/// The same scans, those of one sensor changed.
fn changed(scans: &[Scan], sensor: usize, change: impl Fn(usize, &mut Scan)) -> Vec<Scan> {
    scans
        .iter()
        .enumerate()
        .map(|(number, scan)| {
            let mut scan = scan.clone();
            if scan.sensor == sensor {
                change(number, &mut scan);
            }
            scan
        })
        .collect()
}

fn judged(setup: &Model, sensors: &[Named], scans: &[Scan]) -> Vec<Suspect> {
    let suspects = suspects(setup, sensors, 5, &mut |each| {
        scans.iter().for_each(each);
        Ok(())
    });
    suspects.expect("scans in memory")
}

fn named_of(suspects: &[Suspect]) -> Vec<(usize, &'static str)> {
    named(suspects).into_iter().map(|(sensor, wrong)| (sensor.number(), wrong.word())).collect()
}

/// What cannot be read of a reading; a number that looks like none, the same for the same ray.
fn share(number: usize, ray: usize) -> f64 {
    let mixed = (number as u64 * 1009 + ray as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (mixed ^ mixed >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9) as f64 / u64::MAX as f64
}

fn turned(degrees: f64) -> impl Fn(usize, &mut Scan) {
    move |_, scan| scan.pose = Pose { theta_rad: scan.pose.theta_rad + degrees.to_radians(), ..scan.pose }
}

fn stuck(reading: f64) -> impl Fn(usize, &mut Scan) {
    move |_, scan| scan.readings.iter_mut().for_each(|one| *one = Some(reading))
}

fn half_false(most: f64) -> impl Fn(usize, &mut Scan) {
    move |number, scan| {
        for (ray, reading) in scan.readings.iter_mut().enumerate() {
            if share(number, ray) < 0.5 && reading.is_some() {
                *reading = Some(most * share(ray, number));
            }
        }
    }
}

fn blind(_: usize, scan: &mut Scan) {
    scan.readings.iter_mut().for_each(|reading| *reading = None);
}

#[test]
fn where_all_is_right_nothing_is_named() {
    let suspects = found(0, |_, _| {});
    assert_eq!(named_of(&suspects), []);
    assert!(suspects.iter().all(|suspect| suspect.moved && suspect.readings > 300));
    assert_eq!(table(&suspects).csv().expect("text").iter().filter(|byte| **byte == b'\n').count(), 3);
}

#[test]
fn the_one_that_is_wrong_is_named_and_not_the_other() {
    for (what, suspects, expected) in [
        ("a blind camera", found(0, blind), (0, "blind")),
        ("a blind laser", found(1, blind), (1, "blind")),
        ("a stuck camera", found(0, stuck(12.0)), (0, "stuck")),
        ("a stuck laser", found(1, stuck(1.0)), (1, "stuck")),
        ("half of the camera false", found(0, half_false(60.0)), (0, "unexplained")),
        ("half of the laser false", found(1, half_false(30.0)), (1, "unexplained")),
        ("a camera that is turned", found(0, turned(5.0)), (0, "turned")),
        ("a laser that is turned", found(1, turned(5.0)), (1, "turned")),
        ("a laser that is turned the other way", found(1, turned(-5.0)), (1, "turned")),
    ] {
        assert_eq!(named_of(&suspects), [expected], "{what}: {:?}", lines(&suspects));
    }
}

/// By as much as it was turned, back.
#[test]
fn a_sensor_is_turned_back_by_what_it_was_turned() {
    for (sensor, degrees) in [(0, 5.0), (1, 5.0), (1, -4.0)] {
        let suspects = found(sensor, turned(degrees));
        let [(_, Wrong::Turned { back_rad })] = named(&suspects)[..] else { panic!("{:?}", lines(&suspects)) };
        assert!((back_rad.to_degrees() + degrees).abs() <= 1.0 + 1e-9, "{sensor}: {}", back_rad.to_degrees());
    }
}

/// The ring and the laser: one scan for the ring, or one for each of its sonars, from 10 on.
fn ring_and_laser(is_apart: bool, degrees: f64) -> Vec<Suspect> {
    let scans = changed(&RING.1, 1, turned(degrees));
    let named = |numbers: Vec<usize>, called: &str| Named { numbers, called: called.to_owned() };
    if !is_apart {
        return judged(&RING.0, &[named(vec![1], "ring"), named(vec![2], "laser")], &scans);
    }
    let models = |number: usize| RING.0.sensors.of(&Scan { sensor: number.clamp(1, 2), ..Scan::default() }).clone();
    // The laser is sensor 0, the sonars are 1 to 16.
    let sensors = mapper::Sensors::new((0..=16).map(|number| models(if number == 0 { 2 } else { 1 })).collect());
    let setup = Model { sensors, ..RING.0.clone() };
    let apart = |scan: &Scan| -> Vec<Scan> {
        if scan.sensor == 2 {
            return vec![Scan { sensor: 0, ..scan.clone() }];
        }
        let sonar = |(k, (bearing, reading)): (usize, (&f64, &Option<f64>))| Scan {
            sensor: k + 1,
            pose: Pose { theta_rad: scan.pose.theta_rad + bearing, ..scan.pose },
            bearings_rad: vec![0.0],
            readings: vec![*reading],
            ..scan.clone()
        };
        scan.bearings_rad.iter().zip(&scan.readings).enumerate().map(sonar).collect()
    };
    let scans: Vec<Scan> = scans.iter().flat_map(apart).collect();
    judged(&setup, &[named(vec![0], "laser"), named((1..=16).collect(), "ring")], &scans)
}

#[test]
fn a_ring_of_sonars_that_is_turned_is_named_as_one_and_the_laser_is_not() {
    for is_apart in [false, true] {
        assert_eq!(lines(&ring_and_laser(is_apart, 0.0)), [""; 0], "{is_apart}");
        for degrees in [5.0, -5.0] {
            let suspects = ring_and_laser(is_apart, degrees);
            let [(sensor, Wrong::Turned { back_rad })] = named(&suspects)[..] else {
                panic!(
                    "{is_apart} {degrees}: {:?}\n{}",
                    lines(&suspects),
                    String::from_utf8_lossy(&table(&suspects).csv().expect("text"))
                )
            };
            assert_eq!(sensor.called, "ring");
            assert!((back_rad.to_degrees() + degrees).abs() <= 2.0 + 1e-9, "{}", back_rad.to_degrees());
        }
    }
}

#[test]
fn a_sensor_alone_is_held_against_nothing() {
    let named = [Named { numbers: vec![0], called: "camera".to_owned() }];
    let suspects = suspects(&OFFICE.0, &named, 5, &mut |_| panic!("nothing is read"));
    assert!(suspects.expect("nothing to read").is_empty());
}
