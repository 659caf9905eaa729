//! Ours against theirs on the same scenes, readings and seeds.

use serde::Serialize;

use super::bootstrap::{Interval, interval_of_mean};
use super::differences::Differences;
use super::signed_rank::SignedRank;
use super::verdict::{Better, Margin, Verdict};
use crate::StatisticsError;

/// A p-value of at most this, adjusted for the family, counts as significant.
pub const SIGNIFICANCE: f64 = 0.05;

/// With fewer pairs no verdict is given: the signed-rank test of five cannot reach [`SIGNIFICANCE`]
/// whatever the values (2 / 2⁵ = 0.0625), and a bootstrap of five has hardly anything to draw from.
/// The least, not enough: an interval from so few covers less than it says, see the README.
pub const FEWEST_PAIRS: usize = 6;

/// What paired values of a metric say about the difference of two methods, ours minus theirs.
///
/// It does not depend on the order of the pairs. With ours and theirs exchanged, every
/// signed number changes sign exactly and every other stays.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Comparison {
    /// Number of pairs in which both values are defined.
    pub pairs: usize,
    /// Number of pairs left out because at least one is not.
    pub dropped: usize,
    /// Mean of ours minus theirs, in the unit of the metric.
    pub mean_difference: f64,
    /// The 95 % bootstrap interval (BCa) of that mean.
    pub interval: Interval,
    /// The Wilcoxon signed-rank test; its p is not adjusted, see [`holm`](crate::holm).
    pub signed_rank: SignedRank,
    /// Effect size: matched-pairs rank-biserial correlation, from -1 (ours always the smaller) to 1.
    /// `None` where all differences are zero.
    pub rank_biserial: Option<f64>,
    /// Effect size: mean over standard deviation of the differences, Cohen's d_z (Cohen 1988). `None`
    /// where all differences are equal.
    pub cohen_dz: Option<f64>,
}

impl Comparison {
    /// Compares `ours[i]` with `theirs[i]`, the values of one metric on the i-th scene and seed. Pairs
    /// must be independent of each other: scenes and seeds are, cells of a map are not.
    ///
    /// A difference of less than 1e-12 of the values is rounding and counts as zero.
    ///
    /// # Errors
    /// Lists of different length; fewer than two pairs; NaN, infinities and sizes above 1e300.
    pub fn of(ours: &[f64], theirs: &[f64]) -> Result<Self, StatisticsError> {
        same_length(ours.len(), theirs.len())?;
        Differences::of(ours.iter().zip(theirs).map(|(&a, &b)| (Some(a), Some(b)))).map(|d| Self::from(&d))
    }

    /// The same where a metric may have no value: pairs in which either is `None` are left out and
    /// counted in [`dropped`](Self::dropped). Look at that number: scenes on which one method has
    /// no value may be those on which it fails.
    ///
    /// # Errors
    /// As [`Comparison::of`]; also a value that is no number in a pair that is left out.
    pub fn of_defined(ours: &[Option<f64>], theirs: &[Option<f64>]) -> Result<Self, StatisticsError> {
        same_length(ours.len(), theirs.len())?;
        Differences::of(ours.iter().copied().zip(theirs.iter().copied())).map(|d| Self::from(&d))
    }

    /// The verdict on ours, from the 95 % interval and a p-value adjusted for the family of tests (for a
    /// single test its own, `signed_rank.p`):
    ///
    /// - fewer than [`FEWEST_PAIRS`] pairs: undecided;
    /// - else, the interval inside ±`margin`: equivalent, even if it excludes zero, for the margin
    ///   says that such a difference does not matter;
    /// - else, the interval excludes zero and `adjusted_p` is at most [`SIGNIFICANCE`]: better or worse;
    /// - else undecided, also where interval and test disagree.
    ///
    /// Equivalence is thus two one-sided tests (Schuirmann 1987) at 2.5 % each. The usual 5 % each, a 90 %
    /// interval, would find it more often; here one interval answers both questions.
    pub fn verdict(&self, better: Better, margin: Option<Margin>, adjusted_p: f64) -> Verdict {
        if self.pairs < FEWEST_PAIRS {
            Verdict::Undecided
        } else if margin.is_some_and(|margin| self.interval.inside(margin.value())) {
            Verdict::Equivalent
        } else if self.interval.excludes_zero() && adjusted_p <= SIGNIFICANCE {
            let lower = self.interval.high < 0.0;
            if lower == (better == Better::Lower) { Verdict::Better } else { Verdict::Worse }
        } else {
            Verdict::Undecided
        }
    }
}

