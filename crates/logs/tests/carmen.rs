//! CARMEN logs as a whole: written by a small writer, read back, damaged in every way.

use std::fs;
use std::io::{self, Read};

use crate::writer::{flaser, gzip, robot_laser};
use logs::{Body, FanOptions, Log, LogError, Options, Sensor, Trajectory};
use proptest::prelude::*;
use sensor::{Pose, Scan};

fn read(text: impl AsRef<[u8]>, options: &Options) -> Result<(Vec<Scan>, logs::Report), LogError> {
    let mut log = Log::read(text.as_ref(), "a.log", options)?;
    let scans = log.by_ref().collect::<Result<Vec<_>, _>>()?;
    Ok((scans, log.report().clone()))
}

/// A scan of 181 beams, each a little longer, from a place on the x axis.
fn scan(k: u32) -> Scan {
    let x_m = f64::from(k);
    Scan {
        sensor: 0,
        time_s: 100.0 + 0.5 * x_m,
        pose: Pose { x_m, y_m: -1.5, theta_rad: 0.1 * x_m },
        bearings_rad: (0..181).map(|beam| f64::from(beam - 90).to_radians()).collect(),
        readings: (0..181).map(|beam| Some(1.0 + f64::from(beam) * 0.01)).collect(),
    }
}

fn drive(scans: u32) -> String {
    (0..scans).map(|k| flaser(&scan(k))).collect()
}

#[test]
fn a_scan_in_messages_of_two_names_is_used_once() {
    let twice: String = (0..5).map(|k| flaser(&scan(k)) + &robot_laser(&scan(k), 80.0)).collect();
    let (scans, report) = read(&twice, &Options::default()).expect("a log");
    assert_eq!((scans.len(), report.said_again, report.skipped["ROBOTLASER1"]), (5, 5, 5));
    let said: Vec<String> = report.findings().iter().map(ToString::to_string).collect();
    assert!(said.iter().any(|line| line.starts_with("5 scans stand in messages of two names")), "{said:?}");
    // Other ranges are another scan.
    let other = |k| Scan { readings: (0..181).map(|beam| Some(2.0 + f64::from(beam) * 0.01)).collect(), ..scan(k) };
    let two: String = (0..5).map(|k| flaser(&scan(k)) + &robot_laser(&other(k), 80.0)).collect();
    let (scans, report) = read(&two, &Options::default()).expect("a log");
    assert_eq!((scans.len(), report.said_again), (10, 0));
}

#[test]
fn a_log_of_all_messages() {
    let text = format!(
        "# CARMEN Logfile\nPARAM robot_front_laser_max 30.0 nohost 0\nPARAM robot_length 0.5 nohost 0\n\
         ODOM 0 0 0 0 0 0 99 host 0\n{}ODOM 0 0 0 0 0 0 99 host 0\nTRUEPOS 1 2 0 0 0 0 9 host 9\n{}SYNC tag\n",
        flaser(&Scan { readings: vec![Some(30.0), Some(29.0), None], ..scan(0) }),
        robot_laser(&scan(1), 2.0)
    );
    let mut log = Log::read(text.as_bytes(), "a.log", &Options::default()).expect("fine");
    assert_eq!(log.sensor(), Sensor::Laser { max_range_m: 30.0, beams: 3 });
    let scans: Vec<_> = log.by_ref().map(|scan| scan.expect("fine")).collect();
    assert_eq!(scans[0].readings, [Some(f64::INFINITY), Some(29.0), None]);
    assert_eq!(scans[1].readings.iter().filter(|reading| **reading == Some(f64::INFINITY)).count(), 81);
    let report = log.report();
    assert_eq!((report.lines, report.scans, report.beams, report.no_returns, report.unusable), (9, 2, 184, 82, 1));
    let skipped: Vec<_> = report.skipped.iter().map(|(name, count)| (name.as_str(), *count)).collect();
    assert_eq!(skipped, [("#", 1), ("ODOM", 2), ("PARAM", 2), ("SYNC", 1), ("TRUEPOS", 1)]);
    assert_eq!(report.span_s, Some([0.0, 0.5]));
    // Another maximum range than at first is said, but is no damage.
    assert_eq!((report.damaged, report.problems.len()), (0, 1));
    assert!(report.problems[0].reason.contains("2 m here and 30 m"), "{report}");
}

