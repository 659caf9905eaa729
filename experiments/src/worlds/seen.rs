//! Which cells a robot has seen, from readings alone.

use grid::{DigitalLine, GridSpec, Raster};
use sensor::{Scan, SensorModel};

/// Readings to either side of one that say whether it can be so far.
const NEIGHBOURS: usize = 2;

/// How far a reading is relied on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reach {
    /// As far as it goes: a laser's.
    Reading,
    /// No farther than the median of its neighbours and itself: a stereo camera's, one in five of which is a false match
    /// and may lie behind a wall.
    Median,
}

/// Cells that a ray has crossed or ended in.
pub struct Seen {
    pub cells: Raster<bool>,
    line: DigitalLine,
}

impl Seen {
    /// None yet.
    pub fn new(grid: GridSpec) -> Self {
        Self { cells: Raster::filled(grid, false), line: DigitalLine::default() }
    }

    /// Marks the cells of a scan, whose readings are relied on so far. Of a cone, those along its axis.
    pub fn add(&mut self, scan: &Scan, sensor: &dyn SensorModel, reach: Reach) {
        let range = |(reading, bearing): (&Option<f64>, &f64)| sensor.range_of((*reading)?, *bearing);
        let ranges_m: Vec<Option<f64>> = scan.readings.iter().zip(&scan.bearings_rad).map(range).collect();
        for (k, ray) in scan.rays().enumerate() {
            let Some(range_m) = ranges_m[k] else { continue };
            let reach_m = match reach {
                Reach::Reading => range_m,
                Reach::Median => range_m.min(median_about(&ranges_m, k)),
            };
            self.line.trace(self.cells.spec(), ray.origin_m, ray.direction, reach_m);
            self.line.cells().iter().for_each(|cell| self.cells[*cell] = true);
        }
    }
}

/// The lower median of the ranges about the `k`-th, which is there.
fn median_about(ranges_m: &[Option<f64>], k: usize) -> f64 {
    let about = k.saturating_sub(NEIGHBOURS)..(k + NEIGHBOURS + 1).min(ranges_m.len());
    let mut near: Vec<f64> = ranges_m[about].iter().flatten().copied().collect();
    near.sort_by(f64::total_cmp);
    near[(near.len() - 1) / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_false_match_behind_its_neighbours_reaches_no_farther_than_they() {
        let ranges: [Option<f64>; 7] = [Some(2.0), Some(2.1), Some(9.0), None, Some(2.2), Some(2.3), Some(0.5)];
        let reach: Vec<f64> =
            (0..ranges.len()).filter_map(|k| Some(ranges[k]?.min(median_about(&ranges, k)))).collect();
        assert_eq!(reach, [2.0, 2.1, 2.1, 2.2, 2.2, 0.5]);
    }

    #[test]
    fn an_edge_between_near_and_far_stays_where_it_is() {
        let ranges = [1.0, 1.0, 1.0, 4.0, 4.0, 4.0].map(Some);
        let reach: Vec<f64> = (0..6).map(|k| 4.0f64.min(median_about(&ranges, k))).collect();
        assert_eq!(reach[3..], [4.0, 4.0, 4.0]);
    }
}
