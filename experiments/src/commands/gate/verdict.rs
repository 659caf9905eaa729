//! Whether a gate passes.

use std::collections::BTreeMap;

use score::{Better, Comparison, Interval};

use super::file::{Demand, Gate};
use super::measure::{Measured, ValueKey, Values};
use crate::failure::Failure;
use crate::worlds::site::WorldId;

/// What became of a gate.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The gate.
    pub gate: Gate,
    /// Mean of the metric over those worlds in which it has a value.
    pub value: Option<f64>,
    /// Mean over the worlds of what it is compared with, if with anything: the baseline, or another mapper.
    pub reference: Option<f64>,
    /// Mean of the paired differences, ours minus theirs.
    pub difference: Option<f64>,
    /// The 95 % bootstrap interval of that mean.
    pub interval: Option<Interval>,
    /// Where the paired differences come from: family and mean, the worst first.
    pub families: Vec<(String, f64)>,
    /// Worlds in which the metric has a value.
    pub defined: usize,
    /// The word for it.
    pub verdict: Verdict,
    /// Why it failed, where the numbers do not say it.
    pub cause: Option<String>,
}

/// What a gate comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// What it demands holds.
    Pass,
    /// It does not.
    Fail,
    /// There is nothing to judge: the mapper failed, or the metric has no value.
    Error,
}

impl Verdict {
    /// The word for it in tables and files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail => "FAIL",
            Self::Error => "ERROR",
        }
    }
}

impl Outcome {
    /// What the gate is compared with, in a word.
    pub fn against(&self) -> Option<&str> {
        match &self.gate.demand {
            Demand::NotWorseThanBaselineBy(_) => Some("baseline"),
            Demand::BetterThan { mapper, .. } => Some(mapper),
            Demand::AtMost(_) | Demand::AtLeast(_) => None,
        }
    }

    /// Whether the gate is better than its baseline, surely and by more than its margin: time to raise the bar.
    pub fn outgrown(&self) -> bool {
        let Demand::NotWorseThanBaselineBy(margin) = self.gate.demand else { return false };
        self.worse_by().zip(self.interval).is_some_and(|(worse, interval)| -worse > margin && interval.excludes_zero())
    }

    /// The mean difference, positive where ours is worse.
    fn worse_by(&self) -> Option<f64> {
        self.difference.map(|difference| difference * sign(&self.gate))
    }
}

/// 1 where more is worse, -1 where less is.
fn sign(gate: &Gate) -> f64 {
    match gate.criterion.judged {
        Some((Better::Higher, _)) => -1.0,
        _ => 1.0,
    }
}

/// Judges every gate by what was measured.
///
/// # Errors
/// None but a defect: what cannot be compared was refused with the gates.
pub fn judge(gates: &[Gate], measured: &Measured, baseline: &Values) -> Result<Vec<Outcome>, Failure> {
    gates.iter().map(|gate| outcome(gate, measured, baseline)).collect()
}

fn outcome(gate: &Gate, measured: &Measured, baseline: &Values) -> Result<Outcome, Failure> {
    let of = |values: &Values, mapper: &str| -> Vec<Option<f64>> {
        gate.keys(mapper).map(|key| values.get(&key).copied().flatten()).collect()
    };
    let ours = of(&measured.values, &gate.mapper);
    let theirs = match &gate.demand {
        Demand::AtMost(_) | Demand::AtLeast(_) => None,
        Demand::NotWorseThanBaselineBy(_) => Some(of(baseline, &gate.mapper)),
        Demand::BetterThan { mapper, .. } => Some(of(&measured.values, mapper)),
    };
    let mut outcome = Outcome {
        value: mean(&ours),
        reference: theirs.as_deref().and_then(mean),
        difference: None,
        interval: None,
        families: Vec::new(),
        defined: ours.iter().flatten().count(),
        verdict: Verdict::Error,
        cause: cause(gate, measured, &ours, theirs.as_deref()),
        gate: gate.clone(),
    };
    if outcome.cause.is_some() {
        return Ok(outcome);
    }
    if let Some(theirs) = theirs {
        let comparison = match Comparison::of_defined(&ours, &theirs) {
            Ok(comparison) => comparison,
            Err(error) => return Ok(Outcome { cause: Some(error.to_string()), ..outcome }),
        };
        outcome.difference = Some(comparison.mean_difference);
        outcome.interval = Some(comparison.interval);
        outcome.families = by_family(gate, &ours, &theirs);
    }
    let holds = holds(&outcome);
    Ok(Outcome { verdict: if holds { Verdict::Pass } else { Verdict::Fail }, ..outcome })
}

