//! The paper's method in a world that changes: the reference of `visibility-dynamic`.

use grid::Raster;
use sensor::Scan;

use crate::belief::renewal::{Elapsed, Kinds, Place, Renewal};
use crate::mapper::{Mapper, Work};
use crate::memory::Held as _;
use crate::model::Model;
use crate::pairs::grid::PairwiseGrid;
use crate::pairs::joint::{Joint, bounds};
use crate::pairs::renewal::both_after;
use crate::rules::visibility::Visibility;

/// `visibility`, before each scan of which the time since the last one passes for every place of the map. O(cells of the map) per
/// scan, in double precision: what the fast mapper does where it looks is held to this.
#[derive(Clone)]
pub struct Dynamic {
    visibility: Visibility,
    renewal: Renewal,
    /// `P(kind | E)` and `P(kind | not E)` of every cell.
    kinds: Vec<[Kinds<f64>; 2]>,
    /// `P(E)` of a place that is drawn again, and of two neighbours that are.
    prior: [f64; 2],
    time_s: Option<f64>,
}

impl Dynamic {
    /// An unseen world in which places change as `renewal` says.
    pub fn new(model: &Model, renewal: Renewal) -> Self {
        let visibility = Visibility::exact(model);
        let pairs = PairwiseGrid::prior(grid::GridSpec { width: 2, height: 1, ..model.grid }, &model.prior);
        let prior = [pairs.marginal[0], pairs.both[0]];
        Self { visibility, renewal, kinds: vec![[renewal.shares; 2]; model.grid.cells()], prior, time_s: None }
    }

    /// The map with its joint probabilities.
    pub fn pairs(&self) -> &PairwiseGrid {
        self.visibility.pairs()
    }

    /// Goes on from another map of the same cells.
    ///
    /// # Panics
    /// If it has other cells.
    pub fn set_pairs(&mut self, pairs: PairwiseGrid) {
        self.visibility.set_pairs(pairs);
    }

    /// Lets time pass up to `time_s`, s, in steps of [`Renewal::step_s`]. Time that goes back stands still.
    pub fn pass(&mut self, time_s: f64) {
        let time_s = self.renewal.stands_at(time_s, self.time_s);
        let seconds = self.time_s.map_or(0.0, |last| time_s - last);
        if seconds > 0.0 {
            let pairs = after(self.visibility.pairs(), &mut self.kinds, &self.renewal.over(seconds), self.prior);
            self.visibility.set_pairs(pairs);
        }
        self.time_s = Some(time_s);
    }
}

/// A map and its kinds after some time.
fn after(pairs: &PairwiseGrid, kinds: &mut [[Kinds<f64>; 2]], elapsed: &Elapsed, prior: [f64; 2]) -> PairwiseGrid {
    let spec = *pairs.spec();
    let survivals: Vec<[f64; 2]> = kinds.iter().map(|kinds| kinds.map(|kinds| elapsed.survival(&kinds))).collect();
    let mut next = pairs.clone();
    for (cell, kinds) in kinds.iter_mut().enumerate() {
        let place = elapsed.place(&Place { occupied: pairs.marginal[cell], kinds: *kinds }, prior[0]);
        (next.marginal[cell], *kinds) = (place.occupied, place.kinds);
    }
    for cell in 0..spec.cells() {
        for n in spec.neighbours(cell).filter(|n| n.cell > cell) {
            let joint = Joint::new(pairs.marginal[cell], pairs.marginal[n.cell], pairs.both[n.edge]);
            let (low, high) = bounds(next.marginal[cell], next.marginal[n.cell]);
            let both = both_after(&joint, [cell, n.cell].map(|cell| survivals[cell]), prior[0], prior[1]);
            next.both[n.edge] = both.clamp(low, high);
        }
    }
    next
}

impl Mapper for Dynamic {
    fn integrate(&mut self, scan: &Scan) {
        self.integrate_together(std::slice::from_ref(scan));
    }

    fn integrate_together(&mut self, scans: &[Scan]) {
        scans.iter().for_each(|scan| self.pass(scan.time_s));
        self.visibility.integrate_together(scans);
    }

    fn occupancy(&self) -> &Raster<f64> {
        self.visibility.occupancy()
    }

    fn pairwise(&self) -> Option<PairwiseGrid> {
        self.visibility.pairwise()
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(self.clone()))
    }

    fn work(&self) -> Work {
        let work = self.visibility.work();
        Work { bytes: work.bytes + self.kinds.held(), ..work }
    }
}
