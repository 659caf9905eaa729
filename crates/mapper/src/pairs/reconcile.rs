//! Agreement between rays: least squares under constraints, Eqs. (18)-(20), in closed form.

use grid::{GridSpec, Neighbour};
use serde::{Deserialize, Serialize};

use crate::belief::probability::bounded;
use crate::pairs::grid::PairwiseGrid;
use crate::pairs::joint::{Joint, both_occupied, bounds, correlation};
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
        for cell in moments.touched() {
            // Both ends of an edge on a ray are touched: the lower one sets it.
            for (edge, other) in [(2 * cell, cell + 1), (2 * cell + 1, cell + self.spec().width)] {
                let product = moments.edge[edge];
                if product.count > 0 {
                    self.set_product_moment(cell, other, edge, product.value());
                }
            }
        }
        for EdgeOffRays { number, ends, keeps } in off_rays {
            let [a, b] = ends.map(|cell| cell as usize);
            match rule {
                Reconciliation::AllEdges => self.set_product_moment(a, b, number as usize, keeps),
                Reconciliation::Touched => {
                    self.both[number as usize] = both_occupied(self.marginal[a], self.marginal[b], keeps);
                }
            }
        }
        moments.clear();
    }

    /// The same for a map of independent cells: marginals are reconciled as in
    /// [`reconcile`](Self::reconcile), and every joint becomes the product of its marginals.
    pub fn reconcile_cells(&mut self, moments: &mut Moments, rule: Reconciliation) {
        self.set_marginals(moments, rule);
        for cell in moments.touched() {
            for n in self.spec().neighbours(cell) {
                self.both[n.edge] = both_occupied(self.marginal[cell], self.marginal[n.cell], 0.0);
            }
        }
        moments.clear();
    }

    /// The mean of each touched cell's moment.
    fn set_marginals(&mut self, moments: &Moments, rule: Reconciliation) {
        let mut places = Places::new(self.spec());
        for cell in moments.touched() {
            let mut mean = moments.cell[cell];
            if rule == Reconciliation::AllEdges {
                let off_ray = |n: &Option<Neighbour>| n.is_some_and(|n| moments.edge[n.edge].count == 0);
                let off_rays: u32 = places.neighbours(cell).iter().map(|n| u32::from(off_ray(n))).sum();
                mean.sum += f64::from(off_rays) * (2.0 * self.marginal[cell] - 1.0);
                mean.count += off_rays;
            }
            self.marginal[cell] = bounded(0.5 * (1.0 + mean.value()));
        }
    }

    /// Edges on no ray that end at a cell on one, with what they keep of their state before the scan.
    fn edges_off_rays(&self, moments: &Moments, rule: Reconciliation) -> Vec<EdgeOffRays> {
        let mut off_rays = Vec::new();
        let mut places = Places::new(self.spec());
        for cell in moments.touched() {
            for n in places.neighbours(cell).into_iter().flatten() {
                let twice = n.cell < cell && moments.cell[n.cell].count > 0;
                if moments.edge[n.edge].count > 0 || twice {
                    continue;
                }
                let joint = Joint::new(self.marginal[cell], self.marginal[n.cell], self.both[n.edge]);
                let keeps = match rule {
                    Reconciliation::AllEdges => moments::of(&joint)[2],
                    Reconciliation::Touched => correlation(self.marginal[cell], self.marginal[n.cell], joint.ee),
                };
                // GridSpec::MAX_CELLS fits a u32.
                off_rays.push(EdgeOffRays {
                    number: n.edge as u32,
                    ends: [cell, n.cell].map(|cell| cell as u32),
                    keeps,
                });
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
    number: u32,
    ends: [u32; 2],
    /// Its product moment ([`Reconciliation::AllEdges`]) or its correlation ([`Reconciliation::Touched`]).
    keeps: f64,
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
