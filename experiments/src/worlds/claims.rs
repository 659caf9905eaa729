//! The paper's claim about the room (Section 3.3, Figures 13 and 14), as numbers.

use score::{Better, Summary};
use serde::Serialize;
use serde_json::Value;

use crate::failure::Failure;
use crate::worlds::run::Trial;

/// Something that must be true of the results.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Claim {
    /// What is claimed.
    pub claim: String,
    /// The numbers that decide.
    pub measured: String,
    /// Whether it holds.
    pub holds: bool,
}

/// Whether every claim holds.
///
/// # Errors
/// Those that do not, with their numbers.
pub fn all_hold(claims: &[Claim]) -> Result<(), Failure> {
    let failed: Vec<String> =
        claims.iter().filter(|c| !c.holds).map(|c| format!("{}: {}", c.claim, c.measured)).collect();
    match failed.len() {
        0 => Ok(()),
        n => Err(Failure::Claim(format!("{n} of {} claims fail: {}", claims.len(), failed.join("; ")))),
    }
}

impl Claim {
    /// Whether it holds, in a word.
    pub fn verdict(&self) -> &'static str {
        if self.holds { "holds" } else { "FAILS" }
    }
}

/// The claims for reading below a table: two lines each, after a blank one.
pub fn below(claims: &[Claim]) -> String {
    claims.iter().map(|c| format!("\n{}  {}:\n       {}", c.verdict(), c.claim, c.measured)).collect()
}

/// The claims for reading, a line each.
pub fn lines(claims: &[Claim]) -> String {
    claims.iter().map(|c| format!("{}  {}: {}\n", c.verdict(), c.claim, c.measured)).collect()
}

/// The claims that a `run.json` holds.
pub fn of_record(record: &Value) -> Vec<Claim> {
    let text = |claim: &Value, key: &str| claim[key].as_str().unwrap_or_default().to_owned();
    let claims = record["claims"].as_array().into_iter().flatten();
    let claim = |c: &Value| Claim {
        claim: text(c, "claim"),
        measured: text(c, "measured"),
        holds: c["holds"].as_bool() == Some(true),
    };
    claims.map(claim).collect()
}

/// Least share of the region's free cells that `visibility` must still hold free in the end.
pub const KEPT: f64 = 0.98;

/// Least share of them that `conventional` must have held free once for its loss to count ...
pub const ONCE_FREE: f64 = 0.9;

/// ... and that it must hold occupied in the end.
pub const LOST: f64 = 0.1;

/// Metrics on which `visibility` must beat `conventional`.
const BETTER_ON: [(&str, Better, &str); 4] = [
    ("log_loss", Better::Lower, "log loss"),
    ("brier", Better::Lower, "Brier score"),
    ("phantom_area", Better::Lower, "phantom area"),
    ("retention", Better::Higher, "free-space retention"),
];

/// Judges the claims at the last stage over the given trials, means over seeds; none where one of the
/// two mappers did not run.
///
/// `region` names the paper's region X: seen from near first and only from far later.
pub fn judge(trials: &[Trial], region: &str) -> Vec<Claim> {
    let Some(last) = trials.first().and_then(|t| t.runs.first()).and_then(|r| r.stages.len().checked_sub(1)) else {
        return Vec::new();
    };
    let has = |name: &str| trials[0].runs.iter().any(|run| run.mapper == name);
    if !(has("visibility") && has("conventional")) {
        return Vec::new();
    }
    let mean = |mapper: &str, region: &str, metric: &str| mean(trials, mapper, last, region, metric);
    let mut claims = Vec::new();
    for place in [region, "observable"] {
        for (metric, better, name) in BETTER_ON {
            let [ours, theirs] = ["visibility", "conventional"].map(|mapper| mean(mapper, place, metric));
            let ahead = |(ours, theirs)| if better == Better::Lower { ours < theirs } else { ours > theirs };
            let word = if better == Better::Lower { "lower" } else { "higher" };
            claims.push(Claim {
                claim: format!("{place}: visibility has the {word} {name}"),
                measured: format!("{} against {}", shown(ours), shown(theirs)),
                holds: ours.zip(theirs).is_some_and(ahead),
            });
        }
    }
    let at_least = |claim: String, value: Option<f64>, bound: f64| Claim {
        claim,
        measured: format!("{}, at least {bound}", shown(value)),
        holds: value.is_some_and(|value| value >= bound),
    };
    let kept = mean("visibility", region, "free_known");
    claims.push(at_least(format!("{region}: visibility still has the free cells free"), kept, KEPT));
    let once = once_free(trials, last, region);
    claims.push(at_least(format!("{region}: conventional had the free cells free once"), once, ONCE_FREE));
    let lost = mean("conventional", region, "free_lost");
    claims.push(at_least(format!("{region}: conventional now has them occupied"), lost, LOST));
    claims
}

/// Mean over seeds; none where any seed has no value.
fn mean(trials: &[Trial], mapper: &str, stage: usize, region: &str, metric: &str) -> Option<f64> {
    let values = trials.iter().map(|t| t.metric(mapper, stage, region, metric)?.value);
    Some(Summary::of(&values.collect::<Option<Vec<_>>>()?)?.mean)
}

/// Share of the region's free cells that `conventional` ever held free after having seen them.
fn once_free(trials: &[Trial], stage: usize, region: &str) -> Option<f64> {
    let shares = trials.iter().map(|trial| {
        let held = trial.metric("conventional", stage, region, "retention")?.support;
        let free = trial.metric("conventional", stage, region, "free_lost")?.support;
        (free > 0).then(|| held as f64 / free as f64)
    });
    Some(Summary::of(&shares.collect::<Option<Vec<_>>>()?)?.mean)
}

fn shown(value: Option<f64>) -> String {
    value.map_or_else(|| "no value".to_owned(), |v| format!("{v:.4}"))
}
