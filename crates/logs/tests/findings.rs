//! What can make results doubtful is said, and only then.

use crate::writer::flaser;
use logs::{Body, FanOptions, Finding, Log, LogError, Options, Report, Trajectory};
use sensor::{Pose, Scan};

/// A scan of so many beams; scan k is made after k tenths of a second, k / 20 m along x.
fn scan(k: u32, beams: usize) -> Scan {
    Scan {
        sensor: 0,
        time_s: 1000.0 + 0.1 * f64::from(k),
        pose: Pose { x_m: 0.05 * f64::from(k), y_m: 1.0, theta_rad: 0.01 * f64::from(k) },
        bearings_rad: vec![0.0; beams],
        readings: vec![Some(2.0); beams],
    }
}

fn drive(beams: usize) -> Vec<Scan> {
    (0..40).map(|k| scan(k, beams)).collect()
}

fn text(scans: &[Scan]) -> String {
    scans.iter().map(flaser).collect()
}

fn read(text: &str, options: &Options) -> (Vec<Scan>, Report) {
    let mut log = Log::read(text.as_bytes(), "a.log", options).expect("fine");
    let scans = log.by_ref().collect::<Result<Vec<_>, _>>().expect("fine");
    (scans, log.report().clone())
}

fn said(report: &Report) -> Vec<(bool, String)> {
    report.findings().iter().map(|finding| (finding.is_warning(), finding.to_string())).collect()
}

fn ends(scan: &Scan) -> [i64; 2] {
    let bearings = &scan.bearings_rad;
    [bearings[0], bearings[bearings.len() - 1]].map(|bearing| (10.0 * bearing.to_degrees()).round() as i64)
}

#[test]
fn the_logs_own_parameters_beat_the_number_of_beams_and_options_beat_both() {
    let full = "PARAM laser_front_laser_resolution 1.0\nPARAM laser_front_laser_fov 6.283185\n";
    let (plain, report) = read(&text(&drive(360)), &Options::default());
    assert_eq!(ends(&plain[0]), [-900, 895]);
    assert_eq!(said(&report).len(), 1);
    assert!(matches!(report.findings()[0], Finding::GuessedFan { usual: true, beams: 360, line: 1, .. }));
    assert!(
        said(&report)[0]
            .1
            .contains("its 360 beams are; by their number they are taken to go from -90.0 to 89.5 degrees")
    );

    let both = format!("{full}{}{}", text(&drive(360)[..20]), text(&[scan(20, 361)]));
    let (scans, report) = read(&both, &Options::default());
    assert_eq!((ends(&scans[0]), ends(&scans[20])), ([-1800, 1790], [-1800, 1800]));
    assert_eq!(said(&report), []);

    let fan = FanOptions { fov_rad: Some(240f64.to_radians()), ..FanOptions::default() };
    let (scans, report) = read(&format!("{full}{}", text(&drive(360))), &Options { fan, ..Options::default() });
    assert_eq!((ends(&scans[0]), said(&report)), ([-1200, 1200], vec![]));

    let (_, report) = read(&text(&drive(100)), &Options::default());
    assert!(said(&report)[0].0 && said(&report)[0].1.contains("no usual number"), "{report}");
    let uneven =
        format!("PARAM laser_front_laser_fov 180\nPARAM laser_front_laser_resolution 1\n{}", text(&drive(361)));
    let (scans, report) = read(&uneven, &Options::default());
    assert_eq!(ends(&scans[0]), [-900, 900], "the field of view decides");
    assert!(matches!(report.findings()[..], [Finding::UnevenFan { .. }]), "{report}");
}

