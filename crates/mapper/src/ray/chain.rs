//! A viewing ray as a Markov chain of cells (Section 2.1).

use crate::memory::Held;
use crate::pairs::grid::PairwiseGrid;
use crate::pairs::joint::Joint;
use crate::pairs::posterior::RayPosterior;

/// The cells of one ray, nearest first, as a Markov chain.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Chain {
    marginal: Vec<f64>,
    both: Vec<f64>,
}

impl Chain {
    /// A chain from `P(E_j)` of every cell and `P(E_j, E_{j+1})` of every neighbouring pair.
    ///
    /// # Panics
    /// Unless there is one pair fewer than cells.
    pub fn new(marginal: Vec<f64>, both: Vec<f64>) -> Self {
        assert_eq!(marginal.len(), both.len() + 1, "a chain has one pair fewer than cells");
        Self { marginal, both }
    }

    /// Reads the chain along the given 4-connected cells out of a map.
    pub fn gather(&mut self, pairs: &PairwiseGrid, cells: &[usize]) {
        self.marginal.clear();
        self.marginal.extend(cells.iter().map(|&cell| pairs.marginal[cell]));
        self.both.clear();
        self.both.extend(cells.windows(2).map(|pair| pairs.both[pairs.spec().edge_between(pair[0], pair[1])]));
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.marginal.len()
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.marginal.is_empty()
    }

    /// `P(E_j)`, Eq. (11).
    pub fn occupied(&self, j: usize) -> f64 {
        self.marginal[j]
    }

    /// Joint probability of cells `j` and `j + 1`.
    pub fn joint(&self, j: usize) -> Joint {
        Joint::new(self.marginal[j], self.marginal[j + 1], self.both[j])
    }

    /// `t_j = P(E_{j+1} | E_j)`: the obstacle goes on. 0 where cell `j` is never occupied.
    pub fn stays_occupied(&self, j: usize) -> f64 {
        share(self.both[j], self.marginal[j])
    }

    /// `u_j = P(E_{j+1} | not E_j)`: an obstacle begins. 0 where cell `j` is never free.
    pub fn becomes_occupied(&self, j: usize) -> f64 {
        share(self.marginal[j + 1] - self.both[j], 1.0 - self.marginal[j])
    }

    /// The posterior of a reading that the sensor model holds impossible: everything stays as it was.
    pub(crate) fn keep(&self, posterior: &mut RayPosterior) {
        posterior.pairs.clear();
        posterior.pairs.extend((0..self.len() - 1).map(|j| self.joint(j)));
        posterior.first = self.occupied(0);
    }
}

/// A part over its whole, 0 to 1. Of a state that never occurs the part does not matter, and must not become 0 / 0.
fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { (part / whole).clamp(0.0, 1.0) } else { 0.0 }
}

impl Held for Chain {
    fn held(&self) -> usize {
        (2 * self.len()).saturating_sub(1) * size_of::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::exact;

    #[test]
    fn cells_that_are_certain_stay_so() {
        // Free, unknown, occupied, unknown: the joints follow from the marginals alone.
        let chain = Chain::new(vec![0.0, 0.3, 1.0, 0.2], vec![0.0, 0.3, 0.2]);
        let mut out = RayPosterior::default();
        exact::posterior(&chain, &[0.5, 0.2, 0.1, 0.7], 0.3, &mut out);
        let second = 0.3 * 0.2 / (0.3 * 0.2 + 0.7 * 0.1);
        for (p, expected) in out.marginals().iter().zip([0.0, second, 1.0, 0.2]) {
            assert!((p - expected).abs() < 1e-15, "{p} {expected}");
        }
        assert!((out.evidence - (0.3 * 0.2 + 0.7 * 0.1)).abs() < 1e-15);
    }
}