#[test]
fn a_log_as_other_systems_leave_it() {
    let plain = read(drive(5), &Options::default()).expect("fine");
    let host = |name: &[u8]| {
        let text = drive(5);
        let pieces: Vec<_> = text.split("robot").map(str::as_bytes).collect();
        pieces.join(name)
    };
    let compressed = [gzip(drive(2).as_bytes()), gzip(&drive(5).as_bytes()[drive(2).len()..])].concat();
    for (name, bytes) in [
        ("CRLF", drive(5).replace('\n', "\r\n").into_bytes()),
        ("a byte-order mark", [b"\xef\xbb\xbf", drive(5).as_bytes()].concat()),
        ("a host that is not UTF-8", host(b"r\xf6bot")),
        ("no line end at the end", drive(5).trim_end().as_bytes().to_vec()),
        ("blank lines", drive(5).replace('\n', "\n\n \n").into_bytes()),
        ("gzip", gzip(drive(5).as_bytes())),
        ("gzip in two members", compressed),
    ] {
        let (scans, report) = read(bytes, &Options::default()).expect(name);
        let counts = |report: &logs::Report| (report.lines, report.beams, report.kept, report.findings().len());
        assert_eq!((scans, counts(&report)), (plain.0.clone(), counts(&plain.1)), "{name}");
    }
}

#[test]
fn options_choose_scans() {
    let times = |options: Options| -> Vec<f64> {
        let (scans, report) = read(drive(20), &options).expect("fine");
        let dropped = report.outside_window + report.outside_trajectory + report.thinned;
        assert_eq!((report.scans, report.kept, dropped), (20, scans.len() as u64, 20 - scans.len() as u64));
        assert_eq!(report.span_s, Some([0.0, 9.5]), "of all scans");
        scans.iter().map(|scan| scan.time_s).collect()
    };
    assert_eq!(times(Options { every: 8, ..Options::default() }), [0.0, 4.0, 8.0]);
    assert_eq!(times(Options { window_s: Some(1.0..2.5), ..Options::default() }), [1.0, 1.5, 2.0]);
    assert_eq!(times(Options { every: 2, window_s: Some(1.0..2.5), ..Options::default() }), [1.0, 2.0]);
    assert_eq!(times(Options { least_move_m: Some(7.0), ..Options::default() }), [0.0, 3.5, 7.0]);
    assert_eq!(times(Options { least_turn_rad: Some(0.95), ..Options::default() }), [0.0, 5.0]);
    let (scans, report) =
        read(drive(1), &Options { min_range_m: 1.5, max_range_m: Some(2.0), ..Options::default() }).expect("fine");
    assert_eq!((report.unusable, report.no_returns), (50, 81));
    assert_eq!(scans[0].readings[49..51], [None, Some(1.5)]);
    let fan = FanOptions { first_rad: Some(1.0), step_rad: Some(-0.01), fov_rad: None };
    let (scans, _) = read(drive(1), &Options { fan, ..Options::default() }).expect("fine");
    assert_eq!(scans[0].bearings_rad[..2], [1.0, 0.99]);
    assert!(matches!(read(drive(1), &Options { every: 0, ..Options::default() }), Err(LogError::Option { .. })));
}

#[test]
fn a_trajectory_gives_the_poses() {
    let tum = "100.5 10 20 0 0 0 0 1\n101.5 12 20 0 0 0 0.7071067811865476 0.7071067811865476\n";
    let offset = format!("PARAM robot_frontlaser_offset 0.5\n{}", drive(5));
    let along = |text: &str, body| {
        let trajectory = Trajectory::read(tum.as_bytes(), "a.tum").expect("fine");
        let mut log = Log::read(text.as_bytes(), "a.log", &Options::default())
            .expect("fine")
            .along(trajectory, body)
            .expect("timed");
        let scans: Vec<_> = log.by_ref().map(|scan| scan.expect("fine")).collect();
        assert_eq!((log.report().outside_trajectory, log.report().kept), (2, 3));
        scans
    };
    let near = |pose: Pose, expected: [f64; 3]| {
        let found = [pose.x_m, pose.y_m, pose.theta_rad];
        assert!((0..3).all(|k| (found[k] - expected[k]).abs() < 1e-9), "{found:?} {expected:?}");
    };
    let (half, quarter) = (std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_4);
    let scans = along(&offset, Body::Sensor);
    assert_eq!(scans.iter().map(|scan| scan.time_s).collect::<Vec<_>>(), [0.5, 1.0, 1.5]);
    near(scans[1].pose, [11.0, 20.0, quarter]);
    near(along(&offset, Body::Robot)[2].pose, [12.0, 20.5, half]);
    // robot_laser() writes a laser that stands 0.2 m before its robot.
    let robot: String = (0..5).map(|k| robot_laser(&scan(k), 80.0)).collect();
    near(along(&robot, Body::Robot)[0].pose, [10.2, 20.0, 0.0]);
}

