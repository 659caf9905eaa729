//! What is taken in double precision, over the map in single precision: rays that single precision has no evidence for, and
//! readings from cones.

use sensor::Ray;

use crate::fast::inputs::Inputs;
use crate::fast::passage::Reach;
use crate::fast::sums::{Sums, word};
use crate::fast::tiles::Numbering;
use crate::memory::Held;
use crate::pairs::posterior::RayPosterior;
use crate::ray::chain::Chain;
use crate::ray::cone::ConeUpdate;
use crate::ray::exact;
use crate::ray::update::RayUpdate;

/// Buffers.
#[derive(Default)]
pub(super) struct Slowly {
    ray: RayUpdate,
    cone: ConeUpdate,
    /// Cells of cones so far.
    cells: u64,
}

impl Slowly {
    /// Adds a ray, which has the given number among those of the scan.
    pub(super) fn update(&mut self, inputs: &Inputs, number: usize, ray: &Ray, sums: &mut Sums) -> Reach {
        self.follow(inputs, number, ray);
        let RayUpdate { ray, posterior, .. } = &self.ray;
        add(&inputs.map.numbering, ray.line.cells(), posterior, sums);
        Reach { end_m: ray.line.ranges()[ray.line.len()], ..Reach::NOWHERE }
    }

    /// `P(o | O)` of a ray, per unit of the reading.
    pub(super) fn evidence(&mut self, inputs: &Inputs, number: usize, ray: &Ray) -> f64 {
        self.follow(inputs, number, ray);
        self.ray.posterior.evidence
    }

    fn follow(&mut self, inputs: &Inputs, number: usize, ray: &Ray) {
        let others = inputs.others.map(|others| (others, number));
        let (spec, model) = (inputs.map.numbering.spec(), (inputs.sensor, inputs.onset));
        self.ray.update(ray, spec, model, others, exact::posterior, |chain, cells| gather(inputs, chain, cells));
    }

    /// Adds the chains of the cone about a ray.
    pub(super) fn update_cone(&mut self, inputs: &Inputs, ray: &Ray, sums: &mut Sums) -> Reach {
        let numbering = &inputs.map.numbering;
        if !self.follow_cone(inputs, ray, |cells, posterior| add(numbering, cells, posterior, sums)) {
            return Reach::NOWHERE;
        }
        self.cells += self.cone.cells();
        Reach { end_m: self.cone.end_m, ..Reach::NOWHERE }
    }

    /// `P(o | O)` of a reading from the cone about a ray, per unit of the reading; 1 of one that says nothing.
    pub(super) fn cone_evidence(&mut self, inputs: &Inputs, ray: &Ray) -> f64 {
        if self.follow_cone(inputs, ray, |_, _| {}) { self.cone.evidence } else { 1.0 }
    }

    fn follow_cone(&mut self, inputs: &Inputs, ray: &Ray, add: impl FnMut(&[usize], &RayPosterior)) -> bool {
        let (spec, model) = (inputs.map.numbering.spec(), (inputs.sensor, inputs.onset));
        let gather = |chain: &mut Chain, cells: &[usize]| gather(inputs, chain, cells);
        self.cone.update(ray, spec, model, exact::posterior, gather, add)
    }

    /// Cells of cones since it was last asked.
    pub(super) fn take_cells(&mut self) -> u64 {
        std::mem::take(&mut self.cells)
    }
}

/// Reads a chain along cells.
fn gather(inputs: &Inputs, chain: &mut Chain, cells: &[usize]) {
    let numbering = &inputs.map.numbering;
    let both = |pair: &[usize]| {
        let edge = numbering.spec().edge_between(pair[0], pair[1]);
        let [low, high] = if edge / 2 == pair[0] { [pair[0], pair[1]] } else { [pair[1], pair[0]] };
        let [_, _, both] = inputs.map.pair([low, high].map(|cell| numbering.of(cell)), edge % 2, inputs.continuity);
        both
    };
    let occupied = cells.iter().map(|cell| f64::from(inputs.map.occupied(numbering.of(*cell))));
    *chain = Chain::new(occupied.collect(), cells.windows(2).map(both).collect());
}

/// Adds the posterior of a chain along cells.
fn add(numbering: &Numbering, cells: &[usize], posterior: &RayPosterior, sums: &mut Sums) {
    if let &[only] = cells {
        let entry = sums.entry(numbering.of(only));
        sums.add_cell(entry, 1, word(posterior.first));
    }
    for (pair, joint) in cells.windows(2).zip(&posterior.pairs) {
        let [first, second] = [pair[0], pair[1]].map(|cell| sums.entry(numbering.of(cell)));
        sums.add_cell(first, 1, word(joint.first()));
        sums.add_cell(second, 1, word(joint.second()));
        let edge = numbering.spec().edge_between(pair[0], pair[1]);
        let (low, high) = if edge / 2 == pair[0] { (first, second) } else { (second, first) };
        sums.add_edge(low, high, edge % 2, word(joint.ef + joint.fe));
    }
}

impl Held for Slowly {
    fn held(&self) -> usize {
        self.ray.held() + self.cone.held()
    }
}
