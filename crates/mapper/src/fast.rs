//! The paper's method, fast: several rays at a time, in single precision where that is enough.
//!
//! | step | equations | where | reference |
//! |---|---|---|---|
//! | eight rays cross the grid in lockstep | Section 2.1 | `lines`, `trace` | [`grid::DigitalLine`] |
//! | ... and leap over what is settled | | `settled`, `walk` | one scan of the reference |
//! | likelihood of the reading per first occupied cell | (21) | [`sensor::FastKernel::likelihood_lanes`] | [`sensor::Kernel::likelihood`] |
//! | ... past the last cell | sum to infinity in (7) | `tail` | [`crate::past_the_map`] |
//! | posterior of every pair | (1)-(7) | `bundle` | [`crate::exact`] |
//! | sums over the rays | (20) | `sums`, `passing` | [`crate::Moments`] |
//! | agreement between rays | (18)-(20) | `reconcile` | [`crate::PairwiseGrid::reconcile`] |
//! | ... with continuity across rays | | `lateral` | [`crate::PairwiseGrid::reconcile_laterally`] |
//!
//! `scan` holds the four phases of a scan, `budget` how far all this may be from the reference: [`crate::Visibility`], the
//! same in double precision, ray by ray. `tests/fast.rs` holds it to that.

mod bounds;
mod budget;
mod bundle;
mod inputs;
mod lateral;
pub(crate) mod lines;
mod map;
mod passage;
mod passing;
mod pool;
mod reconcile;
mod renewal;
mod scan;
mod settled;
mod slowly;
mod squares;
mod sums;
pub(crate) mod tail;
pub(crate) mod tiles;
mod touched;
mod trace;
pub(crate) mod visibility;
mod walk;
