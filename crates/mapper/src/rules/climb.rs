//! Hill climbing over maps of occupied and free cells, one flip at a time.

use crate::rules::readings::{Crossings, Readings};

/// A flip must gain more than this, in nats: less is rounding.
const GAIN: f64 = 1e-6;

/// One sum over rays that depends on the map through the first occupied cell of each ray alone, and a
/// prior of independent cells.
///
/// Entries number the cells of all rays as in [`Readings::cells`]; the ray that hits nothing has the
/// value `none`.
pub(crate) struct Values {
    /// What a ray is worth if its first occupied cell is this entry.
    pub(crate) entry: Vec<f64>,
    /// What a ray is worth if none of its cells is occupied.
    pub(crate) none: Vec<f64>,
}

/// A map, and for every ray the first two occupied cells on it.
pub(crate) struct Climb<'a> {
    readings: &'a Readings,
    log_odds: f64,
    crossings: Crossings,
    occupied: Vec<bool>,
    /// Entries of the first and the second occupied cell of each ray; the end of its span if there is none.
    nearest: Vec<[usize; 2]>,
    /// What flipping each cell would gain.
    gain: Vec<f64>,
}

impl<'a> Climb<'a> {
    /// The empty map, with prior log odds of every cell.
    pub(crate) fn new(readings: &'a Readings, cells: usize, log_odds: f64) -> Self {
        let crossings = readings.crossings(cells);
        let nearest = (0..readings.rays()).map(|ray| [readings.span(ray).end; 2]).collect();
        Self { readings, log_odds, crossings, occupied: vec![false; cells], nearest, gain: vec![0.0; cells] }
    }

    /// The map.
    pub(crate) fn occupied(&self) -> &[bool] {
        &self.occupied
    }

    /// Entry of the first occupied cell of a ray, none if it hits nothing.
    pub(crate) fn first(&self, ray: usize) -> Option<usize> {
        Some(self.nearest[ray][0]).filter(|&entry| entry < self.readings.span(ray).end)
    }

    /// What flipping each cell would gain, as of the last climb.
    pub(crate) fn gain(&self) -> &[f64] {
        &self.gain
    }

    /// Flips the cell that gains most, the lowest among equals, until no flip gains; the number of flips.
    ///
    /// Every flip adds to the sum, so no map comes back and the climb ends; `most` bounds it even so.
    pub(crate) fn climb(&mut self, values: &Values, most: usize) -> usize {
        self.gain = self.occupied.iter().map(|&on| if on { -self.log_odds } else { self.log_odds }).collect();
        for ray in 0..self.readings.rays() {
            self.count(values, ray, 1.0);
        }
        for flips in 0..most {
            let (mut best, mut cell) = (GAIN, None);
            for (candidate, &gain) in self.gain.iter().enumerate() {
                if gain > best {
                    (best, cell) = (gain, Some(candidate));
                }
            }
            let Some(cell) = cell else { return flips };
            self.flip(values, cell);
        }
        most
    }

    fn flip(&mut self, values: &Values, cell: usize) {
        let rays = self.crossings.numbers(cell);
        for i in rays.clone() {
            let (ray, entry) = self.crossings.ray(i);
            if entry as usize <= self.nearest[ray as usize][1] {
                self.count(values, ray as usize, -1.0);
            }
        }
        self.occupied[cell] ^= true;
        self.gain[cell] = if self.occupied[cell] { -self.log_odds } else { self.log_odds };
        for i in rays {
            let (ray, entry) = self.crossings.ray(i);
            // Behind the second occupied cell a flip changes nothing.
            if entry as usize <= self.nearest[ray as usize][1] {
                self.look(ray as usize);
                self.count(values, ray as usize, 1.0);
            }
        }
    }

    /// Finds the first two occupied cells of a ray.
    fn look(&mut self, ray: usize) {
        let span = self.readings.span(ray);
        let mut hits = span.clone().filter(|&entry| self.occupied[self.readings.cells()[entry] as usize]);
        self.nearest[ray] = [hits.next().unwrap_or(span.end), hits.next().unwrap_or(span.end)];
    }

    /// Adds, or takes away, what flips would change for one ray.
    fn count(&mut self, values: &Values, ray: usize, sign: f64) {
        let span = self.readings.span(ray);
        let value = |entry: usize| if entry < span.end { values.entry[entry] } else { values.none[ray] };
        let [first, second] = self.nearest[ray];
        let now = value(first);
        for entry in span.start..first {
            self.gain[self.readings.cells()[entry] as usize] += sign * (values.entry[entry] - now);
        }
        if first < span.end {
            self.gain[self.readings.cells()[first] as usize] += sign * (value(second) - now);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use grid::GridSpec;
    use sensor::{Pose, Scan, Stereo};
    use std::sync::Arc;

    /// Rays from everywhere over 6 x 5 cells.
    fn readings() -> Readings {
        let grid = GridSpec { cell_m: 0.2, origin_m: [0.0; 2], width: 6, height: 5 };
        let model = Model::new(grid, Arc::new(Stereo::default()));
        let mut readings = Readings::new(&model);
        for i in 0..40 {
            let turn = f64::from(i);
            let pose = Pose { x_m: 0.6 + 0.5 * turn.sin(), y_m: 0.5 + 0.4 * (1.7 * turn).cos(), theta_rad: 2.4 * turn };
            readings.add(&Scan { sensor: 0, time_s: 0.0, pose, bearings_rad: vec![0.0], readings: vec![Some(20.0)] });
        }
        readings
    }

    #[test]
    fn gains_kept_flip_by_flip_are_those_of_the_map() {
        let readings = readings();
        let values = |phase: f64| {
            let worth = |entry: usize| 4.0 * (entry as f64 * 12.9898 + phase).sin();
            let entry = (0..readings.cells().len()).map(worth).collect();
            Values { entry, none: (0..readings.rays()).map(|ray| worth(ray) - 2.0).collect() }
        };
        let mut climb = Climb::new(&readings, 30, -1.0);
        climb.climb(&values(0.0), 1000);
        let before = climb.occupied().to_vec();
        assert!(climb.climb(&values(2.0), 1000) > 1, "other values, another map");
        assert!(before.iter().zip(climb.occupied()).any(|(before, now)| *before && !now), "some cell is cleared");
        let kept = climb.gain().to_vec();
        climb.climb(&values(2.0), 0); // counts anew
        for (cell, (kept, counted)) in kept.iter().zip(climb.gain()).enumerate() {
            assert!((kept - counted).abs() < 1e-9, "cell {cell}: {kept} {counted}");
        }
    }
}