#[test]
fn every_laser_is_a_sensor_of_its_own() {
    let both: String = drive(181)
        .iter()
        .flat_map(|scan| {
            let back = Pose { theta_rad: scan.pose.theta_rad + 3.1, x_m: scan.pose.x_m - 0.5, ..scan.pose };
            [flaser(scan), flaser(&Scan { pose: back, ..scan.clone() }).replace("FLASER", "RLASER")]
        })
        .collect();
    let mut log = Log::read(both.as_bytes(), "a.log", &Options::default()).expect("fine");
    let mut sensors = Vec::new();
    while let Some(event) = log.next_event() {
        let event = event.expect("fine");
        assert_eq!(event.odometry, Some(Pose { x_m: 7.0, y_m: 7.0, theta_rad: 7.0 }));
        sensors.push((event.sensor, event.line));
    }
    assert_eq!((sensors.len(), &sensors[..3]), (80, &[(0, 1), (1, 2), (0, 3)][..]));
    let names: Vec<_> = log.report().sensors.values().map(|sensor| (sensor.name.as_str(), sensor.scans)).collect();
    assert_eq!(names, [("FLASER", 40), ("RLASER", 40)]);
    assert!(log.report().findings().iter().all(|finding| !finding.is_warning()), "{}", log.report());
}

/// A raw scan of the drive; the robot's odometry is ahead of and behind it.
fn raw(k: u32) -> String {
    let time = 1000.05 + 0.1 * f64::from(k);
    format!("RAWLASER1 0 -1 2 1 80 0 0 3 1 2 3 0 {time} host {time}\n")
}

fn odom(k: u32) -> String {
    let at = scan(k, 1);
    format!("ODOM {} {} {} 0.5 0 0 {} host {}\n", at.pose.x_m, at.pose.y_m, at.pose.theta_rad, at.time_s, at.time_s)
}

#[test]
fn raw_lasers_stand_on_the_odometry() {
    let offset = "PARAM robot_frontlaser_offset 0.25\n";
    let text: String = (0..40).map(|k| odom(k) + &raw(k)).collect();
    let (scans, report) = read(&format!("{offset}{text}"), &Options::default());
    // The last has no odometry behind it.
    assert_eq!((scans.len(), report.unplaced, report.scans, report.skipped["ODOM"]), (39, 1, 40, 40));
    assert_eq!(scans[0].bearings_rad, [-1.0, 0.0, 1.0]);
    for (k, found) in (0..).zip(&scans) {
        let [before, after] = [scan(k, 1).pose, scan(k + 1, 1).pose];
        let theta = 0.5 * (before.theta_rad + after.theta_rad);
        let x = 0.5 * (before.x_m + after.x_m) + 0.25 * theta.cos();
        assert!((found.pose.x_m - x).abs() < 1e-9 && (found.pose.theta_rad - theta).abs() < 1e-9, "{k}: {found:?}");
    }
    // All scans that have a pose have that of the odometry.
    assert!(
        matches!(
            report.findings()[..],
            [Finding::OdometryPoses { scans: 39, .. }, Finding::Unplaced { scans: 1, poses: None }, ..]
        ),
        "{report}"
    );

    // Of the same laser there are scans with poses: they are the same scans.
    let twice: String = (0..40).map(|k| odom(k) + &raw(k) + &flaser(&scan(k, 181))).collect();
    let (scans, report) = read(&twice, &Options::default());
    assert_eq!((scans.len(), report.skipped["RAWLASER1"]), (40, 40));
    // Odometry that stops for five seconds is not bridged.
    let gap: String = (0..100).map(|k| if (20..70).contains(&k) { raw(k) } else { odom(k) + &raw(k) }).collect();
    let (scans, report) = read(&gap, &Options::default());
    assert_eq!((scans.len(), report.in_gaps, report.unplaced), (48, 51, 1));
}

#[test]
fn a_log_that_is_not_corrected_is_noted() {
    let corrected = text(&drive(181));
    let raw: String = drive(181)
        .iter()
        .map(|scan| {
            let Pose { x_m, y_m, theta_rad } = scan.pose;
            flaser(scan).replace(" 7 7 7 ", &format!(" {x_m} {y_m} {theta_rad} "))
        })
        .collect();
    let noted = |text: &str| {
        let findings = read(text, &Options::default()).1.findings();
        findings.into_iter().filter(|finding| matches!(finding, Finding::OdometryPoses { .. })).collect::<Vec<_>>()
    };
    assert_eq!(noted(&corrected), []);
    let found = noted(&raw);
    assert!(matches!(found[..], [Finding::OdometryPoses { scans: 40, .. }]) && !found[0].is_warning(), "{found:?}");
    // One scan that differs is enough.
    assert_eq!(noted(&raw.replacen(" 1 0.01 ", " 1 0.02 ", 1)), []);
}