#[test]
fn damage_in_the_middle_is_noted_counted_and_skipped() {
    let mut lines: Vec<String> = (0..100).map(|k| flaser(&scan(k))).collect();
    lines[10] = lines[10][..300].to_owned() + "\n";
    lines[20] = lines[20].replace("FLASER 181", "FLASER 4000000000");
    lines[30] = lines[30].replace("robot", "robot 7");
    lines[40] = "\0\0\0\n".to_owned();
    let (scans, report) = read(lines.concat(), &Options::default()).expect("4 %");
    assert_eq!((scans.len(), report.damaged, report.lines), (96, 4, 100));
    let numbers: Vec<_> = report.problems.iter().map(|problem| problem.line).collect();
    assert_eq!(numbers, [11, 21, 31, 41]);
    let (_, report) = read(lines.concat(), &Options { problems: 2, ..Options::default() }).expect("4 %");
    assert_eq!((report.damaged, report.problems.len()), (4, 2));

    for line in [50, 60] {
        lines[line] = "?\n".to_owned();
    }
    let mut log = Log::read(io::Cursor::new(lines.concat()), "a.log", &Options { problems: 0, ..Options::default() })
        .expect("begins well");
    let given: Vec<_> = log.by_ref().collect();
    assert_eq!(given.iter().filter(|scan| scan.is_ok()).count(), 94, "all whole scans come before the refusal");
    let message = given[94].as_ref().expect_err("6 %").to_string();
    assert!(message.starts_with("a.log:11: field 2, number of ranges: 181 of them"), "{message}");
    assert!(message.contains("6 of 100 lines are damaged, which is more than 5 %"), "{message}");
    assert!(log.next().is_none());
    assert!(read(lines.concat(), &Options { damaged_share: 0.06, ..Options::default() }).is_ok());
}

#[test]
fn a_log_that_was_cut_keeps_what_was_whole() {
    let text = drive(3);
    let (scans, report) = read(&text[..text.len() - 40], &Options::default()).expect("one line is never too many");
    assert_eq!((scans.len(), report.damaged), (2, 1));
    let whole = gzip(drive(50).as_bytes());
    for bytes in [
        whole[..whole.len() * 2 / 3].to_vec(),
        whole[..whole.len() - 3].to_vec(),
        [whole.as_slice(), b"garbage"].concat(),
    ] {
        let mut log = Log::read(bytes.as_slice(), "a.log.gz", &Options::default()).expect("begins well");
        let given: Vec<_> = log.by_ref().collect();
        let message = given.last().and_then(|last| last.as_ref().err()).expect("an error ends it").to_string();
        assert!(message.starts_with("a.log.gz: cannot be read beyond line"), "{message}");
        assert!(given.len() > 20 && given[..given.len() - 1].iter().all(Result::is_ok), "{}", given.len());
        assert!(log.next().is_none());
    }
}

