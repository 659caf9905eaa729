//! What is said of many errors.

/// Mean and spread of errors, in their unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Number of errors.
    pub count: usize,
    /// Root of the mean of the squares.
    pub rmse: f64,
    /// Arithmetic mean.
    pub mean: f64,
    /// Standard deviation of these errors, not of a population they were drawn from (`n`), as the literature on SLAM gives it.
    pub deviation: f64,
    /// Median; the mean of the two in the middle of an even number.
    pub median: f64,
    /// The largest.
    pub max: f64,
}

impl Spread {
    /// Of errors that are finite; none of no errors. O(n log n).
    pub fn of(errors: &[f64]) -> Option<Self> {
        let count = errors.len();
        let mut sorted = errors.to_vec();
        sorted.sort_by(f64::total_cmp);
        let max = *sorted.last()?;
        let mean_of = |value: &dyn Fn(f64) -> f64| errors.iter().map(|&error| value(error)).sum::<f64>() / count as f64;
        let mean = mean_of(&|error| error);
        Some(Self {
            count,
            rmse: libm::sqrt(mean_of(&|error| error * error)),
            mean,
            deviation: libm::sqrt(mean_of(&|error| (error - mean) * (error - mean))),
            median: 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]),
            max,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let spread = Spread::of(&[9.0, 2.0, 4.0, 5.0, 4.0, 4.0, 5.0, 7.0]).expect("errors");
        assert_eq!(spread, Spread { count: 8, rmse: 29f64.sqrt(), mean: 5.0, deviation: 2.0, median: 4.5, max: 9.0 });
        assert_eq!(Spread::of(&[3.0, 1.0, 2.0]).map(|spread| spread.median), Some(2.0));
        assert_eq!(Spread::of(&[]), None);
    }
}
