//! The paper's method: occupancy with visibility and spatial continuity.

use std::sync::Arc;

use grid::{DigitalLine, Raster};
use sensor::{Scan, SensorModel};

use crate::beyond::{self, Beyond};
use crate::catalogue::Setup;
use crate::work::{Held as _, Work};
use crate::{Chain, Mapper, Moments, PairwiseGrid, Prior, RayPosterior, Reconciliation, exact, printed};

/// A rule for one ray: from the chain, `P(o | F_k)` and the likelihood beyond the last cell to the
/// posterior of every pair.
pub type RayRule = fn(&Chain, &[f64], f64, &mut RayPosterior);

/// Whether neighbouring cells know of each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Continuity {
    /// Joint probabilities are kept, as in the paper.
    Kept,
    /// Every joint stays the product of its marginals.
    Ignored,
}

/// The mapper of the paper, over a [`PairwiseGrid`]. O(cells on the ray) per ray.
pub struct Visibility {
    pairs: PairwiseGrid,
    sensor: Arc<dyn SensorModel>,
    rule: RayRule,
    continuity: Continuity,
    reconciliation: Reconciliation,
    onset: f64,
    line: DigitalLine,
    chain: Chain,
    likelihood: Vec<f64>,
    posterior: RayPosterior,
    moments: Moments,
    cells: u64,
}

impl Visibility {
    /// The posterior that Eq. (2) asks for, summed exactly.
    pub fn exact(setup: &Setup) -> Self {
        Self::new(setup, exact::posterior)
    }

    /// Eqs. (4)-(17) as they are printed.
    pub fn as_printed(setup: &Setup) -> Self {
        Self::new(setup, printed::posterior)
    }

    /// Occlusion without continuity: every cell independent of the others before each scan, whatever
    /// correlation the setup asks for, and made so again after it.
    ///
    /// One ray is then updated by the exact inverse sensor model of Kaufman, Lee, Ai and Moon,
    /// "Bayesian Occupancy Grid Mapping via an Exact Inverse Sensor Model", American Control Conference
    /// 2016: with independent cells the sum over all maps is linear in the cells of the ray. Rays that
    /// cross in one scan are reconciled like those of [`exact`](Self::exact). A reading does make cells
    /// depend on each other; the joints that say so are what this mapper throws away.
    pub fn independent(setup: &Setup) -> Self {
        let prior = Prior { correlation: 0.0, ..setup.prior };
        let independent = Self::new(&Setup { prior, ..setup.clone() }, exact::posterior);
        Self { continuity: Continuity::Ignored, ..independent }
    }

    /// Any other rule for a ray.
    pub fn new(setup: &Setup, rule: RayRule) -> Self {
        Self {
            pairs: PairwiseGrid::prior(setup.grid, &setup.prior),
            sensor: Arc::clone(&setup.sensor),
            rule,
            continuity: Continuity::Kept,
            reconciliation: setup.reconciliation,
            onset: setup.prior.onset(setup.grid.cell_m),
            line: DigitalLine::default(),
            chain: Chain::default(),
            likelihood: Vec::new(),
            posterior: RayPosterior::default(),
            moments: Moments::new(setup.grid),
            cells: 0,
        }
    }

    /// Goes on from another map of the same cells.
    ///
    /// # Panics
    /// If it has other cells.
    pub fn set_pairs(&mut self, pairs: PairwiseGrid) {
        assert_eq!(pairs.spec(), self.pairs.spec(), "a map of the same cells");
        self.pairs = pairs;
    }

    /// The map with its joint probabilities.
    pub fn pairs(&self) -> &PairwiseGrid {
        &self.pairs
    }
}

impl Mapper for Visibility {
    fn integrate(&mut self, scan: &Scan) {
        for ray in scan.rays() {
            let Some(reading) = ray.reading else { continue };
            self.line.trace(self.pairs.spec(), ray.origin_m, ray.direction, f64::INFINITY);
            if self.line.is_empty() {
                continue;
            }
            self.chain.gather(&self.pairs, self.line.cells()); // P(e_j, e_{j+1} | O)
            self.likelihood.resize(self.line.len(), 0.0);
            self.sensor.likelihood(reading, ray.bearing_rad, self.line.ranges(), &mut self.likelihood); // Eq. (21)
            let beyond = Beyond::after(&self.line, ray.direction, self.pairs.spec().cell_m, self.onset);
            let none = beyond::likelihood(&*self.sensor, reading, ray.bearing_rad, &beyond); // k to infinity, Eq. (7)
            (self.rule)(&self.chain, &self.likelihood, none, &mut self.posterior); // Eqs. (1), (4)-(7)
            self.moments.add(self.line.cells(), &self.posterior); // Eq. (20)
            self.cells += self.line.len() as u64;
        }
        match self.continuity {
            Continuity::Kept => self.pairs.reconcile(&mut self.moments, self.reconciliation), // Eqs. (18)-(20)
            Continuity::Ignored => self.pairs.reconcile_cells(&mut self.moments, self.reconciliation),
        }
        debug_assert_eq!(self.pairs.check(), Ok(()));
    }

    fn occupancy(&self) -> &Raster<f64> {
        self.pairs.marginals()
    }

    fn work(&self) -> Work {
        let ray = self.line.held() + self.chain.held() + self.likelihood.held() + self.posterior.held();
        Work { cells: self.cells, bytes: self.pairs.held() + self.moments.held() + ray }
    }
}