fn holds(outcome: &Outcome) -> bool {
    let value = outcome.value.unwrap_or(f64::NAN);
    match &outcome.gate.demand {
        Demand::AtMost(bound) => value <= *bound,
        Demand::AtLeast(bound) => value >= *bound,
        Demand::NotWorseThanBaselineBy(margin) => {
            let worse = outcome.worse_by().unwrap_or(f64::NAN);
            let sure = outcome.interval.is_some_and(|interval| interval.excludes_zero());
            worse <= *margin || (worse.is_finite() && !sure)
        }
        Demand::BetterThan { by, .. } => outcome.interval.is_some_and(|interval| match sign(&outcome.gate) > 0.0 {
            true => interval.high < -by,
            false => interval.low > *by,
        }),
    }
}

/// Why there is nothing to judge, if so: a mapper that failed, no value at all, or none where the other has one,
/// since worlds that drop out may be those that went wrong.
fn cause(gate: &Gate, measured: &Measured, ours: &[Option<f64>], theirs: Option<&[Option<f64>]>) -> Option<String> {
    if let Some(failure) = failure(gate, measured) {
        return Some(failure);
    }
    if ours.iter().all(Option::is_none) {
        return Some("the metric has no value on any world".to_owned());
    }
    let pairs = gate.worlds.iter().zip(ours.iter().zip(theirs?));
    let lost: Vec<&WorldId> =
        pairs.filter(|(_, (ours, theirs))| ours.is_none() && theirs.is_some()).map(|(world, _)| world).collect();
    let first = lost.first()?;
    Some(format!("the metric has lost its value on {} of {} worlds, first on {first}", lost.len(), ours.len()))
}

/// The failure of a mapper that the gate needs.
fn failure(gate: &Gate, measured: &Measured) -> Option<String> {
    gate.mappers().into_iter().find_map(|mapper| {
        let cause = |world: &WorldId| measured.failures.get(&(mapper.to_owned(), world.clone()));
        let failed: Vec<(&WorldId, &String)> = gate.worlds.iter().filter_map(|w| Some((w, cause(w)?))).collect();
        let (world, cause) = failed.first()?;
        let (failed, all) = (failed.len(), gate.worlds.len());
        Some(format!("{mapper} failed on {failed} of {all} worlds, first on {world}: {cause}"))
    })
}

fn mean(values: &[Option<f64>]) -> Option<f64> {
    let values: Vec<f64> = values.iter().flatten().copied().collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Mean difference of each family, the worst first.
fn by_family(gate: &Gate, ours: &[Option<f64>], theirs: &[Option<f64>]) -> Vec<(String, f64)> {
    let mut families: BTreeMap<&str, Vec<Option<f64>>> = BTreeMap::new();
    for (world, (ours, theirs)) in gate.worlds.iter().zip(ours.iter().zip(theirs)) {
        families.entry(&world.family).or_default().push(ours.zip(*theirs).map(|(ours, theirs)| ours - theirs));
    }
    let means = families.into_iter().filter_map(|(family, differences)| Some((family.to_owned(), mean(&differences)?)));
    let mut means: Vec<(String, f64)> = means.collect();
    means.sort_by(|a, b| (b.1 * sign(gate)).total_cmp(&(a.1 * sign(gate))));
    means
}

/// The values that the baselines of these gates consist of.
///
/// # Errors
/// A mapper that failed on a world.
pub fn baselines(gates: &[Gate], measured: &Measured) -> Result<Values, Failure> {
    let mut values = Values::new();
    for gate in gates.iter().filter(|gate| matches!(gate.demand, Demand::NotWorseThanBaselineBy(_))) {
        if let Some(cause) = failure(gate, measured) {
            return Err(Failure::Claim(format!("gate {}: {cause}; the baselines stay as they were", gate.name)));
        }
        let keys: Vec<ValueKey> = gate.keys(&gate.mapper).collect();
        values.extend(keys.into_iter().map(|key| {
            let value = measured.values.get(&key).copied().flatten();
            (key, value)
        }));
    }
    Ok(values)
}

#[cfg(test)]
mod tests;
