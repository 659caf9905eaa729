//! Edges on no ray in the least squares of Eq. (20), by Jeffrey's rule: the reference, in double precision.

use crate::belief::lateral::Lateral;
use crate::belief::probability::bounded;
use crate::pairs::grid::PairwiseGrid;
use crate::pairs::joint::{Joint, bounds};
use crate::pairs::moments::Moments;

/// What one end of an edge learns when the other end has learnt that it is occupied by `moved` more than it was, and
/// what is known of the first given the second stays: Jeffrey's rule (1965), by which the joint becomes
/// `P(e_n | e_i) P'(e_i)`. By how much `P(E_n)` moves, and the probability that the two differ.
pub(crate) fn jeffrey(joint: &Joint, moved: f64) -> [f64; 2] {
    let stays = joint.ee / joint.first(); // P(E_n | E_i)
    let becomes = joint.fe / (1.0 - joint.first()); // P(E_n | not E_i)
    [(stays - becomes) * moved, (1.0 - stays - becomes) * moved]
}

impl PairwiseGrid {
    /// Takes over the posteriors of a scan's rays, as [`reconcile`](Self::reconcile), with edges on no ray as `lateral` has it,
    /// and empties `moments`. O(cells of the map): a reference.
    ///
    /// An edge on no ray enters the mean with the joint that Jeffrey's rule gives from each of its ends, and with the one it
    /// had. Its ends have learnt at first what rays give them, then what came out before: so it spreads by a cell
    /// each of `hops` times.
    pub fn reconcile_laterally(&mut self, moments: &mut Moments, lateral: &Lateral, hops: usize) {
        let spec = *self.spec();
        let off_rays = |edge: usize| moments.edge[edge].count == 0;
        let mut moved = vec![0.0; spec.cells()];
        for cell in moments.touched.iter() {
            moved[cell] = 0.5 * (1.0 + moments.cell[cell].value()) - self.marginal[cell];
        }
        let mut after = self.marginal.clone();
        for hop in 0..hops {
            if hop > 0 {
                moved.iter_mut().enumerate().for_each(|(cell, moved)| *moved = after[cell] - self.marginal[cell]);
            }
            for cell in 0..spec.cells() {
                let rays = moments.cell[cell];
                let (p, by_rays) = (self.marginal[cell], 0.5 * (rays.sum + f64::from(rays.count)));
                let mut sum = by_rays - f64::from(rays.count) * p;
                let mut weight = f64::from(rays.count);
                for n in spec.neighbours(cell).filter(|n| off_rays(n.edge)) {
                    let [learns, _] = jeffrey(&self.joint(n.cell, cell), moved[n.cell]);
                    sum += lateral.learnt * (moved[cell] + learns);
                    weight += 2.0 * lateral.learnt + lateral.before;
                }
                if weight > 0.0 {
                    after[cell] = bounded(p + sum / weight);
                }
            }
        }
        for cell in 0..spec.cells() {
            for n in spec.neighbours(cell).filter(|n| n.cell > cell) {
                let differ = if off_rays(n.edge) {
                    let joint = self.joint(cell, n.cell);
                    let [_, here] = jeffrey(&joint, moved[cell]);
                    let [_, there] = jeffrey(&self.joint(n.cell, cell), moved[n.cell]);
                    let weight = 2.0 * lateral.learnt + lateral.before;
                    joint.ef + joint.fe + lateral.learnt * (here + there) / weight
                } else {
                    0.5 * (1.0 - moments.edge[n.edge].value())
                };
                let (p, q) = (after[cell], after[n.cell]);
                let (low, high) = bounds(p, q);
                self.both[n.edge] = (0.5 * (p + q - differ)).clamp(low, high);
            }
        }
        self.marginal = after;
        moments.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::GridSpec;
    use proptest::prelude::*;

    proptest! {
        /// Against all 64 states of a map of 2 x 3 cells, of which one learns: `P*(states) = P(states | e_i) P'(e_i)`.
        #[test]
        fn a_neighbour_learns_what_the_sum_over_all_maps_says(
            weights in prop::collection::vec(0.01f64..1.0, 64), learns in 0usize..6, learnt in 0.0f64..1.0,
        ) {
            let spec = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 2, height: 3 };
            let total: f64 = weights.iter().sum();
            let probability = |of: &dyn Fn(usize) -> bool| -> f64 {
                (0..64).filter(|states| of(*states)).map(|states| weights[states] / total).sum()
            };
            let on = |states: usize, cell: usize| states >> cell & 1 == 1;
            let before = probability(&|s| on(s, learns));
            let after = |of: &dyn Fn(usize) -> bool| {
                learnt / before * probability(&|s| of(s) && on(s, learns))
                    + (1.0 - learnt) / (1.0 - before) * probability(&|s| of(s) && !on(s, learns))
            };
            for n in spec.neighbours(learns) {
                let both = probability(&|s| on(s, learns) && on(s, n.cell));
                let joint = Joint::new(before, probability(&|s| on(s, n.cell)), both);
                let [moves, differ] = jeffrey(&joint, learnt - before);
                prop_assert!((joint.second() + moves - after(&|s| on(s, n.cell))).abs() < 1e-12);
                let differs = |s: usize| on(s, learns) != on(s, n.cell);
                prop_assert!((joint.ef + joint.fe + differ - after(&differs)).abs() < 1e-12);
            }
        }
    }
}
