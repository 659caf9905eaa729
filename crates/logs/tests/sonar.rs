//! Sonars of CARMEN logs: every one a sensor with its mount and cone, where the robot's lasers or its odometry put them.

use std::f64::consts::FRAC_PI_2;

use crate::writer::{odom, sonar};
use logs::{Body, Event, Finding, Log, LogError, Options, Report, Sensor, Trajectory};
use proptest::prelude::*;
use sensor::{Pose, Scan};

fn read(text: &str, options: &Options) -> Result<(Vec<Event>, Report), LogError> {
    let mut log = Log::read(text.as_bytes(), "a.log", options)?;
    let mut events = Vec::new();
    while let Some(event) = log.next_event() {
        events.push(event?);
    }
    Ok((events, log.report().clone()))
}

fn pose(x_m: f64, y_m: f64, theta_rad: f64) -> Pose {
    Pose { x_m, y_m, theta_rad }
}

fn is_near(found: Pose, expected: Pose) -> bool {
    let turn_rad = libm::remainder(found.theta_rad - expected.theta_rad, std::f64::consts::TAU);
    (found.x_m - expected.x_m).abs() < 1e-9 && (found.y_m - expected.y_m).abs() < 1e-9 && turn_rad.abs() < 1e-9
}

/// To the left and ahead.
const LEFT: Pose = Pose { x_m: 0.1, y_m: 0.2, theta_rad: FRAC_PI_2 };
const AHEAD: Pose = Pose { x_m: 0.3, y_m: 0.0, theta_rad: 0.0 };

/// A `FLASER` line of three beams: the laser's pose, and that of the odometry.
fn laser(at: Pose, odometry: Pose, time_s: f64) -> String {
    let [a, b] = [at, odometry].map(|pose| format!("{} {} {}", pose.x_m, pose.y_m, pose.theta_rad));
    format!("FLASER 3 1 2 3 {a} {b} {time_s} robot {time_s}\n")
}

/// The robot drives along x by 1 m/s and looks along y; corrected, it is 100 m farther up.
fn with_lasers() -> String {
    let head = "PARAM robot_max_sonar 5.0 robot 0\nPARAM robot_frontlaser_offset 0.5 robot 0\n".to_owned();
    let scan = |time_s: f64| {
        let robot = pose(time_s, 0.0, FRAC_PI_2);
        odom(robot, time_s) + &laser(pose(time_s, 100.5, FRAC_PI_2), robot, time_s)
    };
    let both = [(Some(1.25), LEFT), (Some(f64::INFINITY), AHEAD)];
    let end = [(None, LEFT), (Some(4.99), AHEAD)];
    head + &scan(1.0) + &sonar(0.5, &both, 1.25) + &scan(2.0) + &sonar(0.5, &end, 2.0) + &scan(2.5)
}

#[test]
fn each_sonar_is_a_sensor_with_its_mount_and_its_cone() {
    let (events, report) = read(&with_lasers(), &Options::default()).expect("fine");
    let found: Vec<_> = events.iter().map(|event| (event.sensor, event.line, event.scan.readings.clone())).collect();
    let beams = vec![Some(1.0), Some(2.0), Some(3.0)];
    let expected = [
        (0, 4, beams.clone()),
        (1, 5, vec![Some(1.25)]),
        (2, 5, vec![Some(f64::INFINITY)]),
        (0, 7, beams.clone()),
        (1, 8, vec![None]),
        (2, 8, vec![Some(4.99)]),
        (0, 10, beams),
    ];
    assert_eq!(found, expected);
    assert_eq!(events[1].kind, Sensor::Sonar { max_range_m: Some(5.0), width_rad: Some(0.5) });
    assert_eq!((events[1].scan.bearings_rad.as_slice(), events[1].scan.sensor), (&[0.0][..], 1));
    // The robot looks along y: its left is -x, and the corrected log has it 100 m up.
    assert!(is_near(events[1].scan.pose, pose(1.25 - 0.2, 100.1, 2.0 * FRAC_PI_2)), "{:?}", events[1].scan.pose);
    assert!(is_near(events[2].scan.pose, pose(1.25, 100.3, FRAC_PI_2)), "{:?}", events[2].scan.pose);
    assert!(is_near(events[4].scan.pose, pose(1.8, 100.1, 2.0 * FRAC_PI_2)), "{:?}", events[4].scan.pose);
    assert!(is_near(events[1].odometry.expect("by ODOM"), pose(1.25, 0.0, FRAC_PI_2)), "not corrected");
    // What was read at one time stays together.
    let together: Vec<usize> = {
        let scans: Vec<Scan> = events.iter().map(|event| event.scan.clone()).collect();
        scans.chunk_by(Scan::is_with).map(<[Scan]>::len).collect()
    };
    assert_eq!(together, [1, 2, 3, 1]);
    assert_eq!([0, 1, 2].map(|number| report.array_of(number)), [0, 1, 1]);
    assert_eq!((report.scans, report.beams, report.no_returns, report.unusable), (7, 13, 1, 1));
    assert!(!report.skipped.contains_key("SONAR") && report.damaged == 0, "{report}");
}

