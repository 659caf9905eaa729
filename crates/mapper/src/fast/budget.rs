//! How far one scan may be from the reference, and how the thresholds of the fast mapper share that.
//!
//! A posterior is a share of the evidence. Where a likelihood in it is off by a share `e` of its value, a probability `p` moves
//! by at most `e p (1 - p)`, a quarter of `e`; where all are off, some up and some down, by twice that.
//!
//! | what | moves a probability by at most |
//! |---|---|
//! | the kernel in single precision is off by [`KERNEL`] of its value | `KERNEL / 2` |
//! | the sum past the map is off by [`TAIL`] of its value | `TAIL / 4` |
//! | the sum past the map is left out where less than [`OPEN`] is left for it, beside evidence of [`EVIDENT`] | `OPEN / EVIDENT` |
//! | a cell counts as unmoved that moves by [`UNMOVED`] | `UNMOVED` |
//! | a ray is cut where what it has left to add is [`CUT`], and what its last cell has learnt too | `2 CUT` |
//! | what is left in front counts as nothing below [`NEGLIGIBLE`], beside evidence of [`LEAST_EVIDENCE`] | `NEGLIGIBLE / LEAST_EVIDENCE` |
//! | roundings of single precision, 6e-8 each, some thirty in a row | what is left: 2e-6 |

/// Largest difference of a marginal or joint after one scan.
const BUDGET: f64 = 1e-5;

/// Relative error of [`sensor::FastKernel::likelihood_lanes`].
const KERNEL: f64 = 5e-6;

/// Relative error of the sum past the map.
pub(super) const TAIL: f64 = 1e-5;

/// Probability, weighted with the likelihood, that the ray is free up to the border of the map, below which what lies beyond
/// does not matter ...
pub(super) const OPEN: f32 = 1e-9;

/// ... where the evidence is at least this. Of a reading that has less, what lies beyond may be most of it, and the threshold falls
/// with the evidence.
pub(super) const EVIDENT: f32 = 1e-3;

/// Evidence below this is left to double precision.
pub(super) const LEAST_EVIDENCE: f32 = 1e-20;

/// Below this, what is left in front is nothing: it stops the walk through subnormal numbers.
pub(super) const NEGLIGIBLE: f32 = 1e-30;

/// A cell is unmoved where a reading moves neither its probability, nor that of being different from the one before it, by
/// more than this.
pub(super) const UNMOVED: f32 = 1e-6;

/// A ray is followed no farther than to where the rest of it moves no probability by more than this and as much again:
/// [`UNMOVED`] in all.
pub(super) const CUT: f32 = 5e-7;

const _: () = {
    let kernels = KERNEL / 2.0 + TAIL / 4.0;
    let ends = OPEN as f64 / EVIDENT as f64 + UNMOVED as f64 + 2.0 * CUT as f64;
    let nothing = NEGLIGIBLE as f64 / LEAST_EVIDENCE as f64;
    let roundings = 30.0 * 6e-8;
    assert!(kernels + ends + nothing + roundings <= BUDGET, "the thresholds are more than the budget");
};
