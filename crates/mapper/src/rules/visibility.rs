//! The paper's method: occupancy with visibility and spatial continuity.

use std::sync::Arc;

use grid::Raster;
use sensor::{Ray, Scan, SensorModel};

use crate::belief::lateral::Lateral;
use crate::belief::prior::{Continuity, Prior};
use crate::mapper::{Mapper, Work};
use crate::memory::Held as _;
use crate::model::{Model, Sensors};
use crate::pairs::grid::PairwiseGrid;
use crate::pairs::moments::Moments;
use crate::pairs::reconcile::Reconciliation;
use crate::ray::bearing_chain::{BearingChain, Surfaces};
use crate::ray::chain::Chain;
use crate::ray::cone::ConeUpdate;
use crate::ray::update::{RayRule, RayUpdate};
use crate::ray::{exact, printed};

/// The mapper of the paper, over a [`PairwiseGrid`]. O(cells on the ray) per ray.
#[derive(Clone)]
pub struct Visibility {
    pairs: PairwiseGrid,
    sensors: Sensors,
    rule: RayRule,
    continuity: Continuity,
    reconciliation: Reconciliation,
    lateral: Option<(Lateral, Surfaces)>,
    onset: f64,
    ray: RayUpdate,
    cone: ConeUpdate,
    moments: Moments,
    cells: u64,
}

impl Visibility {
    /// The posterior that Eq. (2) asks for, summed exactly.
    pub fn exact(model: &Model) -> Self {
        Self::new(model, exact::posterior)
    }

    /// Eqs. (4)-(17) as they are printed.
    pub fn as_printed(model: &Model) -> Self {
        Self::new(model, printed::posterior)
    }

    /// Occlusion without continuity: every cell independent of the others before each scan, whatever
    /// correlation the model asks for, and made so again after it.
    ///
    /// One ray is then updated by the exact inverse sensor model of Kaufman, Lee, Ai and Moon,
    /// "Bayesian Occupancy Grid Mapping via an Exact Inverse Sensor Model", American Control Conference
    /// 2016: with independent cells the sum over all maps is linear in the cells of the ray. Rays that
    /// cross in one scan are reconciled like those of [`exact`](Self::exact). A reading does make cells
    /// depend on each other; the joints that hold this are what this mapper throws away.
    pub fn independent(model: &Model) -> Self {
        let prior = Prior { correlation: 0.0, ..model.prior };
        let independent = Self::new(&Model { prior, ..model.clone() }, exact::posterior);
        Self { continuity: Continuity::Ignored, ..independent }
    }

    /// The method with continuity across rays: the reference of [`crate::FastVisibility::lateral`].
    pub fn lateral(model: &Model, lateral: Lateral) -> Self {
        let cell_m = model.grid.cell_m;
        let prior = lateral.prior(&model.prior, cell_m);
        let surfaces = Surfaces::new(&model.prior, prior.onset(cell_m), cell_m);
        Self { lateral: Some((lateral, surfaces)), ..Self::exact(&Model { prior, ..model.clone() }) }
    }

    /// Any other rule for a ray.
    pub fn new(model: &Model, rule: RayRule) -> Self {
        Self {
            pairs: PairwiseGrid::prior(model.grid, &model.prior),
            sensors: model.sensors.clone(),
            rule,
            continuity: Continuity::Kept,
            reconciliation: model.reconciliation,
            lateral: None,
            onset: model.prior.onset(model.grid.cell_m),
            ray: RayUpdate::default(),
            cone: ConeUpdate::default(),
            moments: Moments::new(model.grid),
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

impl Visibility {
    /// Adds what the rays of a scan make of the map to the moments, Eq. (20).
    fn update_rays(&mut self, scan: &Scan) {
        let sensor = Arc::clone(self.sensors.of(scan));
        let rays: Vec<Ray> = scan.rays().filter(|ray| ray.reading.is_some()).collect();
        if sensor.width_rad() > 0.0 {
            return rays.iter().for_each(|ray| self.update_cone(ray, &*sensor));
        }
        let lateral = self.lateral.as_ref().filter(|(lateral, _)| lateral.rays);
        let others = lateral.map(|(_, surfaces)| BearingChain::new(&*sensor, &rays, self.pairs.spec(), surfaces));
        for (number, ray) in rays.iter().enumerate() {
            let Self { pairs, ray: update, .. } = self;
            let model = (&*sensor, self.onset);
            let others = others.as_ref().map(|others| (others, number));
            if update.update(ray, pairs.spec(), model, others, self.rule, |chain, cells| chain.gather(pairs, cells)) {
                self.moments.add(update.ray.line.cells(), &update.posterior);
                self.cells += update.ray.line.len() as u64;
            }
        }
    }
}

impl Visibility {
    /// Adds what a reading from the cone about a ray makes of the map to the moments.
    fn update_cone(&mut self, ray: &Ray, sensor: &dyn SensorModel) {
        let Self { pairs, cone, moments, .. } = self;
        let (spec, model) = (*pairs.spec(), (sensor, self.onset));
        let gather = |chain: &mut Chain, cells: &[usize]| chain.gather(pairs, cells);
        if cone.update(ray, &spec, model, self.rule, gather, |cells, posterior| moments.add(cells, posterior)) {
            self.cells += self.cone.cells();
        }
    }
}

impl Mapper for Visibility {
    fn integrate(&mut self, scan: &Scan) {
        self.integrate_together(std::slice::from_ref(scan));
    }

    fn integrate_together(&mut self, scans: &[Scan]) {
        scans.iter().for_each(|scan| self.update_rays(scan));
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

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(self.clone()))
    }

    fn work(&self) -> Work {
        Work { cells: self.cells, bytes: self.pairs.held() + self.moments.held() + self.ray.held() + self.cone.held() }
    }
}
