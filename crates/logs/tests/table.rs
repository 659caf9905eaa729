//! Tables of scans as a whole.

use crate::writer;
use logs::{Body, Log, LogError, Options, Report, Sensor, Trajectory};
use proptest::prelude::*;
use sensor::{Pose, Scan};

fn read(text: impl AsRef<[u8]>, options: &Options) -> Result<(Vec<Scan>, Report, Sensor), LogError> {
    let mut log = Log::read(text.as_ref(), "a.csv", options)?;
    let scans = log.by_ref().collect::<Result<Vec<_>, _>>()?;
    Ok((scans, log.report().clone(), log.sensor()))
}

const STEREO: &str = "scan,time_s,x_m,y_m,theta_rad,bearing_rad,disparity_px,true_range_m";
const LASER: &str = "scan,x_m,y_m,theta_rad,bearing_rad,range_m";

fn number(reading: Option<f64>) -> String {
    reading.map(|value| value.to_string()).unwrap_or_default()
}

/// The project's own table, as `room` writes it.
fn stereo(scans: &[Scan]) -> String {
    let mut text = format!("{STEREO}\n");
    for (k, scan) in scans.iter().enumerate() {
        let pose = scan.pose;
        for (bearing, reading) in scan.bearings_rad.iter().zip(&scan.readings) {
            let (x, y, theta, reading) = (pose.x_m, pose.y_m, pose.theta_rad, number(*reading));
            text += &format!("{k},{},{x},{y},{theta},{bearing},{reading},2.5\n", scan.time_s);
        }
    }
    text
}

fn drive() -> Vec<Scan> {
    let scan = |k: u32| Scan {
        sensor: 0,
        time_s: 5.0 + f64::from(k),
        pose: Pose { x_m: f64::from(k), y_m: 0.5, theta_rad: 0.25 },
        bearings_rad: vec![-0.5, 0.0, 0.5],
        readings: vec![Some(12.0 + f64::from(k)), None, Some(0.25)],
    };
    (0..20).map(scan).collect()
}

#[test]
fn stereo_scans() {
    let (scans, report, sensor) = read(stereo(&drive()), &Options::default()).expect("fine");
    let expected: Vec<_> = drive().into_iter().map(|scan| Scan { time_s: scan.time_s - 5.0, ..scan }).collect();
    assert_eq!((scans, sensor), (expected, Sensor::Stereo));
    assert_eq!((report.lines, report.scans, report.beams, report.unusable, report.damaged), (61, 20, 60, 20, 0));
    assert_eq!(report.suspected_max_range_m(), None);
    let zipped = writer::gzip(stereo(&drive()).replace('\n', "\r").as_bytes());
    assert_eq!(read(zipped, &Options::default()).expect("fine").1, report);
}

#[test]
fn laser_scans() {
    let text = format!("{LASER}\n0,0,0,0,-0.1,2.5\n0,0,0,0,0,inf\n0,0,0,0,0.1,\n1,0,0,0,0,9\n");
    let (scans, report, sensor) = read(&text, &Options { max_range_m: Some(8.0), ..Options::default() }).expect("fine");
    assert_eq!(scans[0].readings, [Some(2.5), Some(f64::INFINITY), None]);
    assert_eq!((scans[1].readings.as_slice(), scans[1].time_s), (&[Some(f64::INFINITY)][..], 1.0));
    assert_eq!(sensor, Sensor::Laser { max_range_m: 8.0, beams: 3 });
    assert_eq!((report.no_returns, report.unusable), (2, 1));

    let trajectory = Trajectory::read(&b"0 0 0 0 0 0 0 1"[..], "a.tum").expect("fine");
    let refused =
        Log::read(text.as_bytes(), "a.csv", &Options::default()).expect("fine").along(trajectory, Body::Sensor);
    assert!(refused.err().expect("untimed").to_string().contains("has no column time_s"));
}

#[test]
fn a_trajectory_gives_the_poses_of_a_timed_table() {
    let trajectory =
        Trajectory::read(&b"6 3 4 0 0 0 0 1\n7 4 4 0 0 0 0 1\n8 5 4 0 0 0 0 1"[..], "a.tum").expect("fine");
    let text = stereo(&drive());
    let mut log = Log::table(text.as_bytes(), "a.csv", &Options::default()).expect("fine");
    log = log.along(trajectory, Body::Robot).expect("timed");
    let places: Vec<_> = log.by_ref().map(|scan| scan.expect("fine").pose.position_m()).collect();
    assert_eq!(places, [[3.0, 4.0], [4.0, 4.0], [5.0, 4.0]]);
    assert_eq!(log.report().outside_trajectory, 17);
}

