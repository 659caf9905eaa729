//! The constant-increment rule that most robots run.

use std::sync::Arc;

use grid::{DigitalLine, Raster};
use sensor::{Scan, SensorModel};

use crate::work::{Held as _, Work};
use crate::{EPSILON, Mapper, catalogue::Setup};

/// A log-odds grid with one constant for a hit and one for a miss.
///
/// The probabilities are those of the inverse sensor model, at even odds beforehand: a hit adds
/// `ln(hit / (1 - hit))`, a miss `ln(miss / (1 - miss))`, and the sum stays within the clamps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogOdds {
    /// Probability of a cell with one hit, above 0.5.
    pub hit: f64,
    /// Probability of a cell with one miss, below 0.5.
    pub miss: f64,
    /// Least and largest probability of a cell that was updated.
    pub clamp: [f64; 2],
    /// Probability from which a cell's first update starts. 0.5 in both presets, as in the programs
    /// they come from, whose increments and clamps are made for it: started at a prior of 0.1, a cell
    /// would lie below OctoMap's lower clamp, and a miss would make it more occupied.
    pub start: f64,
}

impl LogOdds {
    /// The defaults of OctoMap: Hornung, Wurm, Bennewitz, Stachniss and Burgard, "OctoMap: An Efficient
    /// Probabilistic 3D Mapping Framework Based on Octrees", Autonomous Robots 34, 2013.
    pub const OCTOMAP: Self = Self { hit: 0.7, miss: 0.4, clamp: [0.12, 0.97], start: 0.5 };

    /// The defaults of Cartographer's 2D grid: Hess, Kohler, Rapp and Andor, "Real-Time Loop Closure in
    /// 2D LIDAR SLAM", ICRA 2016.
    pub const CARTOGRAPHER: Self = Self { hit: 0.55, miss: 0.49, clamp: [0.1, 0.9], start: 0.5 };

    /// Log odds of a cell after one more hit or miss; `before` is none before the first.
    pub fn update(&self, before: Option<f64>, hit: bool) -> f64 {
        let step = log_odds(if hit { self.hit } else { self.miss });
        let [low, high] = self.clamp.map(log_odds);
        (before.unwrap_or(log_odds(self.start)) + step).clamp(low, high)
    }
}

/// `ln(p / (1 - p))`, with `p` kept off 0 and 1.
fn log_odds(p: f64) -> f64 {
    let p = p.clamp(EPSILON, 1.0 - EPSILON);
    libm::log(p / (1.0 - p))
}

/// What a scan has said of a cell so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Seen {
    Nothing,
    Miss,
    Hit,
}

/// The mapper with this rule. O(cells up to the reading) per ray.
///
/// A reading becomes a point ([`SensorModel::range_of`]): its cell is hit, cells before it are missed,
/// up to the border where the point lies outside the map. Within one scan a cell is updated once, and
/// a hit wins over misses, as in both programs. A reading at infinity (disparity 0) has no point; it is
/// dropped and clears nothing, as point clouds drop it. A cell that was never updated is unknown: it
/// reports the prior, like the unseen cells of every other mapper.
pub struct ConstantIncrements {
    rule: LogOdds,
    occupancy: Raster<f64>,
    log_odds: Vec<Option<f64>>,
    sensor: Arc<dyn SensorModel>,
    line: DigitalLine,
    seen: Vec<Seen>,
    touched: Vec<usize>,
    cells: u64,
}

impl ConstantIncrements {
    /// The unseen map.
    pub fn new(setup: &Setup, rule: LogOdds) -> Self {
        let cells = setup.grid.cells();
        Self {
            rule,
            occupancy: Raster::filled(setup.grid, setup.prior.marginal()),
            log_odds: vec![None; cells],
            sensor: Arc::clone(&setup.sensor),
            line: DigitalLine::default(),
            seen: vec![Seen::Nothing; cells],
            touched: Vec::new(),
            cells: 0,
        }
    }

    fn mark(&mut self, range: f64) {
        let inside = self.line.ranges().last().is_some_and(|&end| end >= range);
        for (k, &cell) in self.line.cells().iter().enumerate() {
            if self.seen[cell] == Seen::Nothing {
                self.touched.push(cell);
            }
            if inside && k + 1 == self.line.len() {
                self.seen[cell] = Seen::Hit;
            } else if self.seen[cell] == Seen::Nothing {
                self.seen[cell] = Seen::Miss;
            }
        }
    }
}

