//! The paper's method: occupancy with visibility and spatial continuity.

use std::sync::Arc;

use grid::{DigitalLine, Raster};
use sensor::{Scan, SensorModel};

use crate::beyond::{self, Beyond};
use crate::{Chain, Mapper, Moments, PairwiseGrid, RayPosterior, Reconciliation, catalogue::Setup, exact, printed};

/// A rule for one ray: from the chain, `P(o | F_k)` and the likelihood beyond the last cell to the
/// posterior of every pair.
pub type RayRule = fn(&Chain, &[f64], f64, &mut RayPosterior);

/// The mapper of the paper, over a [`PairwiseGrid`]. O(cells on the ray) per ray.
pub struct Visibility {
    pairs: PairwiseGrid,
    sensor: Arc<dyn SensorModel>,
    rule: RayRule,
    reconciliation: Reconciliation,
    onset: f64,
    line: DigitalLine,
    chain: Chain,
    likelihood: Vec<f64>,
    posterior: RayPosterior,
    moments: Moments,
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

    /// Any other rule for a ray.
    pub fn new(setup: &Setup, rule: RayRule) -> Self {
        let pairs = PairwiseGrid::prior(setup.grid, &setup.prior);
        let mut pair = Chain::default();
        let unseen = PairwiseGrid::prior(grid::GridSpec { width: 2, height: 1, ..setup.grid }, &setup.prior);
        pair.gather(&unseen, &[0, 1]);
        Self {
            pairs,
            sensor: Arc::clone(&setup.sensor),
            rule,
            reconciliation: setup.reconciliation,
            onset: pair.becomes_occupied(0),
            line: DigitalLine::default(),
            chain: Chain::default(),
            likelihood: Vec::new(),
            posterior: RayPosterior::default(),
            moments: Moments::new(setup.grid),
        }
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
            let &[.., last] = self.line.ranges() else { continue };
            if self.line.is_empty() {
                continue;
            }
            self.chain.gather(&self.pairs, self.line.cells()); // P(e_j, e_{j+1} | O)
            self.likelihood.resize(self.line.len(), 0.0);
            self.sensor.likelihood(reading, ray.bearing_rad, self.line.ranges(), &mut self.likelihood); // Eq. (21)
            // A 4-connected line crosses |cos| + |sin| cells per cell side.
            let chord_m = self.pairs.spec().cell_m / (ray.direction[0].abs() + ray.direction[1].abs());
            let beyond = Beyond { from_m: last, chord_m, onset: self.onset };
            let none = beyond::likelihood(&*self.sensor, reading, ray.bearing_rad, &beyond); // k to infinity, Eq. (7)
            (self.rule)(&self.chain, &self.likelihood, none, &mut self.posterior); // Eqs. (1), (4)-(7)
            self.moments.add(self.line.cells(), &self.posterior); // Eq. (20)
        }
        self.pairs.reconcile(&mut self.moments, self.reconciliation); // Eqs. (18)-(20)
        debug_assert_eq!(self.pairs.check(), Ok(()));
    }

    fn occupancy(&self) -> &Raster<f64> {
        self.pairs.marginals()
    }
}
