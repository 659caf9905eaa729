//! Tables of scans: CSV with a row per beam and the names of the columns in the first line.
//!
//! | column | |
//! |---|---|
//! | `scan` | number of the scan, 0 or more |
//! | `time_s` | s; may be missing, then scans are 1 s apart |
//! | `x_m`, `y_m`, `theta_rad` | pose of the sensor |
//! | `bearing_rad` | direction of the beam, -2 pi to 2 pi |
//! | `disparity_px` | of stereo scans, as `room` writes them: empty where nothing matched |
//! | `range_m` | of laser scans: empty where nothing usable, `inf` or the maximum range (80 m by default) where there was no echo |
//!
//! There is one of the last two. Order is free and other columns are ignored. Rows that follow each other with the same number and
//! the same pose are a scan, at most 100,000 of them. Fields are plain numbers, in quotes or not; a line is a row, so that a
//! stray quote costs one row, not the rest of the file.

use std::f64::consts::TAU;

use sensor::{Pose, Scan};

use crate::carmen::{FAR_M, LATE_S, WOUND_RAD};
use crate::fields::{number, quoted};
use crate::options::Options;
use crate::ranges::{Rule, check_unit};
use crate::record::{Parser, Recorded, Sensor};
use crate::report::Report;

/// A scan of more beams is taken for a mistake.
const MOST_BEAMS: usize = 100_000;

const NAMES: [&str; 8] = ["scan", "time_s", "x_m", "y_m", "theta_rad", "bearing_rad", "disparity_px", "range_m"];
// Where each stands in NAMES.
const SCAN: usize = 0;
const TIME: usize = 1;
const X: usize = 2;
const Y: usize = 3;
const THETA: usize = 4;
const BEARING: usize = 5;
const DISPARITY: usize = 6;
const RANGE: usize = 7;

/// Rows of a table, gathered into scans.
pub(crate) struct Table {
    columns: [Option<usize>; NAMES.len()],
    width: usize,
    rule: Rule,
    /// The scan that is not complete yet.
    open: Option<Open>,
    begun: u64,
}

struct Open {
    number: u64,
    line: u64,
    scan: Scan,
    raw: Vec<f64>,
}

/// Whether a first line is that of a table at all.
pub(crate) fn is_head(line: &[u8]) -> bool {
    let names = cells(line).into_iter();
    names.filter(|name| NAMES.iter().any(|known| known.as_bytes() == *name)).count() >= 2
}

impl Table {
    /// A table with this first line.
    pub(crate) fn new(head: &[u8], options: &Options) -> Result<Self, String> {
        let names = cells(head);
        let mut columns = [None; NAMES.len()];
        for (column, name) in columns.iter_mut().zip(NAMES) {
            let mut found = (0..names.len()).filter(|k| names[*k] == name.as_bytes());
            *column = found.next();
            if found.next().is_some() {
                return Err(format!("column {name}: is there twice; name each column once"));
            }
        }
        let must = [SCAN, X, Y, THETA, BEARING];
        if let Some(missing) = must.into_iter().find(|k| columns[*k].is_none()) {
            let all = must.map(|k| NAMES[k]).join(",");
            return Err(format!("column {}: is missing; the first line must have {all}", NAMES[missing]));
        }
        if columns[DISPARITY].is_some() == columns[RANGE].is_some() {
            let found = if columns[RANGE].is_some() { "both are there" } else { "both are missing" };
            return Err(format!("columns disparity_px and range_m: {found}; give one of them"));
        }
        Ok(Self { columns, width: names.len(), rule: Rule::new(options, None), open: None, begun: 0 })
    }

    fn finish(&self, open: Open) -> Recorded {
        let Open { number, line, scan, mut raw } = open;
        let (sensor, unit) = match self.columns[RANGE] {
            Some(_) => {
                let sensor = Sensor::Laser { max_range_m: self.rule.max_m, beams: scan.readings.len() };
                (sensor, check_unit(&mut raw))
            }
            None => (Sensor::Stereo, Ok(())),
        };
        Recorded { scan, sensor, mount: Pose::default(), line, unit, number: Some(number) }
    }
}

