//! Robots with several sensors.

use std::sync::Arc;

use crate::worlds::{FEW, room, seen, way};
use mapper::{FastVisibility, Mapper as _, Model, Sensors};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use sensor::{Laser, OdometryNoise, Pose, Scan, Sonar, Step};
use slam::{Mounted, Options, Outcome, Slam, Update, Weight};

/// Two lasers, and a ring of sonars as number 2.
fn model() -> Model {
    let laser = || Arc::new(Laser::default());
    let sonar = Arc::new(Sonar { max_range_m: 4.0, ..Sonar::default() });
    Model { sensors: Sensors::new(vec![laser(), laser(), sonar]), ..room() }
}

fn filter(options: Options) -> Slam {
    let model = model();
    let map = Box::new(FastVisibility::visibility(&model));
    Slam::new(map, &model, Arc::new(OdometryNoise::STANDARD), options).expect("valid")
}

/// What the odometry measures of a way, with half as much again of the standard noise.
fn measured(way: &[Pose], seed: u64) -> Vec<Pose> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut odometry = vec![way[0]];
    for pair in way.windows(2) {
        let step = OdometryNoise::STANDARD.scaled(1.5).sample(&Step::between(pair[0], pair[1]), &mut random);
        odometry.push(step.end(odometry[odometry.len() - 1]));
    }
    odometry
}

fn off_m(outcome: &Outcome, way: &[Pose]) -> f64 {
    let off = |((_, a), b): (&(f64, Pose), &Pose)| (a.x_m - b.x_m).hypot(a.y_m - b.y_m);
    outcome.trajectory.iter().zip(way).map(off).fold(0.0, f64::max)
}

/// The beams of a laser's scan that a sensor of this number has: every second.
fn dealt(scan: &Scan, sensor: usize) -> Scan {
    let beams = || (0..scan.readings.len()).filter(move |beam| beam % 2 == sensor);
    Scan {
        sensor,
        bearings_rad: beams().map(|beam| scan.bearings_rad[beam]).collect(),
        readings: beams().map(|beam| scan.readings[beam]).collect(),
        ..*scan
    }
}

const MIDDLE: Pose = Pose { x_m: 0.0, y_m: 0.0, theta_rad: 0.0 };

/// The way is the same to a tenth of a millimetre: rays are added up in another order, and maps are single precision.
#[test]
fn odd_and_even_beams_as_two_sensors_give_the_way_of_the_one() {
    let way = way(160);
    let odometry = measured(&way, 5);
    for weight in [Weight::FIELD, Weight::EVIDENCE] {
        let [mut one, mut two] = [filter(Options { weight, ..FEW }), filter(Options { weight, ..FEW })];
        for (k, (pose, odometry)) in way.iter().zip(&odometry).enumerate() {
            let scan = seen(*pose, k);
            one.take(&scan, *odometry);
            let parts = [dealt(&scan, 0), dealt(&scan, 1)];
            two.take_together(&parts.each_ref().map(|scan| Mounted { scan, mount: MIDDLE }), &[], *odometry);
        }
        let [one, two] = [one.finish(), two.finish()];
        assert_eq!(one.updates.len(), two.updates.len());
        let expected: Vec<Pose> = one.trajectory.iter().map(|(_, pose)| *pose).collect();
        let apart_m = off_m(&two, &expected);
        assert!(apart_m < 1e-4, "{weight:?}: {apart_m}");
        assert!(off_m(&two, &way) < 0.1);
    }
}

/// Lasers that see half of a turn ahead and half of one behind, each from its own place.
const MOUNTS: [Pose; 2] =
    [Pose { x_m: 0.3, y_m: 0.1, theta_rad: 0.2 }, Pose { x_m: -0.25, y_m: 0.0, theta_rad: std::f64::consts::PI }];

fn looked(robot: Pose, number: usize) -> [Scan; 2] {
    [0, 1].map(|sensor| {
        let at = Mounted { scan: &Scan::default(), mount: MOUNTS[sensor] }.pose(robot);
        Scan { sensor, pose: at, ..seen(at, number) }
    })
}

#[test]
fn scans_are_matched_and_mapped_from_where_their_sensors_stand() {
    let way = way(160);
    let odometry = measured(&way, 5);
    let found = |mounts: [Pose; 2]| {
        let mut filter = filter(FEW);
        for (k, (pose, odometry)) in way.iter().zip(&odometry).enumerate() {
            let scans = looked(*pose, k);
            let mounted: Vec<Mounted> = scans.iter().zip(mounts).map(|(scan, mount)| Mounted { scan, mount }).collect();
            filter.take_together(&mounted, &[], *odometry);
        }
        filter.finish()
    };
    let right = found(MOUNTS);
    assert!(off_m(&right, &way) < 0.06, "{}", off_m(&right, &way));
    let occupied = |at: [f64; 2]| right.map.occupied(room().grid.locate(at).expect("on the map"));
    let face = [3.925, 3.975, 4.025, 4.075].map(|x| occupied([x, 3.5])).into_iter().fold(0.0, f64::max);
    assert!(face > 0.4 && occupied([2.0, 2.0]) < 0.1, "{face}");
    // The second laser turned round: what it sees behind would be ahead.
    let wrong = found([MOUNTS[0], MIDDLE]);
    assert!(off_m(&wrong, &way) > 2.0 * off_m(&right, &way), "{} {}", off_m(&wrong, &way), off_m(&right, &way));
}

