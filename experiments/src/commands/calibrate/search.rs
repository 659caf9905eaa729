//! The maximum of a likelihood over a few parameters, and how far each is pinned down.

use rayon::prelude::*;
use score::{Interval, SeriesMean, series_mean};

/// A parameter, and where it may lie.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its name, as the options have it.
    pub name: &'static str,
    /// Its unit; 1 of a number without one.
    pub unit: &'static str,
    /// The least and the largest value looked at.
    pub range: [f64; 2],
    /// Where the search begins.
    pub start: f64,
    /// How values are spaced.
    pub scale: Scale,
}

/// How the values of a parameter are spaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences are equally far: offsets.
    Difference,
    /// Equal ratios are equally far: scales and rates.
    Ratio,
    /// Equal ratios of odds are equally far: probabilities.
    Odds,
}

impl Scale {
    fn to(self, value: f64) -> f64 {
        match self {
            Self::Difference => value,
            Self::Ratio => libm::log(value),
            Self::Odds => libm::log(value / (1.0 - value)),
        }
    }

    fn from(self, at: f64) -> f64 {
        match self {
            Self::Difference => at,
            Self::Ratio => libm::exp(at),
            Self::Odds => 1.0 / (1.0 + libm::exp(-at)),
        }
    }
}

/// Losses of one setting: `-ln P`, summed over so many readings, for every member of a series in time or space. None
/// of a setting that no sensor can have.
pub type Losses = Option<Vec<(f64, u64)>>;

/// What was found.
#[derive(Debug, Clone)]
pub struct Fit {
    /// One per parameter.
    pub found: Vec<Found>,
    /// Loss at the maximum of the likelihood, nats per reading.
    pub loss: SeriesMean,
    /// Settings that were tried.
    pub tried: usize,
}

/// What was found of a parameter.
#[derive(Debug, Clone)]
pub struct Found {
    /// The parameter.
    pub parameter: Parameter,
    /// The value of the largest likelihood.
    pub value: f64,
    /// The values whose loss is not larger with 95 % confidence, all other parameters as found; an end that lies at an end of the
    /// parameter's range may lie beyond.
    pub interval: Interval,
    /// Why it cannot be told, if it cannot.
    pub unidentified: Option<&'static str>,
    /// Values tried, and by how much their loss is larger, nats per reading: what the interval is made from.
    pub profile: Vec<(f64, f64)>,
}

/// Candidates for a parameter at a time.
const CANDIDATES: usize = 7;

/// Rounds over all parameters, at most.
const ROUNDS: usize = 12;

/// A round that gains less than this, nats per reading, is the last.
const TOLERANCE: f64 = 2e-6;

/// A parameter over whose whole range the loss changes by less than this, nats per reading, moves nothing.
const FLAT: f64 = 1e-5;

/// Bisections for an end of an interval.
const BISECTIONS: usize = 7;

/// Minimises the mean loss parameter by parameter, by candidates around the best so far that draw together, and bounds each.
///
/// # Errors
/// None where no setting can be had at the start.
pub fn fit(parameters: &[Parameter], losses: impl Fn(&[f64]) -> Losses + Sync) -> Option<Fit> {
    let mean = |values: &[f64]| losses(values).and_then(|series| series_mean(&series).ok()).map(|found| found.mean);
    let mut best: Vec<f64> = parameters.iter().map(|parameter| parameter.start).collect();
    let mut least = mean(&best)?;
    let mut steps: Vec<f64> =
        parameters.iter().map(|p| 0.25 * (p.scale.to(p.range[1]) - p.scale.to(p.range[0]))).collect();
    let mut tried = 1;
    for _ in 0..ROUNDS {
        let before = least;
        for (k, parameter) in parameters.iter().enumerate() {
            let [low, high] = parameter.range.map(|end| parameter.scale.to(end));
            let at = parameter.scale.to(best[k]);
            let half = (CANDIDATES / 2) as f64;
            let candidates: Vec<f64> = (0..CANDIDATES)
                .map(|c| at + steps[k] * (c as f64 - half) / half)
                .filter(|candidate| (*candidate - at).abs() > 1e-12 && (low..=high).contains(candidate))
                .map(|candidate| parameter.scale.from(candidate))
                .collect();
            tried += candidates.len();
            let results: Vec<Option<f64>> =
                candidates.par_iter().map(|candidate| mean(&with(&best, k, *candidate))).collect();
            let (mut moved, mut to) = (false, best[k]);
            for (candidate, loss) in candidates.iter().zip(results) {
                if let Some(loss) = loss.filter(|loss| *loss < least) {
                    (least, to, moved) = (loss, *candidate, true);
                }
            }
            let far = moved && (parameter.scale.to(to) - at).abs() > 0.9 * steps[k];
            best[k] = to;
            // At the edge of what was tried the best may lie beyond.
            steps[k] *= if far { 1.0 } else { 0.45 };
        }
        if before - least < TOLERANCE && steps.iter().all(|step| *step < 0.05) {
            break;
        }
    }
    let series = losses(&best)?;
    let found = parameters.iter().enumerate().map(|(k, parameter)| bound(parameter, k, &best, &series, &losses));
    let found: Vec<Found> = found.collect();
    tried += found.iter().map(|found| found.profile.len()).sum::<usize>();
    Some(Fit { found, loss: series_mean(&series).ok()?, tried })
}

fn with(values: &[f64], k: usize, value: f64) -> Vec<f64> {
    let mut changed = values.to_vec();
    changed[k] = value;
    changed
}

