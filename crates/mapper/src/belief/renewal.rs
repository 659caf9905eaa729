//! Places change: how that is assumed to happen, and what is left of a belief after some time.
//!
//! Every place is of one [kind](KINDS). At the rate of its kind it is *renewed*: its occupancy is drawn again from the prior. At a
//! slow rate it turns into another kind, and keeps its occupancy. Occupancy and kind are hidden; readings depend on the occupancy
//! alone, so that they move `P(kind | occupancy)` not at all, and `P(occupancy)` as they would in a world at rest (Jeffrey's rule).
//! Kinds compete while time passes: what was found to change becomes more likely to be of a kind that changes.
//!
//! Renewal by the prior at a rate is the Markov chain in time of Meyer-Delius, Beinhofer and Burgard, "Occupancy Grid Models for
//! Robot Mapping in Changing Environments", AAAI 2012, with `P(E)` of the prior as its stationary state.

/// Number of kinds of places: they stay for hours, for minutes, or for seconds.
pub(crate) const KINDS: usize = 3;

/// A number for each kind.
pub(crate) type Kinds<T> = [T; KINDS];

/// How places change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Renewal {
    /// Renewals of a place of each kind, 1/s, at least 0.
    pub rates_per_s: [f64; KINDS],
    /// Share of unseen places that is of each kind; the shares add up to one.
    pub shares: [f64; KINDS],
    /// Rate at which a place is given a kind again, by these shares, 1/s, at least 0.
    pub turnover_per_s: f64,
    /// Time passes in steps that are so long, s; 0 for scans that each stand at their own time. Within a step the world is at rest, so
    /// that nothing is computed for it and what is looked at again settles.
    pub step_s: f64,
}

/// What some time does to a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Elapsed {
    /// Probability, by the kind that the place is of at last and the one that it was of, that it turned so and was not renewed.
    pub(crate) kept: Kinds<Kinds<f64>>,
    /// The same by the kind that it was of, whatever it is of at last.
    pub(crate) survival: Kinds<f64>,
    /// Probability that it was given no kind again.
    pub(crate) same_kind: f64,
    /// The shares by which kinds are given.
    pub(crate) shares: Kinds<f64>,
}

/// What is known of a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    /// `P(E)`.
    pub(crate) occupied: f64,
    /// `P(kind | E)` and `P(kind | not E)`.
    pub(crate) kinds: [Kinds<f64>; 2],
}

impl Renewal {
    /// Chosen by hand among a score. With more places that change sooner fewer trails are left, a world at rest is forgotten faster, and
    /// logs of quiet buildings are predicted worse: a tenth of all that change within a minute leave half as much of a crowd, and
    /// take from Freiburg 079 what minding the time gives. The step is the time in which a moving place is renewed once; steps
    /// of up to 4 s change no score of the sets with people by more than their intervals.
    pub const CHOSEN: Self = Self {
        rates_per_s: [1.0 / 36_000.0, 1.0 / 60.0, 0.5],
        shares: [0.91, 0.06, 0.03],
        turnover_per_s: 5e-4,
        step_s: 2.0,
    };

    /// The time that a scan stands at, s, by its own and that of the scan before: time that goes back stands still.
    pub(crate) fn stands_at(&self, time_s: f64, last_s: Option<f64>) -> f64 {
        let time_s = if self.step_s > 0.0 { (time_s / self.step_s).floor() * self.step_s } else { time_s };
        last_s.map_or(time_s, |last_s| last_s.max(time_s))
    }

    /// What `seconds` do; none, where time stands still or goes back.
    pub(crate) fn over(&self, seconds: f64) -> Elapsed {
        let turnover = self.turnover_per_s;
        let generator = |to: usize, from: usize| {
            let leaves = if to == from { self.rates_per_s[from] + turnover } else { 0.0 };
            turnover * self.shares[to] - leaves
        };
        let kept = exponential(&matrix(generator), seconds.max(0.0));
        let survival = column_sums(&kept);
        Elapsed { kept, survival, same_kind: libm::exp(-turnover * seconds.max(0.0)), shares: self.shares }
    }
}

