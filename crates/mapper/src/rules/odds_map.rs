//! A map in log odds between clamps, in which a cell that no update has reached is unknown.

use std::cell::OnceCell;
use std::ops::Range;

use grid::{GridSpec, Raster};

use crate::belief::probability::{from_log_odds, log_odds};
use crate::memory::Held;
use crate::model::Model;

/// Log odds of every cell: 8 bytes per cell, and 8 more once it is shown.
///
/// A cell's first update starts where the rule says, at even odds in the programs that the rules come from; one that was never
/// updated reports the prior.
#[derive(Clone)]
pub(crate) struct OddsMap {
    spec: GridSpec,
    /// NaN in a cell that was never updated.
    log_odds: Vec<f64>,
    start: f64,
    prior: f64,
    /// Least and largest log odds.
    clamp: [f64; 2],
    occupancy: OnceCell<Raster<f64>>,
}

impl OddsMap {
    /// The unknown map: the probability from which a first update starts, and the least and largest of a cell.
    pub(crate) fn new(model: &Model, start: f64, clamp: [f64; 2]) -> Self {
        Self {
            spec: model.grid,
            log_odds: vec![f64::NAN; model.grid.cells()],
            start: log_odds(start),
            prior: model.prior.marginal(),
            clamp: clamp.map(log_odds),
            occupancy: OnceCell::new(),
        }
    }

    /// The cells.
    pub(crate) fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// The map to be changed by a scan.
    pub(crate) fn change(&mut self) -> Odds<'_> {
        self.occupancy.take();
        Odds { log_odds: &mut self.log_odds, start: self.start, clamp: self.clamp }
    }

    /// The map as others see it.
    pub(crate) fn occupancy(&self) -> &Raster<f64> {
        self.occupancy.get_or_init(|| {
            let occupied =
                self.log_odds.iter().map(|odds| if odds.is_nan() { self.prior } else { from_log_odds(*odds) });
            Raster::new(self.spec, occupied.collect())
        })
    }
}

/// The log odds of a map, to be changed.
pub(crate) struct Odds<'a> {
    log_odds: &'a mut [f64],
    start: f64,
    clamp: [f64; 2],
}

impl Odds<'_> {
    /// Probability of a cell; of one that was never updated, that from which its first update starts.
    pub(crate) fn occupied(&self, cell: usize) -> f64 {
        let odds = self.log_odds[cell];
        from_log_odds(if odds.is_nan() { self.start } else { odds })
    }

    /// Adds to the log odds of some cells in a row.
    #[inline(always)]
    pub(crate) fn add(&mut self, cells: Range<usize>, log_odds: f64) {
        let [low, high] = self.clamp;
        for odds in &mut self.log_odds[cells] {
            let before = if odds.is_nan() { self.start } else { *odds };
            let after = before + log_odds;
            let after = if after > low { after } else { low };
            *odds = if after < high { after } else { high };
        }
    }
}

impl Held for OddsMap {
    fn held(&self) -> usize {
        self.log_odds.held() + self.occupancy.held()
    }
}
