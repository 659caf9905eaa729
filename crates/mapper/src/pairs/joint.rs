//! The joint probability of two neighbours, and its correlation: Eqs. (16)-(19).

use crate::belief::prior::Prior;

/// Joint probability of the states of two cells, nearer or lower cell first; the entries add up to
/// one (Eq. 18).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Joint {
    /// Both occupied, `P(E_j, E_{j+1})`.
    pub ee: f64,
    /// First occupied, second free.
    pub ef: f64,
    /// First free, second occupied.
    pub fe: f64,
    /// Both free.
    pub ff: f64,
}

impl Joint {
    /// The joint of two cells with the given marginals and probability that both are occupied; the
    /// other three entries follow from Eqs. (18) and (19).
    pub fn new(first: f64, second: f64, both: f64) -> Self {
        let ef = (first - both).max(0.0);
        let fe = (second - both).max(0.0);
        Self { ee: both, ef, fe, ff: (1.0 - both - ef - fe).max(0.0) }
    }

    /// Probability that the first cell is occupied, Eq. (11).
    pub fn first(&self) -> f64 {
        self.ee + self.ef
    }

    /// Probability that the second cell is occupied.
    pub fn second(&self) -> f64 {
        self.ee + self.fe
    }

    /// Sum of the entries.
    pub fn total(&self) -> f64 {
        self.ee + self.ef + self.fe + self.ff
    }

    /// Every entry times `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        Self { ee: self.ee * factor, ef: self.ef * factor, fe: self.fe * factor, ff: self.ff * factor }
    }
}

/// What the joint of two cells with the given marginals can be.
pub(crate) fn bounds(p: f64, q: f64) -> (f64, f64) {
    ((p + q - 1.0).max(0.0), p.min(q))
}

/// `P(E_i, E_j)` of two cells with marginals `p` and `q` and correlation `c`: Eq. (16) solved.
pub(crate) fn both_occupied(p: f64, q: f64, c: f64) -> f64 {
    let (low, high) = bounds(p, q);
    (p * q + c * spread(p, q)).clamp(low, high)
}

/// Correlation of two cells, Eq. (16).
pub(crate) fn correlation(p: f64, q: f64, both: f64) -> f64 {
    (both - p * q) / spread(p, q)
}

/// Product of the standard deviations of two cells' states, Eq. (17).
fn spread(p: f64, q: f64) -> f64 {
    libm::sqrt(p * (1.0 - p) * q * (1.0 - q))
}

impl Prior {
    /// `u0 = P(E_{j+1} | not E_j)` of unseen cells of side `cell_m` (m).
    pub fn onset(&self, cell_m: f64) -> f64 {
        let p = self.marginal();
        ((p - both_occupied(p, p, self.neighbour_correlation(cell_m))) / (1.0 - p)).clamp(0.0, 1.0)
    }
}
