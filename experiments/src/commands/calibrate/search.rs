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

/// Rounds over all parameters, at most.
const ROUNDS: usize = 12;

/// A round that gains less than this, nats per reading, is the last.
const TOLERANCE: f64 = 2e-6;

/// A parameter over whose whole range the loss changes by less than this, nats per reading, moves nothing.
const FLAT: f64 = 1e-5;

/// Looks for an end of an interval, at most.
const LOOKS: usize = 10;

/// An end is found where it lies within this share of the last look.
const NEAR: f64 = 0.15;

/// Minimises the mean loss parameter by parameter, and bounds each. What takes long is a setting, so that few are tried: a parameter is
/// looked at on both sides, and the third setting is the lowest point of the parabola through them. `rough`, a cheaper loss whose minimum is
/// near, is walked down first. `watch` is told of every setting.
///
/// # Errors
/// None where no setting can be had at the start.
pub fn fit(parameters: &[Parameter], rough: Option<&Loss>, losses: &Loss, watch: &(dyn Fn() + Sync)) -> Option<Fit> {
    let watched = |loss: &Loss, values: &[f64]| {
        let found = loss(values);
        watch();
        found
    };
    let start: Vec<f64> = parameters.iter().map(|p| p.scale.to(p.start)).collect();
    let steps =
        |share: f64| parameters.iter().map(|p| share * (p.scale.to(p.range[1]) - p.scale.to(p.range[0]))).collect();
    let mut walk = Walk { parameters, at: start, steps: steps(0.15), least: f64::INFINITY, tried: 0 };
    if let Some(rough) = rough {
        walk.down(10.0 * TOLERANCE, &|values| watched(rough, values))?;
        walk.steps = steps(0.02);
    }
    let losses = |values: &[f64]| watched(losses, values);
    walk.down(TOLERANCE, &losses)?;
    let best = walk.values(&walk.at);
    let series = losses(&best)?;
    let found: Vec<Found> = (0..parameters.len()).into_par_iter().map(|k| bound(&walk, k, &series, &losses)).collect();
    let tried = walk.tried + 1 + found.iter().map(|found| found.profile.len() - 1).sum::<usize>();
    Some(Fit { found, loss: series_mean(&series).ok()?, tried })
}

/// A loss of all parameters.
pub type Loss<'a> = dyn Fn(&[f64]) -> Losses + Sync + 'a;

/// A place on the way down, on the parameters' own scales.
struct Walk<'a> {
    parameters: &'a [Parameter],
    at: Vec<f64>,
    steps: Vec<f64>,
    least: f64,
    tried: usize,
}

impl Walk<'_> {
    fn values(&self, at: &[f64]) -> Vec<f64> {
        self.parameters.iter().zip(at).map(|(parameter, at)| parameter.scale.from(*at)).collect()
    }

    fn with(&self, k: usize, at: f64) -> Vec<f64> {
        let mut values = self.values(&self.at);
        values[k] = self.parameters[k].scale.from(at);
        values
    }

    fn ends(&self, k: usize) -> [f64; 2] {
        self.parameters[k].range.map(|end| self.parameters[k].scale.to(end))
    }

    /// Walks until a round gains less than this. None where the start cannot be had.
    fn down(&mut self, tolerance: f64, losses: &Loss) -> Option<()> {
        let mean = |values: &[f64]| losses(values).and_then(|series| mean(&series));
        self.least = mean(&self.values(&self.at))?;
        self.tried += 1;
        for _ in 0..ROUNDS {
            let before = self.least;
            let mut blocked = false;
            for k in 0..self.parameters.len() {
                blocked |= self.step(k, &mean);
            }
            if before - self.least < tolerance && !blocked {
                break;
            }
        }
        Some(())
    }

    /// One parameter: both sides, then the lowest point of the parabola through the three. Whether a side could not be had, so that the
    /// next round must look nearer.
    fn step(&mut self, k: usize, mean: &(impl Fn(&[f64]) -> Option<f64> + Sync)) -> bool {
        let (at, step, [low, high]) = (self.at[k], self.steps[k], self.ends(k));
        let sides = [(at - step).max(low), (at + step).min(high)];
        let is_there = |to: f64| (to - at).abs() > 1e-3 * step;
        let losses: Vec<Option<f64>> =
            sides.into_par_iter().map(|to| is_there(to).then(|| mean(&self.with(k, to))).flatten()).collect();
        self.tried += sides.iter().filter(|to| is_there(**to)).count();
        let before = self.least;
        for (loss, to) in losses.iter().zip(sides) {
            if let Some(loss) = loss.filter(|loss| *loss < self.least) {
                (self.least, self.at[k]) = (loss, to);
            }
        }
        if let [Some(below), Some(above)] = losses[..] {
            let to =
                (at + lowest([at - sides[0], sides[1] - at], [below - before, above - before], step)).clamp(low, high);
            if (to - self.at[k]).abs() > 1e-3 * step {
                self.tried += 1;
                if let Some(loss) = mean(&self.with(k, to)).filter(|loss| *loss < self.least) {
                    (self.least, self.at[k]) = (loss, to);
                }
            }
        }
        let moved = (self.at[k] - at).abs() / step;
        self.steps[k] *= if moved > 0.9 { 1.5 } else { 0.4 };
        losses.iter().zip(sides).any(|(loss, to)| is_there(to) && loss.is_none())
    }
}

