//! A viewing ray as a Markov chain of cells (Section 2.1), and its posterior.

use crate::{Joint, PairwiseGrid};

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
}

/// A part over its whole, 0 to 1. Of a state that never occurs the part does not matter, and must not become 0 / 0.
fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { (part / whole).clamp(0.0, 1.0) } else { 0.0 }
}

/// What a reading says about the cells of one ray. A buffer to fill again and again.
#[derive(Debug, Clone, Default)]
pub struct RayPosterior {
    /// `P(o | O)`, the predictive likelihood of the reading, per unit of the reading.
    pub evidence: f64,
    /// Posterior joint of every neighbouring pair, nearest first; each adds up to one.
    pub pairs: Vec<Joint>,
    /// Posterior marginal of the first cell: all there is to know of a ray of one cell.
    pub first: f64,
    /// Working state of the ray rules.
    pub(crate) scratch: Vec<f64>,
}

impl RayPosterior {
    /// Posterior marginal of every cell: from the pair in which it is the nearer one, the last
    /// cell's from the last pair.
    pub fn marginals(&self) -> Vec<f64> {
        let nearer = self.pairs.iter().map(Joint::first);
        nearer.chain([self.pairs.last().map_or(self.first, Joint::second)]).collect()
    }

    /// A reading that the model holds impossible leaves everything as it was.
    pub(crate) fn keep(&mut self, chain: &Chain) {
        self.pairs.clear();
        self.pairs.extend((0..chain.len() - 1).map(|j| chain.joint(j)));
        self.first = chain.occupied(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact;

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
