//! How far one scan may be from the reference, and how the thresholds of the fast mapper share that.
//!
//! A posterior is a share of the evidence. Where a likelihood in it is off by a share `e` of its value, a probability `p` moves
//! by at most `e p (1 - p)`, a quarter of `e`; where all are off, some up and some down, by twice that.
//!
//! | what | moves a probability by at most |
//! |---|---|
//! | the kernel in single precision is off by [`KERNEL`] of its value | `KERNEL / 2` |
//! | the sum past the map is off by [`TAIL`] of its value | `TAIL / 4` |
//! | the sum past the map is left out where less than [`OPEN`] is left for it, beside evidence of [`EVIDENT`] | `OPEN LIKELIEST / EVIDENT` |
//! | a cell counts as unmoved that moves by [`UNMOVED`] | `UNMOVED` |
//! | a ray is cut where what it has left to add is [`CUT`], and what its last cell has learnt too | `2 CUT` |
//! | what is left in front counts as nothing below [`NEGLIGIBLE`], beside evidence of [`LEAST_EVIDENCE`] | `NEGLIGIBLE / LEAST_EVIDENCE` |
//! | what hits in cells leapt over share of the evidence is [`LEAPT`] at most, and known to a half | `LEAPT / 8` |
//! | roundings of single precision, 6e-8 each, some thirty in a row | what is left: 2e-6 |

/// Largest difference of a marginal or joint after one scan.
const BUDGET: f64 = 1e-5;

/// Relative error of [`sensor::FastKernel::likelihood_lanes`].
const KERNEL: f64 = 5e-6;

/// Relative error of the sum past the map.
pub(super) const TAIL: f64 = 1e-5;

/// Probability, weighted with the likelihood, that the ray is free up to the border of the map, below which what lies beyond
/// does not matter ...
pub(super) const OPEN: f32 = 1e-11;

/// Largest likelihood, per unit of the reading, of what lies past the map: that of a laser whose sigma is 4 mm.
const LIKELIEST: f64 = 100.0;

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
pub(super) const CUT: f32 = 4e-7;

/// A patch is settled where no cell of it has a larger probability. A ray that leaps over it leaves it as it is, where it would have
/// made its cells smaller: by no more than this. What makes other cells wrong does nothing to such small ones.
pub(super) const SETTLED: f32 = 4e-6;

/// A ray that has leapt is taken again, cell by cell, where the evidence for a hit in the cells leapt over is more than this share of
/// all. Half of it may be wrong, since of a patch only the mean of the hazards is known, and a probability then moves by an eighth of
/// this.
pub(super) const LEAPT: f32 = 2.4e-6;

const _: () = {
    let kernels = KERNEL / 2.0 + TAIL / 4.0;
    let ends = OPEN as f64 * LIKELIEST / EVIDENT as f64 + UNMOVED as f64 + 2.0 * CUT as f64;
    let nothing = NEGLIGIBLE as f64 / LEAST_EVIDENCE as f64;
    let roundings = 30.0 * 6e-8;
    let leaps = LEAPT as f64 / 8.0;
    assert!(kernels + ends + nothing + roundings + leaps <= BUDGET, "the thresholds are more than the budget");
    assert!(SETTLED as f64 <= BUDGET);
};
