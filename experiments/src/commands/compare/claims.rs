//! What is promised of the paper's method on worlds that nothing was fitted on.

use super::judgement::{self, Judgement};
use super::options::Worlds;
use super::plan::Plan;
use crate::worlds::claims::Claim;

/// The rivals that the method must beat, where they run.
const BEATEN: [&str; 5] =
    ["conventional", "conventional-tuned", "log-odds-octomap", "log-odds-cartographer", "independent"];

/// By these metrics, over all worlds in the observable region.
const BY: [&str; 2] = ["log_loss", "brier"];

/// Judges the claims on the test set with all readings: the interval of the difference must exclude zero.
pub fn judge(plan: &Plan, judgements: &[Judgement]) -> Vec<Claim> {
    if plan.set != Worlds::Test || plan.assumed.max_range_m.is_some() {
        return Vec::new();
    }
    let rivals = BEATEN.iter().filter(|rival| plan.names().contains(rival));
    let claims = rivals.flat_map(|rival| BY.map(|metric| (rival, metric)));
    claims
        .filter_map(|(rival, metric)| claim(judgement::find(judgements, "all", "observable", rival, metric)?))
        .collect()
}

fn claim(j: &Judgement) -> Option<Claim> {
    let decimals = j.criterion.decimals + 1;
    let comparison = j.comparison.as_ref()?;
    let (low, high) = (comparison.interval.low, comparison.interval.high);
    Some(Claim {
        claim: format!("{} loses on {}", j.mapper, j.criterion.title),
        measured: format!("{:+.decimals$} [{low:+.decimals$}, {high:+.decimals$}]", comparison.mean_difference),
        holds: low > 0.0,
    })
}