#[test]
fn one_particle_with_exact_odometry_is_the_mapper_that_takes_them_together() {
    let way = way(12);
    let model = model();
    let options = Options { particles: 1, proposal: slam::Proposal::Odometry, update_move_m: 0.0, ..FEW };
    let map = || Box::new(FastVisibility::visibility(&model));
    let mut filter = Slam::new(map(), &model, Arc::new(OdometryNoise::NONE), options).expect("valid");
    let mut mapper = map();
    for (k, pose) in way.iter().enumerate() {
        let scans = looked(*pose, k);
        let mounted: Vec<Mounted> = scans.iter().zip(MOUNTS).map(|(scan, mount)| Mounted { scan, mount }).collect();
        filter.take_together(&mounted, &[], *pose).expect("each updates");
        mapper.integrate_together(&scans);
    }
    let outcome = filter.finish();
    assert_eq!(outcome.map.occupancy().values(), mapper.occupancy().values());
}

/// What a ring of 8 sonars hears: the nearest of rays over each cone.
fn heard(robot: Pose, number: usize) -> Scan {
    let bearings_rad: Vec<f64> = (0..8).map(|k| std::f64::consts::TAU * f64::from(k) / 8.0 - 3.0).collect();
    let nearest = |axis: &f64| {
        let rays = seen(Pose { theta_rad: robot.theta_rad + axis, ..robot }, number);
        let within = rays.bearings_rad.iter().zip(&rays.readings).filter(|(bearing, _)| bearing.abs() < 0.26);
        within.filter_map(|(_, reading)| *reading).reduce(f64::min).filter(|range| *range < 4.0).or(Some(f64::INFINITY))
    };
    let readings = bearings_rad.iter().map(nearest).collect();
    Scan { sensor: 2, time_s: 0.2 * number as f64, pose: robot, bearings_rad, readings }
}

fn by_sonars(particles: usize, way: &[Pose], odometry: &[Pose]) -> (Outcome, Vec<Update>) {
    let mut filter = filter(Options { particles, ..FEW });
    let mut updates = Vec::new();
    for (k, (pose, odometry)) in way.iter().zip(odometry).enumerate() {
        updates.extend(filter.take_together(&[Mounted { scan: &heard(*pose, k), mount: MIDDLE }], &[], *odometry));
    }
    (filter.finish(), updates)
}

#[test]
fn cones_weigh_and_are_mapped_and_are_not_matched() {
    let way = way(60);
    let odometry = measured(&way, 5);
    let (alone, updates) = by_sonars(1, &way, &odometry);
    assert!(updates.iter().all(|update| update.matched <= 0.0));
    assert!(off_m(&alone, &odometry) < 1e-9, "one particle cannot do better than the odometry");
    assert!(alone.map.occupancy().values().iter().any(|p| *p < 0.02), "what cones pass is free");
    let (_, updates) = by_sonars(12, &way, &odometry);
    assert!(updates.iter().all(|update| update.matched <= 0.0));
    assert!(
        // A scan of them is worth some two fifths of a reading, see Weight::EVIDENCE: 12 to the bit is no weight at all.
        updates.iter().skip(1).any(|update| update.effective < 11.999),
        "they tell ways apart: {:?}",
        updates.iter().map(|update| update.effective).collect::<Vec<_>>()
    );
    assert!(updates.iter().skip(1).any(|update| update.gain.is_some_and(|gain| gain > 0.0)));
}

/// A laser that reads at every third time is matched whenever the robot has moved far enough since it was, although sonars, which read at
/// every time, update the filter in between.
#[test]
fn a_sensor_that_reads_seldom_has_its_turn() {
    let way = way(90);
    let odometry = measured(&way, 5);
    let (mut both, mut alone) = (filter(FEW), filter(FEW));
    let mut matched = 0;
    for (k, (pose, odometry)) in way.iter().zip(&odometry).enumerate() {
        let (laser, sonars) = (seen(*pose, k), heard(*pose, k));
        let [laser, sonars] = [&laser, &sonars].map(|scan| Mounted { scan, mount: MIDDLE });
        let reads = k % 3 == 0;
        let scans = if reads { vec![laser, sonars] } else { vec![sonars] };
        let update = both.take_together(&scans, &[], *odometry);
        matched += usize::from(update.is_some_and(|update| update.matched > 0.0));
        if reads {
            alone.take_together(&[laser], &[], *odometry);
        }
    }
    // A step is some 0.13 m: each scan of the laser is 0.38 m after the last.
    assert!(matched >= 27, "{matched} of 29");
    let [both, alone] = [both.finish(), alone.finish()];
    let seldom: Vec<Pose> = way.iter().step_by(3).copied().collect();
    // In between there is the odometry.
    let at_laser = |outcome: &Outcome, step: usize| {
        let poses: Vec<Pose> = outcome.trajectory.iter().step_by(step).map(|(_, pose)| *pose).collect();
        apart_m(&poses, &seldom)
    };
    let [both_m, alone_m] = [at_laser(&both, 3), at_laser(&alone, 1)];
    assert!(both_m < 2.0 * alone_m, "{both_m} m with sonars, {alone_m} m without");
    assert!(both_m < apart_m(&odometry, &way), "{both_m} {}", apart_m(&odometry, &way));
}

/// How far the farthest pose is off, m.
fn apart_m(poses: &[Pose], way: &[Pose]) -> f64 {
    poses.iter().zip(way).map(|(a, b)| (a.x_m - b.x_m).hypot(a.y_m - b.y_m)).fold(0.0, f64::max)
}

#[test]
#[should_panic(expected = "at least one sensor has read")]
fn a_time_at_which_nothing_was_read_is_none() {
    filter(FEW).take_together(&[], &[], MIDDLE);
}
