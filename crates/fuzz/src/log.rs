//! CARMEN logs and tables of scans, plain, gzip and bzip2.

use std::collections::HashSet;
use std::f64::consts::FRAC_PI_2;
use std::io::Write as _;
use std::mem::discriminant;

use flate2::Compression;
use flate2::write::GzEncoder;
use logs::{Log, LogError, Options, Report, Sensor};
use sensor::Scan;

use crate::message;

pub(crate) const PLACE: &str = "a.log";

/// Every member of a gzip file begins so.
const MAGIC: [u8; 2] = [0x1f, 0x8b];

/// A CARMEN log. Every line is a scan, or one of each of its sonars, skipped or damaged; scans are as [`read`] has them.
pub fn carmen(data: &[u8]) {
    let open = |options: &Options| Log::carmen(data, PLACE, options);
    let Some(found) = both_ways(open) else { return };
    let Report { lines, damaged, skipped, sensors, .. } = &found.report;
    // Every line of sonars has one of the first of them.
    let first = sensors.iter().filter(|(number, _)| found.report.array_of(**number) == **number);
    let of_scans: u64 = first.map(|(_, sensor)| sensor.scans).sum();
    assert_eq!(*lines, of_scans + damaged + skipped.values().sum::<u64>(), "{:?}", found.report);
}

/// A table of scans, and of features. A row is a beam of each kind of sensor that the table has a column of, damaged, or of a scan that is.
pub fn table(data: &[u8]) {
    features(data);
    let open = |options: &Options| Log::table(data, PLACE, options);
    let Some(found) = both_ways(open) else { return };
    let Report { lines, beams, damaged, skipped, sensors, .. } = &found.report;
    let skipped = skipped.values().sum::<u64>();
    let kinds: HashSet<_> = sensors.values().map(|sensor| sensor.kind.map(|kind| discriminant(&kind))).collect();
    let rows = lines.checked_sub(1 + damaged + skipped).expect("a head, and every line once");
    assert!(*beams <= rows * kinds.len() as u64, "{:?}", found.report);
}

/// A table of features: times rise, and whatever is read is a number within its bounds.
fn features(data: &[u8]) {
    let rows = match logs::table::features::read(data, PLACE) {
        Ok(rows) => rows,
        Err(error) => return message::check(&error, PLACE),
    };
    for pair in rows.windows(2) {
        assert!(pair[0].scan.time_s <= pair[1].scan.time_s && pair[0].line < pair[1].line);
    }
    for row in &rows {
        assert_eq!(row.scan.readings.len(), row.matched.len());
        assert!(row.scan.time_s.is_finite());
        for reading in &row.scan.readings {
            assert!(reading.bearing_rad.abs() <= FRAC_PI_2 && reading.disparity_px.is_finite());
        }
        for pose in [row.scan.pose, row.scan.odometry].into_iter().flatten() {
            assert!([pose.x_m, pose.y_m, pose.theta_rad].iter().all(|value| value.is_finite()));
        }
    }
}

/// A compressed log as it stands; or any text, which read through gzip must be what it is without, and cut a part of it.
pub fn gzip(data: &[u8]) {
    let options = Options { damaged_share: 1.0, ..Options::default() };
    if data.starts_with(&MAGIC) || data.starts_with(b"BZh") {
        read(Log::read(data, PLACE, &options));
        return;
    }
    let Some((place, text)) = data.split_first_chunk() else { return };
    if text.starts_with(&MAGIC) || text.starts_with(b"BZh") {
        return; // is no plain text
    }
    let place = usize::from(u16::from_le_bytes(*place));
    // Two members, as where one log was appended to another.
    let (first, second) = text.split_at(place % (text.len() + 1));
    let whole = [packed(first), packed(second)].concat();
    let plain = read(Log::read(text, PLACE, &options));
    let compressed = read(Log::read(whole.as_slice(), PLACE, &options));
    assert_eq!(plain, compressed);
    let cut = read(Log::read(&whole[..place % whole.len()], PLACE, &options));
    if let (Some(plain), Some(cut)) = (plain, cut) {
        // The last line, and with it the last scan, can be cut too. Of a table whose scans are spread over it, any scan can be cut,
        // and they are put in order.
        let sure = cut.scans.len().saturating_sub(1);
        for scan in &cut.scans[..sure] {
            assert!(plain.scans.iter().any(|whole| is_part(scan, whole)), "{scan:?} is no part of {:?}", plain.scans);
        }
    }
}

