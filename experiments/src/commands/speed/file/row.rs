//! One row of a file of scans.

use std::f64::consts::TAU;

use csv::StringRecord;
use sensor::Pose;

use super::{COLUMNS, Table, refuse};
use crate::commands::speed::scans::ScanSet;
use crate::failure::Failure;

/// Coordinates and ranges reach so far, m.
const FAR_M: f64 = 1e6;

const NEAR_BY: &str = "a finite number of metres, -1000000 to 1000000";
const ANGLE: &str = "a finite number of radians, -1000000 to 1000000";
const BEARING: &str = "a finite number of radians, -6.2832 to 6.2832";
const RANGE: &str = "empty, or a finite number of metres, 0 to 1000000";
const COUNT: &str = "a whole number, 0 or more";

/// A row and where it stands.
pub(super) struct Row<'a> {
    pub(super) record: &'a StringRecord,
    pub(super) table: &'a Table,
    pub(super) place: &'a str,
    pub(super) line: u64,
}

impl Row<'_> {
    /// Adds the ray to its scan; `number` is that of the scan so far.
    pub(super) fn add(&self, set: &mut ScanSet, number: &mut Option<u64>) -> Result<(), Failure> {
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