impl Mapper for ConstantIncrements {
    fn integrate(&mut self, scan: &Scan) {
        for ray in scan.rays() {
            let range = ray.reading.and_then(|reading| self.sensor.range_of(reading, ray.bearing_rad));
            let Some(range) = range else { continue };
            self.line.trace(self.occupancy.spec(), ray.origin_m, ray.direction, range);
            self.mark(range);
            self.cells += self.line.len() as u64;
        }
        for cell in self.touched.drain(..) {
            let hit = std::mem::replace(&mut self.seen[cell], Seen::Nothing) == Seen::Hit;
            let after = self.rule.update(self.log_odds[cell], hit);
            self.log_odds[cell] = Some(after);
            self.occupancy[cell] = (1.0 / (1.0 + libm::exp(-after))).clamp(EPSILON, 1.0 - EPSILON);
        }
    }

    fn occupancy(&self) -> &Raster<f64> {
        &self.occupancy
    }

    fn work(&self) -> Work {
        let map = self.occupancy.held() + self.log_odds.held();
        Work { cells: self.cells, bytes: map + self.seen.held() + self.touched.held() + self.line.held() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::GridSpec;
    use sensor::{Pose, Stereo};

    fn mapper(rule: LogOdds) -> ConstantIncrements {
        let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 40, height: 1 };
        let sensor = Arc::new(Stereo::default());
        ConstantIncrements::new(&Setup::new(grid, sensor), rule)
    }

    fn scan(readings: &[f64]) -> Scan {
        let pose = Pose { x_m: 0.01, y_m: 0.025, theta_rad: 0.0 };
        let readings: Vec<_> = readings.iter().map(|&r| Some(r)).collect();
        Scan { time_s: 0.0, pose, bearings_rad: vec![0.0; readings.len()], readings }
    }

    /// `p` after the given odds ratios, from even odds.
    fn after(ratios: &[f64]) -> f64 {
        let odds: f64 = ratios.iter().product();
        odds / (1.0 + odds)
    }

    #[test]
    fn one_scan_by_hand() {
        let mut mapper = mapper(LogOdds::OCTOMAP);
        mapper.integrate(&scan(&[10.0])); // 1.51 m from the wall: cell 30
        let p = mapper.occupancy().values();
        assert!(p[..30].iter().all(|p| (p - 0.4).abs() < 1e-12));
        assert!((p[30] - 0.7).abs() < 1e-12);
        assert!(p[31..].iter().all(|p| (p - 0.1).abs() < 1e-12), "never updated: the prior");
    }

    #[test]
    fn a_cell_is_updated_once_per_scan_and_a_hit_wins() {
        for order in [[10.0, 12.0, 10.0], [12.0, 10.0, 10.0], [10.0, 10.0, 12.0]] {
            let mut mapper = mapper(LogOdds::OCTOMAP);
            mapper.integrate(&scan(&order)); // 15 / 12 = 1.25 m: cell 25, in front of cell 30
            let p = mapper.occupancy().values();
            assert!((p[25] - 0.7).abs() < 1e-12 && (p[30] - 0.7).abs() < 1e-12, "{order:?}");
            assert!((p[27] - 0.4).abs() < 1e-12 && (p[3] - 0.4).abs() < 1e-12, "{order:?}");
        }
    }

    #[test]
    fn odds_multiply_up_to_the_clamps() {
        let mut mapper = mapper(LogOdds::CARTOGRAPHER);
        for _ in 0..2 {
            mapper.integrate(&scan(&[10.0]));
        }
        let [hit, miss] = [0.55 / 0.45, 0.49 / 0.51];
        assert!((mapper.occupancy()[30] - after(&[hit, hit])).abs() < 1e-12);
        assert!((mapper.occupancy()[3] - after(&[miss, miss])).abs() < 1e-12);
        for _ in 0..200 {
            mapper.integrate(&scan(&[10.0]));
        }
        assert!((mapper.occupancy()[30] - 0.9).abs() < 1e-12 && (mapper.occupancy()[3] - 0.1).abs() < 1e-12);
    }

    /// Hornung et al. (2013): 0.12 and 0.97.
    #[test]
    fn octomap_stops_at_its_own_clamps() {
        let mut mapper = mapper(LogOdds::OCTOMAP);
        for _ in 0..20 {
            mapper.integrate(&scan(&[10.0]));
        }
        assert!((mapper.occupancy()[30] - 0.97).abs() < 1e-12 && (mapper.occupancy()[3] - 0.12).abs() < 1e-12);
    }

    #[test]
    fn points_outside_the_map_clear_up_to_the_border_and_infinity_clears_nothing() {
        let mut mapper = mapper(LogOdds::OCTOMAP);
        mapper.integrate(&scan(&[0.0]));
        assert!(mapper.occupancy().values().iter().all(|p| (p - 0.1).abs() < 1e-12));
        mapper.integrate(&scan(&[3.0])); // 5 m; the map ends at 2 m
        assert!(mapper.occupancy().values().iter().all(|p| (p - 0.4).abs() < 1e-12));
    }
}
