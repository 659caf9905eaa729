//! Scans from a CSV file.

mod lines;

use std::f64::consts::TAU;
use std::fs::File;
use std::io::{self, BufRead as _, BufReader};
use std::path::Path;

use csv::StringRecord;
use scene::reader::nearest;
use sensor::Pose;

use self::lines::Lines;
use super::scans::ScanSet;
use crate::failure::Failure;

/// The columns that a file must have.
pub const COLUMNS: [&str; 6] = ["scan", "x_m", "y_m", "theta_rad", "bearing_rad", "range_m"];

/// More rays are taken for a mistake: these need 2 GB.
const MOST_RAYS: usize = 50_000_000;

/// A longer first line is none of a table.
const LONGEST_HEAD: usize = 4096;

/// Coordinates and ranges reach so far, m.
const FAR_M: f64 = 1e6;

const NEAR_BY: &str = "a finite number of metres, -1000000 to 1000000";
const ANGLE: &str = "a finite number of radians, -1000000 to 1000000";
const BEARING: &str = "a finite number of radians, -6.2832 to 6.2832";
const RANGE: &str = "empty, or a finite number of metres, 0 to 1000000";
const COUNT: &str = "a whole number, 0 or more";

/// Reads a file row by row. 32 bytes are kept of each.
///
/// # Errors
/// A file that cannot be read; the first thing in it that is not as it must be, with line and column.
pub fn load(path: &Path) -> Result<ScanSet, Failure> {
    let place = path.display().to_string();
    let unreadable = |error: &dyn std::fmt::Display| {
        Failure::BadInput(format!("{place}: cannot be read: {error}; give a CSV file, its form: speed --help"))
    };
    let file = File::open(path).map_err(|e| unreadable(&e))?;
    if !file.metadata().map_err(|e| unreadable(&e))?.is_file() {
        return Err(unreadable(&"is no file"));
    }
    let mut source = BufReader::with_capacity(1 << 18, file);
    let start = source.fill_buf().map_err(|e| unreadable(&e))?;
    if start.len() > LONGEST_HEAD && !start[..LONGEST_HEAD].iter().any(|byte| [b'\n', b'\r'].contains(byte)) {
        return Err(refuse(&place, 1, &format!("no table: the first line must be {}", COLUMNS.join(","))));
    }
    read(source, &place)
}

/// Reads scans from CSV text; `place` names it in messages.
///
/// # Errors
/// As [`load`].
pub fn read(source: impl io::Read, place: &str) -> Result<ScanSet, Failure> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(Lines::new(source));
    let mut record = StringRecord::new();
    let mut table: Option<Table> = None;
    let mut set = ScanSet::default();
    let mut number = None;
    let mut line = 1;
    loop {
        match reader.read_record(&mut record) {
            Ok(false) => break,
            Ok(true) => {}
            Err(error) => return Err(broken(place, line, &error)),
        }
        line = reader.position().line() - 1; // every line has its end, and so has this row's
        let Some(table) = &table else {
            table = Some(Table::of(&record, place, line)?);
            continue;
        };
        if set.rays() == MOST_RAYS {
            return Err(refuse(place, line, &format!("must be at most {MOST_RAYS} rows; split the file")));
        }
        let row = Row { record: &record, table, place, line };
        row.add(&mut set, &mut number)?;
    }
    if table.is_none() {
        return Err(refuse(place, 1, &format!("is empty; the first line must be {}", COLUMNS.join(","))));
    }
    if set.rays() == 0 {
        return Err(refuse(place, 1, "no rows; give one at least for every ray"));
    }
    Ok(set)
}

fn refuse(place: &str, line: u64, what: &str) -> Failure {
    Failure::BadInput(format!("{place}:{line}: {what}"))
}

fn broken(place: &str, before: u64, error: &csv::Error) -> Failure {
    let line = error.position().map_or(before, csv::Position::line);
    match error.kind() {
        csv::ErrorKind::Utf8 { .. } => refuse(place, line, "is no UTF-8 text; save the file as UTF-8"),
        _ => Failure::BadInput(format!("{place}: cannot be read: {error}; give a CSV file, its form: speed --help")),
    }
}

/// Where the columns are.
struct Table {
    columns: [usize; COLUMNS.len()],
    width: usize,
}

