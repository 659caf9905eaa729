//! Probabilities that evidence can always move, their log odds, and Bayes' rule for one cell.

/// Smallest distance that a probability keeps from 0 and 1, so that no cell is ever beyond
/// evidence: a cell held free at 1e-6 is held occupied again after three clear readings.
pub const EPSILON: f64 = 1e-6;

/// A probability kept off 0 and 1 by [`EPSILON`].
pub(crate) fn bounded(p: f64) -> f64 {
    p.clamp(EPSILON, 1.0 - EPSILON)
}

/// `ln(p / (1 - p))` of a probability kept off 0 and 1.
pub(crate) fn log_odds(p: f64) -> f64 {
    let p = bounded(p);
    libm::log(p / (1.0 - p))
}

/// The probability of the given log odds, kept off 0 and 1.
pub(crate) fn from_log_odds(log_odds: f64) -> f64 {
    bounded(1.0 / (1.0 + libm::exp(-log_odds)))
}

/// Eq. (22): a cell of probability `p` after a reading with the given likelihoods if it is occupied and if it is free.
/// Likelihoods that are both zero leave it as it is.
pub fn bayes(p: f64, [occupied, free]: [f64; 2]) -> f64 {
    let (yes, no) = (occupied * p, free * (1.0 - p));
    if yes + no > 0.0 { yes / (yes + no) } else { p }
}
