//! Agreement between rays: least squares under constraints, Eqs. (18)-(20), in closed form.

use grid::{GridSpec, Neighbour};
use serde::{Deserialize, Serialize};

use crate::belief::probability::bounded;
use crate::pairs::grid::PairwiseGrid;
use crate::pairs::joint::{Joint, both_occupied, bounds, correlation};
use crate::pairs::moments::{self, Mean, Moments};

/// What becomes of an edge that no ray of the scan runs along.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reconciliation {
    /// It enters the mean with its joint before the scan, as Eq. (20) reads: the sum runs over all
    /// pairs. A cell then moves a little less than its rays have it.
    #[default]
    AllEdges,
    /// It is left out, since the scan gives no evidence on it, and keeps its correlation.
    Touched,
}

impl PairwiseGrid {
    /// Takes over the posteriors of a scan's rays, and empties `moments`. O(cells touched).
    ///
    /// Least squares alone does not keep joints from becoming negative: they are clamped to what
    /// the marginals allow.
    pub fn reconcile(&mut self, moments: &mut Moments, rule: Reconciliation) {
        self.settle(moments, rule);
        let mut places = Places::new(self.spec());
        for cell in moments.touched.iter() {
            let after = moments.cell[cell].sum;
            for n in places.neighbours(cell).iter().flatten() {
                let (there, product) = (moments.cell[n.cell], moments.edge[n.edge]);
                let touched = there.count > 0;
                if touched && n.cell < cell {
                    continue; // an edge of two touched cells is the lower one's
                }
                let ends = [after, if touched { there.sum } else { self.marginal[n.cell] }];
                self.both[n.edge] = if product.count > 0 {
                    moments.edge[n.edge] = Mean::default();
                    with_product_moment(ends, product.value())
                } else {
                    self.off_rays(cell, n, rule, ends)
                };
            }
        }
        self.take_over(moments);
    }

    /// The same for a map of independent cells: marginals are reconciled as in
    /// [`reconcile`](Self::reconcile), and every joint becomes the product of its marginals.
    pub fn reconcile_cells(&mut self, moments: &mut Moments, rule: Reconciliation) {
        self.settle(moments, rule);
        let mut places = Places::new(self.spec());
        for cell in moments.touched.iter() {
            for n in places.neighbours(cell).iter().flatten() {
                let there = moments.cell[n.cell];
                let other = if there.count > 0 { there.sum } else { self.marginal[n.cell] };
                self.both[n.edge] = both_occupied(moments.cell[cell].sum, other, 0.0);
                moments.edge[n.edge] = Mean::default();
            }
        }
        self.take_over(moments);
    }

    /// In the place of the sum of each touched cell's moment, the marginal that comes of it: that of the map is still
    /// needed, as it was.
    fn settle(&self, moments: &mut Moments, rule: Reconciliation) {
        let mut places = Places::new(self.spec());
        for cell in moments.touched.iter() {
            let mut mean = moments.cell[cell];
            if rule == Reconciliation::AllEdges {
                let off_rays = |n: &Option<Neighbour>| n.is_some_and(|n| moments.edge[n.edge].count == 0);
                let off_rays: u32 = places.neighbours(cell).iter().map(|n| u32::from(off_rays(n))).sum();
                mean.sum += f64::from(off_rays) * (2.0 * self.marginal[cell] - 1.0);
                mean.count += off_rays;
            }
            moments.cell[cell].sum = bounded(0.5 * (1.0 + mean.value()));
        }
    }

    /// Takes over the marginals that came out, and empties `moments`, the edges of which are empty by now.
    fn take_over(&mut self, moments: &mut Moments) {
        for cell in moments.touched.drain() {
            self.marginal[cell] = std::mem::take(&mut moments.cell[cell]).sum;
        }
    }

    /// `P(E_i, E_j)` of an edge on no ray whose ends have new marginals.
    #[inline(always)]
    fn off_rays(&self, cell: usize, n: &Neighbour, rule: Reconciliation, [p, q]: [f64; 2]) -> f64 {
        let joint = Joint::new(self.marginal[cell], self.marginal[n.cell], self.both[n.edge]);
        match rule {
            Reconciliation::AllEdges => with_product_moment([p, q], moments::of(&joint)[2]),
            Reconciliation::Touched => {
                both_occupied(p, q, correlation(self.marginal[cell], self.marginal[n.cell], joint.ee))
            }
        }
    }
}

/// `P(E_i, E_j)` of cells with the given marginals and the given `m_ij`, as far as the marginals allow.
#[inline(always)]
fn with_product_moment([p, q]: [f64; 2], product: f64) -> f64 {
    let (low, high) = bounds(p, q);
    // P(E, E) = (1 + m_i + m_j + m_ij) / 4 with m = 2 p - 1.
    (0.5 * (p + q) + 0.25 * (product - 1.0)).clamp(low, high)
}

/// Where cells lie that are asked about in the order of their indices, without a division for each.
struct Places {
    spec: GridSpec,
    row: usize,
    /// The first cell of the row.
    first: usize,
}

impl Places {
    fn new(spec: &GridSpec) -> Self {
        Self { spec: *spec, row: 0, first: 0 }
    }

    /// The neighbours of a cell: right, up, left, down.
    #[inline(always)]
    fn neighbours(&mut self, cell: usize) -> [Option<Neighbour>; 4] {
        while cell >= self.first + self.spec.width {
            (self.row, self.first) = (self.row + 1, self.first + self.spec.width);
        }
        self.spec.neighbours_at(cell - self.first, self.row)
    }
}