impl Table {
    fn of(head: &StringRecord, place: &str, line: u64) -> Result<Self, Failure> {
        let names: Vec<&str> = head.iter().map(str::trim).collect();
        let mut columns = [0; COLUMNS.len()];
        for (column, name) in columns.iter_mut().zip(COLUMNS) {
            let mut found = (0..names.len()).filter(|k| names[*k] == name);
            *column = found.next().ok_or_else(|| {
                let like = nearest(name, names.iter().copied());
                let what = format!(
                    "column {name}: is missing, the nearest is {like:?}; the first line must have {}",
                    COLUMNS.join(",")
                );
                refuse(place, line, &what)
            })?;
            if found.next().is_some() {
                return Err(refuse(place, line, &format!("column {name}: is there twice; name each column once")));
            }
        }
        Ok(Self { columns, width: names.len() })
    }
}

/// A row and where it stands.
struct Row<'a> {
    record: &'a StringRecord,
    table: &'a Table,
    place: &'a str,
    line: u64,
}

impl Row<'_> {
    /// Adds the ray to its scan; `number` is that of the scan so far.
    fn add(&self, set: &mut ScanSet, number: &mut Option<u64>) -> Result<(), Failure> {
        if self.record.len() != self.table.width {
            let (found, width) = (self.record.len(), self.table.width);
            let what = format!("{found} fields; must be {width}, as in the first line; complete the row, or remove it");
            return Err(refuse(self.place, self.line, &what));
        }
        let scan: u64 = self.text(0).parse().map_err(|_| self.refuse(0, COUNT, "number the scans from 0"))?;
        let pose = Pose {
            x_m: self.number(1, FAR_M, NEAR_BY)?,
            y_m: self.number(2, FAR_M, NEAR_BY)?,
            theta_rad: self.number(3, FAR_M, ANGLE)?,
        };
        let bearing = self.number(4, TAU + 1e-4, BEARING)?;
        let range = if self.text(5).is_empty() { None } else { Some(self.number(5, FAR_M, RANGE)?) };
        if range.is_some_and(|range| range < 0.0) {
            return Err(self.refuse(5, RANGE, "leave it empty where nothing was seen"));
        }
        match *number {
            Some(last) if scan < last => {
                let remedy = "keep the rows of a scan together, and sort the scans";
                return Err(self.refuse(0, &format!("{last} or more, as in the row before"), remedy));
            }
            Some(last) if scan == last => self.same_pose(pose, set.scans.last().map(|scan| scan.pose))?,
            _ => set.begin(pose),
        }
        *number = Some(scan);
        set.ray(bearing, range);
        Ok(())
    }

    /// A scan is made from one place.
    fn same_pose(&self, pose: Pose, first: Option<Pose>) -> Result<(), Failure> {
        let Some(first) = first else { return Ok(()) };
        let pairs = [(pose.x_m, first.x_m), (pose.y_m, first.y_m), (pose.theta_rad, first.theta_rad)];
        match pairs.iter().position(|(now, before)| now.total_cmp(before).is_ne() && now - before != 0.0) {
            Some(k) => {
                let bound = format!("{}, the pose of scan {} in its first row", pairs[k].1, self.text(0));
                Err(self.refuse(k + 1, &bound, "give every pose a scan of its own"))
            }
            None => Ok(()),
        }
    }

    fn text(&self, column: usize) -> &str {
        self.record.get(self.table.columns[column]).unwrap_or_default().trim()
    }

    fn number(&self, column: usize, most: f64, bound: &str) -> Result<f64, Failure> {
        let number = self.text(column).parse().ok().filter(|value: &f64| value.abs() <= most);
        let remedy = if column == 5 { "leave it empty where nothing was seen" } else { "give such a number" };
        number.ok_or_else(|| self.refuse(column, bound, remedy))
    }

    fn refuse(&self, column: usize, bound: &str, remedy: &str) -> Failure {
        let (name, mut value) = (COLUMNS[column], self.text(column).to_owned());
        if value.chars().count() > 40 {
            value = value.chars().take(40).chain("...".chars()).collect();
        }
        refuse(self.place, self.line, &format!("column {name}: {value:?}: must be {bound}; {remedy}"))
    }
}
