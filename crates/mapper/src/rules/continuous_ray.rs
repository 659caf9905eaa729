//! Noise along the ray: a reading spreads over as many cells as its range is uncertain.
//!
//! The continuous ray of wavemap: Reijgwart, Cadena, Siegwart and Ott, "Efficient volumetric mapping of multi-scale
//! environments using wavelet-based compression", RSS 2023, Section IV; `continuous_ray.h` and `approximate_gaussian_distribution.h` of
//! wavemap 2.2, with the values of its configurations for depth cameras (`wavemap_panoptic_mapping_rgbd.yaml`). The
//! inverse model it makes continuous is that of Loop, Cai, Orts-Escolano and Chou, "A closed-form Bayesian fusion equation using
//! occupancy probabilities", 3DV 2016.

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

/// What a ray says of a cell at a distance `d` from the sensor, of a reading at range `z`, by `f = (d - z) / sigma`:
///
/// ```text
/// p = 1/2 + s (C(f) - C(f - 3) / 2 - 1/2),   s = scaling_free below 1/2, scaling_occupied above
/// ```
///
/// with `C` a cubic spline like the cumulative normal distribution. That is free in front of `-3 sigma`, most occupied 1.75 sigma behind
/// the reading, since a surface is taken to be 3 sigma thick, and nothing is said from `6 sigma` on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContinuousRay {
    /// `sigma` in cells, at least; above 0.
    pub sigma_cells: f64,
    /// `sigma` as a share of half the range that the sensor's bin about the reading covers ([`sensor::InverseModel::half_bin`]), at
    /// least: 0 where it does not depend on the reading, as wavemap has it.
    pub sigma_bins: f64,
    /// How far a free cell moves from even odds, 0 to 1.
    pub scaling_free: f64,
    /// How far an occupied one does, 0 to 1.
    pub scaling_occupied: f64,
    /// Probability from which a cell's first update starts.
    pub start: f64,
    /// Least and largest probability of a cell that was updated.
    pub clamp: [f64; 2],
}

impl ContinuousRay {
    /// The program's: half a cell, as in its configurations for depth cameras; log odds from -2 to 4.
    pub const WAVEMAP: Self = Self {
        sigma_cells: 0.5,
        sigma_bins: 0.0,
        scaling_free: 0.2,
        scaling_occupied: 0.4,
        start: 0.5,
        clamp: [0.119_202_922_022_117_57, 0.982_013_790_037_908_4],
    };

    /// What the `tune` command finds best on the tuning scenes, which are not the scenes that results are reported on.
    pub const TUNED: Self =
        Self { sigma_cells: 2.0, scaling_occupied: 0.8, start: 0.1, clamp: [0.002, 0.5], ..Self::WAVEMAP };

    /// The rule with the values given.
    pub fn tuned(self, tuning: &Tuning) -> Self {
        Self { start: tuning.start.unwrap_or(self.start), clamp: tuning.clamp(self.clamp), ..self }
    }

    /// Candidates and choice.
    pub(crate) const FIT: Fit = Fit {
        mapper: "wavemap-tuned",
        built_in: || Candidate::of(Self::TUNED),
        tried: || {
            let sigmas = [(1.0, 0.0), (2.0, 0.0), (4.0, 0.0), (0.5, 0.5)];
            let sized = sigmas.map(|(sigma_cells, sigma_bins)| Self { sigma_cells, sigma_bins, ..Self::WAVEMAP });
            let scaled = |rule: Self| {
                let scalings = [[0.1, 0.4], [0.2, 0.8], [0.3, 0.9]];
                scalings.map(|[scaling_free, scaling_occupied]| Self { scaling_free, scaling_occupied, ..rule })
            };
            let started = |rule: Self| {
                let clamps = [[0.002, 0.5], [0.005, 0.5], [0.005, 0.7]].map(|clamp| Self { start: 0.1, clamp, ..rule });
                clamps.into_iter().chain([rule])
            };
            let rules = sized.into_iter().flat_map(scaled).flat_map(started);
            Candidate::all(rules)
        },
    };