#[test]
fn damage_costs_a_beam_and_units_cost_the_scan() {
    let mut lines: Vec<_> = stereo(&drive()).lines().map(str::to_owned).collect();
    lines[2] = "\"0,5,0".to_owned(); // a quote that is never closed
    let (scans, report, _) = read(lines.join("\n"), &Options::default()).expect("one line");
    assert_eq!((scans.len(), scans[0].readings.len(), report.damaged, report.problems[0].line), (20, 2, 1, 3));

    let far: String = (0..3).map(|k| format!("0,0,0,0,0.{k},{}\n", 1500 + k)).collect();
    let near = far.replace("0,0,0,0,0", "1,0,0,0,0").replace(",150", ",1.5");
    let (scans, report, _) = read(format!("{LASER}\n{far}{near}"), &Options::default()).expect("one scan");
    assert_eq!((scans.len(), report.damaged, report.problems[0].line), (1, 1, 2));
    let message = read(format!("{LASER}\n{far}"), &Options::default()).expect_err("mm").to_string();
    assert!(message.contains("line 2: the median of 2 ranges is 1501"), "{message}");
}

#[test]
fn a_scan_that_is_wrong_in_two_ways_is_damaged_once() {
    let head = "scan,time_s,x_m,y_m,theta_rad,bearing_rad,disparity_px,range_m";
    let rows: String = (0..3).map(|k| format!("0,0,0,0,0,0.{k},90{k},150{k}\n1,1,0,0,0,0.{k},9,2\n")).collect();
    let options = Options { max_disparity_px: Some(128.0), ..Options::default() };
    let (scans, report, _) = read(format!("{head}\n{rows}"), &options).expect("the second scan");
    assert_eq!((scans.len(), report.scans, report.damaged, report.problems.len()), (2, 2, 1, 2), "{report}");
}

#[test]
fn a_wrong_head_is_refused_with_its_line() {
    let message = read("\nscan,x_m,y_m,theta_rad,range_m\n", &Options::default()).expect_err("head").to_string();
    assert!(message.starts_with("a.csv:2: column bearing_rad: is missing"), "{message}");
    let no_table = Log::table(&b"FLASER 1 2"[..], "a", &Options::default()).err().expect("a log").to_string();
    assert!(no_table.starts_with("a:1: columns scan, x_m, y_m, theta_rad, bearing_rad: are missing"), "{no_table}");
    let empty = read(format!("{LASER}\n"), &Options::default()).expect_err("no rows").to_string();
    assert!(empty.contains("no scan in 1 lines"), "{empty}");
}

#[test]
fn scans_out_of_order_are_reported() {
    let rows = [0, 1, 2, 3, 5, 4, 6].map(|k| format!("{k},0,0,0,0,1\n{k},0,0,0,0.1,1\n"));
    let (scans, report, _) = read(format!("{LASER}\n{}", rows.concat()), &Options::default()).expect("fine");
    assert_eq!((scans.len(), report.steps_back), (7, 1));
}

#[test]
fn a_compressed_table_that_is_cut_gives_the_rows_before() {
    let whole = writer::gzip(stereo(&drive()).as_bytes());
    let mut log = Log::read(&whole[..whole.len() - 3], "a.csv.gz", &Options::default()).expect("begins well");
    let given: Vec<_> = log.by_ref().collect();
    assert_eq!(given.iter().filter(|scan| scan.is_ok()).count(), 20);
    assert!(matches!(given.last(), Some(Err(LogError::Interrupted { line: 61, .. }))), "{:?}", given.last());
}

proptest! {
    /// Bytes within some rows change: the beams of the others all come through, in order.
    #[test]
    fn damage_costs_only_the_rows_that_it_hits(
        hits in prop::collection::vec((1usize..61, any::<prop::sample::Index>(), any::<u8>()), 0..8),
    ) {
        let mut lines: Vec<Vec<u8>> = stereo(&drive()).lines().map(|line| line.as_bytes().to_vec()).collect();
        let mut hit = [false; 61];
        for (line, at, byte) in hits {
            let at = at.index(lines[line].len());
            lines[line][at] = byte;
            hit[line] = true;
        }
        let (found, ..) = read(lines.join(&b'\n'), &Options { damaged_share: 1.0, ..Options::default() }).expect("rows are left");
        let mut found = found.iter().flat_map(Scan::rays).map(|ray| (ray.origin_m, ray.bearing_rad.to_bits(), ray.reading));
        let expected = drive();
        let expected = expected.iter().flat_map(Scan::rays).map(|ray| (ray.origin_m, ray.bearing_rad.to_bits(), ray.reading));
        for (row, ray) in expected.enumerate().filter(|(row, _)| !hit[row + 1]) {
            prop_assert!(found.any(|found| found == ray), "row {row}");
        }
    }
}
