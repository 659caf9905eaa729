//! Beams that widen with distance: what is free is a triangle, what is occupied its far side.
//!
//! `COccupancyGridMap2D` of MRPT 2.5.8 (Blanco-Claraco and contributors, "Mobile Robot Programming Toolkit") with
//! `insertionOptions.wideningBeamsWithDistance`: `COccupancyGridMap2D_insert.cpp`.

use grid::Raster;
use sensor::{Scan, SensorModel};

use crate::belief::probability::log_odds;
use crate::fit::{Candidate, Fit, Fitted, Setting, numbers};
use crate::mapper::{Mapper, Work};
use crate::memory::Held as _;
use crate::model::{Model, Sensors};
use crate::rules::odds_map::OddsMap;
use crate::rules::wedge::{Wedge, cells_of_triangle, wedges};
use crate::tuning::Tuning;

/// Constant increments over wedges.
///
/// The triangle from the sensor to one cell before the reading, as wide as rays are apart, is missed; the far side of the wedge at the
/// reading is hit. Every ray counts, also where a cell belongs to several.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WideningBeams {
    /// Probability that a hit stands for, from even odds.
    pub hit: f64,
    /// Probability that a miss stands for, from even odds.
    pub miss: f64,
    /// Probability from which a cell's first update starts.
    pub start: f64,
    /// Least and largest probability of a cell that was updated.
    pub clamp: [f64; 2],
    /// A reading from this range on clears up to it and hits nothing, m.
    pub max_range_m: f64,
}

impl WideningBeams {
    /// The defaults of MRPT, whose map holds log odds in sixteenths from -127 to 127: a certainty of 0.65 is 10 of them for a miss, and
    /// three times as many for a hit; readings up to 15 m.
    pub const MRPT: Self = Self {
        hit: 0.867_035_759_802_170_6,
        miss: 0.348_645_135_333_945_75,
        start: 0.5,
        clamp: [0.000_356_970_635_037_657_6, 0.999_643_029_364_962_3],
        max_range_m: 15.0,
    };

    /// What the `tune` command finds best on the tuning scenes, which are not the scenes that results are reported on.
    pub const TUNED: Self = Self { hit: 0.7, miss: 0.48, start: 0.1, clamp: [0.005, 0.7], ..Self::MRPT };

    /// The rule with the values given.
    pub fn tuned(self, tuning: &Tuning) -> Self {
        let [hit, miss, start] = tuning.odds([self.hit, self.miss, self.start]);
        Self { hit, miss, start, clamp: tuning.clamp(self.clamp), ..self }
    }

    /// Candidates and choice.
    pub(crate) const FIT: Fit = Fit {
        mapper: "mrpt-widening-tuned",
        built_in: || Candidate::of(Self::TUNED),
        tried: || {
            let shipped = [Self::MRPT.miss, Self::MRPT.hit];
            let steps = [[0.49, 0.6], [0.49, 0.7], [0.48, 0.7], [0.48, 0.8], [0.47, 0.7], [0.47, 0.8], shipped];
            let starts = steps
                .into_iter()
                .flat_map(|[miss, hit]| [0.1, 0.5].map(|start| Self { hit, miss, start, ..Self::MRPT }));
            let clamped = |rule: Self| {
                [[0.005, 0.5], [0.005, 0.7], [0.01, 0.7], Self::MRPT.clamp].map(|clamp| Self { clamp, ..rule })
            };
            Candidate::all(starts.flat_map(clamped))
        },
    };
}

impl Fitted for WideningBeams {
    fn parameters(&self) -> Vec<(&'static str, Setting)> {
        let Self { hit, miss, start, clamp: [low, high], .. } = *self;
        numbers([("hit", hit), ("miss", miss), ("start", start), ("clamp_low", low), ("clamp_high", high)])
    }

    fn label(&self) -> String {
        let Self { hit, miss, start, clamp: [low, high], .. } = self;
        format!("{hit:.2}/{miss:.3} from {start}, {low:.3}..{high:.2}")
    }

    fn mapper(&self, model: &Model) -> Box<dyn Mapper> {
        Box::new(WideningBeamsMapper::new(model, *self))
    }
}

/// The mapper with this rule. O(cells of the wedge) per ray.
///
/// Cells are those that the triangle, or its far side, meets. The program walks along the borders of the triangle in whole
/// cells and fills a row where it enters it, so that it leaves out cells of flat beams; and it hits the first cell of a far side that is
/// longer than a cell twice. Neither is meant. A beam
/// without echo clears half as far as the last reading before it in its scan, as in the program; a reading below a cell is not used.
#[derive(Clone)]
pub struct WideningBeamsMapper {
    rule: WideningBeams,
    map: OddsMap,
    sensors: Sensors,
    cells: u64,
}

