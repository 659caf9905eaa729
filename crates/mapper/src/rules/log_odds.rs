//! The constant-increment rule that most robots run.

use std::cell::OnceCell;

use grid::Raster;
use sensor::{Ray, Scan, SensorModel, in_lanes};

use crate::belief::probability::{from_log_odds, log_odds};
use crate::fast::tiles::{Numbering, PATCH, TILE, Tiles, split};
use crate::fit::{Candidate, Fit, Fitted, Setting, numbers};
use crate::mapper::{Mapper, Work};
use crate::memory::Held as _;
use crate::model::{Model, Sensors};
use crate::ray::predictive::evidence_of_cells;
use crate::rules::range_cut;
use crate::rules::sweep::{Cells, Sweep};
use crate::tuning::Tuning;

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
    /// Range up to which a beam without echo (a reading of `f64::INFINITY`) is a miss, m; 0 where it changes nothing.
    pub no_echo_m: f64,
    /// Range beyond which a reading hits nothing and misses the cells up to it, but for the one that it lies in, m; infinite where
    /// every reading counts.
    pub max_range_m: f64,
}

impl LogOdds {
    /// The defaults of OctoMap: Hornung, Wurm, Bennewitz, Stachniss and Burgard, "OctoMap: An Efficient
    /// Probabilistic 3D Mapping Framework Based on Octrees", Autonomous Robots 34, 2013. It
    /// takes point clouds, in which a beam without echo has no point.
    pub const OCTOMAP: Self =
        Self { hit: 0.7, miss: 0.4, clamp: [0.12, 0.97], start: 0.5, no_echo_m: 0.0, max_range_m: f64::INFINITY };

    /// The same with `maxrange` of `insertPointCloud`, as the `tune` command finds it best on the tuning scenes, which are not
    /// the scenes that results are reported on. A point beyond it clears its ray up to it (`computeUpdate` in `OccupancyOcTreeBase.hxx`).
    pub const OCTOMAP_CUT: Self = Self { max_range_m: 4.0, ..Self::OCTOMAP };

    /// The defaults of Cartographer's 2D grid: Hess, Kohler, Rapp and Andor, "Real-Time Loop Closure in
    /// 2D LIDAR SLAM", ICRA 2016. A range beyond the largest is a miss of 5 m (`missing_data_ray_length`).
    pub const CARTOGRAPHER: Self =
        Self { hit: 0.55, miss: 0.49, clamp: [0.1, 0.9], start: 0.5, no_echo_m: 5.0, ..Self::OCTOMAP };

    /// The range of the cut.
    pub(crate) const CUT_FIT: Fit = Fit {
        mapper: "octomap-cut",
        built_in: || Candidate::of(Self::OCTOMAP_CUT),
        tried: || Candidate::all(range_cut::RANGES_M.map(|max_range_m| Self { max_range_m, ..Self::OCTOMAP })),
    };

    /// The rule with the values given.
    pub fn tuned(self, tuning: &Tuning) -> Self {
        let [hit, miss, start] = tuning.odds([self.hit, self.miss, self.start]);
        Self { hit, miss, start, clamp: tuning.clamp(self.clamp), ..self }
    }

    /// Log odds that a hit or a miss adds, and the clamps.
    fn steps(&self) -> Steps {
        let [low, high] = self.clamp.map(log_odds);
        Steps { start: log_odds(self.start), hit: log_odds(self.hit), miss: log_odds(self.miss), low, high }
    }
}

impl Fitted for LogOdds {
    fn parameters(&self) -> Vec<(&'static str, Setting)> {
        numbers([("max_range_m", self.max_range_m)])
    }

    fn label(&self) -> String {
        range_cut::label(self.max_range_m)
    }

    fn mapper(&self, model: &Model) -> Box<dyn Mapper> {
        Box::new(ConstantIncrements::new(model, *self))
    }
}

/// A rule in log odds.
#[derive(Clone, Copy)]
struct Steps {
    start: f64,
    hit: f64,
    miss: f64,
    low: f64,
    high: f64,
}

/// A tile of the map: 8.3 bytes per cell.
#[derive(Clone)]
pub(super) struct Tile {
    /// NaN in a cell that was never updated.
    pub(super) log_odds: [f64; TILE],
    /// Cells that the scan has passed through so far, a bit to each, patch by patch, ...
    missed: [u64; PATCHES],
    /// ... and those that it has ended in.
    hit: [u64; PATCHES],
    /// Whether it has come to any of them.
    touched: bool,
}

