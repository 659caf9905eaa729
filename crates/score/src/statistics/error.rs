//! What cannot be compared.

use thiserror::Error;

/// Why values cannot be compared.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum StatisticsError {
    /// Two lists that are no pairs.
    #[error("{ours} values of ours, {theirs} of theirs: give one of each per scene and seed, in the same order")]
    Lengths {
        /// Number of our values.
        ours: usize,
        /// Number of theirs.
        theirs: usize,
    },
    /// A value that is no number, infinite or beyond any metric.
    #[error(
        "{side} value {value} of pair {pair} is not within -1e300 to 1e300: \
         leave out what is not defined, as None, and look for its cause"
    )]
    Value {
        /// Whose value: `our` or `their`.
        side: &'static str,
        /// Index of the pair.
        pair: usize,
        /// The value.
        value: f64,
    },
    /// Nothing to tell a difference by.
    #[error("{found} pairs with both values, of {given}: an interval needs at least 2, run more seeds")]
    TooFew {
        /// Pairs in which both values are defined.
        found: usize,
        /// All pairs.
        given: usize,
    },
    /// A series without a mean.
    #[error("a series of {members} members has no mean: give sums that are finite, over one part or more in all")]
    Series {
        /// Number of members.
        members: usize,
    },
    /// Something that is no p-value.
    #[error("p-value {value} at {place} is not within 0 to 1: leave out tests that were not made, as None")]
    PValue {
        /// The value.
        value: f64,
        /// Where it stands in the family.
        place: String,
    },
    /// Something that is no margin.
    #[error(
        "equivalence margin {value} is not above 0 and finite: state the largest difference that does not matter, \
         in the unit of the metric"
    )]
    Margin {
        /// The value.
        value: f64,
    },
}
