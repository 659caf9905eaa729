//! The posterior of one viewing ray, exactly, in O(N): Eqs. (1)-(7).
//!
//! A reading explains only the first occupied cell, so the sum over all 2^N states of the ray
//! (Eq. 2) becomes one pass from the far end and one from the sensor. With `L_k = P(o | F_k)` and
//! the transitions `t_j`, `u_j` of the chain, the front pass carries the likelihood-weighted
//! probability that the hit lies at or before cell `j`, split by the state of `j`, and `S`, that
//! all cells so far are free; the pass from behind carries `B[j]`, the likelihood of the reading
//! given that all cells up to `j` are free.
//!
//! These are not Eqs. (6) and (7) as printed, see [`super::printed`]; it equals the sum over
//! all states, which is what Eq. (2) asks for. `tests/enumeration.rs` is the oracle.

use crate::pairs::joint::Joint;
use crate::pairs::posterior::RayPosterior;
use crate::ray::chain::Chain;

/// Below this, what is left in front is nothing: it stops the walk through subnormal numbers.
const NEGLIGIBLE: f64 = 1e-280;

/// Updates the pairs along one viewing ray with one reading.
///
/// `likelihood[k]` is `P(o | F_k)` and `none` the same for a ray that hits none of its cells, both
/// per unit of the reading. `posterior.evidence` becomes `P(o | O)`; where that is zero the reading
/// is impossible and the posterior is the prior. O(cells), no allocation once the buffers have grown.
///
/// # Panics
/// If the chain is empty, or there is not one likelihood per cell.
pub fn posterior(chain: &Chain, likelihood: &[f64], none: f64, posterior: &mut RayPosterior) {
    assert!(!chain.is_empty(), "a ray has at least one cell");
    assert_eq!(chain.len(), likelihood.len(), "one likelihood per cell");
    let mut behind = std::mem::take(&mut posterior.scratch);
    backward(chain, likelihood, none, &mut behind); // the sums beyond j of Eqs. (6), (7)
    let mut front = Front::at_first_cell(chain, likelihood); // the sums up to j of Eqs. (4)-(7)
    let evidence = front.hit_occupied + front.clear * behind[0];
    posterior.evidence = evidence;
    if evidence >= f64::MIN_POSITIVE {
        let normalise = 1.0 / evidence; // alpha of Eq. (1)
        posterior.first = front.hit_occupied * normalise;
        posterior.pairs.clear();
        for j in 0..chain.len() - 1 {
            let (t, u) = (chain.stays_occupied(j), chain.becomes_occupied(j));
            let next = likelihood[j + 1];
            posterior.pairs.push(front.pair(t, u, next, behind[j + 1]).scaled(normalise));
            front.advance(t, u, next);
        }
    } else {
        posterior.evidence = 0.0;
        chain.keep(posterior);
    }
    posterior.scratch = behind;
}

/// `B[j]`: likelihood of the reading given that cells `0 ..= j` are free.
fn backward(chain: &Chain, likelihood: &[f64], none: f64, behind: &mut Vec<f64>) {
    behind.clear();
    behind.resize(chain.len(), none);
    for j in (0..chain.len() - 1).rev() {
        let u = chain.becomes_occupied(j);
        behind[j] = u * likelihood[j + 1] + (1.0 - u) * behind[j + 1];
    }
}

/// What is known in front of, and at, the current cell, weighted with the likelihood of the reading.
struct Front {
    /// `W_E`: the hit is at or before this cell, and this cell is occupied.
    hit_occupied: f64,
    /// `W_F`: the hit is before this cell, and this cell is free.
    hit_free: f64,
    /// `S`: all cells so far are free.
    clear: f64,
}

impl Front {
    fn at_first_cell(chain: &Chain, likelihood: &[f64]) -> Self {
        let p = chain.occupied(0);
        Self { hit_occupied: likelihood[0] * p, hit_free: 0.0, clear: 1.0 - p }
    }

    /// Joint of this cell and the next with the reading, not yet normalised: Eqs. (4)-(7) times the prior.
    fn pair(&self, t: f64, u: f64, next: f64, behind: f64) -> Joint {
        Joint {
            ee: self.hit_occupied * t,                             // Eq. (4)
            ef: self.hit_occupied * (1.0 - t),                     // Eq. (5)
            fe: (self.hit_free + self.clear * next) * u,           // Eq. (6)
            ff: (self.hit_free + self.clear * behind) * (1.0 - u), // Eq. (7)
        }
    }

    /// Moves on to the next cell.
    fn advance(&mut self, t: f64, u: f64, next: f64) {
        let occupied = self.hit_occupied * t + (self.hit_free + self.clear * next) * u;
        self.hit_free = self.hit_occupied * (1.0 - t) + self.hit_free * (1.0 - u);
        self.hit_occupied = occupied;
        self.clear *= 1.0 - u;
        if self.clear < NEGLIGIBLE {
            self.clear = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_of_one_cell_is_bayes_rule() {
        let mut out = RayPosterior::default();
        posterior(&Chain::new(vec![0.1], vec![]), &[0.5], 0.02, &mut out);
        assert!((out.evidence - 0.068).abs() < 1e-16);
        assert!((out.first - 0.05 / 0.068).abs() < 1e-15);
        assert_eq!(out.marginals(), [out.first]);
        assert!(out.pairs.is_empty());
    }

    #[test]
    fn an_impossible_reading_changes_nothing() {
        let chain = Chain::new(vec![0.1, 0.2], vec![0.05]);
        let mut out = RayPosterior::default();
        posterior(&chain, &[0.0, 0.0], 0.0, &mut out);
        assert!(out.evidence.abs() < f64::MIN_POSITIVE);
        assert_eq!(out.pairs, [chain.joint(0)]);
    }

    #[test]
    fn a_hundred_thousand_cells_neither_underflow_nor_drift() {
        let n = 100_000;
        let chain = Chain::new(vec![0.1; n], vec![0.088_39; n - 1]);
        let mut likelihood = vec![0.003; n];
        likelihood[70_000] = 0.6;
        let mut out = RayPosterior::default();
        posterior(&chain, &likelihood, 0.003, &mut out);
        assert!(out.pairs.iter().all(|pair| (pair.total() - 1.0).abs() < 1e-9));
        assert!((out.pairs[90_000].first() - 0.1).abs() < 1e-9, "far behind, the prior is kept");
    }
}
