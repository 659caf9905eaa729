//! The constant-increment rule that most robots run.

use std::cell::OnceCell;
use std::sync::Arc;

use grid::{GridSpec, Raster};
use pulp::{Arch, Simd, WithSimd};
use sensor::lanes::{LANES, Lanes};
use sensor::{Ray, Scan, SensorModel};

use crate::lines::Lines;
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
    /// Range up to which a beam without echo (a reading of `f64::INFINITY`) is a miss, m; 0 where it says nothing.
    pub no_echo_m: f64,
}

impl LogOdds {
    /// The defaults of OctoMap: Hornung, Wurm, Bennewitz, Stachniss and Burgard, "OctoMap: An Efficient
    /// Probabilistic 3D Mapping Framework Based on Octrees", Autonomous Robots 34, 2013. It
    /// takes point clouds, in which a beam without echo has no point.
    pub const OCTOMAP: Self = Self { hit: 0.7, miss: 0.4, clamp: [0.12, 0.97], start: 0.5, no_echo_m: 0.0 };

    /// The defaults of Cartographer's 2D grid: Hess, Kohler, Rapp and Andor, "Real-Time Loop Closure in
    /// 2D LIDAR SLAM", ICRA 2016. A range beyond the largest is a miss of 5 m (`missing_data_ray_length`).
    pub const CARTOGRAPHER: Self = Self { hit: 0.55, miss: 0.49, clamp: [0.1, 0.9], start: 0.5, no_echo_m: 5.0 };

    /// Log odds that a hit or a miss adds, and the clamps.
    fn steps(&self) -> Steps {
        let [low, high] = self.clamp.map(log_odds);
        Steps { hit: log_odds(self.hit), miss: log_odds(self.miss), low, high }
    }
}

/// A rule in log odds.
#[derive(Clone, Copy)]
struct Steps {
    hit: f64,
    miss: f64,
    low: f64,
    high: f64,
}

/// `ln(p / (1 - p))`, with `p` kept off 0 and 1.
fn log_odds(p: f64) -> f64 {
    let p = p.clamp(EPSILON, 1.0 - EPSILON);
    libm::log(p / (1.0 - p))
}

/// A cell of the map.
#[derive(Clone, Copy)]
struct Cell {
    log_odds: f64,
    /// What the scan has said of it so far.
    seen: Seen,
    /// Whether it was ever updated.
    known: bool,
}

/// What a scan has said of a cell so far; more is stronger.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
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
/// dropped and clears nothing, as point clouds drop it. A beam without echo clears as far as
/// [`LogOdds::no_echo_m`] says, whatever the sensor's range, and hits nothing. A cell that was never updated is unknown: it
/// reports the prior, like the unseen cells of every other mapper.
pub struct ConstantIncrements {
    spec: GridSpec,
    steps: Steps,
    no_echo_m: f64,
    prior: f64,
    map: Vec<Cell>,
    sensor: Arc<dyn SensorModel>,
    lines: Lines,
    touched: Vec<u32>,
    cells: u64,
    /// The map as others see it, made when it is asked for.
    occupancy: OnceCell<Raster<f64>>,
}

impl ConstantIncrements {
    /// The unseen map.
    pub fn new(setup: &Setup, rule: LogOdds) -> Self {
        let unknown = Cell { log_odds: log_odds(rule.start), seen: Seen::Nothing, known: false };
        Self {
            spec: setup.grid,
            steps: rule.steps(),
            no_echo_m: rule.no_echo_m,
            prior: setup.prior.marginal(),
            map: vec![unknown; setup.grid.cells()],
            sensor: Arc::clone(&setup.sensor),
            lines: Lines::default(),
            touched: Vec::new(),
            cells: 0,
            occupancy: OnceCell::new(),
        }
    }

    /// Up to where a ray misses, and where it hits, m; none if it does neither.
    fn ends(&self, ray: &Ray) -> Option<Ends> {
        let reading = ray.reading?;
        if reading == f64::INFINITY {
            let ends = Ends { until_m: self.no_echo_m, hit_m: f64::INFINITY };
            return Some(ends).filter(|ends| ends.until_m > 0.0);
        }
        let point_m = self.sensor.range_of(reading, ray.bearing_rad)?;
        Some(Ends { until_m: point_m, hit_m: point_m })
    }