    /// `sigma` of a reading with a range, m.
    fn sigma_m(&self, sensor: &dyn SensorModel, reading: f64, bearing: f64, range_m: f64, cell_m: f64) -> f64 {
        let half = sensor.half_bin(cell_m);
        let end = |reading: f64| sensor.range_of(reading.max(0.0), bearing);
        let spread = |to: f64| end(to).map_or(range_m, |to_m| (to_m - range_m).abs());
        // The side of the bin that is nearer, which is finite for every sensor.
        let bin_m = spread(reading - half).min(spread(reading + half));
        (self.sigma_cells * cell_m).max(self.sigma_bins * bin_m)
    }

    /// The log odds that a reading adds to a cell `ahead_sigmas` behind it.
    fn update(&self, ahead_sigmas: f64) -> f64 {
        let moved = cumulative(ahead_sigmas) - 0.5 * cumulative(ahead_sigmas - 3.0) - 0.5;
        log_odds(0.5 + moved * if moved < 0.0 { self.scaling_free } else { self.scaling_occupied })
    }
}

/// Up to so many sigma in front of the reading, all is free.
const FRONT: f64 = 3.0;

/// From so many sigma behind the reading on, nothing is said.
const BEHIND: f64 = 6.0;

/// The spline: the cumulative distribution of the mean of three uniform variables, from -3 to 3.
fn cumulative(t: f64) -> f64 {
    let cube = |x: f64| x * x * x / 48.0;
    match t {
        t if t < -3.0 => 0.0,
        t if t <= -1.0 => cube(t + 3.0),
        t if t < 1.0 => 0.5 + t * (t + 3.0) * (3.0 - t) / 24.0,
        t if t <= 3.0 => 1.0 - cube(3.0 - t),
        _ => 1.0,
    }
}

impl Fitted for ContinuousRay {
    fn parameters(&self) -> Vec<(&'static str, Setting)> {
        numbers([
            ("sigma_cells", self.sigma_cells),
            ("sigma_bins", self.sigma_bins),
            ("scaling_free", self.scaling_free),
            ("scaling_occupied", self.scaling_occupied),
            ("start", self.start),
            ("clamp_low", self.clamp[0]),
            ("clamp_high", self.clamp[1]),
        ])
    }

    fn label(&self) -> String {
        let Self { sigma_cells: cells, sigma_bins: bins, scaling_free: f, scaling_occupied: o, .. } = self;
        let Self { start, clamp: [low, high], .. } = self;
        format!("{cells}/{bins} {f}/{o} {start}: {low:.3}..{high:.2}")
    }

    fn mapper(&self, model: &Model) -> Box<dyn Mapper> {
        Box::new(ContinuousRays::new(model, *self))
    }
}

/// The mapper with this rule. O(cells that the scan sees) per scan, some 40 ns each.
///
/// As in the program, a cell is updated once per scan, by the ray nearest to its centre, however many cross it; the centre's distance to the
/// sensor is what counts. Readings without a range and beams without echo say nothing.
#[derive(Clone)]
pub struct ContinuousRays {
    rule: ContinuousRay,
    map: OddsMap,
    sensors: Sensors,
    cells: u64,
}

impl ContinuousRays {
    /// The unknown map.
    pub fn new(model: &Model, rule: ContinuousRay) -> Self {
        Self { rule, map: OddsMap::new(model, rule.start, rule.clamp), sensors: model.sensors.clone(), cells: 0 }
    }

