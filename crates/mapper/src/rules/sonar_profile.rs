//! The profile by which sonars were first mapped: an empty sector before the reading, and an arc at it that is occupied somewhere.
//!
//! Moravec and Elfes, "High resolution maps from wide angle sonar", ICRA 1985, give it in closed form; Moravec, "Sensor fusion in certainty grids for
//! mobile robots", AI Magazine 9(2), 1988, keeps the shape and replaces the two numbers per cell by one probability and Bayes' rule. For
//! a cell at range `d` and angle `a` to the axis, a reading `R` of a cone of width `w` with the error `e`:
//!
//! ```text
//! empty    = (1 - (d / (R - e))^2) (1 - (2 a / w)^2)      d <= R - e
//! occupied = (1 - ((d - R) / e)^2) (1 - (2 a / w)^2)      R - e <= d <= R + e
//! ```
//!
//! What is known to be empty takes its share from the arc, and the arc is then normalised to one: it says that something stands on it, not where.
//!
//! Assumed where the two differ, or say nothing: there is no least range; `e` is two standard deviations and at least half the diagonal of a cell;
//! both parts are multiplied by `P(T)` of the sensor, for trust; a part `q` is the probability `(1 - q) / 2` or `(1 + q) / 2` of a cell at even odds,
//! and the emptiness of a cell of probability `p` is `1 - 2p`. A reading without an echo is left out, as the largest readings are in 1985.

use grid::{DigitalLine, GridSpec, Raster};
use sensor::{Ray, Scan, SensorModel};

use crate::belief::probability::{EPSILON, log_odds};
use crate::mapper::{Mapper, Work};
use crate::memory::Held as _;
use crate::model::{Model, Sensors};
use crate::rules::odds_map::OddsMap;

/// A cell of the cone of a reading.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    cell: usize,
    /// Range of its middle, m.
    range_m: f64,
    /// `1 - (2 a / w)^2`.
    across: f64,
}

/// Moravec's sonar profile as a mapper. A sensor that looks along a ray has the profile of the axis. O(cells of the cone's surroundings) per reading.
#[derive(Clone)]
pub struct SonarProfiles {
    map: OddsMap,
    sensors: Sensors,
    line: DigitalLine,
    places: Vec<Place>,
    cells: u64,
}

impl SonarProfiles {
    /// The unknown map, at even odds where a first reading reaches it.
    pub fn new(model: &Model) -> Self {
        Self {
            map: OddsMap::new(model, model.tuning.start.unwrap_or(0.5), model.tuning.clamp([EPSILON, 1.0 - EPSILON])),
            sensors: model.sensors.clone(),
            line: DigitalLine::default(),
            places: Vec::new(),
            cells: 0,
        }
    }

    /// Finds the cells of a ray's cone up to a range, m.
    fn find(&mut self, ray: &Ray, sensor: &dyn SensorModel, end_m: f64) {
        let (spec, width_rad) = (*self.map.spec(), sensor.width_rad());
        self.places.clear();
        if width_rad > 0.0 {
            let across = |angle_rad: f64| 1.0 - (2.0 * angle_rad / width_rad).powi(2);
            let cells = within_cone(&spec, ray, width_rad, end_m);
            self.places.extend(cells.map(|(cell, range_m, angle_rad)| Place {
                cell,
                range_m,
                across: across(angle_rad),
            }));
            return;
        }
        // A chord is at most a diagonal: no cell that matters is cut short.
        self.line.trace(&spec, ray.origin_m, ray.direction, end_m + 3.0 * spec.cell_m);
        let chords = self.line.cells().iter().zip(self.line.ranges().windows(2));
        self.places.extend(chords.map(|(&cell, chord)| Place {
            cell,
            range_m: 0.5 * (chord[0] + chord[1]),
            across: 1.0,
        }));
    }