impl Tile {
    /// Places of the cells that the scan has come to so far.
    pub(super) fn looked_at(&self) -> impl Iterator<Item = usize> + use<> {
        let looked_at: [u64; PATCHES] = std::array::from_fn(|patch| self.missed[patch] | self.hit[patch]);
        (0..TILE).filter(move |place| looked_at[place / PATCH] >> (place % PATCH) & 1 == 1)
    }
}

/// Patches of a tile.
const PATCHES: usize = TILE / PATCH;

/// The mapper with this rule. O(cells up to the reading) per ray.
///
/// A reading becomes a point ([`sensor::InverseModel::range_of`]): its cell is hit, cells before it are missed,
/// up to the border where the point lies outside the map. Within one scan a cell is updated once, and
/// a hit wins over misses, as in both programs. A reading at infinity (disparity 0) has no point; it is
/// dropped and clears nothing, as point clouds drop it. A beam without echo clears as far as
/// [`LogOdds::no_echo_m`], whatever the sensor's range, and hits nothing. A cell that was never updated is unknown: it
/// reports the prior, like the unseen cells of every other mapper.
///
/// While a scan is taken, it is only noted which cells were missed and hit, a bit to each and a patch of 8 x 8 cells at a time.
/// Then every cell that was is updated, once.
#[derive(Clone)]
pub struct ConstantIncrements {
    steps: Steps,
    no_echo_m: f64,
    max_range_m: f64,
    prior: f64,
    onset: f64,
    map: Tiles<Tile>,
    sensors: Sensors,
    sweep: Sweep,
    /// The tiles that the scan has come to so far.
    touched: Vec<usize>,
    cells: u64,
    /// The map as others see it, made when it is asked for.
    occupancy: OnceCell<Raster<f64>>,
}

impl ConstantIncrements {
    /// The unseen map.
    pub fn new(model: &Model, rule: LogOdds) -> Self {
        let unknown = Tile { log_odds: [f64::NAN; TILE], missed: [0; PATCHES], hit: [0; PATCHES], touched: false };
        Self {
            steps: rule.steps(),
            no_echo_m: rule.no_echo_m,
            max_range_m: rule.max_range_m,
            prior: model.prior.marginal(),
            onset: model.prior.onset(model.grid.cell_m),
            map: Tiles::new(Numbering::new(model.grid), unknown),
            sensors: model.sensors.clone(),
            sweep: Sweep::default(),
            touched: Vec::new(),
            cells: 0,
            occupancy: OnceCell::new(),
        }
    }

    /// Up to where a ray misses, and what becomes of the cell there; none if it does nothing.
    fn end(&self, sensor: &dyn SensorModel, ray: &Ray) -> Option<(f64, End)> {
        let reading = ray.reading?;
        if reading == f64::INFINITY {
            return Some((self.no_echo_m, End::Missed)).filter(|(until_m, _)| *until_m > 0.0);
        }
        let point_m = sensor.range_of(reading, ray.bearing_rad)?;
        Some(if point_m <= self.max_range_m { (point_m, End::Hit) } else { (self.max_range_m, End::Spared) })
    }

    /// Marks the cells of a ray up to a range (m).
    fn follow(&mut self, ray: &Ray, until_m: f64, end: End) {
        let Self { map, sweep, touched, .. } = self;
        sweep.trace(&map.numbering, ray, until_m);
        let Some(last) = sweep.last() else { return };
        for &cells in sweep.before_last() {
            touch(map, touched, cells).missed[cells.patch as usize % PATCHES] |= cells.bits;
        }
        let (tile, patch) = (touch(map, touched, last), last.patch as usize % PATCHES);
        self.cells += sweep.len() as u64;
        match end {
            _ if sweep.end_m() < until_m => tile.missed[patch] |= last.bits, // at the border
            End::Hit => tile.hit[patch] |= last.bits,
            End::Missed => tile.missed[patch] |= last.bits,
            End::Spared => self.cells -= 1,
        }
    }

