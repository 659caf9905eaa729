//! Occupancy mappers behind one trait.
//!
//! A [`Mapper`] takes scans one by one and holds, for every cell, the probability that it is
//! occupied. The paper's method keeps a [`PairwiseGrid`]: a marginal per cell and a joint
//! probability per pair of neighbours. One update reads like the paper:
//!
//! | step | equations | function |
//! |---|---|---|
//! | the ray as a Markov chain of cells | Section 2.1, (11)-(13) | [`Chain::gather`] |
//! | likelihood of the reading per first occupied cell | (21) | [`sensor::SensorModel::likelihood`] |
//! | ... beyond the last cell | sum to infinity in (7) | [`beyond::likelihood`] |
//! | posterior of every pair | (1)-(7) | [`exact::posterior`], [`printed::posterior`] |
//! | agreement between rays | (18)-(20) | [`Moments`], [`PairwiseGrid::reconcile`] |
//!
//! [`Lateral`] adds continuity across rays, which is not in the paper.
//! [`lockstep`] does the same for several rays at a time, which is what `visibility` runs; this is its reference.
//! [`catalogue`] lists every mapper by name. To add your own, implement [`Mapper`]: the example
//! `own_mapper` does it in twenty lines.

pub mod beyond;
pub mod catalogue;
mod chain;
mod climb;
mod conventional;
pub mod estimate;
pub mod exact;
mod forward_em;
mod lateral;
mod lines;
pub mod lockstep;
mod log_odds;
mod moments;
pub mod mrf;
pub mod no_occlusion;
mod pairs;
mod predictive;
pub mod printed;
mod prior;
mod ray;
mod readings;
mod reconcile;
mod tiles;
mod tuning;
mod unseen;
mod visibility;
mod work;

pub use chain::{Chain, RayPosterior};
pub use conventional::{Conventional, ConventionalRule};
pub use estimate::Estimate;
pub use forward_em::ForwardEm;
pub use lateral::Lateral;
pub use lockstep::Lockstep;
pub use log_odds::{ConstantIncrements, LogOdds};
pub use moments::Moments;
pub use mrf::{Field, Mrf};
pub use no_occlusion::NoOcclusion;
pub use pairs::{Broken, Joint, PairwiseGrid};
pub use predictive::{Belief, Predictive};
pub use prior::{CorrelationLaw, Prior};
pub use reconcile::Reconciliation;
pub use tuning::Tuning;
pub use unseen::Unseen;
pub use visibility::{RayRule, Visibility};
pub use work::Work;

use grid::Raster;
use sensor::Scan;

/// Smallest distance that a probability keeps from 0 and 1, so that no cell is ever beyond
/// evidence: a cell held free at 1e-6 is held occupied again after three clear readings.
pub const EPSILON: f64 = 1e-6;

/// A rule that turns scans into a map.
pub trait Mapper: Send {
    /// Updates the map with one scan. Rays without a reading, and rays that start outside the map,
    /// say nothing.
    fn integrate(&mut self, scan: &Scan);

    /// Brings the map up to date with the scans so far. A batch mapper, which sees all scans at once,
    /// solves here; others are always up to date.
    fn settle(&mut self) {}

    /// Probability, 0 to 1, that each cell is occupied, given the scans up to the last
    /// [`settle`](Self::settle), or so far if the mapper is no batch mapper.
    fn occupancy(&self) -> &Raster<f64>;

    /// The joint probabilities of neighbours, of a map that holds them; made for the call.
    fn pairwise(&self) -> Option<PairwiseGrid> {
        None
    }

    /// What it has done since it was made, and the memory that it holds. A mapper that does not say is taken to hold
    /// its occupancy alone.
    fn work(&self) -> Work {
        Work::uncounted(self.occupancy())
    }
}