impl WideningBeamsMapper {
    /// The unknown map.
    pub fn new(model: &Model, rule: WideningBeams) -> Self {
        Self { rule, map: OddsMap::new(model, rule.start, rule.clamp), sensors: model.sensors.clone(), cells: 0 }
    }

    /// Updates the cells of a triangle.
    fn add(&mut self, corners: [[f64; 2]; 3], probability: f64) {
        let (spec, step) = (*self.map.spec(), log_odds(probability));
        let (mut odds, cells) = (self.map.change(), &mut self.cells);
        cells_of_triangle(&spec, corners, |row, columns| {
            *cells += columns.len() as u64;
            odds.add(row * spec.width + columns.start..row * spec.width + columns.end, step);
        });
    }
}

/// Where a ray ends.
struct End {
    /// Range up to which it clears, one cell short, m.
    range_m: f64,
    hits: bool,
}

impl WideningBeams {
    /// Where a ray ends; none if it is not used. `last_m` is the last range of the scan.
    fn end(&self, sensor: &dyn SensorModel, wedge: &Wedge, last_m: &mut f64) -> Option<End> {
        let reading = wedge.ray.reading?;
        if reading == f64::INFINITY {
            return Some(End { range_m: self.max_range_m.min(0.5 * *last_m), hits: false });
        }
        let range_m = sensor.range_of(reading, wedge.ray.bearing_rad)?;
        *last_m = range_m;
        Some(End { range_m: range_m.min(self.max_range_m), hits: range_m < self.max_range_m })
    }
}

impl Mapper for WideningBeamsMapper {
    fn integrate(&mut self, scan: &Scan) {
        let (cell_m, rule) = (self.map.spec().cell_m, self.rule);
        if self.map.spec().locate(scan.pose.position_m()).is_none() {
            return;
        }
        let sensor = std::sync::Arc::clone(self.sensors.of(scan));
        let mut last_m = rule.max_range_m;
        for wedge in wedges(scan) {
            let Some(End { range_m, hits }) = rule.end(&*sensor, &wedge, &mut last_m) else { continue };
            if range_m < cell_m {
                continue;
            }
            let [first, second] = wedge.ends(range_m - cell_m);
            self.add([wedge.ray.origin_m, first, second], rule.miss);
            if hits {
                let [first, second] = wedge.ends(range_m);
                self.add([first, second, second], rule.hit);
            }
        }
    }