    /// Takes a scan; `before` is given the number and the state of every tile that it has come to, before their cells are updated.
    pub(super) fn integrate_after(&mut self, scan: &Scan, mut before: impl FnMut(usize, &mut Tile)) {
        let sensor = std::sync::Arc::clone(self.sensors.of(scan));
        for ray in scan.rays() {
            if let Some((until_m, end)) = self.end(&*sensor, &ray) {
                self.follow(&ray, until_m, end);
            }
        }
        for number in self.touched.drain(..) {
            let tile = self.map.make(number);
            before(number, tile);
            update(tile, self.steps);
        }
        self.occupancy.take();
    }

    /// The tiles of the map.
    pub(super) fn tiles(&self) -> &Tiles<Tile> {
        &self.map
    }

    fn of_cell(&self, tile: &Tile, place: usize) -> f64 {
        let log_odds = tile.log_odds[place];
        if log_odds.is_nan() { self.prior } else { from_log_odds(log_odds) }
    }

    /// The part of the map that rays have crossed, as [`crate::FastVisibility::seen`].
    pub fn seen(&self) -> Option<Raster<f64>> {
        let (from, window) = self.map.seen()?;
        Some(self.map.raster(from, window, |tile, place| self.of_cell(tile, place)))
    }
}

/// What becomes of the cell in which a ray ends.
#[derive(Clone, Copy)]
enum End {
    /// The point lies there.
    Hit,
    /// Nothing is known to be there.
    Missed,
    /// The ray was cut short there.
    Spared,
}

/// The tile of some cells, to be marked.
#[inline(always)]
fn touch<'a>(map: &'a mut Tiles<Tile>, touched: &mut Vec<usize>, cells: Cells) -> &'a mut Tile {
    let tile = cells.patch as usize / PATCHES;
    let here = map.make(tile);
    if !here.touched {
        here.touched = true;
        touched.push(tile);
    }
    here
}

in_lanes! {
    fn update<'a>(tile: &'a mut Tile, steps: Steps) {
        update_cells(tile, steps);
    }
}

/// Adds what a scan has seen of the cells of a tile to their log odds.
#[inline(always)]
fn update_cells(Tile { log_odds, missed, hit, touched }: &mut Tile, steps: Steps) {
    *touched = false;
    for (log_odds, (missed, hit)) in log_odds.chunks_exact_mut(PATCH).zip(missed.iter_mut().zip(hit)) {
        let [seen, hits] = [*missed | *hit, *hit];
        if seen == 0 {
            continue;
        }
        (*missed, *hit) = (0, 0);
        for (k, log_odds) in log_odds.iter_mut().enumerate() {
            let before = if log_odds.is_nan() { steps.start } else { *log_odds };
            let after = before + if hits >> k & 1 == 0 { steps.miss } else { steps.hit };
            let after = if after > steps.low { after } else { steps.low };
            let after = if after < steps.high { after } else { steps.high };
            *log_odds = if seen >> k & 1 == 0 { *log_odds } else { after };
        }
    }
}

impl Mapper for ConstantIncrements {
    fn integrate(&mut self, scan: &Scan) {
        self.integrate_after(scan, |_, _| {});
    }

    fn occupancy(&self) -> &Raster<f64> {
        let spec = *self.map.numbering.spec();
        self.occupancy.get_or_init(|| self.map.raster([0, 0], spec, |tile, place| self.of_cell(tile, place)))
    }

    fn occupied(&self, cell: usize) -> f64 {
        let (tile, place) = split(self.map.numbering.of(cell));
        self.of_cell(self.map.at(tile), place)
    }

