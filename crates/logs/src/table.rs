//! Tables of scans: a row per beam and the names of the columns in the first line.
//!
//! | column | |
//! |---|---|
//! | `scan` | number of the scan, 0 or more |
//! | `time_s` | s; may be missing, then scans are 1 s apart |
//! | `sensor` | number of the sensor, 0 to 255; may be missing, then sensors are told by their poses at one time and number |
//! | `x_m`, `y_m`, `theta_rad` | pose of the sensor |
//! | `bearing_rad` | direction of the beam, -2 pi to 2 pi |
//! | `disparity_px` | of stereo scans, as `room` writes them: no match where it is empty, NaN, 0, negative, infinite or above [`Options::max_disparity_px`] |
//! | `range_m` | of laser scans: nothing usable where it is empty, NaN, 0 or negative; `inf` or the maximum range (80 m by default) where there was no echo |
//! | `sonar_m` | of sonar scans, a row for each cone and the bearing of its axis: as `range_m`, of the nearest thing in the cone; no echo from [`Options::max_sonar_m`] on |
//! | `odom_x_m`, `odom_y_m`, `odom_theta_rad` | pose of the robot by its odometry; may be missing or empty |
//!
//! There is at least one of `disparity_px`, `range_m` and `sonar_m`. In a table with several, each sensor has its readings in one of them; without
//! the column `sensor` the readings of each column are those of a sensor, at the same poses: the camera is number 0. Order is free, upper case is lower case and other columns are ignored. Fields are
//! separated by commas, semicolons (then a comma can be the decimal point), tabs or blanks, whichever the first line has; they are
//! plain numbers, in quotes or not. A line is a row, so that a stray quote costs one row, not the rest of the file. Lines that begin
//! with `#` are comments, unless they name the columns.
//!
//! Rows of the same number, time, pose and sensor are a scan, at most 100,000 of them. Rows of two sensors can take turns. Rows
//! that are sorted in another way, such as by bearing, are put together as long as they are no more than four million.

pub mod features;
mod gather;
mod head;
mod row;

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use sensor::Scan;

use self::gather::{ByColumn, Gather, Group};
use self::head::{Columns, DISPARITY, NAMES, READINGS, SONAR, TIME};
use self::row::Row;
use crate::options::Options;
use crate::ranges::{Rule, check_scale, check_unit, disparity};
use crate::record::{Fault, Parser, Recorded, Sensor};
use crate::report::Report;

pub(crate) use self::head::Head;

/// Rows of a table, gathered into scans.
pub(crate) struct Table {
    columns: Columns,
    rule: Rule,
    /// That of sonars.
    sonar_rule: Rule,
    max_sonar_m: Option<f64>,
    max_disparity_px: Option<f64>,
    gather: Gather,
    /// Number and time of the last complete scan, and how many different ones there were.
    last: Option<(u64, Option<u64>)>,
    begun: u64,
    /// Of every numbered sensor, the column of its readings, by its place in [`READINGS`].
    kinds: BTreeMap<usize, usize>,
}

impl Table {
    /// A table with this first line.
    pub(crate) fn new(head: &[u8], options: &Options) -> Result<Self, String> {
        let rule = Rule::new(options, None);
        Ok(Self {
            columns: Columns::new(head)?,
            rule,
            sonar_rule: Rule { max_m: options.max_sonar_m.unwrap_or(rule.max_m), ..rule },
            max_sonar_m: options.max_sonar_m,
            max_disparity_px: options.max_disparity_px,
            gather: Gather::new(),
            last: None,
            begun: 0,
            kinds: BTreeMap::new(),
        })
    }

