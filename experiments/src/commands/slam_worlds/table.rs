//! What `slam-worlds` prints.

use score::Comparison;
use serde_json::json;
use slam::Weight;

use super::options::Weighed;
use super::world::Outcome;
use crate::output::table::{Table, aligned, optional, rounded};

/// Every world.
pub(super) fn table(outcomes: &[Outcome]) -> Table {
    Table::of(
        outcomes,
        &[
            ("family", &|row| json!(row.family)),
            ("seed", &|row| json!(row.seed)),
            ("sensor", &|row| json!(row.sensor.name())),
            ("weight", &|row| json!(row.weighed.by.name())),
            ("power", &|row| optional(row.weighed.weight.map(Weight::power))),
            ("ate_m", &|row| rounded(row.ate_m)),
            ("odometry_ate_m", &|row| rounded(row.odometry_ate_m)),
            ("log_loss", &|row| rounded(row.log_loss)),
            ("log_loss_of_true_poses", &|row| rounded(row.true_log_loss)),
            ("n_eff", &|row| rounded(row.effective)),
            ("resampled", &|row| json!(row.resampled)),
            ("nees", &|row| optional(row.nees)),
        ],
    )
}

/// Means over the worlds of each family, with intervals.
pub(super) fn text(outcomes: &[Outcome], particles: u32) -> String {
    let alike = |a: &Outcome, b: &Outcome| (&a.family, a.sensor, a.weighed) == (&b.family, b.sensor, b.weighed);
    let mut groups: Vec<Vec<&Outcome>> = Vec::new();
    for outcome in outcomes {
        match groups.iter_mut().find(|group| alike(group[0], outcome)) {
            Some(group) => group.push(outcome),
            None => groups.push(vec![outcome]),
        }
    }
    let row = |group: &Vec<&Outcome>| {
        let of = |value: fn(&Outcome) -> f64| mean(group.iter().map(|outcome| value(outcome)).collect());
        let nees: Vec<f64> = group.iter().filter_map(|outcome| outcome.nees).collect();
        let nees = if nees.is_empty() { "-".to_owned() } else { format!("{:.1}", median(nees)) };
        vec![
            group[0].family.clone(),
            group[0].sensor.name().to_owned(),
            name(&group[0].weighed),
            group.len().to_string(),
            of(|outcome| outcome.ate_m),
            of(|outcome| outcome.odometry_ate_m),
            of(|outcome| outcome.log_loss / outcome.true_log_loss),
            format!("{:.1}", group.iter().map(|outcome| outcome.effective).sum::<f64>() / group.len() as f64),
            nees,
        ]
    };
    let rows: Vec<Vec<String>> = groups.iter().map(row).collect();
    let heads = ["family", "sensor", "weight", "worlds", "ATE, m", "odometry, m", "log loss ratio", "N_eff", "NEES"];
    format!(
        "{particles} particles; means over worlds with 95 % bootstrap intervals; ATE after rigid alignment; log loss of the map from the poses \
         found, over that from the true ones; NEES is the median, 2.4 of covariances that are right\n\n{}",
        aligned(&heads, &rows)
    )
}

/// What particles are weighed by, with its power.
fn name(weighed: &Weighed) -> String {
    let power = weighed.weight.map(|weight| format!(" {}", weight.power()));
    format!("{}{}", weighed.by.name(), power.unwrap_or_default())
}

/// A mean with its interval, which a single value does not have.
fn mean(values: Vec<f64>) -> String {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    match Comparison::of(&values, &vec![0.0; values.len()]) {
        Ok(comparison) => format!("{mean:.3} [{:.3}, {:.3}]", comparison.interval.low, comparison.interval.high),
        Err(_) => format!("{mean:.3}"),
    }
}

/// The middle of values, of which there is one at least.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len() % 2 == 1 { values[half] } else { 0.5 * (values[half - 1] + values[half]) }
}