#[test]
fn without_lasers_the_odometry_puts_them() {
    let mut text = String::new();
    for k in 0..30 {
        let time_s = 0.5 * f64::from(k);
        text += &odom(pose(time_s, 7.0, 0.0), time_s);
        text += &sonar(0.0, &[(Some(2.0), AHEAD)], time_s + 0.1);
    }
    let (events, report) = read(&text, &Options::default()).expect("fine");
    assert_eq!(events.len(), 29);
    for (event, k) in events.iter().zip(0..) {
        assert!(is_near(event.scan.pose, pose(0.5 * f64::from(k) + 0.1 + 0.3, 7.0, 0.0)), "{event:?}");
        assert_eq!(event.kind, Sensor::Sonar { max_range_m: Some(5.0), width_rad: None });
    }
    // The last has no pose after it.
    assert_eq!((report.unplaced, report.kept), (1, 29));
    let said: Vec<String> = report.findings().iter().map(ToString::to_string).collect();
    for start in
        ["the pose equals the odometry", "line 2: no PARAM robot_max_sonar", "1 scans of raw lasers or sonars are"]
    {
        assert!(said.iter().any(|line| line.starts_with(start)), "{said:?}");
    }
    let warned = report.findings().into_iter().filter(Finding::is_warning).count();
    // All readings are of 2 m, and none is longer.
    assert_eq!((warned, said[0].contains("give --sonar-range 2")), (1, true), "{said:?}");
}

#[test]
fn options_come_before_the_log_and_sonars_can_be_left_out() {
    let reach = |options: Options| {
        let (events, _) = read(&with_lasers(), &options).expect("fine");
        events.iter().filter(|event| event.sensor > 0).map(|event| event.scan.readings[0]).collect::<Vec<_>>()
    };
    let none = Some(f64::INFINITY);
    assert_eq!(reach(Options::default()), [Some(1.25), none, None, Some(4.99)]);
    assert_eq!(reach(Options { max_sonar_m: Some(1.0), ..Options::default() }), [none, none, None, none]);
    assert_eq!(reach(Options { max_range_m: Some(1.0), ..Options::default() })[0], Some(1.25), "that is of lasers");
    assert_eq!(reach(Options { min_range_m: 2.0, ..Options::default() })[0], None);
    let (events, report) = read(&with_lasers(), &Options { sonars: false, ..Options::default() }).expect("fine");
    assert_eq!((events.len(), report.skipped["SONAR"]), (3, 2));
    let message = read(&sonar(0.5, &[(None, LEFT)], 1.0), &Options { sonars: false, ..Options::default() });
    assert!(message.expect_err("no scan").to_string().contains("only SONAR; give"));
}