    fn finish(&mut self, group: Group) -> Vec<Recorded> {
        if !group.is_at_once_with(self.last) {
            self.last = Some(group.instant());
            self.begun += 1;
        }
        let time_s = if self.timed() { group.scan.time_s } else { (self.begun - 1) as f64 };
        let columns: Vec<usize> = self.columns.readings().collect();
        let read: Vec<usize> = columns.iter().copied().filter(|kind| !group.raw[*kind].is_empty()).collect();
        let is_numbered = group.first.sensor.is_some();
        let kinds = match (&columns[..], &read[..]) {
            (&[only], _) => vec![only],
            // A sensor that says nothing in this scan is of the kind that it was.
            (_, []) if is_numbered => vec![self.kinds.get(&group.sensor).copied().unwrap_or(columns[0])],
            (_, []) => vec![columns[0]],
            (_, read) => read.to_vec(),
        };
        let one_kind = || {
            let before = self.kinds.get(&group.sensor).copied();
            (kinds.len() == 1 && before.is_none_or(|before| before == kinds[0])).then_some(()).ok_or_else(|| {
                let all = kinds.iter().copied().chain(before).map(|kind| NAMES[READINGS[kind]]);
                let all: BTreeSet<&str> = all.collect();
                format!(
                    "sensor {} has readings in {}; give each sensor a number of its own",
                    group.sensor,
                    all.into_iter().collect::<Vec<_>>().join(" and ")
                )
            })
        };
        let fault = if is_numbered { one_kind().err() } else { None };
        if is_numbered && fault.is_none() && !read.is_empty() {
            self.kinds.insert(group.sensor, kinds[0]);
        }
        let number = |kind: usize| match is_numbered || columns.len() == 1 {
            true => group.sensor,
            false => group.sensor * columns.len() + columns.iter().position(|other| *other == kind).unwrap_or(0),
        };
        let recorded = |kind: usize| {
            let readings: Vec<Option<f64>> = group.readings.iter().map(|readings| readings[kind]).collect();
            let mut raw = group.raw[kind].clone();
            let (sensor_kind, unit) = match READINGS[kind] {
                DISPARITY => (Sensor::Stereo, check_scale(&mut raw, self.max_disparity_px)),
                SONAR => (Sensor::Sonar { max_range_m: self.max_sonar_m, width_rad: None }, check_unit(&mut raw)),
                _ => (Sensor::Laser { max_range_m: self.rule.max_m, beams: readings.len() }, check_unit(&mut raw)),
            };
            Recorded {
                scan: Scan { time_s, readings, ..group.scan.clone() },
                odometry: group.first.odometry,
                placed: true,
                unit: fault.clone().map_or(unit, Err),
                number: Some(group.first.number),
                ..Recorded::of(number(kind), sensor_kind, group.line)
            }
        };
        // What is refused as a whole is so once.
        let given = if fault.is_some() { 1 } else { kinds.len() };
        kinds[..given].iter().map(|kind| recorded(*kind)).collect()
    }

    /// What the readings of a row say, by their columns.
    fn readings(&self, row: &Row, report: &mut Report) -> ByColumn<Option<f64>> {
        let mut readings = [None; READINGS.len()];
        for kind in self.columns.readings() {
            readings[kind] = match READINGS[kind] {
                DISPARITY => disparity(row.raw[kind], self.max_disparity_px, &mut report.codes),
                SONAR => row.raw[kind].and_then(|range| self.sonar_rule.reading(range)),
                _ => row.raw[kind].and_then(|range| self.rule.reading(range)),
            };
        }
        readings
    }
}

impl Parser for Table {
    fn line(&mut self, text: &[u8], line: u64, report: &mut Report, out: &mut VecDeque<Recorded>) -> Result<(), Fault> {
        if text.trim_ascii_start().starts_with(b"#") {
            report.skip("#");
            return Ok(());
        }
        let row = Row::read(text, &self.columns)?;
        let readings = self.readings(&row, report);
        let mut complete = Vec::new();
        let outcome = self.gather.add(&row, readings, line, &mut complete);
        out.extend(complete.into_iter().flat_map(|group| self.finish(group)));
        outcome
    }

    fn end(&mut self, report: &mut Report, out: &mut VecDeque<Recorded>) {
        let mut complete = Vec::new();
        self.gather.end(report, &mut complete);
        out.extend(complete.into_iter().flat_map(|group| self.finish(group)));
    }

    fn timed(&self) -> bool {
        self.columns.place(TIME).is_some()
    }
}

#[cfg(test)]
mod tests {
    use sensor::Pose;

    use super::gather::MOST_BEAMS;
    use super::*;

    const HEAD: &str = "scan,x_m,y_m,theta_rad,bearing_rad,range_m";

    fn table(head: &str) -> Table {
        Table::new(head.as_bytes(), &Options::default()).expect(head)
    }

    /// All scans of rows that must be fine, and what is to be said of them.
    fn scans(head: &str, rows: &[String]) -> (Vec<Recorded>, Report) {
        let (mut table, mut out, mut report) = (table(head), VecDeque::new(), Report::default());
        for (row, line) in rows.iter().zip(2..) {
            table.line(row.as_bytes(), line, &mut report, &mut out).expect(row);
        }
        table.end(&mut report, &mut out);
        (out.into(), report)
    }

    fn rows(rows: &[&str]) -> Vec<String> {
        rows.iter().map(|row| (*row).to_owned()).collect()
    }

