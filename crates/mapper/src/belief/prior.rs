//! What is assumed before the first reading, and how it scales with the cell size.

use serde::{Deserialize, Serialize};

use crate::belief::probability::bounded;

/// How the correlation between neighbouring cells depends on the cell size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CorrelationLaw {
    /// `c(d) = exp(-d / l)`: the world stays the same, whatever the cells that describe it.
    #[default]
    Scaled,
    /// The same correlation at every cell size. The free-space probability of one metre then
    /// depends on the cell size: the ablation that shows why the law is needed.
    Fixed,
}

/// Whether neighbouring cells depend on each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Continuity {
    /// Joint probabilities are kept, as in the paper.
    Kept,
    /// Every joint stays the product of its marginals.
    Ignored,
}

/// Occupancy and spatial continuity of an unseen world.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Prior {
    /// `P(E_i)` of an unseen cell, 0 to 1. Default 0.1 (Section 3.2).
    pub occupancy: f64,
    /// Correlation of two cells 5 cm apart, 0 to 1. Default 0.871 (Section 3.2): obstacles of
    /// 0.4 m mean length.
    pub correlation: f64,
    /// How the correlation depends on the cell size.
    pub correlation_law: CorrelationLaw,
}

impl Default for Prior {
    fn default() -> Self {
        Self { occupancy: 0.1, correlation: 0.871, correlation_law: CorrelationLaw::Scaled }
    }
}

impl Prior {
    /// Distance (m) at which [`correlation`](Self::correlation) is given.
    pub const REFERENCE_M: f64 = 0.05;

    /// Correlation of neighbouring cells of side `cell_m` (m).
    ///
    /// Along a line, a two-state Markov process of mean occupied length `L` and occupied share `p`
    /// has correlation `exp(-d / l)` at distance `d`, with `l = (1 - p) L`.
    pub fn neighbour_correlation(&self, cell_m: f64) -> f64 {
        match self.correlation_law {
            CorrelationLaw::Fixed => self.correlation,
            CorrelationLaw::Scaled => libm::pow(self.correlation, cell_m / Self::REFERENCE_M),
        }
    }

    /// The occupancy, kept off 0 and 1.
    pub fn marginal(&self) -> f64 {
        bounded(self.occupancy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_correlation_is_an_obstacle_of_forty_centimetres() {
        let length: f64 = 0.402;
        let prior = Prior::default();
        assert!((prior.neighbour_correlation(0.05) - 0.871).abs() < 1e-15);
        assert!(((-0.05 / (0.9 * length)).exp() - 0.871).abs() < 5e-4);
    }

    #[test]
    fn two_steps_of_half_a_cell_are_one_step_of_a_cell() {
        let prior = Prior::default();
        let half = prior.neighbour_correlation(0.025);
        assert!((half * half - 0.871).abs() < 1e-15);
        let fixed = Prior { correlation_law: CorrelationLaw::Fixed, ..prior };
        assert_eq!(fixed.neighbour_correlation(0.2).to_bits(), 0.871f64.to_bits());
    }
}