    /// Marks the cells of some rays; `touched` has so many of them already.
    fn mark(&mut self, rays: &[(Ray, Ends)], touched: usize) -> usize {
        self.lines.reset(&self.spec);
        let mut ranges = [f64::INFINITY; LANES];
        for (lane, (ray, ends)) in rays.iter().enumerate() {
            self.lines.start(lane, &self.spec, ray.origin_m, ray.direction, ends.until_m);
            ranges[lane] = ends.hit_m;
        }
        let longest = LANES * (self.spec.width + self.spec.height);
        if self.touched.len() < touched + longest {
            self.touched.resize((touched + longest).next_power_of_two(), 0);
        }
        Arch::new().dispatch(Mark { mapper: self, ranges, touched })
    }
}

/// Where a ray ends.
#[derive(Clone, Copy)]
struct Ends {
    /// Range up to which its cells are marked, m.
    until_m: f64,
    /// Range at which a cell is hit, m; infinite if none is.
    hit_m: f64,
}

/// Following rays to their points, with what the processor has; gives how many cells are touched then.
struct Mark<'a> {
    mapper: &'a mut ConstantIncrements,
    ranges: Lanes<f64>,
    touched: usize,
}

impl WithSimd for Mark<'_> {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        let Self { mapper, ranges, mut touched } = self;
        let mut lines = mapper.lines.clone();
        while !lines.done() {
            let (cell, alive) = (lines.cell(), lines.alive);
            let step = lines.step();
            for l in 0..LANES {
                if alive[l] > 0.0 {
                    let here = &mut mapper.map[cell[l] as usize];
                    mapper.touched[touched] = cell[l];
                    touched += usize::from(here.seen == Seen::Nothing);
                    let seen = if step.exit[l] >= ranges[l] { Seen::Hit } else { Seen::Miss };
                    here.seen = here.seen.max(seen);
                    mapper.cells += 1;
                }
            }
        }
        touched
    }
}

impl Mapper for ConstantIncrements {
    fn integrate(&mut self, scan: &Scan) {
        let rays: Vec<(Ray, Ends)> = scan.rays().filter_map(|ray| Some((ray, self.ends(&ray)?))).collect();
        let touched = rays.chunks(LANES).fold(0, |touched, rays| self.mark(rays, touched));
        let Steps { hit, miss, low, high } = self.steps;
        for &cell in &self.touched[..touched] {
            let here = &mut self.map[cell as usize];
            let step = if here.seen == Seen::Hit { hit } else { miss };
            *here = Cell { log_odds: (here.log_odds + step).clamp(low, high), seen: Seen::Nothing, known: true };
        }
        self.occupancy.take();
    }

    fn occupancy(&self) -> &Raster<f64> {
        let occupied = |cell: &Cell| {
            let p = if cell.known { 1.0 / (1.0 + libm::exp(-cell.log_odds)) } else { return self.prior };
            p.clamp(EPSILON, 1.0 - EPSILON)
        };
        self.occupancy.get_or_init(|| Raster::new(self.spec, self.map.iter().map(occupied).collect()))
    }

    fn work(&self) -> Work {
        Work { cells: self.cells, bytes: self.map.held() + self.touched.held() + self.occupancy.held() }
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

    #[test]
    fn a_beam_without_echo_hits_nothing_and_clears_as_far_as_the_rule_says() {
        for (rule, cleared) in [(LogOdds { no_echo_m: 1.0, ..LogOdds::CARTOGRAPHER }, 21), (LogOdds::OCTOMAP, 0)] {
            let mut mapper = mapper(rule);
            mapper.integrate(&scan(&[f64::INFINITY]));
            let p = mapper.occupancy().values(); // 1.01 m from the border: up to cell 20
            assert!(p[..cleared].iter().all(|p| (p - rule.miss).abs() < 1e-12), "{p:?}");
            assert!(p[cleared..].iter().all(|p| (p - 0.1).abs() < 1e-12), "{p:?}");
        }
    }
}
