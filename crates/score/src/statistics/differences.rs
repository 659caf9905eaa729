//! Paired differences, in an order and with sums that make every statistic of them symmetric.

use crate::StatisticsError;

/// Largest size of a value, so that no sum of differences overflows.
const LARGEST: f64 = 1e300;

/// Differences below this share of the values they come from are rounding, and zero: a sign that
/// hangs on the last digit must not enter a test that looks at nothing but signs and ranks.
const ROUNDING: f64 = 1e-12;

/// Ours minus theirs of all pairs in which both are defined, sorted.
///
/// **Symmetry.** Statistics depend neither on the order of the pairs, since the differences are
/// sorted, nor on who is called ours: sums take the k-th smallest and the k-th largest
/// together, so that they change sign to the last bit when all differences do.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Differences {
    sorted: Vec<f64>,
    dropped: usize,
}

impl Differences {
    pub(crate) fn of(
        pairs: impl ExactSizeIterator<Item = (Option<f64>, Option<f64>)>,
    ) -> Result<Self, StatisticsError> {
        let given = pairs.len();
        let mut sorted = Vec::with_capacity(given);
        for (pair, (ours, theirs)) in pairs.enumerate() {
            for (side, value) in [("our", ours), ("their", theirs)] {
                if let Some(value) = value.filter(|v| v.is_nan() || v.abs() > LARGEST) {
                    return Err(StatisticsError::Value { side, pair, value });
                }
            }
            if let Some((ours, theirs)) = ours.zip(theirs) {
                let difference = ours - theirs;
                let rounding = difference.abs() <= ROUNDING * ours.abs().max(theirs.abs());
                sorted.push(if rounding { 0.0 } else { difference });
            }
        }
        let found = sorted.len();
        if found < 2 {
            return Err(StatisticsError::TooFew { found, given });
        }
        sorted.sort_by(f64::total_cmp);
        Ok(Self { sorted, dropped: given - found })
    }

    /// The differences, smallest first; at least two.
    pub(crate) fn sorted(&self) -> &[f64] {
        &self.sorted
    }

    /// Number of pairs left out because a value was not defined.
    pub(crate) fn dropped(&self) -> usize {
        self.dropped
    }

    /// The mean.
    pub(crate) fn mean(&self) -> f64 {
        if self.constant() { 0.5 * self.least() + 0.5 * self.greatest() } else { self.sum(|d| d) / self.count() }
    }

    /// Whether all differences are the same but for rounding.
    pub(crate) fn constant(&self) -> bool {
        let (least, greatest) = (self.least(), self.greatest());
        greatest - least <= ROUNDING * least.abs().max(greatest.abs())
    }

    /// Mean over sample standard deviation (`n - 1`): Cohen's d_z. `None` where nothing varies.
    pub(crate) fn standardised_mean(&self) -> Option<f64> {
        let (scale, squares, _) = self.central()?;
        Some(self.mean() / (scale * libm::sqrt(squares / (self.count() - 1.0))))
    }

    /// The acceleration of the mean, `Σ (d - m)³ / (6 (Σ (d - m)²)^(3/2))`, where the jackknife leads
    /// to (Efron and Tibshirani 1993, Eq. 14.15). `None` where nothing varies.
    pub(crate) fn acceleration(&self) -> Option<f64> {
        let (_, squares, cubes) = self.central()?;
        Some(cubes / (6.0 * squares * libm::sqrt(squares)))
    }

    /// The largest distance from the mean, and the sums of squares and cubes of all distances in
    /// units of it: tiny differences do not underflow.
    fn central(&self) -> Option<(f64, f64, f64)> {
        if self.constant() {
            return None;
        }
        let mean = self.mean();
        let scale = (self.greatest() - mean).max(mean - self.least());
        let power = |power: i32| {
            self.sum(|d| {
                let distance = (d - mean) / scale;
                (0..power).fold(1.0, |product, _| product * distance)
            })
        };
        Some((scale, power(2), power(3)))
    }

    fn sum(&self, term: impl Fn(f64) -> f64) -> f64 {
        let n = self.sorted.len();
        let ends = |k: usize| term(self.sorted[k]) + term(self.sorted[n - 1 - k]);
        let middle = if n % 2 == 1 { term(self.sorted[n / 2]) } else { 0.0 };
        (0..n / 2).fold(middle, |sum, k| sum + ends(k))
    }

    fn count(&self) -> f64 {
        self.sorted.len() as f64
    }

    fn least(&self) -> f64 {
        self.sorted[0]
    }

