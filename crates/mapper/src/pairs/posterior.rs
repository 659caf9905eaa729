//! The posterior of the pairs along one ray.

use crate::memory::Held;
use crate::pairs::joint::Joint;

/// The posterior of one reading for the cells of its ray. A buffer to fill again and again.
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
}

impl Held for RayPosterior {
    fn held(&self) -> usize {
        self.pairs.held() + self.scratch.held()
    }
}