/// Whether a scan is from the same place as another, and has no beam beside those of the other.
fn is_part(part: &Scan, whole: &Scan) -> bool {
    let beams = |scan: &Scan| -> Vec<String> {
        scan.bearings_rad.iter().zip(&scan.readings).map(|beam| format!("{beam:?}")).collect()
    };
    let mut left = beams(whole);
    let taken = |beam: &String| left.iter().position(|other| other == beam).map(|at| left.swap_remove(at)).is_some();
    part.pose == whole.pose && beams(part).iter().all(taken)
}

fn packed(text: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(text).expect("memory can be written");
    encoder.finish().expect("memory can be written")
}

/// What was read of a log that has a scan.
#[derive(Debug, PartialEq)]
pub(crate) struct Found {
    scans: Vec<Scan>,
    pub(crate) report: Report,
    whole: bool,
}

/// All scans, and then every second one; what several sensors read at one time is one.
fn both_ways<'a>(open: impl Fn(&Options) -> Result<Log<'a>, LogError>) -> Option<Found> {
    let all = read(open(&Options::default()))?;
    let half = read(open(&Options { every: 2, damaged_share: 1.0, ..Options::default() }))?;
    let second = all.scans.chunk_by(Scan::is_with).step_by(2).flatten();
    assert!(half.scans.iter().eq(second), "{half:?} are not every second of {all:?}");
    assert_eq!(half.report.kept + half.report.thinned, all.report.kept);
    Some(all)
}

/// Reads to the end; every number must be one, and the report must add up.
pub(crate) fn read(log: Result<Log<'_>, LogError>) -> Option<Found> {
    let mut log = log.inspect_err(|error| message::check(error, PLACE)).ok()?;
    let mut scans: Vec<Scan> = Vec::new();
    let mut whole = true;
    for scan in &mut log {
        match scan {
            Ok(scan) => scans.push(scan),
            Err(error) => {
                message::check(&error, PLACE);
                whole = false;
            }
        }
    }
    assert!(log.next().is_none(), "goes on after its end");
    let report = log.report().clone();
    let dropped = report.left_out();
    assert_eq!((report.kept, report.kept + dropped), (scans.len() as u64, report.scans));
    assert!(report.scans > 0 && report.damaged <= report.lines && report.problems.len() <= 20, "{report:?}");
    report.problems.iter().for_each(|problem| message::line(&problem.reason));
    report.findings().iter().for_each(|finding| message::line(&finding.text(report.unit)));
    let counted = [report.beams, report.unusable, report.no_returns];
    let readings = || scans.iter().flat_map(|scan| &scan.readings);
    let count = |wanted: fn(&Option<f64>) -> bool| readings().filter(|reading| wanted(reading)).count() as u64;
    if dropped == 0 {
        assert_eq!(counted, [count(|_| true), count(Option::is_none), count(|r| *r == Some(f64::INFINITY))]);
    }
    for scan in &scans {
        assert!(!scan.readings.is_empty() && scan.readings.len() == scan.bearings_rad.len());
        let numbers = [scan.time_s, scan.pose.x_m, scan.pose.y_m, scan.pose.theta_rad];
        assert!(numbers.iter().chain(&scan.bearings_rad).all(|v| v.is_finite()), "{scan:?}");
        let kind = report.sensors.get(&scan.sensor).and_then(|sensor| sensor.kind);
        let fine = |reading: f64| match kind.expect("a scan's sensor is in the report") {
            Sensor::Laser { .. } | Sensor::Sonar { .. } => reading > 0.0,
            Sensor::Stereo => reading > 0.0 && reading.is_finite(),
        };
        assert!(scan.readings.iter().flatten().all(|reading| fine(*reading)), "{scan:?}");
    }
    assert!(!report.to_string().is_empty());
    Some(Found { scans, report, whole })
}
