//! The ratio of two means over the same worlds, with its interval.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

use super::bootstrap::{Interval, RESAMPLES};

/// Every interval is drawn from the same stream: it depends on the pairs alone.
const SEED: u64 = 1979;

/// A ratio of means with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ratio {
    /// Mean numerator over mean denominator.
    pub value: f64,
    /// Where it lies with 95 % coverage; none from a single world, and where a resample has a denominator that is not above 0: the ratio may
    /// then be anything.
    pub interval: Option<Interval>,
}

/// The ratio of the means of pairs of numerator and denominator, a pair per world, with the percentile interval of a bootstrap of
/// worlds (Efron 1979): numerator and denominator of a world stay together.
///
/// None where the mean denominator is not above 0, or a value is not finite.
pub fn ratio_of_means(pairs: &[(f64, f64)]) -> Option<Ratio> {
    let n = pairs.len();
    let of = |members: &mut dyn Iterator<Item = usize>| {
        let (above, below) = members.fold((0.0, 0.0), |(a, b), k| (a + pairs[k].0, b + pairs[k].1));
        (below > 0.0).then_some(above / below)
    };
    let value = of(&mut (0..n)).filter(|value| value.is_finite())?;
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut draw = || ((u64::from(rng.next_u32()) * n as u64) >> 32) as usize;
    let resamples: Option<Vec<f64>> =
        (0..RESAMPLES).map(|_| of(&mut std::iter::repeat_with(&mut draw).take(n))).collect();
    Some(Ratio { value, interval: resamples.filter(|_| n > 1).map(Interval::percentile) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn it_is_the_ratio_of_sums_and_not_the_mean_of_ratios() {
        let ratio = ratio_of_means(&[(1.0, 1.0), (1.0, 3.0)]).expect("above 0");
        assert!((ratio.value - 0.5).abs() < 1e-15);
        let interval = ratio.interval.expect("two worlds");
        assert!((interval.low - 1.0 / 3.0).abs() < 1e-15 && (interval.high - 1.0).abs() < 1e-15, "{interval:?}");
    }

    #[test]
    fn what_has_no_ratio_has_none() {
        assert_eq!(ratio_of_means(&[]), None);
        assert_eq!(ratio_of_means(&[(1.0, -1.0), (1.0, 0.5)]), None);
        assert_eq!(ratio_of_means(&[(f64::NAN, 1.0)]), None);
        assert_eq!(ratio_of_means(&[(-1.0, 2.0)]), Some(Ratio { value: -0.5, interval: None }));
        // Worlds that speak for and against: where the second alone is drawn, there is no ratio.
        assert_eq!(ratio_of_means(&[(1.0, 2.0), (1.0, -1.0)]), Some(Ratio { value: 2.0, interval: None }));
    }

    proptest! {
        /// Worlds of one ratio have that ratio for certain, whatever their weight; and any ratio lies within the interval of its worlds'.
        #[test]
        fn worlds_of_one_ratio_have_it(pairs in prop::collection::vec((-2.0f64..3.0, 0.1f64..9.0), 2..30), one in -2.0f64..3.0) {
            let alike: Vec<_> = pairs.iter().map(|(_, below)| (one * below, *below)).collect();
            let ratio = ratio_of_means(&alike).expect("above 0");
            let interval = ratio.interval.expect("worlds");
            prop_assert!((ratio.value - one).abs() < 1e-9 && (interval.high - interval.low).abs() < 1e-9);
            let mixed: Vec<_> = pairs.iter().map(|(share, below)| (share * below, *below)).collect();
            let interval = ratio_of_means(&mixed).and_then(|ratio| ratio.interval).expect("worlds");
            let ends = pairs.iter().fold([f64::MAX, f64::MIN], |[low, high], (share, _)| [low.min(*share), high.max(*share)]);
            prop_assert!(ends[0] - 1e-9 <= interval.low && interval.low <= interval.high && interval.high <= ends[1] + 1e-9);
        }
    }
}