#[test]
fn what_holds_no_scan_is_refused_and_says_why() {
    let endless = "7".repeat(logs::LONGEST_LINE + 5);
    let millimetres: String = (0..9)
        .map(|k| flaser(&Scan { readings: scan(k).readings.iter().map(|r| r.map(|r| r * 1e3)).collect(), ..scan(k) }))
        .collect();
    for (bytes, message) in [
        (&b""[..], "a.log: no scan in 0 lines: it is empty"),
        (b"\n\r\n", "it is empty"),
        (b"ODOM 0 0 0 0 0 0 9 host 9\n# text\n", "no scan in 2 lines, only #, ODOM; give"),
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "is a PNG image, not a log"),
        (b"\x01\x02\x03", "no name of a message"),
        (b"\x7fELF\0\0", "is a program, not a log"),
        (b"FLASER\0\0", "a byte of value 0, so that it is no text"),
        (endless.as_bytes(), "is longer than 1048576 bytes"),
        (b"FLASER 360 1 2 3", "line 1: field 2, number of ranges: 360 of them, but 3 fields follow"),
        (millimetres.as_bytes(), "are they in mm or cm?"),
        (b"\x1f\x8b\x08", "a.log: cannot be read beyond line 0"),
    ] {
        let found = read(bytes, &Options::default()).expect_err(message).to_string();
        assert!(found.contains(message), "{found}");
    }
}

#[test]
fn paths() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.txt"); // gzip under another name
    fs::write(&path, gzip(drive(3).as_bytes())).expect("written");
    assert_eq!(Log::open(&path, &Options::default()).expect("fine").count(), 3);
    let found = Log::open(folder.path(), &Options::default()).err().expect("a folder").to_string();
    assert!(found.ends_with("is a folder; give one log"), "{found}");
    let found = Log::open(&folder.path().join("b"), &Options::default()).err().expect("missing").to_string();
    assert!(found.contains("b: cannot be opened"), "{found}");
    assert!(matches!(Trajectory::open(folder.path()), Err(LogError::Folder { .. })));
    fs::write(&path, "1 2 3 0 0 0 0 1\n").expect("written");
    assert!(Trajectory::open(&path).expect("fine").pose(1.0).is_some());
}

#[test]
fn time_that_goes_back_is_reported_and_kept() {
    let text = format!("{}{}{}", flaser(&scan(3)), flaser(&scan(1)), flaser(&scan(4)));
    let (scans, report) = read(text, &Options::default()).expect("fine");
    assert_eq!(scans.iter().map(|scan| scan.time_s).collect::<Vec<_>>(), [0.0, -1.0, 0.5]);
    assert_eq!((report.steps_back, report.span_s), (1, Some([-1.0, 0.5])));
}

/// Makes the lines of a log as they are asked for: what is read is never in memory as a whole.
struct Endless {
    line: Vec<u8>,
    at: usize,
    lines: u32,
}

impl Read for Endless {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.at == self.line.len() {
            (self.at, self.lines) = (0, self.lines.saturating_sub(1));
        }
        let rest = if self.lines == 0 { &[] } else { &self.line[self.at..] };
        let count = rest.len().min(buffer.len());
        buffer[..count].copy_from_slice(&rest[..count]);
        self.at += count;
        Ok(count)
    }
}

#[test]
fn a_long_log_streams() {
    let source = Endless { line: flaser(&scan(0)).into_bytes(), at: 0, lines: 5000 };
    let mut log = Log::carmen(source, "endless", &Options { every: 1000, ..Options::default() }).expect("fine");
    assert_eq!(log.by_ref().filter(Result::is_ok).count(), 5);
    assert_eq!(log.report().beams, 5000 * 181);
}

/// What is read adds up and is made of numbers; what is refused is so in a line that names the place.
fn holds(bytes: &[u8], options: &Options) -> Result<(), TestCaseError> {
    let mut log = match Log::read(bytes, "noise", options) {
        Ok(log) => log,
        Err(error) => {
            let message = error.to_string();
            prop_assert!(message.starts_with("noise") && !message.contains('\n') && message.len() < 1000, "{message}");
            return Ok(());
        }
    };
    let mut kept = 0;
    while let Some(event) = log.next_event() {
        let Ok(event) = event else { continue };
        kept += 1;
        prop_assert!(event.scan.readings.len() == event.scan.bearings_rad.len() && event.scan.pose.x_m.is_finite());
        prop_assert!(log.report().sensors.contains_key(&event.sensor));
    }
    let report = log.report();
    prop_assert_eq!((report.kept, report.kept + report.left_out()), (kept, report.scans));
    Ok(())
}

