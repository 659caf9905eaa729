//! One row of a table: one beam.

use std::f64::consts::TAU;

use sensor::Pose;

use super::head::{BEARING, Columns, NAMES, ODOMETRY, READINGS, SCAN, SENSOR, Separator, THETA, TIME, X, Y};
use crate::bounds::{FAR_M, LATE_S, WOUND_RAD};
use crate::fields::{number, quoted};

/// Sensors of a table have numbers below this.
const MOST_SENSORS: usize = 256;

/// One beam, and which scan it is of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Row {
    pub(super) number: u64,
    /// None in a table without times.
    pub(super) time_s: Option<f64>,
    pub(super) pose: Pose,
    /// None in a table without sensors.
    pub(super) sensor: Option<usize>,
    pub(super) odometry: Option<Pose>,
    pub(super) bearing_rad: f64,
    /// The readings as they stand, by the places of their columns in [`READINGS`]; none where a field is empty or there is no such column.
    pub(super) raw: [Option<f64>; READINGS.len()],
}

impl Row {
    pub(super) fn read(text: &[u8], columns: &Columns) -> Result<Self, String> {
        let cells = columns.separator.cells(text);
        if cells.len() != columns.width {
            return Err(format!("{} fields; must be {}, as in the first line", cells.len(), columns.width));
        }
        let cells = Cells { cells: &cells, columns };
        let pose = |[x, y, theta]: [usize; 3]| {
            Ok::<_, String>(Pose {
                x_m: cells.number(x, FAR_M, "m")?,
                y_m: cells.number(y, FAR_M, "m")?,
                theta_rad: cells.number(theta, WOUND_RAD, "rad")?,
            })
        };
        let is_there = |name: usize| columns.place(name).is_some();
        let mut raw = [None; READINGS.len()];
        for kind in columns.readings() {
            raw[kind] = cells.reading(READINGS[kind])?;
        }
        let odometry = ODOMETRY.iter().all(|name| !cells.cell(*name).is_empty());
        Ok(Self {
            number: cells.whole(SCAN, u64::MAX)?,
            time_s: if is_there(TIME) { Some(cells.number(TIME, LATE_S, "s")?) } else { None },
            pose: pose([X, Y, THETA])?,
            sensor: if is_there(SENSOR) { Some(cells.whole(SENSOR, MOST_SENSORS as u64 - 1)? as usize) } else { None },
            odometry: if odometry { Some(pose(ODOMETRY)?) } else { None },
            bearing_rad: cells.number(BEARING, TAU + 1e-4, "rad")?,
            raw,
        })
    }
}

struct Cells<'a> {
    cells: &'a [&'a [u8]],
    columns: &'a Columns,
}

