//! The pairwise occupancy grid: a marginal per cell, a joint probability per pair of neighbours.

use std::fmt;

use grid::{GridSpec, Raster};

use crate::belief::prior::Prior;
use crate::belief::probability::EPSILON;
use crate::memory::Held;
use crate::pairs::joint::{Joint, both_occupied, bounds};

/// Marginals and joints of a whole map. Three numbers per cell: its own probability and that of
/// being occupied together with its right and its upper neighbour.
#[derive(Debug, Clone, PartialEq)]
pub struct PairwiseGrid {
    pub(crate) marginal: Raster<f64>,
    /// `P(E_i, E_j)` by edge number, [`GridSpec::edge_between`]; edges over the border are unused.
    pub(crate) both: Vec<f64>,
}

/// An invariant that does not hold: a defect, never a consequence of the readings.
#[derive(Debug, Clone, PartialEq)]
pub struct Broken(String);

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Broken {}

impl PairwiseGrid {
    /// The unseen world: the same marginal everywhere, the same correlation between all neighbours.
    pub fn prior(spec: GridSpec, prior: &Prior) -> Self {
        let p = prior.marginal();
        let both = both_occupied(p, p, prior.neighbour_correlation(spec.cell_m));
        Self { marginal: Raster::filled(spec, p), both: vec![both; 2 * spec.cells()] }
    }

    /// The cells' geometry.
    pub fn spec(&self) -> &GridSpec {
        self.marginal.spec()
    }

    /// Probability that each cell is occupied.
    pub fn marginals(&self) -> &Raster<f64> {
        &self.marginal
    }

    /// Joint probability of two neighbours, in the order given.
    pub fn joint(&self, a: usize, b: usize) -> Joint {
        Joint::new(self.marginal[a], self.marginal[b], self.both[self.spec().edge_between(a, b)])
    }

    /// Verifies every invariant: `eps <= p <= 1 - eps` for cells, and for edges
    /// `max(0, p_i + p_j - 1) <= P(E_i, E_j) <= min(p_i, p_j)`.
    ///
    /// # Errors
    /// The first cell or edge that breaks one.
    pub fn check(&self) -> Result<(), Broken> {
        for (cell, &p) in self.marginal.values().iter().enumerate() {
            if !(EPSILON..=1.0 - EPSILON).contains(&p) {
                return Err(Broken(format!("cell {cell}: probability {p} is not within {EPSILON} of 0 and 1")));
            }
            for n in self.spec().neighbours(cell) {
                let (low, high) = bounds(p, self.marginal[n.cell]);
                let both = self.both[n.edge];
                if !(low..=high).contains(&both) {
                    return Err(Broken(format!("edge {}: joint {both} is not in {low} ..= {high}", n.edge)));
                }
            }
        }
        Ok(())
    }
}

impl Held for PairwiseGrid {
    fn held(&self) -> usize {
        self.marginal.held() + self.both.held()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pairs::joint::correlation;

    #[test]
    fn the_prior_has_the_papers_correlation() {
        let spec = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 3, height: 2 };
        let pairs = PairwiseGrid::prior(spec, &Prior::default());
        pairs.check().expect("valid");
        let joint = pairs.joint(0, 3);
        assert!((correlation(0.1, 0.1, joint.ee) - 0.871).abs() < 1e-14);
        assert!((joint.first() - 0.1).abs() < 1e-15 && (joint.total() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn check_finds_what_is_broken() {
        let spec = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 2, height: 1 };
        let mut pairs = PairwiseGrid::prior(spec, &Prior::default());
        pairs.both[0] = 0.11;
        assert!(pairs.check().expect_err("too large").to_string().contains("edge 0"));
        pairs.both[0] = f64::NAN;
        assert!(pairs.check().is_err());
        pairs.marginal[1] = 1.0;
        assert!(pairs.check().is_err());
    }
}
