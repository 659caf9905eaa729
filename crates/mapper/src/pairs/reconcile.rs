//! Agreement between rays: least squares under constraints, Eqs. (18)-(20), in closed form.

use serde::{Deserialize, Serialize};

use crate::belief::probability::bounded;
use crate::pairs::grid::PairwiseGrid;
use crate::pairs::joint::{both_occupied, bounds, correlation};
use crate::pairs::moments::{self, Moments};

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
        let off_rays = self.edges_off_rays(moments, rule);
        self.set_marginals(moments, rule);
        for &cell in &moments.touched {
            for n in self.spec().neighbours(cell).filter(|n| n.cell > cell && moments.edge[n.edge].count > 0) {
                self.set_product_moment(cell, n.cell, n.edge, moments.edge[n.edge].value());
            }
        }
        for edge in off_rays {
            match edge.keeps {
                Kept::Correlation(c) => {
                    self.both[edge.number] = both_occupied(self.marginal[edge.ends[0]], self.marginal[edge.ends[1]], c);
                }
                Kept::ProductMoment(m) => self.set_product_moment(edge.ends[0], edge.ends[1], edge.number, m),
            }
        }
        moments.clear();
    }

    /// The same for a map of independent cells: marginals are reconciled as in
    /// [`reconcile`](Self::reconcile), and every joint becomes the product of its marginals.
    pub fn reconcile_cells(&mut self, moments: &mut Moments, rule: Reconciliation) {
        self.set_marginals(moments, rule);
        for &cell in &moments.touched {
            for n in self.spec().neighbours(cell) {
                self.both[n.edge] = both_occupied(self.marginal[cell], self.marginal[n.cell], 0.0);
            }
        }
        moments.clear();
    }

    /// The mean of each touched cell's moment.
    fn set_marginals(&mut self, moments: &Moments, rule: Reconciliation) {
        for &cell in &moments.touched {
            let mut mean = moments.cell[cell];
            if rule == Reconciliation::AllEdges {
                let off_rays = self.spec().neighbours(cell).filter(|n| moments.edge[n.edge].count == 0).count() as u32;
                mean.sum += f64::from(off_rays) * (2.0 * self.marginal[cell] - 1.0);
                mean.count += off_rays;
            }
            self.marginal[cell] = bounded(0.5 * (1.0 + mean.value()));
        }
    }

    /// Edges on no ray that end at a cell on one, with what they keep of their state before the scan.
    fn edges_off_rays(&self, moments: &Moments, rule: Reconciliation) -> Vec<EdgeOffRays> {
        let mut off_rays = Vec::new();
        for &cell in &moments.touched {
            for n in self.spec().neighbours(cell) {
                let twice = n.cell < cell && moments.cell[n.cell].count > 0;
                if moments.edge[n.edge].count > 0 || twice {
                    continue;
                }
                let joint = self.joint(cell, n.cell);
                let keeps = match rule {
                    Reconciliation::AllEdges => Kept::ProductMoment(moments::of(&joint)[2]),
                    Reconciliation::Touched => {
                        Kept::Correlation(correlation(self.marginal[cell], self.marginal[n.cell], joint.ee))
                    }
                };
                off_rays.push(EdgeOffRays { number: n.edge, ends: [cell, n.cell], keeps });
            }
        }
        off_rays
    }

    /// Sets the joint of neighbours `a` and `b` to their marginals and the given `m_ij`, as far as
    /// the marginals allow.
    fn set_product_moment(&mut self, a: usize, b: usize, edge: usize, product: f64) {
        let (p, q) = (self.marginal[a], self.marginal[b]);
        let (low, high) = bounds(p, q);
        // P(E, E) = (1 + m_i + m_j + m_ij) / 4 with m = 2 p - 1.
        self.both[edge] = (0.5 * (p + q) + 0.25 * (product - 1.0)).clamp(low, high);
    }
}

struct EdgeOffRays {
    number: usize,
    ends: [usize; 2],
    keeps: Kept,
}

enum Kept {
    Correlation(f64),
    ProductMoment(f64),
}
