//! The moments of the rays' posteriors, Eq. (20) in the basis that separates it.

use grid::GridSpec;
use sensor::lanes::Lanes;

use crate::memory::Held;
use crate::pairs::cell_set::CellSet;
use crate::pairs::joint::Joint;
use crate::pairs::posterior::RayPosterior;

/// Sum and number of the values of one moment.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Mean {
    pub(crate) sum: f64,
    pub(crate) count: u32,
}

impl Mean {
    pub(crate) fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    pub(crate) fn value(self) -> f64 {
        self.sum / f64::from(self.count)
    }
}

/// The moments of the posteriors of one scan, for the cells and edges that its rays cross.
///
/// With `s = +1` for occupied and `-1` for free, a joint is
/// `P = (1 + m_i s_i + m_j s_j + m_ij s_i s_j) / 4`. The four functions are orthogonal, so the
/// squared error of Eq. (20) is a sum over the moments, and its minimum under Eqs. (18) and (19) is
/// the mean of each moment over the posteriors that share it.
#[derive(Debug, Clone)]
pub struct Moments {
    pub(crate) spec: GridSpec,
    pub(crate) cell: Vec<Mean>,
    pub(crate) edge: Vec<Mean>,
    /// Cells with a mean.
    pub(crate) touched: CellSet,
}

/// `m_i`, `m_j` and `m_ij` of a joint.
pub(crate) fn of(joint: &Joint) -> [f64; 3] {
    let Joint { ee, ef, fe, ff } = *joint;
    [(ee + ef) - (fe + ff), (ee + fe) - (ef + ff), (ee + ff) - (ef + fe)]
}

/// The posterior of one of several rays.
pub(crate) struct RayMoments<'a> {
    pub(crate) lane: usize,
    /// Posterior marginal of its first cell.
    pub(crate) first: f64,
    /// `m_j`, `m_{j+1}` and `m_{j,j+1}` of its pairs.
    pub(crate) pairs: &'a [[Lanes<f64>; 3]],
}

impl Moments {
    /// No posterior yet.
    pub fn new(spec: GridSpec) -> Self {
        Self {
            spec,
            cell: vec![Mean::default(); spec.cells()],
            edge: vec![Mean::default(); 2 * spec.cells()],
            touched: CellSet::new(spec.cells()),
        }
    }

    /// Adds the posterior of a ray through the given 4-connected cells.
    ///
    /// A ray of one cell has no pair; it counts for its cell alone.
    pub fn add(&mut self, cells: &[usize], posterior: &RayPosterior) {
        if let &[only] = cells {
            self.cell[only].add(2.0 * posterior.first - 1.0);
        }
        for (pair, joint) in cells.windows(2).zip(&posterior.pairs) {
            let [first, second, product] = of(joint);
            self.cell[pair[0]].add(first);
            self.cell[pair[1]].add(second);
            self.edge[self.spec.edge_between(pair[0], pair[1])].add(product);
        }
        cells.iter().for_each(|cell| self.touched.insert(*cell));
    }

    /// The same of a ray that was updated together with others.
    pub(crate) fn add_moments(&mut self, cells: &[usize], RayMoments { lane, first, pairs }: &RayMoments) {
        if let &[only] = cells {
            self.cell[only].add(2.0 * first - 1.0);
        }
        let lane = *lane;
        for (pair, [first, second, product]) in cells.windows(2).zip(*pairs) {
            self.cell[pair[0]].add(first[lane]);
            self.cell[pair[1]].add(second[lane]);
            self.edge[self.spec.edge_between(pair[0], pair[1])].add(product[lane]);
        }
        cells.iter().for_each(|cell| self.touched.insert(*cell));
    }

    /// Forgets everything, at the cost of what was touched.
    pub(crate) fn clear(&mut self) {
        for cell in self.touched.drain() {
            self.cell[cell] = Mean::default();
            // Of the ends of an edge on a ray both are touched: it is enough to ask the lower.
            self.edge[2 * cell..2 * cell + 2].fill(Mean::default());
        }
    }
}

impl Held for Moments {
    fn held(&self) -> usize {
        self.cell.held() + self.edge.held() + self.touched.held()
    }
}