fn any_scan() -> impl Strategy<Value = Scan> {
    let reading = prop_oneof![
        8 => (0.01..79.0).prop_map(Some),
        1 => Just(Some(f64::INFINITY)),
        1 => Just(None),
    ];
    let pose = (-1e3..1e3, -1e3..1e3, -3.2..3.2).prop_map(|(x_m, y_m, theta_rad)| Pose { x_m, y_m, theta_rad });
    (pose, prop::collection::vec(reading, 2..40), 0.0..1e9).prop_map(|(pose, readings, time_s)| {
        let step = std::f64::consts::PI / (readings.len() - 1) as f64;
        let bearings_rad = (0..readings.len()).map(|k| -std::f64::consts::FRAC_PI_2 + k as f64 * step).collect();
        Scan { sensor: 0, time_s, pose, bearings_rad, readings }
    })
}

proptest! {
    #[test]
    fn what_is_written_comes_back(scans in prop::collection::vec(any_scan(), 1..6), zip in any::<bool>(), robot in any::<bool>()) {
        let text: String = scans.iter().map(|scan| if robot { robot_laser(scan, 80.0) } else { flaser(scan) }).collect();
        let bytes = if zip { gzip(text.as_bytes()) } else { text.into_bytes() };
        let (found, _) = read(bytes, &Options::default()).expect("fine");
        prop_assert_eq!(found.len(), scans.len());
        for (found, scan) in found.iter().zip(&scans) {
            prop_assert_eq!(found.time_s.to_bits(), (scan.time_s - scans[0].time_s).to_bits());
            prop_assert_eq!((found.pose, &found.readings), (scan.pose, &scan.readings));
            let apart = found.bearings_rad.iter().zip(&scan.bearings_rad).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            prop_assert!(apart < 1e-12);
        }
    }

    #[test]
    fn random_bytes_are_read_or_refused_in_one_line(bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
        holds(&bytes, &Options::default())?;
        for start in [&b"FLASER "[..], b"ROBOTLASER1 ", b"RAWLASER1 ", b"SONAR ", b"SONAR 0.5 1 ", b"scan,x_m,y_m,theta_rad,bearing_rad,range_m\n", b"\x1f\x8b\x08\0", b"BZh91AY&SY"] {
            holds(&[start, &bytes].concat(), &Options::default())?;
        }
    }

    #[test]
    fn random_words_are_read_or_refused_in_one_line(words in prop::collection::vec("[0-9]{1,3}|-?[0-9]\\.[0-9]|nan|inf|-inf|FLASER|ROBOTLASER1|RAWLASER1|SONAR|SONAR 0.5 1|SONAR 1 2 3 0 0 0 9 h 9|ODOM|PARAM|\n|4000000000|1e999", 0..120)) {
        holds(words.join(" ").as_bytes(), &Options { damaged_share: 1.0, ..Options::default() })?;
    }

    /// Bytes within some lines are changed, removed or doubled: the other lines all come through, in order.
    #[test]
    fn damage_costs_only_the_lines_that_it_hits(
        hits in prop::collection::vec((0usize..12, any::<prop::sample::Index>(), 0u8..3, any::<u8>()), 0..8),
        robot in any::<bool>(),
    ) {
        let write = |k| if robot { robot_laser(&scan(k), 80.0) } else { flaser(&scan(k)) };
        let mut lines: Vec<Vec<u8>> = (0..12).map(|k| write(k).into_bytes()).collect();
        let mut hit = [false; 12];
        for (line, at, what, byte) in hits {
            hit[line] = true;
            let end = lines[line].len() - 1; // the line end stays
            let at = at.index(end);
            match what {
                0 => lines[line][at] = byte,
                1 if end > 1 => { lines[line].remove(at); }
                _ => lines[line].insert(at, byte),
            }
        }
        let options = Options { damaged_share: 1.0, max_range_m: Some(80.0), ..Options::default() };
        let found = match read(lines.concat(), &options) {
            Ok((found, _)) => found,
            Err(error) => { prop_assert!(hit.iter().all(|hit| *hit), "{error}"); return Ok(()); }
        };
        let mut found = found.iter();
        for k in (0..12).filter(|k| !hit[*k as usize]) {
            let expected = scan(k);
            prop_assert!(found.any(|found| found.pose == expected.pose && found.readings == expected.readings), "line {}", k + 1);
        }
    }
}