impl From<&Differences> for Comparison {
    fn from(differences: &Differences) -> Self {
        let signed_rank = SignedRank::of(differences.sorted());
        Self {
            pairs: differences.sorted().len(),
            dropped: differences.dropped(),
            mean_difference: differences.mean(),
            interval: interval_of_mean(differences),
            signed_rank,
            rank_biserial: signed_rank.rank_biserial(),
            cohen_dz: differences.standardised_mean(),
        }
    }
}

fn same_length(ours: usize, theirs: usize) -> Result<(), StatisticsError> {
    if ours == theirs { Ok(()) } else { Err(StatisticsError::Lengths { ours, theirs }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn comparison(pairs: usize, low: f64, high: f64) -> Comparison {
        let signed_rank = SignedRank { positive: 0.0, negative: 0.0, zeros: pairs, p: 1.0, exact: true };
        let interval = Interval { low, high };
        let mean_difference = 0.5 * (low + high);
        Comparison { pairs, dropped: 0, mean_difference, interval, signed_rank, rank_biserial: None, cohen_dz: None }
    }

    #[test]
    fn verdicts() {
        use Verdict::{Better as Won, Equivalent, Undecided, Worse};
        let margin = Margin::new(0.1).ok();
        for (pairs, low, high, margin, p, expected) in [
            (30, -0.3, -0.2, None, 0.01, Won),
            (30, 0.2, 0.3, None, 0.01, Worse),
            (30, -0.3, -0.2, None, 0.05, Won),
            (30, -0.3, -0.2, None, 0.0501, Undecided),
            (30, -0.3, -0.2, None, f64::NAN, Undecided),
            (30, -0.3, 0.2, None, 0.01, Undecided),
            (30, -0.05, 0.05, None, 0.01, Undecided),
            (30, -0.05, 0.05, margin, 0.01, Equivalent),
            (30, 0.0, 0.0, margin, 1.0, Equivalent),
            (30, -0.09, -0.01, margin, 0.01, Equivalent),
            (30, -0.3, -0.01, margin, 0.01, Won),
            (30, -0.1, 0.05, margin, 0.01, Undecided),
            (5, -0.3, -0.2, margin, 0.01, Undecided),
            (5, -0.05, 0.05, margin, 0.01, Undecided),
            (6, -0.05, 0.05, margin, 0.01, Equivalent),
        ] {
            let c = comparison(pairs, low, high);
            assert_eq!(c.verdict(Better::Lower, margin, p), expected, "{pairs} {low} {high} {margin:?} {p}");
            assert_eq!(c.verdict(Better::Higher, margin, p), expected.reversed(), "{pairs} {low} {high} {p}");
        }
    }

    #[test]
    fn fewest_pairs_is_where_the_test_can_first_be_significant() {
        let p = |pairs: usize| Comparison::of(&vec![1.0; pairs], &vec![0.0; pairs]).expect("valid").signed_rank.p;
        assert!(p(FEWEST_PAIRS) <= SIGNIFICANCE && p(FEWEST_PAIRS - 1) > SIGNIFICANCE);
    }

    #[test]
    fn equal_values_are_equivalent_to_any_margin() {
        let values = [0.3, 0.1, 0.7, 0.2, 0.9, 0.4];
        let same = Comparison::of(&values, &values).expect("valid");
        let effects = (same.mean_difference, same.signed_rank.p, same.rank_biserial, same.cohen_dz);
        assert_eq!(effects, (0.0, 1.0, None, None));
        assert_eq!(same.verdict(Better::Lower, Margin::new(1e-300).ok(), 1.0), Verdict::Equivalent);
        assert_eq!(same.verdict(Better::Lower, None, 1.0), Verdict::Undecided);
    }

    #[test]
    fn what_makes_no_pairs_is_refused() {
        let message = |ours: &[f64], theirs: &[f64]| Comparison::of(ours, theirs).expect_err("refused").to_string();
        assert!(message(&[1.0, 2.0], &[1.0]).starts_with("2 values of ours, 1 of theirs: "));
        assert!(message(&[1.0], &[1.0]).starts_with("1 pairs with both values, of 1: "));
        assert!(message(&[], &[]).starts_with("0 pairs with both values, of 0: "));
        assert!(message(&[1.0, f64::NAN], &[1.0, 2.0]).starts_with("our value NaN of pair 1 "));
        let lengths = Comparison::of_defined(&[None], &[]);
        assert_eq!(lengths, Err(StatisticsError::Lengths { ours: 1, theirs: 0 }));
    }
}
