//! The signed-rank test: is a difference more often, and more clearly, to one side?

use serde::Serialize;

use super::normal;

/// Up to this many differences that are not zero p is exact. The cost grows with the cube, to some
/// milliseconds here, and the normal approximation is by then within 2 % of a p of 0.01.
pub const EXACT_PAIRS: usize = 200;

/// The Wilcoxon signed-rank test of paired differences, two-sided. Wilcoxon (1945).
///
/// **Zeros** are ranked with the others and then left out (Pratt 1959), so that many equal pairs
/// weaken a few different ones. **Ties** share the mean of their ranks. **p** is exact, given the
/// ranks, up to [`EXACT_PAIRS`]: the distribution over all choices of signs is computed, which
/// ties and zeros do not hinder. Beyond, it is the normal approximation with the variance that ties
/// and zeros leave, and the continuity correction of one half.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SignedRank {
    /// Sum of the ranks of the positive differences; W+ or V elsewhere.
    pub positive: f64,
    /// Sum of the ranks of the negative differences.
    pub negative: f64,
    /// Number of differences that are zero.
    pub zeros: usize,
    /// Probability of ranks at least as one-sided as these if signs were by chance.
    pub p: f64,
    /// Whether p is exact.
    pub exact: bool,
}

impl SignedRank {
    pub(crate) fn of(differences: &[f64]) -> Self {
        let ranks = Ranks::of(differences);
        let exact = ranks.doubled.len() <= EXACT_PAIRS;
        Self {
            positive: 0.5 * ranks.positive as f64,
            negative: 0.5 * ranks.negative() as f64,
            zeros: differences.len() - ranks.doubled.len(),
            p: if exact { ranks.exact_p() } else { ranks.normal_p() },
            exact,
        }
    }

    /// The matched-pairs rank-biserial correlation, an effect size from -1 (all differences
    /// negative) to 1 (all positive): the share of the rank sum that is positive less the share
    /// that is negative. Kerby (2014). `None` where all differences are zero.
    pub fn rank_biserial(&self) -> Option<f64> {
        let all = self.positive + self.negative;
        (all > 0.0).then(|| (self.positive - self.negative) / all)
    }
}

/// Ranks of the differences that are not zero, doubled: whole numbers even where they are shared.
struct Ranks {
    doubled: Vec<usize>,
    /// Sum of them over the positive differences.
    positive: usize,
}

impl Ranks {
    fn of(differences: &[f64]) -> Self {
        let mut sorted = differences.to_vec();
        sorted.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        let mut ranks = Self { doubled: Vec::with_capacity(sorted.len()), positive: 0 };
        let mut before = 0;
        for tie in sorted.chunk_by(|a, b| a.abs().total_cmp(&b.abs()).is_eq()) {
            let shared = 2 * before + tie.len() + 1;
            before += tie.len();
            if tie[0].abs() > 0.0 {
                ranks.doubled.extend(tie.iter().map(|_| shared));
                ranks.positive += shared * tie.iter().filter(|d| **d > 0.0).count();
            }
        }
        ranks
    }

    fn all(&self) -> usize {
        self.doubled.iter().sum()
    }

    fn negative(&self) -> usize {
        self.all() - self.positive
    }

    /// Twice the probability of the smaller of both sums or less, every sign being by chance. O(n³).
    fn exact_p(&self) -> f64 {
        let smaller = self.positive.min(self.negative());
        // Probability of every sum up to the smaller one, one difference after another.
        let mut chance = vec![0.0; smaller + 1];
        chance[0] = 1.0;
        for &rank in &self.doubled {
            for sum in (0..=smaller).rev() {
                let with = if sum < rank { 0.0 } else { chance[sum - rank] };
                chance[sum] = 0.5 * (chance[sum] + with);
            }
        }
        // Both sides share the middle, where the doubled probability would exceed one.
        (2.0 * chance.iter().sum::<f64>()).min(1.0)
    }

    /// The variance of a sum of ranks with random signs is a quarter of their sum of squares, which
    /// for whole ranks is the textbook's n (n + 1) (2 n + 1) / 24, and less with ties and zeros.
    fn normal_p(&self) -> f64 {
        let variance = self.doubled.iter().map(|&rank| (rank * rank) as f64).sum::<f64>() / 16.0;
        // From the expected sum, half of all; doubled twice, so a quarter.
        let distance = self.positive.abs_diff(self.negative()) as f64 / 4.0;
        if variance > 0.0 {
            let z = (distance - 0.5).max(0.0) / libm::sqrt(variance);
            2.0 * normal::cdf(-z)
        } else {
            1.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, expected: f64) {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} and not {expected}");
    }

