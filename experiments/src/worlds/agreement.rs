//! Whether scans agree with a map of the others: the share of their readings that end near its surfaces.

use grid::{DigitalLine, Raster};
use sensor::{Scan, SensorModel};
use serde_json::{Value, json};

/// A cell is a surface above this.
const OCCUPIED: f64 = 0.5;

/// Near is within so many cells of one, and so many standard deviations of the reading.
const CELLS: f64 = 2.0;
const SIGMAS: f64 = 3.0;

/// A disparity's deviation grows with the square of its range; farther than this nothing is near, m.
const FARTHEST_M: f64 = 0.5;

/// Of the readings that should hit what the map holds, at least this share ends near a surface. Measured, under the map of
/// `visibility`: 0.93 to 1 in logs of real and simulated lasers and 0.79 to 0.84 in those of a simulated stereo camera, but at most
/// 0.65 with poses of a drifting odometry, across a gap in which the robot turned, and with headings in degrees.
const LEAST: f64 = 0.72;

/// Fewer readings tell nothing.
const FEWEST: u64 = 100;

/// The standard deviation of a reading.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Spread {
    /// Of a range, m.
    Range(f64),
    /// Of a disparity, px.
    Disparity(f64),
    /// Of what is somewhere in a cone: where it ends is not known, so that it says nothing.
    Cone,
}

/// Readings that were looked at, and those of them that end near a surface.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Agreement {
    /// Readings that end where the map says something.
    pub(crate) ends: u64,
    /// Readings that end near a cell that is rather occupied.
    pub(crate) near: u64,
}

impl Agreement {
    /// What the readings of a scan say of a map, of which some cells are `seen`. A reading that ends where nothing was seen, with
    /// no surface before it, says nothing.
    pub(crate) fn of(
        scan: &Scan,
        map: &Raster<f64>,
        seen: &Raster<bool>,
        sensor: &dyn SensorModel,
        spread: Spread,
    ) -> Self {
        let mut agreement = Self::default();
        let mut line = DigitalLine::default();
        for ray in scan.rays() {
            let Some(reading) = ray.reading else { continue };
            let Some(range_m) = sensor.range_of(reading, ray.bearing_rad) else { continue };
            let end = [0, 1].map(|k| ray.origin_m[k] + range_m * ray.direction[k]);
            let Some(cell) = map.spec().locate(end) else { continue };
            let deviation_m = match spread {
                Spread::Range(sigma_m) => SIGMAS * sigma_m,
                Spread::Disparity(sigma_px) => sensor
                    .range_of(reading - SIGMAS * sigma_px, ray.bearing_rad)
                    .map_or(FARTHEST_M, |farther_m| farther_m - range_m),
                Spread::Cone => continue,
            };
            let within_m = deviation_m.clamp(0.0, FARTHEST_M).max(CELLS * map.spec().cell_m);
            let near = is_near_surface(map, cell, end, within_m);
            let judged = near || seen[cell] || {
                line.trace(map.spec(), ray.origin_m, ray.direction, range_m);
                line.cells().iter().any(|crossed| map[*crossed] > OCCUPIED)
            };
            agreement.ends += u64::from(judged);
            agreement.near += u64::from(near);
        }
        agreement
    }

    /// Of two sets of readings.
    pub(crate) fn and(self, other: Self) -> Self {
        Self { ends: self.ends + other.ends, near: self.near + other.near }
    }

    /// Share of the readings that end near a surface; none without any.
    pub(crate) fn share(&self) -> Option<f64> {
        (self.ends > 0).then(|| self.near as f64 / self.ends as f64)
    }

    /// Whether too few end there, by a sensor whose readings are right with this probability.
    pub(crate) fn fails(&self, correct: f64) -> bool {
        self.ends >= FEWEST && self.share().is_some_and(|share| share < LEAST * correct)
    }