impl Elapsed {
    /// Probability that a place of the given kinds was not renewed.
    pub(crate) fn survival(&self, kinds: &Kinds<f64>) -> f64 {
        (0..KINDS).map(|kind| self.survival[kind] * kinds[kind]).sum()
    }

    /// What is known of a place after it, where `prior` is `P(E)` of one that is drawn again.
    pub(crate) fn place(&self, before: &Place, prior: f64) -> Place {
        let p = before.occupied;
        let masses = [p, 1.0 - p];
        let drawn = [prior, 1.0 - prior];
        let mut after = [[0.0; KINDS]; 2];
        for (kind, kept) in self.kept.iter().enumerate() {
            let left = [0, 1].map(|x| masses[x] * dot(kept, &before.kinds[x]));
            let was: f64 = (0..2).map(|x| masses[x] * before.kinds[x][kind]).sum();
            let is = self.same_kind * was + (1.0 - self.same_kind) * self.shares[kind];
            let renewed = (is - left[0] - left[1]).max(0.0);
            (0..2).for_each(|x| after[x][kind] = left[x] + drawn[x] * renewed);
        }
        let [occupied, free]: [f64; 2] = after.map(|kinds| kinds.iter().sum());
        let kinds = [(after[0], occupied), (after[1], free)].map(|(kinds, all)| kinds.map(|kind| kind / all));
        Place { occupied: occupied / (occupied + free), kinds }
    }
}

fn matrix(entry: impl Fn(usize, usize) -> f64) -> Kinds<Kinds<f64>> {
    let mut all = [[0.0; KINDS]; KINDS];
    for (to, row) in all.iter_mut().enumerate() {
        for (from, value) in row.iter_mut().enumerate() {
            *value = entry(to, from);
        }
    }
    all
}

fn dot(a: &Kinds<f64>, b: &Kinds<f64>) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn column_sums(of: &Kinds<Kinds<f64>>) -> Kinds<f64> {
    let mut sums = [0.0; KINDS];
    of.iter().for_each(|row| sums.iter_mut().zip(row).for_each(|(sum, value)| *sum += value));
    sums
}

fn product(a: &Kinds<Kinds<f64>>, b: &Kinds<Kinds<f64>>) -> Kinds<Kinds<f64>> {
    matrix(|to, from| (0..KINDS).map(|k| a[to][k] * b[k][from]).sum())
}

/// Norm up to which ten terms of the series are exact in double precision.
const SMALL: f64 = 0.2;

/// `exp(generator * seconds)`, by scaling and squaring; of a generator whose entries off the diagonal are not negative.
fn exponential(generator: &Kinds<Kinds<f64>>, seconds: f64) -> Kinds<Kinds<f64>> {
    let norm = generator.iter().flatten().fold(0.0f64, |most, value| most.max(value.abs())) * KINDS as f64 * seconds;
    let mut halvings = 0;
    let mut scale = seconds;
    while norm * scale > SMALL * seconds && halvings < 64 {
        (scale, halvings) = (0.5 * scale, halvings + 1);
    }
    let step = matrix(|to, from| generator[to][from] * scale);
    let unit = matrix(|to, from| if to == from { 1.0 } else { 0.0 });
    // Horner: 1 + x (1 + x / 2 (1 + x / 3 (...))).
    let mut sum = unit;
    for term in (1..=10).rev() {
        let next = product(&step, &sum);
        sum = matrix(|to, from| unit[to][from] + next[to][from] / f64::from(term));
    }
    for _ in 0..halvings {
        sum = product(&sum, &sum);
    }
    matrix(|to, from| sum[to][from].max(0.0))
}

#[cfg(test)]
mod tests;