impl Parser for Table {
    fn line(&mut self, text: &[u8], line: u64, _report: &mut Report) -> Result<Option<Recorded>, String> {
        let cells = cells(text);
        if cells.len() != self.width {
            return Err(format!("{} fields; must be {}, as in the first line", cells.len(), self.width));
        }
        let row = Row { cells: &cells, columns: &self.columns };
        let scan_number = row.scan_number()?;
        let pose =
            Pose { x_m: row.number(X, FAR_M)?, y_m: row.number(Y, FAR_M)?, theta_rad: row.number(THETA, WOUND_RAD)? };
        let time_s = if self.timed() { Some(row.number(TIME, LATE_S)?) } else { None };
        let bearing_rad = row.number(BEARING, TAU + 1e-4)?;
        let raw = row.reading(if self.columns[RANGE].is_some() { RANGE } else { DISPARITY })?;
        let reading = match self.columns[RANGE] {
            Some(_) => raw.and_then(|range| self.rule.reading(range)),
            None => raw.filter(|disparity| disparity.is_finite() && *disparity >= 0.0),
        };
        let goes_on = self.open.as_ref().is_some_and(|open| open.number == scan_number && open.scan.pose == pose);
        let complete = if goes_on { None } else { self.open.take().map(|open| self.finish(open)) };
        let open = self.open.get_or_insert_with(|| {
            let time_s = time_s.unwrap_or(self.begun as f64);
            self.begun += 1;
            Open { number: scan_number, line, scan: Scan { time_s, pose, ..Scan::default() }, raw: Vec::new() }
        });
        if open.scan.readings.len() == MOST_BEAMS {
            return Err(format!(
                "scan {scan_number} has more than {MOST_BEAMS} rows; give its other beams another number"
            ));
        }
        open.scan.bearings_rad.push(bearing_rad);
        open.scan.readings.push(reading);
        open.raw.extend(raw);
        Ok(complete)
    }

    fn end(&mut self) -> Option<Recorded> {
        self.open.take().map(|open| self.finish(open))
    }

    fn timed(&self) -> bool {
        self.columns[TIME].is_some()
    }
}

struct Row<'a> {
    cells: &'a [&'a [u8]],
    columns: &'a [Option<usize>; NAMES.len()],
}

impl Row<'_> {
    fn cell(&self, name: usize) -> &[u8] {
        self.columns[name].and_then(|column| self.cells.get(column)).copied().unwrap_or_default()
    }

    fn scan_number(&self) -> Result<u64, String> {
        let cell = self.cell(SCAN);
        let found = std::str::from_utf8(cell).ok().and_then(|text| text.parse().ok());
        found.ok_or_else(|| format!("column scan: {} must be a whole number, 0 or more", quoted(cell)))
    }

    fn number(&self, name: usize, most: f64) -> Result<f64, String> {
        let cell = self.cell(name);
        let found = number(cell).filter(|value| value.abs() <= most);
        found.ok_or_else(|| {
            format!("column {}: {} must be a number from {:e} to {most:e}", NAMES[name], quoted(cell), -most)
        })
    }

    /// None where the field is empty.
    fn reading(&self, name: usize) -> Result<Option<f64>, String> {
        let cell = self.cell(name);
        if cell.is_empty() {
            return Ok(None);
        }
        let found = number(cell).map(Some);
        found.ok_or_else(|| format!("column {}: {} must be a number or empty", NAMES[name], quoted(cell)))
    }
}