/// How far a parameter can go before its loss is larger for sure.
fn bound(
    parameter: &Parameter,
    k: usize,
    best: &[f64],
    series: &[(f64, u64)],
    losses: &(impl Fn(&[f64]) -> Losses + Sync),
) -> Found {
    let scale = parameter.scale;
    let more = |at: f64| -> Option<SeriesMean> {
        let there = losses(&with(best, k, scale.from(at)))?;
        let differences: Vec<(f64, u64)> = there.iter().zip(series).map(|(a, b)| (a.0 - b.0, b.1)).collect();
        series_mean(&differences).ok()
    };
    let at = scale.to(best[k]);
    let ends = parameter.range.map(|end| scale.to(end));
    // An end, whether the loss is larger for sure beyond it, and what was tried.
    type Side = (f64, bool, Vec<(f64, f64)>);
    let sides: Vec<Side> = ends
        .par_iter()
        .map(|&end| {
            let mut profile = Vec::new();
            let mut worse = |at: f64| match more(at) {
                Some(more) => {
                    profile.push((scale.from(at), more.mean));
                    more.interval.low > 0.0
                }
                None => true,
            };
            if !worse(end) {
                return (scale.from(end), false, profile);
            }
            let (mut inside, mut outside) = (at, end);
            // The first steps are short: an end is mostly near.
            for step in 0..BISECTIONS + 3 {
                let share = if step < 3 { 0.1 } else { 0.5 };
                let middle = inside + share * (outside - inside);
                if worse(middle) {
                    outside = middle;
                } else {
                    inside = middle;
                }
            }
            (scale.from(0.5 * (inside + outside)), true, profile)
        })
        .collect();
    let (low, high) = (&sides[0], &sides[1]);
    let mut profile: Vec<(f64, f64)> = low.2.iter().chain(&high.2).copied().collect();
    profile.push((best[k], 0.0));
    profile.sort_by(|a, b| a.0.total_cmp(&b.0));
    let most = profile.iter().map(|(_, more)| *more).fold(0.0, f64::max);
    let unidentified = match (low.1, high.1) {
        _ if most < FLAT => Some("no value of the range makes a difference"),
        (false, false) => Some("the readings allow the whole range"),
        (false, true) => Some("only bounded from above"),
        (true, false) => Some("only bounded from below"),
        (true, true) => None,
    };
    let interval = Interval { low: low.0.min(best[k]), high: high.0.max(best[k]) };
    Found { parameter: parameter.clone(), value: best[k], interval, unidentified, profile }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(name: &'static str, range: [f64; 2], start: f64, scale: Scale) -> Parameter {
        Parameter { name, unit: "1", range, start, scale }
    }

    /// Numbers that look drawn, uniform in 0 to 1.
    fn drawn(n: usize, factor: f64) -> impl Iterator<Item = f64> {
        (0..n).map(move |k| (factor * (k as f64 + 0.5)).fract())
    }

    #[test]
    fn a_scale_and_a_share_are_found_and_what_moves_nothing_is_said() {
        // Exponential of mean 0.3 with a share of 0.8, else uniform on 0 to 10.
        let values: Vec<f64> = drawn(4000, 0.754_877_666)
            .zip(drawn(4000, 0.569_840_290))
            .map(|(a, b)| if a < 0.8 { -0.3 * libm::log(1.0 - b) } else { 10.0 * b })
            .collect();
        let parameters = [
            parameter("mean", [0.01, 5.0], 1.0, Scale::Ratio),
            parameter("share", [0.01, 0.99], 0.5, Scale::Odds),
            parameter("idle", [0.1, 10.0], 1.0, Scale::Ratio),
        ];
        let losses = |p: &[f64]| {
            let density = |x: f64| p[1] * libm::exp(-x / p[0]) / p[0] + (1.0 - p[1]) / 10.0;
            Some(values.chunks(10).map(|xs| (-xs.iter().map(|x| libm::log(density(*x))).sum::<f64>(), 10)).collect())
        };
        let fit = fit(&parameters, losses).expect("found");
        let [mean, share, idle] = &fit.found[..] else { panic!("three") };
        assert!((mean.value - 0.3).abs() < 0.02 && (share.value - 0.8).abs() < 0.02, "{fit:?}");
        for (found, truth) in [(mean, 0.3), (share, 0.8)] {
            let Interval { low, high } = found.interval;
            assert!(low < truth && truth < high && high / low < 1.3 && found.unidentified.is_none(), "{found:?}");
        }
        assert_eq!(idle.unidentified, Some("no value of the range makes a difference"));
        assert!(fit.tried < 400, "{}", fit.tried);
    }

    #[test]
    fn a_maximum_at_the_end_is_bounded_from_one_side_alone() {
        let values: Vec<f64> = drawn(500, 0.618_033_988).collect();
        let losses = |p: &[f64]| Some(values.iter().map(|x| (p[0] * (1.0 + 0.2 * x), 1)).collect());
        let fit = fit(&[parameter("rate", [0.001, 1.0], 0.1, Scale::Ratio)], losses).expect("found");
        assert!(fit.found[0].value < 0.0011 && fit.found[0].unidentified == Some("only bounded from above"), "{fit:?}");
    }

    #[test]
    fn settings_that_cannot_be_are_walked_round() {
        let losses =
            |p: &[f64]| (p[0] + p[1] <= 1.0).then(|| vec![((p[0] - 0.7).powi(2) + (p[1] - 0.2).powi(2), 1); 30]);
        let both = [parameter("a", [0.05, 0.95], 0.3, Scale::Odds), parameter("b", [0.01, 0.9], 0.3, Scale::Odds)];
        let fit = fit(&both, losses).expect("found");
        assert!((fit.found[0].value - 0.7).abs() < 0.02 && (fit.found[1].value - 0.2).abs() < 0.02, "{fit:?}");
    }
}