    fn greatest(&self) -> f64 {
        self.sorted[self.sorted.len() - 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn of(differences: &[f64]) -> Differences {
        Differences::of(differences.iter().map(|&d| (Some(d), Some(0.0)))).expect("valid")
    }

    #[test]
    fn by_hand() {
        let d = of(&[3.0, -1.0, 1.0, 5.0]);
        assert_eq!(d.sorted(), [-1.0, 1.0, 3.0, 5.0]);
        assert!((d.mean() - 2.0).abs() < 1e-15);
        // Squares 9 + 1 + 1 + 9 = 20, over 3.
        assert!((d.standardised_mean().expect("varies") - 2.0 / (20.0f64 / 3.0).sqrt()).abs() < 1e-15);
        assert!(d.acceleration().expect("varies").abs() < 1e-15, "symmetric about the mean");
        // Distances -1, -1, 2: cubes 6, squares 6.
        let a = of(&[0.0, 0.0, 3.0]).acceleration().expect("varies");
        assert!((a - 6.0 / (6.0 * 6.0f64.powf(1.5))).abs() < 1e-15, "{a}");
    }

    #[test]
    fn rounding_is_no_difference() {
        let d = Differences::of([(Some(0.1 + 0.2), Some(0.3)), (Some(0.3), Some(0.1 + 0.2))].into_iter()).expect("ok");
        assert_eq!(d.sorted(), [0.0, 0.0]);
        let same = of(&[0.3 - 0.2, 0.2 - 0.1, 0.1]);
        assert_eq!((same.standardised_mean(), same.acceleration()), (None, None));
        assert!((same.mean() - 0.1).abs() < 1e-16);
        assert!(of(&[1e-12, -1e-12]).standardised_mean().is_some(), "small values, not rounding");
    }

    #[test]
    fn tiny_and_huge_differences_keep_their_shape() {
        let [plain, tiny, huge] = [1.0, 1e-200, 1e299].map(|s| of(&[-s, s, 2.0 * s]));
        for other in [tiny, huge] {
            let near = |a: Option<f64>, b: Option<f64>| (a.expect("a") / b.expect("b") - 1.0).abs() < 1e-12;
            assert!(near(other.standardised_mean(), plain.standardised_mean()), "{other:?}");
            assert!(near(other.acceleration(), plain.acceleration()), "{other:?}");
        }
    }

    #[test]
    fn undefined_values_drop_their_pair() {
        let d = Differences::of(
            [(None, Some(9.0)), (Some(2.0), Some(1.0)), (Some(4.0), None), (Some(0.0), Some(1.0))].into_iter(),
        );
        assert_eq!(d, Ok(Differences { sorted: vec![-1.0, 1.0], dropped: 2 }));
        let few = Differences::of([(Some(1.0), Some(2.0)), (None, None)].into_iter());
        assert_eq!(few, Err(StatisticsError::TooFew { found: 1, given: 2 }));
    }

    #[test]
    fn what_is_no_value_is_refused_with_its_place_even_in_a_dropped_pair() {
        for bad in [f64::NAN, f64::INFINITY, -1.1e300] {
            let broken = [(Some(1.0), Some(2.0)), (None, Some(bad))];
            let message = Differences::of(broken.into_iter()).expect_err("refused").to_string();
            assert!(message.starts_with(&format!("their value {bad} of pair 1 is not within")), "{message}");
        }
    }

    proptest! {
        #[test]
        fn exactly_antisymmetric(values in prop::collection::vec(-3.0f64..5.0, 2..40)) {
            let (one, other) = (of(&values), of(&values.iter().map(|v| -v).collect::<Vec<_>>()));
            let negated = |d: &Differences| [Some(-d.mean()), d.standardised_mean().map(|z| -z), d.acceleration().map(|a| -a)];
            prop_assert_eq!([Some(one.mean()), one.standardised_mean(), one.acceleration()], negated(&other));
        }

        #[test]
        fn acceleration_is_that_of_the_jackknife(values in prop::collection::vec(-3.0f64..5.0, 3..20)) {
            let n = values.len() as f64;
            let total: f64 = values.iter().sum();
            let without: Vec<f64> = values.iter().map(|v| (total - v) / (n - 1.0)).collect();
            let centre = without.iter().sum::<f64>() / n;
            let sum = |power: i32| without.iter().map(|w| (centre - w).powi(power)).sum::<f64>();
            let expected = sum(3) / (6.0 * sum(2).powf(1.5));
            prop_assert!((of(&values).acceleration().expect("varies") - expected).abs() < 1e-9);
        }
    }
}