/// The fields of a row without blanks and quotes around them.
fn cells(line: &[u8]) -> Vec<&[u8]> {
    let cells = line.split(|byte| *byte == b',').map(<[u8]>::trim_ascii);
    cells.map(|cell| cell.strip_prefix(b"\"").and_then(|cell| cell.strip_suffix(b"\"")).unwrap_or(cell)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "scan,x_m,y_m,theta_rad,bearing_rad,range_m";

    fn table(head: &str) -> Result<Table, String> {
        Table::new(head.as_bytes(), &Options::default())
    }

    /// All scans of rows that must be fine.
    fn scans(head: &str, rows: &[&str]) -> Vec<Recorded> {
        let mut table = table(head).expect(head);
        let mut all = Vec::new();
        for (row, line) in rows.iter().zip(2..) {
            all.extend(table.line(row.as_bytes(), line, &mut Report::default()).expect(row));
        }
        all.extend(table.end());
        all
    }

    #[test]
    fn heads_are_told_from_messages() {
        for (line, head) in [(HEAD, true), ("\"scan\" , range_m", true), ("# scan,range", false), ("FLASER 1 2", false)]
        {
            assert_eq!(is_head(line.as_bytes()), head, "{line}");
        }
    }

    #[test]
    fn a_head_names_each_column_once_and_one_reading() {
        for (head, message) in [
            ("scan,x_m,y_m,theta_rad,range_m", "column bearing_rad: is missing"),
            ("scan,x_m,y_m,theta_rad,bearing_rad", "columns disparity_px and range_m: both are missing"),
            (&format!("{HEAD},disparity_px"), "columns disparity_px and range_m: both are there"),
            (&format!("{HEAD},x_m"), "column x_m: is there twice"),
        ] {
            let found = table(head).err().unwrap_or_default();
            assert!(found.contains(message), "{head}: {found}");
        }
    }

    #[test]
    fn rows_of_one_number_and_pose_are_a_laser_scan() {
        let rows =
            ["0,1,2,0.5,-0.1,4", "0,1,2,0.5,0,inf", "0,1,2,0.5,0.1,", "0,1,2.5,0.5,0,90", "7,1,2.5,0.5,0,\"-1\""];
        let all = scans(HEAD, &rows);
        let readings: Vec<_> = all.iter().map(|recorded| recorded.scan.readings.clone()).collect();
        assert_eq!(readings, [vec![Some(4.0), Some(f64::INFINITY), None], vec![Some(f64::INFINITY)], vec![None]]);
        assert_eq!(all[0].scan.bearings_rad, [-0.1, 0.0, 0.1]);
        assert_eq!(all[1].scan.pose, Pose { x_m: 1.0, y_m: 2.5, theta_rad: 0.5 });
        assert_eq!(all[0].sensor, Sensor::Laser { max_range_m: 80.0, beams: 3 });
        assert_eq!(all.iter().map(|recorded| recorded.scan.time_s).collect::<Vec<_>>(), [0.0, 1.0, 2.0]);
        assert_eq!(all.iter().map(|recorded| recorded.line).collect::<Vec<_>>(), [2, 5, 6]);
    }

    #[test]
    fn the_projects_own_table_is_a_stereo_scan() {
        let head = "scan,time_s,x_m,y_m,theta_rad,bearing_rad,disparity_px,true_range_m";
        let all = scans(head, &["0,0.5,1,2,0,-0.1,12.5,1.2", "0,0.5,1,2,0,0.1,,", "0,0.5,1,2,0,0.2,100,0.2"]);
        assert_eq!((all.len(), all[0].sensor, all[0].scan.time_s), (1, Sensor::Stereo, 0.5));
        assert_eq!(all[0].scan.readings, [Some(12.5), None, Some(100.0)], "no range, so no maximum");
    }

    #[test]
    fn damaged_rows_name_column_value_and_bound() {
        for (row, message) in [
            ("0,1,2,0.5,0", "5 fields; must be 6, as in the first line"),
            ("-1,1,2,0.5,0,4", "column scan: \"-1\" must be a whole number"),
            ("0,nan,2,0.5,0,4", "column x_m: \"nan\" must be a number from -1e8 to 1e8"),
            ("0,1,2,0.5,7,4", "column bearing_rad: \"7\" must be"),
            ("0,1,2,0.5,0,4 m", "column range_m: \"4 m\" must be a number or empty"),
        ] {
            let found = table(HEAD).expect(HEAD).line(row.as_bytes(), 2, &mut Report::default());
            assert!(found.err().unwrap_or_default().contains(message), "{row}");
        }
    }

    #[test]
    fn a_scan_has_a_bound() {
        let mut table = table(HEAD).expect(HEAD);
        let mut add = || table.line(b"0,1,2,0.5,0,4", 2, &mut Report::default());
        for _ in 0..MOST_BEAMS {
            assert!(add().is_ok_and(|complete| complete.is_none()));
        }
        assert!(add().err().unwrap_or_default().contains("more than 100000 rows"));
    }
}