    /// Updates the cells of a wedge whose ray reads `range_m`.
    fn add(&mut self, wedge: &Wedge, range_m: f64, sigma_m: f64) {
        let until_m = range_m + BEHIND * sigma_m;
        let [from_x, from_y] = wedge.ray.origin_m;
        // Beyond the arc, so that the triangle holds the sector.
        let far_m = until_m / libm::cos(wedge.half_rad[0].max(wedge.half_rad[1]));
        let [first, second] = wedge.ends(far_m);
        let (spec, rule) = (*self.map.spec(), self.rule);
        let free = rule.update(f64::NEG_INFINITY);
        let (mut odds, cells) = (self.map.change(), &mut self.cells);
        cells_of_triangle(&spec, [wedge.ray.origin_m, first, second], |row, columns| {
            let mut offset = [0.0, spec.centre_at(columns.start, row)[1] - from_y];
            for column in columns {
                offset[0] = spec.centre_at(column, row)[0] - from_x;
                if !wedge.holds(offset) {
                    continue;
                }
                let distance_m = libm::hypot(offset[0], offset[1]);
                if distance_m <= until_m {
                    let (cell, ahead_sigmas) = (spec.index(column, row), (distance_m - range_m) / sigma_m);
                    odds.add(cell..cell + 1, if ahead_sigmas < -FRONT { free } else { rule.update(ahead_sigmas) });
                    *cells += 1;
                }
            }
        });
    }
}

impl Mapper for ContinuousRays {
    fn integrate(&mut self, scan: &Scan) {
        let cell_m = self.map.spec().cell_m;
        if self.map.spec().locate(scan.pose.position_m()).is_none() {
            return;
        }
        let sensor = std::sync::Arc::clone(self.sensors.of(scan));
        for wedge in wedges(scan) {
            let bearing = wedge.ray.bearing_rad;
            let Some(reading) = wedge.ray.reading else { continue };
            let Some(range_m) = sensor.range_of(reading, bearing) else { continue };
            let sigma_m = self.rule.sigma_m(&*sensor, reading, bearing, range_m, cell_m);
            self.add(&wedge, range_m, sigma_m);
        }
    }

