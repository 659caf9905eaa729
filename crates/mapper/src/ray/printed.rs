//! The posterior of one viewing ray by Eqs. (4)-(17) exactly as the paper prints them.
//!
//! It is not the posterior that Eq. (2) asks for. In Eqs. (6) and (7) the visibilities
//! `P(F_{j+1} | O)` and `P(F_k | O)`, k > j, are not conditioned on the states of the pair, so the
//! weights of a case do not add up to one; and the sum in Eq. (7) begins at `k = j + 1` although
//! cell `j + 1` is free there. It is kept to measure the gap, see [`exact`].
//!
//! The sums over `k` are carried along the ray, O(N) instead of the paper's O(N²);
//! `tests/printed.rs` holds the double sums as they stand in the paper.

use crate::pairs::joint::{Joint, correlation};
use crate::pairs::posterior::RayPosterior;
use crate::ray::chain::Chain;
use crate::ray::exact;

/// Updates the pairs along one viewing ray with one reading, by the printed equations.
///
/// Arguments as for [`exact::posterior`]. `none` closes the sum to infinity in Eq. (7).
/// Neighbouring pairs need not agree on the cell they share. The evidence is `1 / alpha` of the
/// first pair.
///
/// # Panics
/// If the chain is empty, or there is not one likelihood per cell.
pub fn posterior(chain: &Chain, likelihood: &[f64], none: f64, posterior: &mut RayPosterior) {
    assert_eq!(chain.len(), likelihood.len(), "one likelihood per cell");
    if chain.len() < 2 {
        return exact::posterior(chain, likelihood, none, posterior); // no pair, nothing printed
    }
    let mut seen = std::mem::take(&mut posterior.scratch);
    visible_likelihood(chain, likelihood, &mut seen);
    // Sum over k > j of P(o | F_k) P(F_k | O), Eq. (7), shrinking as j moves on.
    let mut beyond = clear(chain) * none + (1..chain.len()).map(|k| seen[k] * chain.occupied(k)).sum::<f64>();
    let mut sums = Sums { independent: 0.0, correlated: 0.0 };
    posterior.evidence = 0.0;
    posterior.pairs.clear();
    for j in 0..chain.len() - 1 {
        let p = chain.occupied(j);
        let given_free = sums.given_free(p); // k < j
        sums.add(seen[j], p);
        let given_occupied = sums.given_occupied(p); // k <= j
        let at_next = seen[j + 1] * chain.occupied(j + 1);
        let prior = chain.joint(j);
        let pair = Joint {
            ee: given_occupied * prior.ee,                 // Eq. (4)
            ef: given_occupied * prior.ef,                 // Eq. (5)
            fe: (given_free + at_next) * prior.fe,         // Eq. (6)
            ff: (given_free + beyond.max(0.0)) * prior.ff, // Eq. (7)
        };
        let evidence = pair.total();
        if j == 0 {
            posterior.evidence = evidence;
        }
        let possible = evidence >= f64::MIN_POSITIVE;
        posterior.pairs.push(if possible { pair.scaled(1.0 / evidence) } else { prior });
        beyond -= at_next;
        sums.step(chain, j);
    }
    posterior.first = posterior.pairs[0].first();
    posterior.scratch = seen;
}

/// `P(o | F_k)` times the factors of Eqs. (8)-(10) that do not depend on `j`:
/// `P(free 0 | free 1) ... P(free k-2 | free k-1) P(free k-1 | E_k)`.
fn visible_likelihood(chain: &Chain, likelihood: &[f64], seen: &mut Vec<f64>) {
    seen.clear();
    seen.push(likelihood[0]);
    let mut clear = 1.0;
    for (j, &next) in likelihood[1..].iter().enumerate() {
        let pair = chain.joint(j);
        seen.push(next * clear * pair.fe / (pair.ee + pair.fe)); // Eq. (12)
        clear *= pair.ff / (pair.ff + pair.ef); // Eq. (13)
    }
}

/// Probability that every cell of the ray is free, by Eqs. (10) and (13).
fn clear(chain: &Chain) -> f64 {
    let last_free = 1.0 - chain.occupied(chain.len() - 1);
    (0..chain.len() - 1).map(|q| chain.joint(q)).fold(last_free, |clear, pair| clear * pair.ff / (pair.ff + pair.ef))
}

/// Sums over the cells `k` up to the current one, `j`, of `seen[k] P(E_k, e_j)`: Eq. (14) splits the
/// joint into a product and a part that fades with the correlations between `k` and `j`.
struct Sums {
    /// Sum of `seen[k] P(E_k)`.
    independent: f64,
    /// Sum of `seen[k] sqrt(P(E_k) P(not E_k)) c_{k,k+1} ... c_{j-1,j}`.
    correlated: f64,
}

impl Sums {
    fn add(&mut self, seen: f64, p: f64) {
        self.independent += seen * p;
        self.correlated += seen * libm::sqrt(p * (1.0 - p));
    }

    /// Sum of `P(o | F_k) P(F_k | E_j)`, Eqs. (8), (14), (17).
    fn given_occupied(&self, p: f64) -> f64 {
        (self.independent + self.correlated * libm::sqrt((1.0 - p) / p)).max(0.0)
    }

    /// Sum of `P(o | F_k) P(F_k | not E_j)`, Eqs. (9), (15), (17).
    fn given_free(&self, p: f64) -> f64 {
        (self.independent - self.correlated * libm::sqrt(p / (1.0 - p))).max(0.0)
    }

    /// Moves on from cell `j` to the next: one more correlation in the product of Eq. (14).
    fn step(&mut self, chain: &Chain, j: usize) {
        self.correlated *= correlation(chain.occupied(j), chain.occupied(j + 1), chain.joint(j).ee); // Eq. (16)
    }
}