    #[test]
    fn rows_of_one_number_and_pose_are_a_laser_scan() {
        let rows = rows(&[
            "0,1,2,0.5,-0.1,4",
            "0,1,2,0.5,0,inf",
            "0,1,2,0.5,0.1,",
            "0,1,2.5,0.5,0,90",
            "7,1,2.5,0.5,0,\"-1\"",
        ]);
        let (all, _) = scans(HEAD, &rows);
        let readings: Vec<_> = all.iter().map(|recorded| recorded.scan.readings.clone()).collect();
        assert_eq!(readings, [vec![Some(4.0), Some(f64::INFINITY), None], vec![Some(f64::INFINITY)], vec![None]]);
        assert_eq!(all[0].scan.bearings_rad, [-0.1, 0.0, 0.1]);
        assert_eq!(all[1].scan.pose, Pose { x_m: 1.0, y_m: 2.5, theta_rad: 0.5 });
        assert_eq!(all[0].kind, Sensor::Laser { max_range_m: 80.0, beams: 3 });
        // Of one number, and so of one time: two sensors.
        assert_eq!(all.iter().map(|recorded| recorded.scan.time_s).collect::<Vec<_>>(), [0.0, 0.0, 1.0]);
        assert_eq!(
            all.iter().map(|recorded| (recorded.sensor, recorded.line)).collect::<Vec<_>>(),
            [(0, 2), (1, 5), (0, 6)]
        );
    }

    #[test]
    fn the_projects_own_table_is_a_stereo_scan() {
        let head = "scan,time_s,x_m,y_m,theta_rad,bearing_rad,disparity_px,true_range_m";
        let rows = rows(&["0,0.5,1,2,0,-0.1,12.5,1.2", "0,0.5,1,2,0,0.1,,", "0,0.5,1,2,0,0.2,100,0.2"]);
        let (all, _) = scans(head, &rows);
        assert_eq!((all.len(), all[0].kind, all[0].scan.time_s), (1, Sensor::Stereo, 0.5));
        assert_eq!(all[0].scan.readings, [Some(12.5), None, Some(100.0)], "no range, so no maximum");
    }

    const BOTH: &str = "scan,time_s,x_m,y_m,theta_rad,bearing_rad,disparity_px,range_m";

    #[test]
    fn columns_of_two_kinds_are_two_sensors() {
        let lines = rows(&["0,0.5,1,2,0,-0.1,12.5,1.2", "0,0.5,1,2,0,0.1,,inf", "1,1.0,1,2,0,0,7,"]);
        let (all, report) = scans(BOTH, &lines);
        let found: Vec<_> = all.iter().map(|r| (r.sensor, r.kind, r.scan.readings.clone())).collect();
        let laser = |beams| Sensor::Laser { max_range_m: 80.0, beams };
        assert_eq!(
            found,
            [
                (0, Sensor::Stereo, vec![Some(12.5), None]),
                (1, laser(2), vec![Some(1.2), Some(f64::INFINITY)]),
                (0, Sensor::Stereo, vec![Some(7.0)]),
            ]
        );
        assert!(all[0].scan.is_with(&Scan { sensor: 1, ..all[1].scan.clone() }) && report.noted.is_empty());
        assert_eq!(all[0].scan.bearings_rad, all[1].scan.bearings_rad);
    }

    #[test]
    fn numbered_sensors_have_one_kind_each() {
        let head = format!("{BOTH},sonar_m,sensor");
        let lines = rows(&[
            "0,0,0,0,0,0,,,2.5,7",
            "0,0,0,0,0,0,4.0,,,0",
            "0,0,0,0,0,0.1,,,,0",
            "0,0,0.1,0,0,0.1,,3,,2",
            "1,1,0,0,0,0,,,,7",
            "1,1,0,0,0,0,,1.5,,0",
            "1,1,0.1,0,0,0,5,1.5,,3",
        ]);
        let (mut table, mut out, mut report) = (table(&head), VecDeque::new(), Report::default());
        for (row, line) in lines.iter().zip(2..) {
            table.line(row.as_bytes(), line, &mut report, &mut out).expect(row);
        }
        table.end(&mut report, &mut out);
        let found: Vec<_> = out.iter().map(|r| (r.sensor, r.kind, r.unit.is_ok())).collect();
        let laser = Sensor::Laser { max_range_m: 80.0, beams: 1 };
        let sonar = Sensor::Sonar { max_range_m: None, width_rad: None };
        assert_eq!(found[..4], [(7, sonar, true), (0, Sensor::Stereo, true), (2, laser, true), (7, sonar, true)]);
        let refused: Vec<&str> = out.iter().filter_map(|r| r.unit.as_ref().err().map(String::as_str)).collect();
        let expected = |sensor: usize| {
            format!("sensor {sensor} has readings in disparity_px and range_m; give each sensor a number of its own")
        };
        assert_eq!(refused, [expected(0), expected(3)]);
    }