    /// One line: of the map of a mapper, with its bound.
    pub(crate) fn text(&self, mapper: &str, correct: f64) -> String {
        let share = 100.0 * self.share().unwrap_or_default();
        format!(
            "{share:.1} % of {} readings kept back end near surfaces of the map of {mapper}; at least {:.0} % should",
            self.ends,
            100.0 * LEAST * correct
        )
    }

    /// What to say where too few do.
    pub(crate) fn warning(&self, mapper: &str, correct: f64) -> Option<String> {
        self.fails(correct).then(|| format!("{}: {CAUSES}", self.text(mapper, correct)))
    }

    /// For the record of a run.
    pub(crate) fn record(&self, mapper: &str, correct: f64) -> Value {
        json!({
            "map": mapper,
            "readings": self.ends,
            "near_surfaces": self.share(),
            "at_least": LEAST * correct,
            "fails": self.fails(correct),
        })
    }
}

const CAUSES: &str = "the scans do not fit together: are the poses raw odometry, is there a gap in them, are headings in degrees or \
     lengths in centimetres, is the laser's fan another (--fov, --first-bearing), are there two clocks or two lasers?";

/// Whether the centre of an occupied cell is within so much of a point, in the given cell.
fn is_near_surface(map: &Raster<f64>, cell: usize, point: [f64; 2], within_m: f64) -> bool {
    let spec = map.spec();
    let reach = (within_m / spec.cell_m).ceil() as usize;
    let (column, row) = spec.column_row(cell);
    (row.saturating_sub(reach)..=(row + reach).min(spec.height - 1)).any(|row| {
        (column.saturating_sub(reach)..=(column + reach).min(spec.width - 1)).any(|column| {
            let other = spec.index(column, row);
            let centre = spec.centre(other);
            map[other] > OCCUPIED && libm::hypot(centre[0] - point[0], centre[1] - point[1]) <= within_m
        })
    })
}

#[cfg(test)]
mod tests {
    use grid::GridSpec;
    use sensor::{Laser, Pose};

    use super::*;

    /// A wall at x = 3 m, seen from the left.
    fn wall() -> (Raster<f64>, Raster<bool>) {
        let spec = GridSpec::covering([0.0; 2], [6.0, 2.0], 0.1).expect("a grid");
        let column = |cell: usize| spec.column_row(cell).0;
        let cells = || 0..spec.cells();
        let map = cells().map(|cell| if column(cell) == 30 { 0.9 } else { 0.1 }).collect();
        (Raster::new(spec, map), Raster::new(spec, cells().map(|cell| column(cell) <= 30).collect()))
    }

    fn ahead(range_m: f64) -> Agreement {
        let (map, seen) = wall();
        let pose = Pose { x_m: 1.0, y_m: 1.0, theta_rad: 0.0 };
        let scan = Scan { pose, bearings_rad: vec![0.0], readings: vec![Some(range_m)], ..Scan::default() };
        Agreement::of(&scan, &map, &seen, &Laser::default(), Spread::Range(0.02))
    }

    #[test]
    fn readings_count_that_end_where_the_map_says_something() {
        let told = |ends, near| Agreement { ends, near };
        assert_eq!(ahead(2.0), told(1, 1), "on the wall");
        assert_eq!(ahead(2.2), told(1, 1), "0.15 m behind its centre");
        assert_eq!(ahead(1.0), told(1, 0), "in free space");
        assert_eq!(ahead(3.0), told(1, 0), "through the wall");
        assert_eq!(ahead(9.0), told(0, 0), "off the map");
    }

    #[test]
    fn too_few_of_many_are_warned_of() {
        assert_eq!(Agreement { ends: 99, near: 0 }.warning("visibility", 1.0), None, "too few to tell");
        assert_eq!(Agreement { ends: 100, near: 72 }.warning("visibility", 1.0), None);
        assert_eq!(Agreement { ends: 100, near: 58 }.warning("visibility", 0.8), None, "a camera is wrong in a fifth");
        let said = Agreement { ends: 100, near: 71 }.warning("visibility", 1.0).expect("too few");
        assert!(said.starts_with("71.0 % of 100 readings kept back") && said.contains("raw odometry"), "{said}");
    }
}