    /// Takes in one reading, at `range_m` (m) with the error `error_m` (m).
    fn update(&mut self, range_m: f64, error_m: f64, trust: f64) {
        let mut map = self.map.change();
        let near_m = range_m - error_m;
        for place in self.places.iter().filter(|place| place.range_m < near_m) {
            let empty = trust * (1.0 - (place.range_m / near_m).powi(2)) * place.across;
            map.add(place.cell..place.cell + 1, log_odds(0.5 * (1.0 - empty)));
            self.cells += 1;
        }
        let arc = |place: &&Place| (near_m..=range_m + error_m).contains(&place.range_m);
        let share = |place: &Place| {
            let along = 1.0 - ((place.range_m - range_m) / error_m).powi(2);
            along * place.across * (2.0 * map.occupied(place.cell)).min(1.0)
        };
        let shares: Vec<(usize, f64)> =
            self.places.iter().filter(arc).map(|place| (place.cell, share(place).max(0.0))).collect();
        let all: f64 = shares.iter().map(|(_, share)| share).sum();
        for (cell, share) in shares {
            let occupied = if all > 0.0 { trust * share / all } else { 0.0 };
            map.add(cell..cell + 1, log_odds(0.5 * (1.0 + occupied)));
            self.cells += 1;
        }
    }
}

/// The cells whose middles lie in a cone up to a range, m, with their ranges, m, and angles to its axis, rad, 0 to half of its width.
fn within_cone(
    spec: &GridSpec,
    ray: &Ray,
    width_rad: f64,
    end_m: f64,
) -> impl Iterator<Item = (usize, f64, f64)> + use<> {
    let ([x, y], [along_x, along_y], spec) = (ray.origin_m, ray.direction, *spec);
    let number =
        |v: f64, k: usize, most: usize| ((v - spec.origin_m[k]) / spec.cell_m).floor().clamp(0.0, most as f64) as usize;
    let columns = number(x - end_m, 0, spec.width)..(number(x + end_m, 0, spec.width) + 1).min(spec.width);
    let rows = number(y - end_m, 1, spec.height)..(number(y + end_m, 1, spec.height) + 1).min(spec.height);
    rows.flat_map(move |row| columns.clone().map(move |column| spec.index(column, row))).filter_map(move |cell| {
        let [middle_x, middle_y] = spec.centre(cell);
        let [to_x, to_y] = [middle_x - x, middle_y - y];
        let range_m = libm::hypot(to_x, to_y);
        let angle_rad = libm::atan2(to_y * along_x - to_x * along_y, to_x * along_x + to_y * along_y).abs();
        (range_m <= end_m && angle_rad <= 0.5 * width_rad).then_some((cell, range_m, angle_rad))
    })
}

/// `e`: how far around a reading its surface may be, m.
fn error_m(sensor: &dyn SensorModel, reading: f64, bearing_rad: f64, spec: &GridSpec) -> f64 {
    (2.0 * sensor.range_sigma(reading, bearing_rad)).max(std::f64::consts::FRAC_1_SQRT_2 * spec.cell_m)
}

impl Mapper for SonarProfiles {
    fn integrate(&mut self, scan: &Scan) {
        let sensor = self.sensors.of(scan).clone();
        let spec = *self.map.spec();
        if spec.locate(scan.pose.position_m()).is_none() {
            return;
        }
        for ray in scan.rays() {
            let range_m = ray.reading.and_then(|reading| sensor.range_of(reading, ray.bearing_rad));
            let Some((reading, range_m)) = ray.reading.zip(range_m) else { continue };
            let error_m = error_m(&*sensor, reading, ray.bearing_rad, &spec);
            self.find(&ray, &*sensor, range_m + error_m);
            self.update(range_m, error_m, sensor.correct_match().min(1.0 - EPSILON));
        }
    }

    fn occupancy(&self) -> &Raster<f64> {
        self.map.occupancy()
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(self.clone()))
    }

    fn work(&self) -> Work {
        let places = self.places.capacity() * size_of::<Place>();
        Work { cells: self.cells, bytes: self.map.held() + self.line.held() + places }
    }
}

#[cfg(test)]
mod tests;