#[test]
fn bad_poses_are_named_by_their_line_and_left_out() {
    for (at, by_m) in [(23usize, 382.0), (0, 588e3), (39, 588e3)] {
        let mut scans = drive(181);
        scans[at].pose.y_m += by_m;
        let (found, report) = read(&text(&scans), &Options::default());
        assert_eq!((found.len(), report.strays, report.kept), (39, 1, 39));
        assert!(found.iter().all(|scan| scan.pose.y_m < 2.0));
        let warning = &said(&report)[0];
        assert!(warning.0 && warning.1.starts_with(&format!("line {}: the pose is ", at + 1)), "{warning:?}");
        assert!(report.motion.jump.is_none());
    }
}

#[test]
fn jumps_and_turns_are_warned_of_with_their_lines_and_a_good_drive_is_not() {
    let warnings = |scans: &[Scan]| {
        let findings = read(&text(scans), &Options::default()).1.findings();
        findings.into_iter().filter(Finding::is_warning).map(|finding| finding.to_string()).collect::<Vec<_>>()
    };
    assert_eq!(warnings(&drive(181)), Vec::<String>::new());
    let mut jump = drive(181);
    jump[30..].iter_mut().for_each(|scan| scan.pose.x_m += 9.0);
    let found = warnings(&jump);
    assert!(
        found.len() == 1 && found[0].starts_with("line 31: the sensor is 9.05 m from where it was at line 30"),
        "{found:?}"
    );
    let mut turn = drive(181);
    turn[10].pose.theta_rad += 2.0;
    let found = warnings(&turn);
    assert!(
        found.len() == 1 && found[0].contains("turned by 115 degrees") && found[0].contains("(2 such turns)"),
        "{found:?}"
    );
    let centimetres: Vec<_> = drive(181)
        .into_iter()
        .map(|scan| Scan { pose: Pose { x_m: 100.0 * scan.pose.x_m, ..scan.pose }, ..scan })
        .collect();
    assert!(warnings(&centimetres)[0].contains("centimetres"));
}

#[test]
fn two_clocks_are_counted_with_the_largest_step() {
    let mut scans = drive(181);
    scans.iter_mut().skip(20).for_each(|scan| scan.time_s -= 25.0);
    scans[30].time_s -= 0.3;
    let (found, report) = read(&text(&scans), &Options::default());
    assert_eq!((found.len(), report.steps_back), (40, 2));
    let warning = &said(&report)[0];
    assert!(
        warning.0 && warning.1.starts_with("2 steps back in time, the largest of 24.9 s at line 21"),
        "{warning:?}"
    );
    let (_, report) = read(&text(&scans), &Options { window_s: Some(0.0..1.0), ..Options::default() });
    assert!(said(&report)[0].1.contains("--window takes scans of several parts of the log"));
}

/// Poses for the drive, in the TUM format, of these scans.
fn poses(numbers: impl Iterator<Item = u32>, clock_s: f64) -> Trajectory {
    let lines = numbers.map(|k| {
        let Scan { time_s, pose, .. } = scan(k, 1);
        let (sin, cos) = (0.5 * pose.theta_rad).sin_cos();
        format!("{} {} {} 0 0 0 {sin} {cos}\n", time_s + clock_s, pose.x_m, pose.y_m)
    });
    Trajectory::read(lines.collect::<String>().as_bytes(), "a.tum").expect("fine")
}

