//! How sure a mean difference is: the bootstrap interval.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};
use serde::Serialize;

use super::differences::Differences;
use super::normal;

/// Number of bootstrap resamples. The ends of a 95 % interval then rest on 250 resamples each,
/// which puts them within about 2 % of the interval's width of where endless resampling would.
pub const RESAMPLES: usize = 10_000;

/// Every interval is drawn from the same stream: it depends on the differences alone, and
/// comparisons of as many pairs share their luck.
const SEED: u64 = 1993;

/// The 2.5 % point of the standard normal distribution, for the coverage of 95 %.
const LOWER_Z: f64 = -1.959963984540054;

/// The smallest interval of values that a comparison leaves in play.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// The middle 95 % of the values of resamples, of which there is one at least.
    pub(crate) fn percentile(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let end = |share: f64| values[((share * values.len() as f64) as usize).min(values.len() - 1)];
        Self { low: end(0.025), high: end(0.975) }
    }

    /// Whether the interval lies on one side of zero, zero not being an end of it either.
    pub fn excludes_zero(&self) -> bool {
        self.low > 0.0 || self.high < 0.0
    }

    /// Whether the interval lies between `-margin` and `margin`, both excluded.
    pub fn inside(&self, margin: f64) -> bool {
        self.low > -margin && self.high < margin
    }
}

/// The bias-corrected and accelerated (BCa) bootstrap interval of the mean with 95 % coverage: Efron
/// (1987); Efron and Tibshirani (1993), Section 14.3.
///
/// BCa and not percentile, because differences of a loss are skewed (a few scenes go badly wrong) and
/// the percentile interval then ends too early on the side of the long tail.
///
/// **Antithetic resamples** (Hall 1989): each draw of ranks is used twice, once counted from the
/// smallest difference and once from the largest. Each is a bootstrap resample in its own right;
/// together they make the interval change sign exactly when the differences do.
pub(crate) fn interval_of_mean(differences: &Differences) -> Interval {
    let Some(acceleration) = differences.acceleration() else {
        let mean = differences.mean();
        return Interval { low: mean, high: mean };
    };
    let sums = resampled_sums(differences.sorted());
    let bias = bias_correction(&sums, differences);
    let end = |z: f64| {
        // |acceleration| < 1/6 for a mean, |bias| < 3.9 for 10,000 resamples: the divisor is positive.
        let shifted = bias + z;
        sums[rank(bias + shifted / (1.0 - acceleration * shifted)) - 1] / differences.sorted().len() as f64
    };
    Interval { low: end(LOWER_Z), high: end(-LOWER_Z) }
}

/// Sums of the resamples, smallest first.
fn resampled_sums(sorted: &[f64]) -> Vec<f64> {
    let n = sorted.len();
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut sums = Vec::with_capacity(RESAMPLES);
    for _ in 0..RESAMPLES / 2 {
        let (mut sum, mut mirrored) = (0.0, 0.0);
        for _ in 0..n {
            // Multiply and shift: uniform but for n / 2^32, and the same with every version of `rand`.
            let drawn = ((u64::from(rng.next_u32()) * n as u64) >> 32) as usize;
            sum += sorted[drawn];
            mirrored += sorted[n - 1 - drawn];
        }
        sums.extend([sum, mirrored]);
    }
    sums.sort_by(f64::total_cmp);
    sums
}

/// How far the resampled means lie to one side of the mean: the normal quantile of the share below it,
/// where means equal to it (but for rounding) count one half.
fn bias_correction(sums: &[f64], differences: &Differences) -> f64 {
    let n = differences.sorted().len() as f64;
    let total = n * differences.mean();
    let rounding = 1e-12 * differences.sorted().iter().fold(0.0, |sum, d| sum + d.abs());
    let below = sums.partition_point(|&sum| sum < total - rounding);
    let not_above = sums.partition_point(|&sum| sum <= total + rounding);
    // In halves of a resample, so that both sides of the middle are treated alike.
    let halves = (below + not_above).clamp(1, 2 * RESAMPLES - 1);
    let share = |halves: usize| halves as f64 / (2 * RESAMPLES) as f64;
    if halves <= RESAMPLES { normal::quantile(share(halves)) } else { -normal::quantile(share(2 * RESAMPLES - halves)) }
}

/// The rank (from 1) of the resample at a normal quantile: `(B + 1) Φ(z)`, rounded away from the
/// middle, so that the interval errs on the wide side.
fn rank(z: f64) -> usize {
    let from_the_end = |z: f64| (((RESAMPLES + 1) as f64 * normal::cdf(z)) as usize).clamp(1, RESAMPLES);
    if z <= 0.0 { from_the_end(z) } else { RESAMPLES + 1 - from_the_end(-z) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interval(values: &[f64]) -> Interval {
        interval_of_mean(&Differences::of(values.iter().map(|&d| (Some(d), Some(0.0)))).expect("valid"))
    }

    fn near(values: &[f64], low: f64, high: f64, tolerance: f64) {
        let found = interval(values);
        let close = (found.low - low).abs() < tolerance && (found.high - high).abs() < tolerance;
        assert!(close, "{found:?} and not {low} to {high}");
    }

    /// `scipy.stats.bootstrap((d,), numpy.mean, n_resamples=200000, method="BCa")` of scipy 1.17. The
    /// tolerance is 3 % of the width: the ends of 10,000 resamples stray by about 1 %.
    #[test]
    fn equals_scipy() {
        let skewed = [0.01, 0.02, 0.02, 0.03, 0.05, 0.06, 0.08, 0.09, 0.12, 0.15, 0.19, 0.26, 0.34, 0.55, 1.2];
        near(&skewed, 0.1085, 0.467, 0.011);
        let depression = [0.952, -0.147, 1.022, 0.43, 0.62, 0.59, 0.49, -0.08, 0.01];
        near(&depression, 0.1664, 0.6884, 0.016);
        let darwin = [49., -67., 8., 16., 6., 23., 28., 41., 14., 29., 56., 24., 75., 60., -48.];
        near(&darwin, -1.63, 36.33, 1.15);
    }

    #[test]
    fn ranks_mirror_each_other() {
        assert_eq!((rank(LOWER_Z), rank(-LOWER_Z)), (250, RESAMPLES + 1 - 250));
        assert_eq!((rank(-40.0), rank(40.0)), (1, RESAMPLES));
        for z in [0.1, 0.7, 1.3, 2.9, 3.8] {
            assert_eq!(rank(z) + rank(-z), RESAMPLES + 1);
        }
        assert!((normal::quantile(0.025) - LOWER_Z).abs() < 1e-14);
    }

    #[test]
    fn equal_differences_leave_nothing_open() {
        assert_eq!(interval(&[0.25; 7]), Interval { low: 0.25, high: 0.25 });
        assert_eq!(interval(&[0.0; 7]), Interval { low: 0.0, high: 0.0 });
    }

    #[test]
    fn sides() {
        let of = |low, high| Interval { low, high };
        assert!(of(0.1, 0.2).excludes_zero() && of(-0.2, -0.1).excludes_zero());
        assert!(!of(-0.1, 0.1).excludes_zero() && !of(0.0, 0.1).excludes_zero() && !of(-0.1, 0.0).excludes_zero());
        assert!(of(-0.1, 0.1).inside(0.2) && !of(-0.1, 0.1).inside(0.1) && !of(-0.3, 0.1).inside(0.2));
    }
}