    fn occupancy(&self) -> &Raster<f64> {
        self.map.occupancy()
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(self.clone()))
    }

    fn leaves_out(&self) -> bool {
        self.rule.max_range_m.is_finite()
    }

    fn work(&self) -> Work {
        Work { cells: self.cells, bytes: self.map.held() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::GridSpec;
    use proptest::prelude::*;
    use sensor::{Laser, Pose};
    use std::sync::Arc;

    fn mapper(width: usize, height: usize) -> WideningBeamsMapper {
        let grid = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width, height };
        WideningBeamsMapper::new(&Model::new(grid, Arc::new(Laser::default())), WideningBeams::MRPT)
    }

    fn scan(bearings_rad: &[f64], readings: &[Option<f64>]) -> Scan {
        let pose = Pose { x_m: 0.05, y_m: 1.05, theta_rad: 0.0 };
        Scan { sensor: 0, time_s: 0.0, pose, bearings_rad: bearings_rad.to_vec(), readings: readings.to_vec() }
    }

    /// Three rays 0.2 rad apart at 1.5 m: 15 cells out, the middle one is 0.3 m wide.
    #[test]
    fn a_far_reading_is_as_wide_as_its_wedge() {
        let mut mapper = mapper(30, 21);
        mapper.integrate(&scan(&[-0.2, 0.0, 0.2], &[None, Some(1.5), None]));
        let p = |column, row| mapper.occupancy()[mapper.map.spec().index(column, row)];
        for row in [9, 10, 11] {
            assert!((p(15, row) - WideningBeams::MRPT.hit).abs() < 1e-12, "{row}");
            assert!((p(13, row) - WideningBeams::MRPT.miss).abs() < 1e-12, "{row}");
        }
        assert!((p(15, 12) - 0.1).abs() < 1e-12 && (p(3, 11) - 0.1).abs() < 1e-12, "wide where it is far");
        assert!((p(17, 10) - 0.1).abs() < 1e-12, "unknown behind");
    }

    #[test]
    fn no_echo_clears_half_as_far_as_the_reading_before_and_far_readings_hit_nothing() {
        let cleared = |readings: &[Option<f64>]| {
            let mut mapper = mapper(200, 21);
            mapper.integrate(&scan(&[0.0, 1e-3], readings));
            let row = (0..200).map(|column| mapper.occupancy()[mapper.map.spec().index(column, 10)]);
            let row: Vec<f64> = row.collect();
            assert!(readings.iter().flatten().any(|r| *r < 15.0) || row.iter().all(|p| *p < 0.5));
            row.iter().take_while(|p| **p < 0.36 && (**p - 0.1).abs() > 1e-9).count()
        };
        assert_eq!(cleared(&[None, Some(f64::INFINITY)]), 75, "0.05 + 7.5 - 0.1 m");
        assert_eq!(cleared(&[Some(4.0), None]), 40);
        assert_eq!(cleared(&[Some(16.0), None]), 150, "up to 15 m, one cell short");
        assert_eq!(cleared(&[Some(0.05), None]), 0, "nearer than a cell");
    }

    proptest! {
        /// Sampled: the map of rays of which every cell is asked about by many points in it.
        #[test]
        fn cells_are_those_that_hold_points_of_the_wedge(
            at in prop::array::uniform2(0.1f64..2.9), theta_rad in -4.0f64..4.0,
            ranges in prop::collection::vec(prop::option::of(0.05f64..4.0), 9),
        ) {
            let mut mapper = mapper(30, 30);
            let pose = Pose { x_m: at[0], y_m: at[1], theta_rad };
            let bearings_rad: Vec<f64> = (-4..=4).map(|k| 0.06 * f64::from(k)).collect();
            let scan = Scan { sensor: 0, time_s: 0.0, pose, bearings_rad, readings: ranges };
            mapper.integrate(&scan);
            let rule = WideningBeams::MRPT;
            let odds = |p: f64| (p / (1.0 - p)).ln();
            // How many rays certainly miss and hit each cell, by points well inside it.
            let spec = *mapper.map.spec();
            for cell in 0..spec.cells() {
                let corner = spec.corner(cell);
                let points = (0..400).map(|k| [0, 1].map(|a| {
                    corner[a] + 0.1 * (0.025 + 0.05 * f64::from([k % 20, k / 20][a]))
                }));
                let points: Vec<[f64; 2]> = points.collect();
                let (mut misses, mut hits) = (0, 0);
                for ray in scan.rays() {
                    let Some(range) = ray.reading.filter(|r| *r >= 0.1) else { continue };
                    // Depth along the ray, and the tangent of the angle to it.
                    let along = |p: &[f64; 2]| {
                        let (dx, dy) = (p[0] - at[0], p[1] - at[1]);
                        let [ux, uy] = ray.direction;
                        (dx * ux + dy * uy, (ux * dy - uy * dx) / (dx * ux + dy * uy))
                    };
                    let tan = 0.03f64.tan();
                    let free = |p: &[f64; 2]| {
                        let (d, t) = along(p);
                        d > 0.0 && d <= (range - 0.1) * 0.03f64.cos() && t.abs() <= tan
                    };
                    let edge = |p: &[f64; 2]| {
                        let (d, t) = along(p);
                        d > 0.0 && (d - range * 0.03f64.cos()).abs() < 2.5e-3 && t.abs() <= tan
                    };
                    misses += i32::from(points.iter().any(free));
                    hits += i32::from(points.iter().any(edge));
                }
                let p = mapper.occupancy()[cell];
                let found = if (p - 0.1).abs() < 1e-12 { 0.0 } else { odds(p) };
                // Points miss what a wedge only clips, never the other way round: a lower bound on both counts.
                let best = (0..=9).flat_map(|m| (0..=9).map(move |h| (m, h)))
                    .find(|(m, h)| (f64::from(*m) * odds(rule.miss) + f64::from(*h) * odds(rule.hit) - found).abs() < 1e-9);
                if p > 1e-3 && p < 0.999 {
                    let (m, h) = best.expect("whole rays");
                    // A hit is three misses' worth: only the sum is known.
                    let excess = (m - misses) - 3 * (h - hits);
                    prop_assert!(excess.abs() <= 9, "cell {cell}: {m} {h}, by points {misses} {hits}");
                    prop_assert!((p - 0.1).abs() > 1e-12 || misses + hits == 0, "cell {cell} is met");
                }
            }
        }
    }
}
