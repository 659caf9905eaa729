//! A mean over worlds, and how surely it is known.

/// A mean with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    pub value: f64,
    /// The ends of the interval; none from a single world.
    pub interval: Option<(f64, f64)>,
}

impl Estimate {
    /// A value that is no mean over worlds.
    pub fn exact(value: f64) -> Self {
        Self { value, interval: None }
    }

    /// The same of a rising or falling function of the mean.
    pub fn map(self, of: impl Fn(f64) -> f64) -> Self {
        let ends = |(low, high)| {
            let (a, b): (f64, f64) = (of(low), of(high));
            (a.min(b), a.max(b))
        };
        Self { value: of(self.value), interval: self.interval.map(ends) }
    }
}

impl Estimate {
    /// The same with an interval that is even on a logarithmic axis and stays above 0: that of the mean's logarithm, by the
    /// delta method. None of a mean of 0.
    pub fn on_logarithm(self) -> Self {
        let Self { value, interval } = self;
        let ends = |(low, high): (f64, f64)| {
            (value * libm::exp((low - value) / value), value * libm::exp((high - value) / value))
        };
        Self { value, interval: interval.filter(|_| value > 0.0).map(ends) }
    }
}

/// Sums over worlds of a total and of the number of things that it is a total of.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moments {
    worlds: u64,
    total: f64,
    count: f64,
    total_squared: f64,
    count_squared: f64,
    product: f64,
}

impl Moments {
    /// The sums over worlds, of each of which a total and a number are given; a mean over worlds has a number of 1 each.
    pub fn of(worlds: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let mut moments = Self::default();
        worlds.into_iter().for_each(|(total, count)| moments.add(total, count));
        moments
    }

    /// Takes in a world.
    pub fn add(&mut self, total: f64, count: f64) {
        if count > 0.0 {
            self.worlds += 1;
            self.total += total;
            self.count += count;
            self.total_squared += total * total;
            self.count_squared += count * count;
            self.product += total * count;
        }
    }

    /// The sums over these worlds and others.
    pub fn and(&self, others: &Self) -> Self {
        Self {
            worlds: self.worlds + others.worlds,
            total: self.total + others.total,
            count: self.count + others.count,
            total_squared: self.total_squared + others.total_squared,
            count_squared: self.count_squared + others.count_squared,
            product: self.product + others.product,
        }
    }

    /// How many things there are.
    pub fn count(&self) -> f64 {
        self.count
    }

    /// The total over the number: the ratio estimator, with the t interval of its linear form, in which a world is one
    /// draw (Cochran, Sampling Techniques, 1977, Section 6.3). None of no worlds.
    pub fn estimate(&self) -> Option<Estimate> {
        let mean = (self.worlds > 0).then(|| self.total / self.count)?;
        let squares = self.total_squared - 2.0 * mean * self.product + mean * mean * self.count_squared;
        let reach = || {
            let worlds = self.worlds as f64;
            quantile(self.worlds - 1) * (worlds / (worlds - 1.0) * squares.max(0.0)).sqrt() / self.count
        };
        let interval = (self.worlds > 1).then(|| (mean - reach(), mean + reach()));
        Some(Estimate { value: mean, interval })
    }
}

/// The quantile of 0.975 of Student's t by its degrees of freedom; from 31 on to three digits.
fn quantile(freedom: u64) -> f64 {
    const FIRST: [f64; 30] = [
        12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145, 2.131,
        2.120, 2.110, 2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042,
    ];
    let place = freedom.saturating_sub(1) as usize;
    FIRST.get(place).copied().unwrap_or_else(|| 1.96 + 2.4 / freedom as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_mean_over_worlds_has_the_interval_of_student() {
        // Mean 2, standard deviation 1, four worlds but one of them out of line: by hand.
        let moments = Moments::of([1.0, 1.0, 3.0, 3.0].map(|value| (value, 1.0)));
        let estimate = moments.estimate().expect("worlds");
        let reach = 3.182 * (4.0f64 / 3.0).sqrt() / 2.0;
        let (low, high) = estimate.interval.expect("more than one");
        assert!((estimate.value - 2.0).abs() < 1e-12);
        assert!((low - 2.0 + reach).abs() < 1e-12 && (high - 2.0 - reach).abs() < 1e-12);
        assert_eq!(Moments::of([(5.0, 2.0)]).estimate(), Some(Estimate::exact(2.5)));
        assert_eq!(Moments::of([(0.0, 0.0)]).estimate(), None);
    }

    #[test]
    fn quantiles_fall_to_that_of_the_normal() {
        let all: Vec<f64> = (1..200).map(quantile).collect();
        assert!(all.is_sorted_by(|a, b| a > b) && (all[198] - 1.972).abs() < 1e-3 && (all[59] - 2.000).abs() < 1e-3);
    }

    #[test]
    fn on_a_logarithm_an_interval_is_even_and_above_zero() {
        let estimate = Estimate { value: 0.1, interval: Some((-0.1, 0.3)) }.on_logarithm();
        let (low, high) = estimate.interval.expect("an interval");
        assert!((0.1 / low - high / 0.1).abs() < 1e-9 && low > 0.0);
        assert_eq!(Estimate { value: 0.0, interval: Some((0.0, 0.0)) }.on_logarithm().interval, None);
    }

    proptest! {
        #[test]
        fn worlds_of_one_rate_are_known_exactly(counts in prop::collection::vec(1.0..1e5f64, 2..30), rate in 0.0..5.0f64) {
            let estimate = Moments::of(counts.iter().map(|n| (rate * n, *n))).estimate().expect("worlds");
            let (low, high) = estimate.interval.expect("more than one");
            prop_assert!((estimate.value - rate).abs() < 1e-9 && high - low < 1e-4 * (1.0 + rate));
            let negated = estimate.map(|v| -v);
            prop_assert!(negated.interval.is_some_and(|(a, b)| a <= b));
        }
    }
}
