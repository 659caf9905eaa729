//! The moments of the rays' posteriors, Eq. (20) in the basis that separates it.

use std::ops::Range;

use grid::GridSpec;

use crate::memory::Held;
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
    /// Cells with a mean, a bit to each.
    touched: Vec<u64>,
    /// The words of `touched` that may have a bit.
    words: Range<usize>,
}

/// `m_i`, `m_j` and `m_ij` of a joint.
pub(crate) fn of(joint: &Joint) -> [f64; 3] {
    let Joint { ee, ef, fe, ff } = *joint;
    [(ee + ef) - (fe + ff), (ee + fe) - (ef + ff), (ee + ff) - (ef + fe)]
}

impl Moments {
    /// No posterior yet.
    pub fn new(spec: GridSpec) -> Self {
        Self {
            spec,
            cell: vec![Mean::default(); spec.cells()],
            edge: vec![Mean::default(); 2 * spec.cells()],
            touched: vec![0; spec.cells().div_ceil(64)],
            words: usize::MAX..0,
        }
    }

    /// Adds the posterior of a ray through the given 4-connected cells.
    ///
    /// A ray of one cell has no pair; it counts for its cell alone.
    pub fn add(&mut self, cells: &[usize], posterior: &RayPosterior) {
        if let &[only] = cells {
            self.add_cell(only, 2.0 * posterior.first - 1.0);
        }
        for (pair, joint) in cells.windows(2).zip(&posterior.pairs) {
            let [first, second, product] = of(joint);
            self.add_cell(pair[0], first);
            self.add_cell(pair[1], second);
            self.edge[self.spec.edge_between(pair[0], pair[1])].add(product);
        }
    }

    #[inline(always)]
    fn add_cell(&mut self, cell: usize, moment: f64) {
        let word = cell / 64;
        self.touched[word] |= 1 << (cell % 64);
        self.words = self.words.start.min(word)..self.words.end.max(word + 1);
        self.cell[cell].add(moment);
    }

    /// Cells with a mean, in the order of their indices.
    pub(crate) fn touched(&self) -> impl Iterator<Item = usize> + use<'_> {
        let words = self.words.clone();
        let bits = self.touched.get(words.clone()).unwrap_or_default().iter().zip(words);
        bits.flat_map(|(&bits, word)| {
            let left = std::iter::successors(Some(bits), |bits| Some(bits & (bits - 1))).take_while(|bits| *bits != 0);
            left.map(move |bits| 64 * word + bits.trailing_zeros() as usize)
        })
    }

    /// Forgets everything, at the cost of what was touched.
    pub(crate) fn clear(&mut self) {
        for word in std::mem::replace(&mut self.words, usize::MAX..0) {
            let mut bits = std::mem::take(&mut self.touched[word]);
            while bits != 0 {
                let cell = 64 * word + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                self.cell[cell] = Mean::default();
                // Of the ends of an edge on a ray both are touched: it is enough to ask the lower.
                self.edge[2 * cell..2 * cell + 2].fill(Mean::default());
            }
        }
    }
}

impl Held for Moments {
    fn held(&self) -> usize {
        self.cell.held() + self.edge.held() + self.touched.held()
    }
}