#[test]
fn gaps_of_a_trajectory_are_not_bridged() {
    let gap = || poses((0..10).chain(25..40), 0.0);
    let along = |max_gap_s| {
        let text = text(&drive(181));
        let options = Options { max_gap_s, ..Options::default() };
        let mut log =
            Log::read(text.as_bytes(), "a.log", &options).expect("fine").along(gap(), Body::Sensor).expect("timed");
        let scans = log.by_ref().filter(Result::is_ok).count();
        (scans, log.report().clone())
    };
    let (scans, report) = along(1.0);
    assert_eq!((scans, report.in_gaps, report.outside_trajectory), (25, 15, 0));
    let note = said(&report).into_iter().map(|(_, text)| text).collect::<String>();
    assert!(
        note.contains("15 scans are left out: they lie where no pose is known for more than 1 s, at most for 1.6 s"),
        "{note}"
    );
    assert_eq!(along(2.0).0, 40);
    // Keyframes that are far apart still give the poses of their own scans.
    let text = text(&drive(181));
    let keyframes = poses((0..40).step_by(13), 0.0);
    let log = Log::read(text.as_bytes(), "a.log", &Options::default()).expect("fine").along(keyframes, Body::Sensor);
    assert_eq!(log.expect("timed").count(), 4);
}

#[test]
fn another_clock_is_an_error_that_gives_both_spans() {
    let text = text(&drive(181));
    let mut log = Log::read(text.as_bytes(), "a.log", &Options::default())
        .expect("fine")
        .along(poses(0..40, -1000.0), Body::Sensor)
        .expect("timed");
    let error = log.next().expect("an error").expect_err("another clock");
    assert!(matches!(error, LogError::Clocks { scans: 40, .. }));
    let message = error.to_string();
    assert!(message.contains("from 1000.000 to 1003.900 s, the trajectory from 0.000 to 3.900 s"), "{message}");
    assert!(message.contains("add 1000.000 s"), "{message}");
    assert!(log.next().is_none());
}

const STEREO: &str = "scan,time_s,x_m,y_m,theta_rad,bearing_rad,disparity_px\n";

/// Scans of 20 beams; of every fifth the reading is `code`.
fn camera(scale: f64, code: &str) -> String {
    let mut text = STEREO.to_owned();
    for k in 0..10 {
        for beam in 0..20 {
            let reading = if beam % 5 == 0 { code.to_owned() } else { format!("{}", scale * f64::from(4 + beam)) };
            text += &format!(
                "{k},{},{},0,0,{},{reading}\n",
                0.1 * f64::from(k),
                0.1 * f64::from(k),
                0.02 * f64::from(beam)
            );
        }
    }
    text
}

#[test]
fn every_code_for_no_match_means_the_same() {
    let options = Options { max_disparity_px: Some(64.0), ..Options::default() };
    let (expected, report) = read(&camera(1.0, ""), &options);
    assert_eq!(said(&report), []);
    for (code, finding) in
        [("-1", ""), ("-16", ""), ("nan", ""), ("0", "exactly 0"), ("inf", "infinite"), ("65535", "largest disparity")]
    {
        let (scans, report) = read(&camera(1.0, code), &options);
        assert_eq!(scans, expected, "{code}");
        let said = said(&report);
        assert_eq!(said.len(), usize::from(!finding.is_empty()), "{code}: {said:?}");
        assert!(said.iter().all(|(_, text)| text.contains(finding)), "{code}: {said:?}");
    }
    for scale in [16.0, 256.0] {
        let error =
            Log::read(camera(scale, "-16").as_bytes(), "a.csv", &options).err().expect("out of scale").to_string();
        assert!(error.contains("% of 16 disparities lie above the largest that is searched, 64 px"), "{error}");
    }
}

#[test]
fn scans_of_one_beam_are_warned_of() {
    let mut text = "scan,x_m,y_m,theta_rad,bearing_rad,range_m\n".to_owned();
    (0..120).for_each(|k| text += &format!("{k},{},0,0,0,2\n", 0.01 * f64::from(k)));
    let (scans, report) = read(&text, &Options::default());
    assert_eq!(scans.len(), 120);
    assert!(matches!(report.findings()[..], [Finding::OneBeam { scans: 120 }]), "{report}");
}
