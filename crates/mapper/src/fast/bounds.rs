//! What probabilities can be in single precision.

/// Least probability of a cell, within [`crate::EPSILON`] of 0 in double precision too ...
const LEAST: f32 = 1.000_000_1e-6;

/// ... and the largest.
const MOST: f32 = 0.999_998_9;

/// A probability kept off 0 and 1.
#[inline(always)]
pub(super) fn bounded(p: f32) -> f32 {
    let p = if p > LEAST { p } else { LEAST };
    if p < MOST { p } else { MOST }
}

/// The joint probability of two occupied cells, as far as their marginals allow.
#[inline(always)]
pub(super) fn possible(p: f32, q: f32, both: f32) -> f32 {
    let low = if p + q > 1.0 { p + q - 1.0 } else { 0.0 };
    let high = if p < q { p } else { q };
    let both = if both > low { both } else { low };
    if both < high { both } else { high }
}
