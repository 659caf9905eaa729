//! The spread of a metric over seeds.

use serde::Serialize;

/// Mean and spread of some values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Summary {
    /// Arithmetic mean.
    pub mean: f64,
    /// Sample standard deviation (`n - 1`); `None` for a single value, which has no spread to know.
    pub standard_deviation: Option<f64>,
    /// Number of values.
    pub count: usize,
    /// Smallest value.
    pub minimum: f64,
    /// Largest value.
    pub maximum: f64,
}

impl Summary {
    /// Summarises `values`; `None` where there are none. Values that are not numbers make all
    /// statistics NaN: they are not passed over in silence.
    pub fn of(values: &[f64]) -> Option<Self> {
        let (&first, count) = (values.first()?, values.len());
        // About the first value, so that equal values have exactly that mean and no deviation.
        let mean = first + values.iter().map(|v| v - first).sum::<f64>() / count as f64;
        let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        let extreme = |pick: fn(f64, f64) -> f64| {
            if values.iter().any(|v| v.is_nan()) { f64::NAN } else { values.iter().copied().fold(first, pick) }
        };
        Some(Self {
            mean,
            standard_deviation: (count > 1).then(|| libm::sqrt(squares / (count - 1) as f64)),
            count,
            minimum: extreme(f64::min),
            maximum: extreme(f64::max),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn by_hand() {
        let summary = Summary::of(&[2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]).expect("values");
        assert!((summary.standard_deviation.expect("eight") - (32.0f64 / 7.0).sqrt()).abs() < 1e-15);
        let rest = (summary.mean, summary.count, summary.minimum, summary.maximum);
        assert_eq!(rest, (5.0, 8, 2.0, 9.0));
    }

    #[test]
    fn none_and_one() {
        assert_eq!(Summary::of(&[]), None);
        let one = Summary { mean: 0.3, standard_deviation: None, count: 1, minimum: 0.3, maximum: 0.3 };
        assert_eq!(Summary::of(&[0.3]), Some(one));
    }

    #[test]
    fn equal_values_have_no_spread_at_all() {
        let same = Summary::of(&[0.1; 7]).expect("values");
        let all = Summary { mean: 0.1, standard_deviation: Some(0.0), count: 7, minimum: 0.1, maximum: 0.1 };
        assert_eq!(same, all);
    }

    #[test]
    fn a_value_that_is_no_number_shows() {
        for values in [[f64::NAN, 1.0, 2.0], [1.0, f64::NAN, 2.0], [1.0, 2.0, f64::NAN]] {
            let s = Summary::of(&values).expect("values");
            let deviation = s.standard_deviation.expect("three");
            assert!([s.mean, deviation, s.minimum, s.maximum].iter().all(|v| v.is_nan()), "{s:?}");
        }
    }

    proptest! {
        #[test]
        fn equals_the_pairwise_form(values in prop::collection::vec(-10.0f64..10.0, 2..30)) {
            // The variance as half the mean squared difference over all pairs needs no mean.
            let n = values.len() as f64;
            let pairs: f64 = values.iter().flat_map(|a| values.iter().map(move |b| (a - b) * (a - b))).sum();
            let expected = (pairs / (2.0 * n * (n - 1.0))).sqrt();
            let summary = Summary::of(&values).expect("values");
            prop_assert!((summary.standard_deviation.expect("two or more") - expected).abs() < 1e-12);
            prop_assert!((summary.mean - values.iter().sum::<f64>() / n).abs() < 1e-13);
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            prop_assert_eq!(Some((summary.minimum, summary.maximum)), sorted.first().copied().zip(sorted.last().copied()));
        }
    }
}