    fn occupancy(&self) -> &Raster<f64> {
        self.map.occupancy()
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(self.clone()))
    }

    fn leaves_out(&self) -> bool {
        true
    }

    fn work(&self) -> Work {
        Work { cells: self.cells, bytes: self.map.held() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::probability::from_log_odds;
    use grid::GridSpec;
    use proptest::prelude::*;
    use sensor::{Laser, Pose, Stereo};
    use std::sync::Arc;

    /// The spline is the density of three uniform variables on -1 ..= 1 added up, integrated: here by a sum over two of them.
    #[test]
    fn the_spline_is_that_of_three_uniform_variables() {
        let below = |t: f64| (t + 1.0).clamp(0.0, 2.0) / 2.0;
        for t in [-3.5, -2.9, -1.7, -1.0, -0.4, 0.0, 0.8, 1.0, 1.9, 2.99, 4.0] {
            let n = 400;
            let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n) * 2.0 - 1.0;
            let all = (0..n).flat_map(|i| (0..n).map(move |j| below(t - at(i) - at(j)))).sum::<f64>();
            let expected = all / f64::from(n * n);
            assert!((cumulative(t) - expected).abs() < 1e-5, "{t}: {} {expected}", cumulative(t));
        }
    }

    /// Values worked out by hand from the formulas of the program.
    #[test]
    fn one_cell_by_hand() {
        let p = |f: f64| from_log_odds(ContinuousRay::WAVEMAP.update(f));
        assert!((p(-5.0) - 0.4).abs() < 1e-12, "free: 1/2 - 0.2 / 2");
        assert!((p(0.0) - 0.5).abs() < 1e-12, "at the reading: even odds");
        // C(1.5) = 1 - 1.5^3 / 48 = 0.9296875, C(-1.5) = 1.5^3 / 48 = 0.0703125: 0.39453125 of 0.4.
        assert!((p(1.5) - (0.5 + 0.4 * 0.394_531_25)).abs() < 1e-12);
        assert!((p(-1.5) - (0.5 + 0.2 * (0.070_312_5 - 0.5))).abs() < 1e-12);
        assert!((p(3.0) - (0.5 + 0.4 * 0.25)).abs() < 1e-12);
        assert!((p(6.0) - 0.5).abs() < 1e-12, "and nothing from six sigma on");
    }

    #[test]
    fn sigma_is_half_a_cell_or_follows_the_bin() {
        let stereo = Stereo::default();
        let rule = |sigma_bins| ContinuousRay { sigma_bins, ..ContinuousRay::WAVEMAP };
        let sigma = |rule: ContinuousRay, o: f64| rule.sigma_m(&stereo, o, 0.0, 15.0 / o, 0.05);
        assert!((sigma(rule(0.0), 3.0) - 0.025).abs() < 1e-12);
        assert!((sigma(rule(1.0), 3.0) - (5.0 - 15.0 / 3.5)).abs() < 1e-12);
        assert!((sigma(rule(1.0), 0.3) - (50.0 - 15.0 / 0.8)).abs() < 1e-9, "the far side of the bin is at infinity");
        let laser = Laser { range_sigma_m: 0.03, ..Laser::default() };
        assert!((rule(1.0).sigma_m(&laser, 2.0, 0.0, 2.0, 0.05) - 0.03).abs() < 1e-12);
    }

    proptest! {
        /// Every cell of the map by itself: its nearest ray by the angle between their directions, and the formula.
        #[test]
        fn every_cell_takes_what_its_nearest_ray_says(
            at in prop::array::uniform2(0.1f64..2.9), theta_rad in -4.0f64..4.0,
            ranges in prop::collection::vec(prop::option::of(0.3f64..4.0), 30), scans in 1usize..3, sigma_bins in 0.0f64..2.0,
        ) {
            let spec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: 30, height: 30 };
            let laser = Laser::default();
            let model = Model::new(spec, Arc::new(laser));
            let rule = ContinuousRay { sigma_bins, ..ContinuousRay::WAVEMAP };
            let bearings_rad: Vec<f64> = (0..30).map(|k| 0.04 * (f64::from(k) - 14.5)).collect();
            let pose = Pose { x_m: at[0], y_m: at[1], theta_rad };
            let scan = Scan { sensor: 0, time_s: 0.0, pose, bearings_rad, readings: ranges };
            let mut mapper = ContinuousRays::new(&model, rule);
            (0..scans).for_each(|_| mapper.integrate(&scan));
            let [low, high] = rule.clamp.map(|p| (p / (1.0 - p)).ln());
            for cell in 0..spec.cells() {
                let [x, y] = spec.centre(cell);
                let (dx, dy) = (x - at[0], y - at[1]);
                let distance = dx.hypot(dy);
                let away = |bearing: f64| {
                    let [ux, uy] = pose.direction(bearing);
                    ((ux * dx + uy * dy) / distance).clamp(-1.0, 1.0).acos()
                };
                let rays = scan.bearings_rad.iter().zip(&scan.readings);
                let mut rays: Vec<(f64, Option<f64>)> = rays.map(|(b, r)| (away(*b), *r)).collect();
                rays.sort_by(|a, b| a.0.total_cmp(&b.0));
                let (angle, reading) = rays[0];
                // Where two rays are as near as each other, either may be the one.
                if rays[1].0 - angle < 1e-6 || (angle - 0.02).abs() < 1e-6 {
                    continue;
                }
                let sigma = 0.05f64.max(sigma_bins * 0.05);
                let heard = reading.filter(|z| angle < 0.02 && distance <= z + 6.0 * sigma);
                let expected = heard.map_or(0.1, |z| {
                    let f = (distance - z) / sigma;
                    let part = cumulative(f) - 0.5 * cumulative(f - 3.0) - 0.5;
                    let p = 0.5 + part * if part < 0.0 { 0.2 } else { 0.4 };
                    let mut odds = 0.0f64;
                    (0..scans).for_each(|_| odds = (odds + (p / (1.0 - p)).ln()).clamp(low, high));
                    1.0 / (1.0 + (-odds).exp())
                });
                prop_assert!((mapper.occupancy()[cell] - expected).abs() < 1e-9, "{cell}: {expected}");
            }
        }
    }
}
