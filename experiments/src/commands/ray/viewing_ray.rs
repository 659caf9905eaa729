//! One viewing ray and one reading: all that its posterior depends on.

use mapper::Chain;
use sensor::{Kernel as _, Stereo};

/// Most cells of a ray.
pub const MOST_CELLS: usize = 100_000;

/// A ray straight along the optical axis. Cell `k` spans the ranges `k` to `k + 1` times the cell size; the sensor stands at the near
/// side of cell 0.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewingRay {
    /// Length of the ray in every cell, m.
    pub cell_size_m: f64,
    /// The reading, px.
    pub observation_px: f64,
    /// `P(E_k)` of every cell, 0 to 1, both included.
    pub prior: Vec<f64>,
    /// Correlation of every pair of neighbours, -1 to 1, taken as it is whatever the cell size.
    pub correlation: Vec<f64>,
    /// Correlation with which the chain goes on past the last cell: the last pair's.
    pub onward: f64,
    /// `P(o | no cell of the ray is occupied)`, 1/px, if it is given.
    pub no_hit_likelihood: Option<f64>,
    /// The camera.
    pub stereo: Stereo,
}

impl ViewingRay {
    /// A ray with the same correlation everywhere, seen by the paper's camera.
    pub fn new(observation_px: f64, prior: Vec<f64>, correlation: f64) -> Self {
        Self {
            cell_size_m: 0.05,
            observation_px,
            correlation: vec![correlation; prior.len() - 1],
            prior,
            onward: correlation,
            no_hit_likelihood: None,
            stereo: Stereo::default(),
        }
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.prior.len()
    }

    /// Range (m) at which the ray enters cell `k`, and leaves cell `k - 1`.
    pub fn enters_m(&self, k: usize) -> f64 {
        k as f64 * self.cell_size_m
    }

    /// The same ray with cells that know nothing of each other.
    pub fn uncorrelated(&self) -> Self {
        Self { correlation: vec![0.0; self.correlation.len()], onward: 0.0, ..self.clone() }
    }

    /// The prior as a Markov chain.
    pub fn chain(&self) -> Chain {
        let pairs = self.prior.windows(2).zip(&self.correlation);
        Chain::new(self.prior.clone(), pairs.map(|(p, &c)| both(p[0], p[1], c)).collect())
    }

    /// `P(o | F_k)` of every cell, 1/px, Eq. (21).
    pub fn likelihood(&self) -> Vec<f64> {
        let ranges: Vec<f64> = (0..=self.cells()).map(|k| self.enters_m(k)).collect();
        let mut likelihood = vec![0.0; self.cells()];
        self.stereo.likelihood(self.observation_px, 0.0, &ranges, &mut likelihood);
        likelihood
    }

    /// Probability that an obstacle begins in a cell past the end, given that the one before is free:
    /// the transition of a chain that keeps the last cell's prior and the last pair's correlation.
    pub fn onset(&self) -> f64 {
        let p = self.prior[self.cells() - 1];
        if p < 1.0 { ((p - both(p, p, self.onward)) / (1.0 - p)).clamp(0.0, 1.0) } else { 1.0 }
    }
}

/// `P(E_i, E_j)` of neighbours with marginals `p` and `q` and correlation `c`, clamped to what the marginals allow (Eq. 16 solved
/// for the joint).
pub fn both(p: f64, q: f64, c: f64) -> f64 {
    let joint = p * q + c * libm::sqrt(p * (1.0 - p) * q * (1.0 - q));
    joint.max(0.0).max(p + q - 1.0).min(p).min(q)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_stays_within_its_marginals() {
        assert!((both(0.1, 0.1, 0.871) - 0.088_39).abs() < 1e-12);
        assert!((both(0.1, 0.9, 1.0) - 0.1).abs() < 1e-15);
        assert!((both(0.9, 0.8, -1.0) - 0.7).abs() < 1e-15);
        for (p, q) in [(0.0, 0.3), (1.0, 0.1), (1.0, 1.0), (0.0, 1.0)] {
            assert!((both(p, q, 0.5) - p * q).abs() < 1e-15, "{p} {q}: certain cells have no correlation");
        }
    }

    #[test]
    fn past_the_end_the_papers_obstacles_begin_as_before_it() {
        assert!((ViewingRay::new(10.0, vec![0.1; 3], 0.871).onset() - 0.0129).abs() < 1e-15);
        assert!((ViewingRay::new(10.0, vec![0.1; 3], 0.871).uncorrelated().onset() - 0.1).abs() < 1e-15);
        assert!((ViewingRay::new(10.0, vec![1.0; 3], 0.871).onset() - 1.0).abs() < 1e-15);
        assert!(ViewingRay::new(10.0, vec![0.0; 3], 0.871).onset().abs() < 1e-15);
    }
}
