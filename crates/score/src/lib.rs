#![doc = include_str!("../README.md")]
//!
//! # Where things are
//!
//! - [`align`] finds where a map lies best.
//! - [`suspicion`] looks for rows in the wrong order and origins half a cell off.
//! - [`resample`] brings a map into the cells of the truth.
//! - [`Sightings`] turns noise-free casts ([`Sight`]) into the masks of every [`Region`].
//! - [`Scorer`] compares a map with the truth over a mask and gives [`Scores`], a list of [`Metric`]s.
//! - [`log_loss`] is the one metric cheap enough for every scan; [`reliability`] is the diagram
//!   behind the calibration error; [`probability_bins`] is the one that adds up over maps.
//! - [`Retention`] follows free space from scan to scan.
//! - [`Moving`] follows a world in which things move, and gives the regions ([`MovingRegion`]) and metrics ([`MovingScores`]) that only such a world
//!   has; [`Lag`] counts the looks until a map has followed a change.
//! - [`error_profile`] shows where a map is wrong: error against range, or against number of looks.
//! - [`Comparison`] says which of two methods is better, by how much and how surely; [`holm`] adjusts
//!   for many such questions; [`Verdict`] puts the answer into a word.
//! - [`navigation`] plans drives on a map and says how many of them can be driven.
//! - [`Tiles`] says how sure the difference of two maps of one world is.
//! - [`Summary`] is the spread of a metric over seeds.
//! - [`trajectory`] scores poses instead of maps, and [`landmarks`] landmarks.
//! - [`threshold`] holds the probabilities at which a map is taken at its word.
//!
//! Sums run in index order, logarithms come from `libm`: the same input gives the same bytes.

mod align;
mod calibration;
mod error;
mod judged;
pub mod landmarks;
mod log_loss;
mod metric;
mod moving;
pub mod navigation;
mod pooled;
mod profile;
mod ranking;
mod region;
mod resample;
mod retention;
mod scorer;
mod scores;
mod sight;
mod statistics;
mod summary;
mod suspicion;
mod tally;
pub mod threshold;
mod tiles;
pub mod trajectory;

pub use align::{AlignBound, Alignment, align};
pub use calibration::{BINS, Bin, reliability};
pub use error::ScoreError;
pub use log_loss::log_loss;
pub use metric::Metric;
pub use moving::{LONGEST_LAG, Lag, Moving, MovingRegion, MovingScores, NEAR_LOOK_M, QUICK_LOOKS};
pub use pooled::{PROBABILITY_EDGES, ProbabilityBin, probability_bins};
pub use profile::{ErrorBin, ErrorProfile, LOOK_EDGES, RANGE_EDGES_M, error_profile};
pub use region::Region;
pub use resample::{Finer, Resampled, Resampling, Share, meant, resample};
pub use retention::Retention;
pub use scorer::Scorer;
pub use scores::Scores;
pub use sight::{NUDGE_M, SHELL_DEPTH_M, Sight, Sightings};
pub use statistics::{
    Better, Comparison, EXACT_PAIRS, FEWEST_PAIRS, Interval, Margin, RESAMPLES, Ratio, SIGNIFICANCE, SeriesMean,
    SignedRank, StatisticsError, Verdict, holm, holm_table, ratio_of_means, series_mean,
};
pub use summary::Summary;
pub use suspicion::{Suspicion, suspicion};
pub use tiles::{FEWEST_TILES, TiledDifference, Tiles};

#[cfg(test)]
mod drawing;
