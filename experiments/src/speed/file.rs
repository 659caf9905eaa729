//! Scans from a CSV file.

mod lines;
mod row;

use std::fs::File;
use std::io::{self, BufRead as _, BufReader};
use std::path::Path;

use csv::StringRecord;
use strict::nearest;

use self::lines::Lines;
use self::row::Row;
use super::scans::ScanSet;
use crate::failure::Failure;

/// The columns that a file must have.
pub const COLUMNS: [&str; 6] = ["scan", "x_m", "y_m", "theta_rad", "bearing_rad", "range_m"];

/// More rays are taken for a mistake: these need 2 GB.
const MOST_RAYS: usize = 50_000_000;

/// A longer first line is none of a table.
const LONGEST_HEAD: usize = 4096;

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
