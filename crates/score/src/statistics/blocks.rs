//! The mean of a series whose neighbours are alike, with its interval.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

use super::StatisticsError;
use super::bootstrap::{Interval, RESAMPLES};

/// Every interval is drawn from the same stream: it depends on the series alone, and series of one length share their
/// luck.
const SEED: u64 = 1989;

/// A mean over a series in time, with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeriesMean {
    /// Mean over all parts of all members.
    pub mean: f64,
    /// Where it lies with 95 % coverage.
    pub interval: Interval,
}

/// Mean of a series of sums, each over so many parts, with the percentile interval of the circular block bootstrap
/// (Künsch 1989; Politis and Romano 1992): blocks of neighbours are drawn instead of members, since what is near in time is alike.
///
/// A block has as many members as the root of their number: then both the blocks and their number grow with the series.
///
/// # Errors
/// An empty series, a sum that is not finite, or no part at all.
pub fn series_mean(series: &[(f64, u64)]) -> Result<SeriesMean, StatisticsError> {
    let n = series.len();
    let total = |members: &mut dyn Iterator<Item = usize>| {
        members.fold((0.0, 0), |(sum, parts), k| (sum + series[k].0, parts + series[k].1))
    };
    let (sum, parts) = total(&mut (0..n));
    if parts == 0 || !sum.is_finite() {
        return Err(StatisticsError::Series { members: n });
    }
    let block = (n as f64).sqrt().round() as usize;
    let blocks: Vec<(f64, u64)> = (0..n).map(|first| total(&mut (first..first + block).map(|k| k % n))).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut draw = || blocks[((u64::from(rng.next_u32()) * n as u64) >> 32) as usize];
    let means = (0..RESAMPLES)
        .filter_map(|_| {
            let (sum, parts) = (0..n.div_ceil(block)).fold((0.0, 0), |(sum, parts), _| {
                let (more, further) = draw();
                (sum + more, parts + further)
            });
            (parts > 0).then(|| sum / parts as f64)
        })
        .collect();
    Ok(SeriesMean { mean: sum / parts as f64, interval: Interval::percentile(means) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uniform(rng: &mut ChaCha8Rng) -> f64 {
        f64::from(rng.next_u32()) / 4_294_967_296.0
    }

    /// Members that follow each other with the given correlation, of mean 0.
    fn series(rng: &mut ChaCha8Rng, n: usize, correlation: f64) -> Vec<(f64, u64)> {
        let mut at = 0.0;
        let step = |_| {
            let noise: f64 = (0..12).map(|_| uniform(rng) - 0.5).sum();
            at = correlation * at + (1.0 - correlation * correlation).sqrt() * noise;
            (at, 1)
        };
        (0..n + 50).map(step).skip(50).collect()
    }

    /// How often the interval holds the mean, and how wide it is.
    fn coverage(correlation: f64, shuffled: bool) -> f64 {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let trials = 200;
        let mut held = 0;
        for _ in 0..trials {
            let mut series = series(&mut rng, 400, correlation);
            if shuffled {
                (1..series.len()).for_each(|k| series.swap(k, (uniform(&mut rng) * (k + 1) as f64) as usize));
            }
            let Interval { low, high } = series_mean(&series).expect("valid").interval;
            held += usize::from(low < 0.0 && high > 0.0);
        }
        held as f64 / f64::from(trials)
    }

    #[test]
    fn the_interval_holds_the_mean_of_a_series_whose_members_are_alike() {
        let independent = coverage(0.0, false);
        assert!((0.88..=0.99).contains(&independent), "{independent}");
        let alike = coverage(0.7, false);
        assert!((0.84..=0.98).contains(&alike), "{alike}");
        // The same members in any order: without their neighbours the interval is far too narrow.
        let torn = coverage(0.7, true);
        assert!(torn < 0.7, "{torn}");
    }

    #[test]
    fn a_mean_is_over_parts() {
        let found = series_mean(&[(1.0, 1), (9.0, 4), (0.0, 0)]).expect("valid");
        assert!((found.mean - 2.0).abs() < 1e-15);
        let Interval { low, high } = found.interval;
        assert!(low <= 2.0 && high >= 2.0, "{found:?}");
        let one = series_mean(&[(3.0, 2)]).expect("valid");
        assert!((one.mean - 1.5).abs() < 1e-15 && one.interval == Interval { low: 1.5, high: 1.5 });
    }

    #[test]
    fn what_is_no_series_is_refused() {
        assert!(
            series_mean(&[]).is_err() && series_mean(&[(0.0, 0)]).is_err() && series_mean(&[(f64::NAN, 1)]).is_err()
        );
    }
}