/// Where the parabola through 0 and what the loss grows by at these distances below and above is lowest, at most three steps away; 0 where
/// it bends down.
fn lowest([below, above]: [f64; 2], more: [f64; 2], step: f64) -> f64 {
    let slope = more[1] * below * below - more[0] * above * above;
    let bend = more[0] * above + more[1] * below;
    if bend > 0.0 { (-0.5 * slope / bend).clamp(-3.0 * step, 3.0 * step) } else { 0.0 }
}

fn mean(series: &[(f64, u64)]) -> Option<f64> {
    let (sum, parts) = series.iter().fold((0.0, 0), |(sum, parts), (more, of)| (sum + more, parts + of));
    (parts > 0 && sum.is_finite()).then(|| sum / parts as f64)
}

/// How far from the best a look was, and how much the loss grows there, member by member.
type Looks = Vec<(f64, Vec<f64>)>;

/// An end of an interval.
struct End {
    value: f64,
    /// Whether the loss is larger for sure beyond it.
    bounds: bool,
    /// What was tried, and how much the mean loss grows there.
    tried: Vec<(f64, f64)>,
}

/// How far a parameter can go before its loss is larger for sure.
fn bound(walk: &Walk, k: usize, series: &[(f64, u64)], losses: &Loss) -> Found {
    let parameter = &walk.parameters[k];
    let value = parameter.scale.from(walk.at[k]);
    let ends: Vec<End> = walk.ends(k).into_par_iter().map(|last| end(walk, k, last, series, losses)).collect();
    let (low, high) = (&ends[0], &ends[1]);
    let mut profile: Vec<(f64, f64)> = low.tried.iter().chain(&high.tried).copied().collect();
    profile.push((value, 0.0));
    profile.sort_by(|a, b| a.0.total_cmp(&b.0));
    let most = profile.iter().map(|(_, more)| *more).fold(0.0, f64::max);
    let unidentified = match (low.bounds, high.bounds) {
        _ if most < FLAT => Some("no value of the range makes a difference"),
        (false, false) => Some("the readings allow the whole range"),
        (false, true) => Some("only bounded from above"),
        (true, false) => Some("only bounded from below"),
        (true, true) => None,
    };
    let interval = Interval { low: low.value.min(value), high: high.value.max(value) };
    Found { parameter: parameter.clone(), value, interval, unidentified, profile }
}

