//! The paper's claim about the room (Section 3.3, Figures 13 and 14), as numbers.

use score::Summary;
use serde::Serialize;

use crate::trial::Trial;

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

/// Least share of the region's free cells that `visibility` must still hold free in the end.
pub const KEPT: f64 = 0.98;

/// Least share of them that `conventional` must have held free once for its loss to count ...
pub const ONCE_FREE: f64 = 0.9;

/// ... and that it must hold occupied in the end.
pub const LOST: f64 = 0.1;

/// Metrics on which `visibility` must beat `conventional`, with whether more is better.
const BETTER_ON: [(&str, bool); 4] =
    [("log_loss", false), ("brier", false), ("phantom_area", false), ("retention", true)];

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
        for (metric, more_is_better) in BETTER_ON {
            let [ours, theirs] = ["visibility", "conventional"].map(|mapper| mean(mapper, place, metric));
            let holds = match (ours, theirs) {
                (Some(a), Some(b)) => {
                    if more_is_better {
                        a > b
                    } else {
                        a < b
                    }
                }
                _ => false,
            };
            let claim = format!("{place}: visibility beats conventional on {metric}");
            let measured = format!("{} against {}", shown(ours), shown(theirs));
            claims.push(Claim { claim, measured, holds });
        }
    }
    let kept = mean("visibility", region, "free_known");
    claims.push(Claim {
        claim: format!("{region}: visibility holds at least {KEPT} of the free cells free in the end"),
        measured: shown(kept),
        holds: kept.is_some_and(|kept| kept >= KEPT),
    });
    let lost = mean("conventional", region, "free_lost");
    let once = once_free(trials, last, region);
    claims.push(Claim {
        claim: format!(
            "{region}: conventional, which held at least {ONCE_FREE} free once, holds {LOST} or more occupied"
        ),
        measured: format!("{} once free, {} lost", shown(once), shown(lost)),
        holds: lost.is_some_and(|lost| lost >= LOST) && once.is_some_and(|once| once >= ONCE_FREE),
    });
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