    /// Hollander and Wolfe (1973), p. 29: depression of nine patients before and after therapy, the
    /// example of R's `wilcox.test`: V = 40, p = 0.03906.
    const DEPRESSION: [f64; 9] = [0.952, -0.147, 1.022, 0.43, 0.62, 0.59, 0.49, -0.08, 0.01];

    /// Darwin (1876): height of crossed less self-fertilised maize, eighths of an inch; the
    /// example of Fisher (1935) and of `scipy.stats.wilcoxon`: p = 0.04126.
    const MAIZE: [f64; 15] = [49., -67., 8., 16., 6., 23., 28., 41., 14., 29., 56., 24., 75., 60., -48.];

    /// Zeros and ties.
    const TIED: [f64; 20] = [0., 0., 1., 1., -1., 2., 2., 3., -3., 4., 5., 5., -2., 6., 7., 0., 8., -4., 9., 10.];

    #[test]
    fn published_examples() {
        let depression = SignedRank::of(&DEPRESSION);
        assert_eq!((depression.positive, depression.negative, depression.exact), (40.0, 5.0, true));
        close(depression.p, 20.0 / 512.0);
        let maize = SignedRank::of(&MAIZE);
        assert_eq!((maize.positive, maize.negative), (96.0, 24.0));
        close(maize.p, 0.041259765625);
        close(maize.rank_biserial().expect("not all zero"), 0.6);
    }

    /// scipy 1.17: `wilcoxon(d, zero_method="pratt", method=PermutationMethod(n_resamples=inf))`, which
    /// takes all 2^17 signs; `wilcoxon(d, method="exact")` for sixty differences without ties.
    #[test]
    fn equals_scipy_exactly() {
        let tied = SignedRank::of(&TIED);
        assert_eq!((tied.negative, tied.zeros), (36.0, 3));
        close(tied.p, 0.0114593505859375);
        let sixty: Vec<f64> = (0..60u32).map(|i| f64::from(i * 37 % 101) - 42.5 + f64::from(i) / 1000.0).collect();
        let sixty = SignedRank::of(&sixty);
        close(sixty.positive.min(sixty.negative), 669.0);
        close(sixty.p, 0.07052937400422277);
    }

    /// scipy 1.17: `wilcoxon(d, zero_method="pratt", correction=True, method="asymptotic")`.
    #[test]
    fn equals_scipy_in_the_normal_approximation() {
        close(Ranks::of(&DEPRESSION).normal_p(), 0.04401098401295143);
        close(Ranks::of(&MAIZE).normal_p(), 0.043772323763041174);
        close(Ranks::of(&TIED).normal_p(), 0.014141863450242514);
        for (middle, statistic, p) in [(40.0, 14610.0, 1.192456993927669e-07), (48.0, 20918.5, 0.2716358081701471)] {
            let many: Vec<f64> = (0..300u32).map(|i| f64::from(i * 37 % 101) - middle).collect();
            let many = SignedRank::of(&many);
            assert_eq!((many.positive.min(many.negative), many.zeros, many.exact), (statistic, 3, false));
            assert!((many.p / p - 1.0).abs() < 1e-11, "{} and not {p}", many.p);
        }
    }

    #[test]
    fn the_approximation_takes_over_smoothly() {
        let alternating: Vec<f64> = (1..=EXACT_PAIRS).map(|i| if i % 5 < 2 { -1.0 } else { 1.0 } * i as f64).collect();
        let ranks = Ranks::of(&alternating);
        assert!(SignedRank::of(&alternating).exact);
        // Where one takes over from the other, no p in a table of three decimals changes.
        assert!((ranks.exact_p() - ranks.normal_p()).abs() < 5e-4, "{} {}", ranks.exact_p(), ranks.normal_p());
    }

    #[test]
    fn limits() {
        let none = SignedRank::of(&[0.0; 5]);
        assert_eq!((none.p, none.zeros, none.exact, none.rank_biserial()), (1.0, 5, true, None));
        close(Ranks::of(&[0.0; 5]).normal_p(), 1.0);
        let one_sided = SignedRank::of(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        close(one_sided.p, 2.0 / 64.0);
        assert_eq!(one_sided.rank_biserial(), Some(1.0));
        close(SignedRank::of(&[1.0; EXACT_PAIRS]).p, 0.5f64.powi(EXACT_PAIRS as i32 - 1));
        close(SignedRank::of(&[1.0, -1.0]).p, 1.0);
    }
}
