//! Constant increments whose effect grows old: what a cell was is worth less, the longer ago it was looked at.

use std::cell::OnceCell;

use grid::Raster;
use sensor::Scan;

use crate::fast::tiles::{Numbering, TILE, Tiles};
use crate::mapper::{Mapper, Work};
use crate::memory::Held as _;
use crate::model::Model;
use crate::rules::log_odds::{ConstantIncrements, LogOdds};

/// What becomes of a cell between two looks.
pub trait Ageing: Clone + Send + 'static {
    /// The state of a cell so long after it was `state`, s, 0 or more. Ageing twice is ageing for the sum of the times.
    fn aged(&self, state: f64, time_s: f64) -> f64;

    /// Probability that a cell in a state is occupied.
    fn occupied(&self, state: f64) -> f64;
}

/// A grid of constant increments ([`ConstantIncrements`], with its cells, hits and misses), whose cells age by the times of the
/// scans ([`Scan::time_s`]). O(cells up to the reading) per ray: a cell is aged when it is looked at and when it is asked for, so that
/// what is not looked at costs nothing.
///
/// A state is what the increments are added to: log odds of evidence, or of occupancy, as the ageing takes it. The map is that of the
/// time of the last scan. Time does not run backwards: scans of an earlier time count as of the latest so far.
#[derive(Clone)]
pub struct AgeingIncrements<A> {
    increments: ConstantIncrements,
    /// When each cell was updated last, s.
    updated_s: Tiles<[f64; TILE]>,
    ageing: A,
    prior: f64,
    now_s: f64,
    /// The map as others see it, made when it is asked for.
    occupancy: OnceCell<Raster<f64>>,
}

impl<A: Ageing> AgeingIncrements<A> {
    /// The unseen map.
    pub fn new(model: &Model, rule: LogOdds, ageing: A) -> Self {
        Self {
            increments: ConstantIncrements::new(model, rule),
            updated_s: Tiles::new(Numbering::new(model.grid), [f64::NEG_INFINITY; TILE]),
            ageing,
            prior: model.prior.marginal(),
            now_s: f64::NEG_INFINITY,
            occupancy: OnceCell::new(),
        }
    }

    /// The map now.
    fn raster(&self) -> Raster<f64> {
        let tiles = self.increments.tiles();
        tiles.raster_by_number([0, 0], *tiles.numbering.spec(), |tile, place| {
            let state = tiles.at(tile).log_odds[place];
            if state.is_nan() {
                return self.prior;
            }
            self.ageing.occupied(self.ageing.aged(state, self.now_s - self.updated_s.at(tile)[place]))
        })
    }
}

impl<A: Ageing> Mapper for AgeingIncrements<A> {
    fn integrate(&mut self, scan: &Scan) {
        let Self { increments, updated_s, ageing, now_s, occupancy, .. } = self;
        *now_s = now_s.max(scan.time_s);
        increments.integrate_after(scan, |number, tile| {
            let updated_s = updated_s.make(number);
            for place in tile.looked_at() {
                let state = &mut tile.log_odds[place];
                if !state.is_nan() {
                    *state = ageing.aged(*state, *now_s - updated_s[place]);
                }
                updated_s[place] = *now_s;
            }
        });
        occupancy.take();
    }

    fn occupancy(&self) -> &Raster<f64> {
        self.occupancy.get_or_init(|| self.raster())
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(self.clone()))
    }

    fn leaves_out(&self) -> bool {
        self.increments.leaves_out()
    }

    fn work(&self) -> Work {
        let Work { cells, bytes } = self.increments.work();
        Work { cells, bytes: bytes + self.updated_s.held() + self.occupancy.held() }
    }
}

/// Scans along a row of cells, for tests.
#[cfg(test)]
pub(super) mod tests {
    use std::sync::Arc;

    use grid::GridSpec;
    use sensor::{Pose, Stereo};

    use super::*;

    /// A row of 40 cells of 5 cm before the paper's camera.
    pub(in crate::rules) fn model() -> Model {
        let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 40, height: 1 };
        Model::new(grid, Arc::new(Stereo::default()))
    }

    /// The cell that [`scan`] hits or misses.
    pub(in crate::rules) const CELL: usize = 25;

    /// Looks at [`CELL`] at a time, s: a hit there, a miss (the hit lies behind), or no reading.
    pub(in crate::rules) fn scan(time_s: f64, look: Option<bool>) -> Scan {
        let pose = Pose { x_m: 0.01, y_m: 0.025, theta_rad: 0.0 };
        let reading = look.map(|hit| if hit { 12.0 } else { 10.0 }); // 15 / 12 = 1.25 m, 15 / 10 = 1.5 m
        Scan { sensor: 0, time_s, pose, bearings_rad: vec![0.0], readings: vec![reading] }
    }

    /// What every cell is after some looks, by the rule that ages all cells with every scan.
    pub(in crate::rules) fn eagerly<A: Ageing>(
        looks: &[(f64, Option<bool>)],
        rule: LogOdds,
        ageing: &A,
        step: [f64; 2],
    ) -> Vec<f64> {
        let (model, mut now_s) = (model(), f64::NEG_INFINITY);
        let mut states: Vec<Option<f64>> = vec![None; model.grid.cells()];
        for (time_s, look) in looks {
            let passed_s = if now_s.is_finite() { (time_s - now_s).max(0.0) } else { 0.0 };
            now_s = now_s.max(*time_s);
            states.iter_mut().flatten().for_each(|state| *state = ageing.aged(*state, passed_s));
            // Which cells a scan hits and misses is what constant increments make of it alone.
            let marks = LogOdds { hit: 0.9, miss: 0.2, ..LogOdds::OCTOMAP };
            let mut alone = ConstantIncrements::new(&model, LogOdds { clamp: [0.0, 1.0], ..marks });
            alone.integrate(&scan(*time_s, *look));
            for (state, mark) in states.iter_mut().zip(alone.occupancy().values()) {
                let [low, high] = rule.clamp.map(crate::belief::probability::log_odds);
                let start = crate::belief::probability::log_odds(rule.start);
                let increment = match mark {
                    mark if (mark - 0.9).abs() < 1e-9 => step[0],
                    mark if (mark - 0.2).abs() < 1e-9 => step[1],
                    _ => continue,
                };
                *state = Some((state.unwrap_or(start) + increment).clamp(low, high));
            }
        }
        states.iter().map(|state| state.map_or(model.prior.marginal(), |state| ageing.occupied(state))).collect()
    }
}