#[test]
fn what_has_no_pose_near_in_time_is_left_out_and_counted() {
    let robot =
        |time_s: f64| odom(pose(time_s, 0.0, 0.0), time_s) + &laser(pose(time_s, 0.0, 0.0), Pose::default(), time_s);
    let both = [(Some(2.0), LEFT), (Some(3.0), AHEAD)];
    let text = sonar(0.5, &both, 0.5)
        + &robot(1.0)
        + &robot(2.0)
        + &sonar(0.5, &both, 4.0)
        + &robot(6.0)
        + &sonar(0.5, &both, 6.5)
        + &odom(pose(7.0, 0.0, 0.0), 7.0);
    let (events, report) = read(&text, &Options::default()).expect("fine");
    assert_eq!(events.len(), 3, "those of the laser");
    assert_eq!((report.in_gaps, report.unplaced, report.scans), (2, 4, 9));
    let (_, bridged) = read(&text, &Options { max_gap_s: 5.0, ..Options::default() }).expect("fine");
    assert_eq!((bridged.in_gaps, bridged.unplaced), (0, 4));
    let said = report.findings().iter().map(ToString::to_string).collect::<String>();
    assert!(said.contains("2 scans are left out: they lie where no pose is known for more than 1 s"), "{said}");
}

#[test]
fn a_trajectory_is_of_the_robot_or_of_its_laser() {
    let tum = "1 10 20 0 0 0 0 1\n2 12 20 0 0 0 0 1\n";
    let along = |body| {
        let trajectory = Trajectory::read(tum.as_bytes(), "a.tum").expect("fine");
        let text = with_lasers();
        let log = Log::read(text.as_bytes(), "a.log", &Options::default()).expect("fine");
        let mut log = log.along(trajectory, body).expect("timed").collect::<Result<Vec<_>, _>>().expect("fine");
        log.retain(|scan| scan.sensor == 2);
        log[0].pose
    };
    assert!(is_near(along(Body::Robot), pose(10.8, 20.0, 0.0)), "{:?}", along(Body::Robot));
    // The laser is 0.5 m before the robot's middle.
    assert!(is_near(along(Body::Sensor), pose(10.3, 20.0, 0.0)), "{:?}", along(Body::Sensor));
}

#[test]
fn lines_without_mounts_are_skipped_and_said() {
    let other = "SONAR 2 1.5 2.5 1 2 0.5 1 2 0.5 9 host 9\n".repeat(40);
    let (events, report) = read(&(with_lasers() + &other), &Options::default()).expect("not damaged");
    assert_eq!((events.len(), report.skipped["SONAR"], report.damaged), (7, 40, 0));
    assert!(report.findings().contains(&Finding::WithoutMounts { lines: 40, line: 11 }), "{report}");
    // Sonars that all stand at one place.
    let alike = with_lasers() + &sonar(0.5, &[(None, LEFT); 3], 2.2);
    assert!(!read(&alike, &Options::default()).expect("fine").1.to_string().contains("look the same way"), "not first");
    let alike = sonar(0.5, &[(None, LEFT); 3], 1.0) + &with_lasers();
    let (_, report) = read(&alike, &Options::default()).expect("fine");
    assert!(report.findings().contains(&Finding::SonarsAlike { line: 1, count: 3 }), "{report}");
}

#[test]
fn damage_costs_one_line() {
    let mut lines: Vec<String> = with_lasers().lines().map(|line| line.to_owned() + "\n").collect();
    lines[4] = lines[4].replace("SONAR 0.5", "SONAR -0.5");
    let (events, report) = read(&lines.concat(), &Options::default()).expect("one line");
    assert_eq!((events.len(), report.damaged, report.problems[0].line), (5, 1, 5));
    assert!(report.problems[0].reason.starts_with("field 2, cone angle: \"-0.5\""), "{report}");
    let centimetres = sonar(0.5, &[(Some(120.0), LEFT), (Some(240.0), AHEAD), (Some(500.0), LEFT)], 2.2);
    let (_, report) = read(&(with_lasers() + &centimetres), &Options::default()).expect("one line");
    assert!(report.damaged == 1 && report.problems[0].reason.contains("are they in mm or cm?"), "{report}");
}