    /// Rows of two lasers, 20 scans each of 5 beams: number, sensor, beam.
    fn two_lasers() -> Vec<[usize; 3]> {
        let mut all = Vec::new();
        for scan in 0..20 {
            for sensor in 0..2 {
                all.extend((0..5).map(|beam| [scan, sensor, beam]));
            }
        }
        all
    }

    fn text([scan, sensor, beam]: [usize; 3], sensors: bool) -> String {
        let (x, theta) = (scan as f64 + if sensor == 0 { 0.3 } else { -0.3 }, 3.0 * sensor as f64);
        let column = if sensors { format!(",{}", 7 * sensor) } else { String::new() };
        format!("{scan},{},{x},0,{theta},{},{}{column}", 0.5 * scan as f64, 0.1 * beam as f64, 1.0 + beam as f64)
    }

    #[test]
    fn however_rows_are_sorted_the_scans_are_the_same() {
        let head = |sensors: bool| {
            format!("scan,time_s,x_m,y_m,theta_rad,bearing_rad,range_m{}", if sensors { ",sensor" } else { "" })
        };
        let read = |order: &[[usize; 3]], sensors: bool| {
            let lines: Vec<_> = order.iter().map(|row| text(*row, sensors)).collect();
            let (mut all, report) = scans(&head(sensors), &lines);
            all.sort_by_key(|recorded| (recorded.number, recorded.sensor));
            let found: Vec<_> =
                all.into_iter().map(|recorded| (recorded.number, recorded.sensor, recorded.scan)).collect();
            (found, report.noted.len())
        };
        let blocks = two_lasers();
        let (expected, notes) = read(&blocks, false);
        assert_eq!((expected.len(), notes), (40, 0));
        assert!(expected.iter().all(|(.., scan)| scan.readings.len() == 5));
        let mut turns = blocks.clone();
        turns.sort_by_key(|[scan, sensor, beam]| (*scan, *beam, *sensor));
        let mut whole_runs = blocks.clone();
        whole_runs.sort_by_key(|[scan, sensor, beam]| (*sensor, *scan, *beam));
        let mut by_bearing = blocks.clone();
        by_bearing.sort_by_key(|[scan, sensor, beam]| (*beam, *scan, *sensor));
        let mut shuffled = blocks.clone();
        shuffled
            .sort_by_key(|[scan, sensor, beam]| ((scan * 31 + sensor * 17 + beam * 7) % 101, *scan, *sensor, *beam));
        for (order, sensors, notes) in [
            (&turns, false, 0),
            (&turns, true, 0),
            (&whole_runs, true, 0),
            (&by_bearing, false, 1),
            (&by_bearing, true, 1),
            (&shuffled, true, 1),
        ] {
            let expected: Vec<_> = expected
                .iter()
                .map(|(number, sensor, scan)| (*number, if sensors { 7 * sensor } else { *sensor }, scan.clone()))
                .collect();
            assert_eq!(read(order, sensors), (expected, notes));
        }
    }

    #[test]
    fn rows_that_stand_apart_are_said() {
        let mut lines: Vec<_> = two_lasers().into_iter().map(|row| text(row, true)).collect();
        let apart = lines.remove(100);
        lines.insert(129, apart);
        let head = "scan,time_s,x_m,y_m,theta_rad,bearing_rad,range_m,sensor";
        let (all, report) = scans(head, &lines);
        assert_eq!(all.len(), 41);
        assert!(matches!(report.noted[..], [crate::Finding::Split { count: 1, line: 131 }]), "{:?}", report.noted);
    }

    #[test]
    fn a_sensor_of_one_beam_is_one() {
        let lines: Vec<_> = (0..50).map(|k| format!("{k},{k},0,0,0,2.5")).collect();
        let (all, report) = scans(HEAD, &lines);
        assert_eq!((all.len(), report.noted.len()), (50, 0));
        assert!(all.iter().zip(0..).all(|(recorded, k)| recorded.scan.time_s.total_cmp(&f64::from(k)).is_eq()));
    }

    #[test]
    fn a_scan_has_a_bound() {
        let (mut table, mut out) = (table(HEAD), VecDeque::new());
        let mut add = || table.line(b"0,1,2,0.5,0,4", 2, &mut Report::default(), &mut out);
        for _ in 0..MOST_BEAMS {
            assert_eq!(add(), Ok(()));
        }
        assert!(matches!(add(), Err(Fault::Damage(reason)) if reason.contains("more than 100000 rows")));
    }
}
