//! A map in log odds between clamps, in which a cell that no update has reached is unknown.

use std::cell::OnceCell;

use grid::{GridSpec, Raster};

use crate::belief::probability::{from_log_odds, log_odds};
use crate::memory::Held;
use crate::model::Model;

/// Log odds of every cell: 9 bytes per cell, and 8 more once it is shown.
///
/// A cell's first update starts where the rule says, at even odds in the programs that the rules come from; one that was never
/// updated reports the prior.
#[derive(Clone)]
pub(crate) struct OddsMap {
    spec: GridSpec,
    log_odds: Vec<f64>,
    known: Vec<bool>,
    prior: f64,
    /// Least and largest log odds.
    clamp: [f64; 2],
    occupancy: OnceCell<Raster<f64>>,
}

impl OddsMap {
    /// The unknown map: the probability from which a first update starts, and the least and largest of a cell.
    pub(crate) fn new(model: &Model, start: f64, clamp: [f64; 2]) -> Self {
        let (spec, cells) = (model.grid, model.grid.cells());
        Self {
            spec,
            log_odds: vec![log_odds(start); cells],
            known: vec![false; cells],
            prior: model.prior.marginal(),
            clamp: clamp.map(log_odds),
            occupancy: OnceCell::new(),
        }
    }

    /// The cells.
    pub(crate) fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// Adds to the log odds of a cell.
    pub(crate) fn add(&mut self, cell: usize, log_odds: f64) {
        let [low, high] = self.clamp;
        self.log_odds[cell] = (self.log_odds[cell] + log_odds).max(low).min(high);
        self.known[cell] = true;
        self.occupancy.take();
    }

    /// The map as others see it.
    pub(crate) fn occupancy(&self) -> &Raster<f64> {
        self.occupancy.get_or_init(|| {
            let cells = self.log_odds.iter().zip(&self.known);
            let occupied = cells.map(|(odds, known)| if *known { from_log_odds(*odds) } else { self.prior });
            Raster::new(self.spec, occupied.collect())
        })
    }
}

impl Held for OddsMap {
    fn held(&self) -> usize {
        self.log_odds.held() + self.known.held() + self.occupancy.held()
    }
}