    fn evidence(&self, scan: &Scan) -> Option<f64> {
        let known = (&**self.sensors.of(scan), self.onset);
        evidence_of_cells(scan, *self.map.numbering.spec(), known, |cell| self.occupied(cell))
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(self.clone()))
    }

    fn leaves_out(&self) -> bool {
        self.max_range_m.is_finite()
    }

    fn work(&self) -> Work {
        let scan = self.sweep.held() + self.touched.held();
        Work { cells: self.cells, bytes: self.map.held() + self.occupancy.held() + scan }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::GridSpec;
    use proptest::prelude::*;
    use sensor::{InverseModel as _, Pose, Stereo};
    use std::sync::Arc;

    fn mapper(rule: LogOdds) -> ConstantIncrements {
        let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 40, height: 1 };
        let sensor = Arc::new(Stereo::default());
        ConstantIncrements::new(&Model::new(grid, sensor), rule)
    }

    fn scan(readings: &[f64]) -> Scan {
        let pose = Pose { x_m: 0.01, y_m: 0.025, theta_rad: 0.0 };
        let readings: Vec<_> = readings.iter().map(|&r| Some(r)).collect();
        Scan { sensor: 0, time_s: 0.0, pose, bearings_rad: vec![0.0; readings.len()], readings }
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

    proptest! {
        /// To the bit: every cell of every ray, one by one, in a map that is all there.
        #[test]
        fn a_map_that_grows_in_lockstep_is_the_plain_one(
            width in 1usize..70, height in 1usize..70, rays in prop::collection::vec((-4.0f64..4.0, 0.0f64..12.0), 1..40),
            at in prop::array::uniform2(0.0f64..1.0), scans in 1usize..4,
        ) {
            let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width, height };
            let model = Model::new(grid, Arc::new(Stereo { focal_baseline: 1.0, ..Stereo::default() }));
            let rule = LogOdds::OCTOMAP;
            let (mut mapper, Steps { hit, miss, low, high, .. }) = (ConstantIncrements::new(&model, rule), rule.steps());
            let mut plain: Vec<Option<f64>> = vec![None; grid.cells()];
            let pose = Pose { x_m: at[0] * 0.05 * width as f64, y_m: at[1] * 0.05 * height as f64, theta_rad: 1.0 };
            for number in 0..scans {
                let (bearings_rad, readings) = rays.iter().map(|(b, r)| (*b, Some(r * (1 + number) as f64))).unzip();
                let scan = Scan { sensor: 0, time_s: 0.0, pose, bearings_rad, readings };
                mapper.integrate(&scan);
                let mut seen = vec![0; grid.cells()];
                for ray in scan.rays() {
                    let Some(range) = Stereo { focal_baseline: 1.0, ..Stereo::default() }.range_of(ray.reading.expect("all read"), ray.bearing_rad) else { continue };
                    let mut line = grid::DigitalLine::default();
                    line.trace(&grid, ray.origin_m, ray.direction, range);
                    for (cell, exit) in line.cells().iter().zip(&line.ranges()[1..]) {
                        seen[*cell] = seen[*cell].max(if *exit >= range { 2 } else { 1 });
                    }
                }
                for (cell, seen) in seen.iter().enumerate().filter(|(_, seen)| **seen > 0) {
                    let before = plain[cell].unwrap_or_else(|| log_odds(rule.start));
                    plain[cell] = Some((before + if *seen == 2 { hit } else { miss }).clamp(low, high));
                }
            }
            for (cell, plain) in plain.iter().enumerate() {
                let expected = plain.map_or(0.1, |odds| 1.0 / (1.0 + libm::exp(-odds)));
                prop_assert_eq!(mapper.occupancy()[cell].to_bits(), expected.to_bits());
            }
            if let Some(seen) = mapper.seen() {
                prop_assert!(seen.values().iter().any(|p| (p - 0.1).abs() > 1e-9));
            }
        }
    }

    /// `insertPointCloud(.., maxrange = 1.3)` of OctoMap, asked through its Python binding (octomap-python 1.10.0) for a sensor at
    /// 0.01 m, one point at 1.51 m and then one at 1.21 m: 0.4 in cells 0 to 25, nothing in cell 26; then 0.307692, 0.608696, 0.4 in cells
    /// 23, 24, 25.
    #[test]
    fn a_point_beyond_the_range_clears_up_to_it_as_the_program_does() {
        let rule = LogOdds { max_range_m: 1.3, ..LogOdds::OCTOMAP };
        let mut mapper = mapper(rule);
        mapper.integrate(&scan(&[10.0])); // 1.51 m: 1.31 m are cleared
        let p = mapper.occupancy().values();
        assert!(p[..26].iter().all(|p| (p - 0.4).abs() < 1e-12) && p[26..].iter().all(|p| (p - 0.1).abs() < 1e-12));
        mapper.integrate(&scan(&[12.5])); // 1.2 m lie within
        for (cell, program) in [(23, 0.307_692), (24, 0.608_696), (25, 0.4), (26, 0.1)] {
            assert!((mapper.occupancy()[cell] - program).abs() < 1e-6, "{cell}");
        }
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
