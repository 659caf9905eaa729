//! The paper's method: occupancy with visibility and spatial continuity.

use std::sync::Arc;

use grid::Raster;
use sensor::{Ray, Scan, SensorModel};

use crate::catalogue::Setup;
use crate::lateral::{Across, Surfaces};
use crate::ray::RayUpdate;
use crate::work::{Held as _, Work};
use crate::{Chain, Lateral, Mapper, Moments, PairwiseGrid, Prior, RayPosterior, Reconciliation, exact, printed};

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
    lateral: Option<(Lateral, Surfaces)>,
    onset: f64,
    ray: RayUpdate,
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

    /// The method with continuity across rays: the reference of [`crate::Lockstep::lateral`].
    pub fn lateral(setup: &Setup, lateral: Lateral) -> Self {
        let cell_m = setup.grid.cell_m;
        let prior = lateral.prior(&setup.prior, cell_m);
        let surfaces = Surfaces::new(&setup.prior, prior.onset(cell_m), cell_m);
        Self { lateral: Some((lateral, surfaces)), ..Self::exact(&Setup { prior, ..setup.clone() }) }
    }

    /// Any other rule for a ray.
    pub fn new(setup: &Setup, rule: RayRule) -> Self {
        Self {
            pairs: PairwiseGrid::prior(setup.grid, &setup.prior),
            sensor: Arc::clone(&setup.sensor),
            rule,
            continuity: Continuity::Kept,
            reconciliation: setup.reconciliation,
            lateral: None,
            onset: setup.prior.onset(setup.grid.cell_m),
            ray: RayUpdate::default(),
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
        let rays: Vec<Ray> = scan.rays().filter(|ray| ray.reading.is_some()).collect();
        let across = self.lateral.as_ref().filter(|(lateral, _)| lateral.rays);
        let across = across.map(|(_, on)| Across::new(&*self.sensor, &rays, self.pairs.spec(), on));
        for (number, ray) in rays.iter().enumerate() {
            let Self { pairs, ray: update, .. } = self;
            let belief = (&*self.sensor, self.onset);
            let across = across.as_ref().map(|across| (across, number));
            if update.update(ray, pairs.spec(), belief, across, self.rule, |chain, cells| chain.gather(pairs, cells)) {
                self.moments.add(update.line.cells(), &update.posterior); // Eq. (20)
                self.cells += update.line.len() as u64;
            }
        }
        match (self.continuity, &self.lateral) {
            (_, Some((lateral, _))) if lateral.edges => {
                let hops = lateral.hops(self.pairs.spec().cell_m);
                self.pairs.reconcile_laterally(&mut self.moments, lateral, hops);
            }
            (Continuity::Kept, _) => self.pairs.reconcile(&mut self.moments, self.reconciliation), // Eqs. (18)-(20)
            (Continuity::Ignored, _) => self.pairs.reconcile_cells(&mut self.moments, self.reconciliation),
        }
        debug_assert_eq!(self.pairs.check(), Ok(()));
    }

    fn occupancy(&self) -> &Raster<f64> {
        self.pairs.marginals()
    }

    fn pairwise(&self) -> Option<PairwiseGrid> {
        matches!(self.continuity, Continuity::Kept).then(|| self.pairs.clone())
    }

    fn work(&self) -> Work {
        Work { cells: self.cells, bytes: self.pairs.held() + self.moments.held() + self.ray.held() }
    }
}