/// The end of an interval towards the end `last` of the parameter's range.
fn end(walk: &Walk, k: usize, last: f64, series: &[(f64, u64)], losses: &Loss) -> End {
    let (scale, at) = (walk.parameters[k].scale, walk.at[k]);
    let (whole, direction) = ((last - at).abs(), sign(last - at));
    let member = |more: &[f64]| more.iter().zip(series).map(|(more, of)| (*more, of.1)).collect::<Vec<_>>();
    let worse = |more: &[f64]| series_mean(&member(more)).is_ok_and(|more| more.interval.low > 0.0);
    let mut tried = Vec::new();
    let mut is_worse_at = |far: f64, seen: &mut Looks| {
        let to = at + direction * far;
        // What no sensor can have is worse.
        let Some(there) = losses(&walk.with(k, to)) else { return true };
        let more: Vec<f64> = there.iter().zip(series).map(|(a, b)| a.0 - b.0).collect();
        tried.push((scale.from(to), mean(&member(&more)).unwrap_or(f64::NAN)));
        let is_worse = worse(&more);
        seen.push((far, more));
        is_worse
    };
    if whole < 1e-9 || !is_worse_at(whole, &mut Looks::new()) {
        return End { value: scale.from(last), bounds: false, tried };
    }
    let (mut seen, mut inside, mut outside) = (Looks::new(), 0.0, whole);
    let mut next = 0.04 * whole;
    for number in 0..LOOKS {
        match is_worse_at(next, &mut seen) {
            true => outside = next,
            false => inside = next,
        }
        let before = next;
        let guess = reach(&seen, outside, &worse);
        let is_between = guess > 1.02 * inside && guess < 0.98 * outside;
        // An end is mostly near.
        let share = if number < 3 { 0.1 } else { 0.5 };
        next = if is_between { guess } else { inside + share * (outside - inside) };
        if (is_between && (guess - before).abs() < NEAR * before) || outside - inside < NEAR * outside {
            break;
        }
    }
    End { value: scale.from(at + direction * next), bounds: true, tried }
}

fn sign(x: f64) -> f64 {
    if x < 0.0 { -1.0 } else { 1.0 }
}

/// How far from the best the loss is larger for sure, by parabolas through the best and the last two looks: `a x + b x^2` of every member,
/// without its slope where there is one look alone.
fn reach(looks: &Looks, most: f64, worse: &impl Fn(&[f64]) -> bool) -> f64 {
    let Some((last, more)) = looks.last() else { return most };
    let x = *last;
    let model: Vec<(f64, f64)> = match looks.len() {
        1 => more.iter().map(|more| (0.0, more / (x * x))).collect(),
        n => {
            let (other, before) = (looks[n - 2].0, &looks[n - 2].1);
            let parabola = |(p, q): (&f64, &f64)| {
                let b = (p / x - q / other) / (x - other);
                (p / x - b * x, b)
            };
            more.iter().zip(before).map(parabola).collect()
        }
    };
    let (mut inside, mut outside) = (0.0, most);
    for _ in 0..12 {
        let middle = 0.5 * (inside + outside);
        let there: Vec<f64> = model.iter().map(|(a, b)| (a + b * middle) * middle).collect();
        if worse(&there) { outside = middle } else { inside = middle }
    }
    0.5 * (inside + outside)
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
        let fit = fit(&parameters, None, &losses, &|| ()).expect("found");
        let [mean, share, idle] = &fit.found[..] else { panic!("three") };
        assert!((mean.value - 0.3).abs() < 0.02 && (share.value - 0.8).abs() < 0.02, "{fit:?}");
        for (found, truth) in [(mean, 0.3), (share, 0.8)] {
            let Interval { low, high } = found.interval;
            assert!(low < truth && truth < high && high / low < 1.3 && found.unidentified.is_none(), "{found:?}");
        }
        assert_eq!(idle.unidentified, Some("no value of the range makes a difference"));
        assert!(fit.tried < 150, "{}", fit.tried);
    }

    #[test]
    fn a_maximum_at_the_end_is_bounded_from_one_side_alone() {
        let values: Vec<f64> = drawn(500, 0.618_033_988).collect();
        let losses = |p: &[f64]| Some(values.iter().map(|x| (p[0] * (1.0 + 0.2 * x), 1)).collect());
        let fit = fit(&[parameter("rate", [0.001, 1.0], 0.1, Scale::Ratio)], None, &losses, &|| ()).expect("found");
        assert!(fit.found[0].value < 0.0011 && fit.found[0].unidentified == Some("only bounded from above"), "{fit:?}");
    }

    #[test]
    fn settings_that_cannot_be_are_walked_round() {
        let losses =
            |p: &[f64]| (p[0] + p[1] <= 1.0).then(|| vec![((p[0] - 0.7).powi(2) + (p[1] - 0.2).powi(2), 1); 30]);
        let both = [parameter("a", [0.05, 0.95], 0.3, Scale::Odds), parameter("b", [0.01, 0.9], 0.3, Scale::Odds)];
        let fit = fit(&both, None, &losses, &|| ()).expect("found");
        assert!((fit.found[0].value - 0.7).abs() < 0.02 && (fit.found[1].value - 0.2).abs() < 0.02, "{fit:?}");
    }
}
