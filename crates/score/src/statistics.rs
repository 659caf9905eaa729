//! Which of two methods is better, by how much, and how sure that is: statistics of paired values.

mod blocks;
mod bootstrap;
mod comparison;
mod differences;
mod error;
mod holm;
mod normal;
mod ratio;
mod signed_rank;
mod verdict;

pub use blocks::{SeriesMean, series_mean};
pub use bootstrap::{Interval, RESAMPLES};
pub use comparison::{Comparison, FEWEST_PAIRS, SIGNIFICANCE};
pub use error::StatisticsError;
pub use holm::{holm, holm_table};
pub use ratio::{Ratio, ratio_of_means};
pub use signed_rank::{EXACT_PAIRS, SignedRank};
pub use verdict::{Better, Margin, Verdict};