impl Cells<'_> {
    fn cell(&self, name: usize) -> &[u8] {
        self.columns.place(name).and_then(|column| self.cells.get(column)).copied().unwrap_or_default()
    }

    fn parse(&self, cell: &[u8]) -> Option<f64> {
        let comma = self.columns.separator == Separator::Byte(b';') && cell.contains(&b',');
        if !comma {
            return number(cell);
        }
        // Where fields are separated by semicolons, commas are decimal points.
        number(&cell.iter().map(|byte| if *byte == b',' { b'.' } else { *byte }).collect::<Vec<_>>())
    }

    fn whole(&self, name: usize, most: u64) -> Result<u64, String> {
        let cell = self.cell(name);
        let whole = || self.parse(cell).filter(|value| value.fract() == 0.0 && (0.0..1e15).contains(value));
        let found =
            std::str::from_utf8(cell).ok().and_then(|text| text.parse().ok()).or_else(|| whole().map(|v| v as u64));
        let upto = if most == u64::MAX { "0 or more".to_owned() } else { format!("0 to {most}") };
        found
            .filter(|value| *value <= most)
            .ok_or_else(|| format!("column {}: {} must be a whole number, {upto}", NAMES[name], quoted(cell)))
    }

    fn number(&self, name: usize, most: f64, unit: &str) -> Result<f64, String> {
        let cell = self.cell(name);
        let found = self.parse(cell);
        found.filter(|value| value.abs() <= most).ok_or_else(|| {
            let beyond = found.is_some_and(|value| value.is_finite());
            let hint = match name {
                _ if !beyond => "",
                BEARING | THETA => ": is it in degrees?",
                TIME => ": is it in ns?",
                _ => "",
            };
            format!(
                "column {}: {} must be a number from {:e} to {most:e} {unit}{hint}",
                NAMES[name],
                quoted(cell),
                -most
            )
        })
    }

    /// None where the field is empty.
    fn reading(&self, name: usize) -> Result<Option<f64>, String> {
        let cell = self.cell(name);
        if cell.is_empty()
            || ["na", "n/a", "null", "none"].iter().any(|word| cell.eq_ignore_ascii_case(word.as_bytes()))
        {
            return Ok(None);
        }
        let found = self.parse(cell).map(Some);
        found.ok_or_else(|| format!("column {}: {} must be a number or empty", NAMES[name], quoted(cell)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(head: &str, row: &str) -> Result<Row, String> {
        Row::read(row.as_bytes(), &Columns::new(head.as_bytes()).expect(head))
    }

    #[test]
    fn every_separator_gives_the_same_row() {
        let head = "scan,time_s,x_m,y_m,theta_rad,bearing_rad,range_m,sensor,odom_x_m,odom_y_m,odom_theta_rad,comment";
        let row = "7,1.5,1,2,0.5,-0.25,4.125,3,1,2,0.25,x";
        let expected = read(head, row).expect("fine");
        let odometry = Pose { x_m: 1.0, y_m: 2.0, theta_rad: 0.25 };
        assert_eq!((expected.number, expected.sensor, expected.odometry), (7, Some(3), Some(odometry)));
        assert_eq!(
            (expected.time_s, expected.bearing_rad, expected.raw),
            (Some(1.5), -0.25, [None, Some(4.125), None])
        );
        for separator in [";", "\t", " ", " ; ", "\t "] {
            let change = |text: &str| text.replace(',', separator);
            assert_eq!(read(&change(head), &change(row)), Ok(expected), "{separator:?}");
        }
        assert_eq!(
            read(&head.replace(',', ";"), &row.replace(',', ";").replace('.', ",")),
            Ok(expected),
            "decimal commas"
        );
        assert_eq!(read(&head.to_uppercase(), row), Ok(expected));
        assert_eq!(read(&format!("# {head}"), &row.replace("7,", "7.0,")), Ok(expected));
    }

    #[test]
    fn damaged_rows_name_column_value_and_bound() {
        let head = "scan,x_m,y_m,theta_rad,bearing_rad,range_m,sensor";
        for (row, message) in [
            ("0,1,2,0.5,0", "5 fields; must be 7, as in the first line"),
            ("-1,1,2,0.5,0,4,0", "column scan: \"-1\" must be a whole number, 0 or more"),
            ("0,nan,2,0.5,0,4,0", "column x_m: \"nan\" must be a number from -1e8 to 1e8 m"),
            ("0,1,2,0.5,7,4,0", "column bearing_rad: \"7\" must be"),
            ("0,1,2,0.5,-90,4,0", "rad: is it in degrees?"),
            ("0,1,2,0.5,0,4 m,0", "column range_m: \"4 m\" must be a number or empty"),
            ("0,1,2,0.5,0,4,300", "column sensor: \"300\" must be a whole number, 0 to 255"),
        ] {
            let found = read(head, row).err().unwrap_or_default();
            assert!(found.contains(message), "{row}: {found}");
        }
        for empty in ["", "NA", "null"] {
            assert_eq!(read(head, &format!("0,1,2,0.5,0,{empty},0")).map(|row| row.raw), Ok([None; 3]));
        }
    }
}