/// Neither many sonars nor missing poses make a log grow in memory, and a bad pose drags no sonar away.
#[test]
fn what_waits_is_bounded_and_strays_stay_alone() {
    let ring: Vec<(Option<f64>, Pose)> = (0..16).map(|k| (Some(1.0), pose(0.0, 0.0, 0.4 * f64::from(k)))).collect();
    let text: String = (0..600).map(|k| sonar(0.5, &ring, f64::from(k))).collect();
    let mut log = Log::read(text.as_bytes(), "a.log", &Options::default()).expect("scans without poses");
    assert!(log.next_event().is_none());
    assert_eq!((log.report().unplaced, log.report().scans), (9600, 9600));
    let drive = |bad: u32| -> String {
        (0..60)
            .map(|k| {
                let time_s = f64::from(k);
                let far = if k == bad { 588e3 } else { 0.0 };
                laser(pose(time_s + far, 0.0, 0.0), Pose::default(), time_s) + &sonar(0.5, &ring, time_s + 0.5)
            })
            .collect()
    };
    // The laser's scan, and the messages of sonars before and after it; the last message has no pose after it.
    for (bad, lost) in [(0, 16 + 16), (20, 32 + 16), (59, 16 + 16)] {
        let (events, report) = read(&drive(bad), &Options::default()).expect("fine");
        assert!(events.iter().all(|event| event.scan.pose.x_m < 100.0), "{bad}: {report}");
        assert_eq!((report.strays, report.unplaced), (1, lost), "{bad}");
    }
}

fn any_drive() -> impl Strategy<Value = (Vec<Pose>, Vec<(f64, f64)>, f64)> {
    let mount = (-0.5f64..0.5, -0.5f64..0.5, -3.1f64..3.1).prop_map(|(x, y, theta)| pose(x, y, theta));
    let step = (0.05f64..0.9, 0.0f64..1.0);
    (prop::collection::vec(mount, 1..20), prop::collection::vec(step, 25..60), 0.05f64..3.0)
}

proptest! {
    /// A ring of sonars on a robot that drives a circle: what is read is what was written, at the places by hand.
    #[test]
    fn a_written_log_is_read_again((mounts, steps, width_rad) in any_drive(), by_laser in any::<bool>()) {
        let at = |time_s: f64| pose(3.0 * libm::cos(time_s), 3.0 * libm::sin(time_s), time_s);
        let (mut text, mut now_s, mut expected) = ("PARAM robot_max_sonar 5 robot 0\n".to_owned(), 10.0, Vec::new());
        for (k, (step_s, share)) in steps.iter().enumerate() {
            let robot = at(now_s);
            text += &if by_laser { laser(robot, Pose::default(), now_s) } else { odom(robot, now_s) };
            let (sonar_s, next) = (now_s + share * step_s, at(now_s + step_s));
            let readings: Vec<(Option<f64>, Pose)> =
                mounts.iter().enumerate().map(|(s, mount)| (Some(0.1 + 0.1 * ((s + k) % 30) as f64), *mount)).collect();
            text += &sonar(width_rad, &readings, sonar_s);
            let along = |a: f64, b: f64| a + share * (b - a);
            let between = pose(along(robot.x_m, next.x_m), along(robot.y_m, next.y_m), along(robot.theta_rad, next.theta_rad));
            expected.extend(readings.into_iter().map(|(reading, mount)| {
                let (sin, cos) = libm::sincos(between.theta_rad);
                let x_m = between.x_m + cos * mount.x_m - sin * mount.y_m;
                let y_m = between.y_m + sin * mount.x_m + cos * mount.y_m;
                (reading, pose(x_m, y_m, between.theta_rad + mount.theta_rad), sonar_s)
            }));
            now_s += step_s;
        }
        let last = at(now_s);
        text += &if by_laser { laser(last, Pose::default(), now_s) } else { odom(last, now_s) };
        let (events, report) = read(&text, &Options::default()).expect("fine");
        let sonars: Vec<&Event> = events.iter().filter(|event| matches!(event.kind, Sensor::Sonar { .. })).collect();
        prop_assert_eq!((sonars.len(), report.damaged, report.left_out()), (expected.len(), 0, 0));
        for (event, (reading, pose, time_s)) in sonars.iter().zip(&expected) {
            prop_assert_eq!(event.scan.readings[0], *reading);
            prop_assert!(is_near(event.scan.pose, *pose), "{:?} {:?}", event.scan.pose, pose);
            prop_assert!((event.scan.time_s + report.start_s - time_s).abs() < 1e-9);
            prop_assert_eq!(event.kind, Sensor::Sonar { max_range_m: Some(5.0), width_rad: Some(width_rad) });
        }
    }
}
