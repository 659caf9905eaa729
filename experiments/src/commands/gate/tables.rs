//! The outcome of gates as a table, and as text for reading.

use std::fmt::Write as _;

use serde_json::json;

use super::file::{Demand, Gate};
use super::verdict::{Outcome, Verdict};
use crate::output::table::{Table, aligned, optional, rounded, wrapped};

/// Columns of a terminal.
const WIDTH: usize = 80;

/// Every gate: a row each.
pub fn table(outcomes: &[Outcome]) -> Table {
    Table::of(
        outcomes,
        &[
            ("gate", &|o| json!(o.gate.name)),
            ("mapper", &|o| json!(o.gate.mapper)),
            ("metric", &|o| json!(o.gate.criterion.metric)),
            ("unit", &|o| json!(o.gate.criterion.unit)),
            ("region", &|o| json!(o.gate.region)),
            ("worlds", &|o| json!(o.gate.worlds.len())),
            ("value", &|o| optional(o.value)),
            ("demand", &|o| json!(o.gate.demand.key())),
            ("bound", &|o| rounded(o.gate.demand.bound())),
            ("reference", &|o| json!(o.against())),
            ("reference_value", &|o| optional(o.reference)),
            ("difference", &|o| optional(o.difference)),
            ("low", &|o| optional(o.interval.map(|interval| interval.low))),
            ("high", &|o| optional(o.interval.map(|interval| interval.high))),
            ("defined", &|o| json!(o.defined)),
            ("verdict", &|o| json!(o.verdict.word())),
            ("cause", &|o| json!(o.cause)),
        ],
    )
}

/// The table for reading, within eighty columns, and those that fail once more with all that is known of them.
pub fn text(outcomes: &[Outcome], heading: &str) -> String {
    let heads = ["gate", "value", "against", "difference, 95 % interval", "bound", ""];
    let mut rows: Vec<Vec<String>> = outcomes.iter().map(row).collect();
    let longest = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let others: usize = (1..heads.len()).map(|column| 2 + longest(column).max(heads[column].chars().count())).sum();
    let room = WIDTH.saturating_sub(others).max(12);
    for row in &mut rows {
        if row[0].chars().count() > room {
            row[0] = row[0].chars().take(room - 1).chain(['…']).collect();
        }
    }
    let mut text = format!("{heading}\n\n{}", aligned(&heads, &rows));
    let outgrown: Vec<&str> = outcomes.iter().filter(|o| o.outgrown()).map(|o| o.gate.name.as_str()).collect();
    // Not beside gates that fail: a change that trades one thing for another is no progress to hold.
    if !outgrown.is_empty() && outcomes.iter().all(|outcome| outcome.verdict == Verdict::Pass) {
        let names = wrapped(&outgrown.join(", "), WIDTH - 2).join("\n  ");
        let _ =
            write!(text, "\nBetter than the baseline by more than the margin; `gate --update` holds it:\n  {names}\n");
    }
    for outcome in outcomes.iter().filter(|outcome| outcome.verdict != Verdict::Pass) {
        let _ = write!(text, "\n{} {}\n", outcome.verdict.word(), outcome.gate.name);
        for line in account(outcome) {
            let _ = writeln!(text, "     {}", wrapped(&line, WIDTH - 5).join("\n     "));
        }
    }
    text
}

fn row(outcome: &Outcome) -> Vec<String> {
    let decimals = decimals(&outcome.gate);
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.decimals$}"));
    vec![
        outcome.gate.name.clone(),
        number(outcome.value),
        number(outcome.reference),
        difference(outcome).unwrap_or_default(),
        bound(&outcome.gate),
        outcome.verdict.word().to_owned(),
    ]
}

/// What is known of an outcome, a line to a thought: what was measured, the numbers, and where.
pub fn account(outcome: &Outcome) -> Vec<String> {
    let Gate { mapper, criterion, region, worlds, .. } = &outcome.gate;
    let decimals = decimals(&outcome.gate);
    let unit = if criterion.unit == "1" { String::new() } else { format!(" {}", criterion.unit) };
    let mut families: Vec<&str> = worlds.iter().map(|world| world.family.as_str()).collect();
    families.dedup();
    let mut lines = vec![format!(
        "{} of {mapper}, {region} cells, {} worlds: {}",
        criterion.title,
        worlds.len(),
        families.join(", ")
    )];
    if let Some(value) = outcome.value {
        let reference = match (outcome.against(), outcome.reference) {
            (Some(against), Some(reference)) => format!(", {against} {reference:.decimals$}"),
            _ => String::new(),
        };
        let difference = difference(outcome).map_or_else(String::new, |difference| format!(": {difference}"));
        lines.push(format!("{value:.decimals$}{unit}{reference}{difference}; must {}", bound_in_words(&outcome.gate)));
    }
    if outcome.families.len() > 1 {
        let part = |(family, difference): &(String, f64)| format!("{family} {}", signed(*difference, decimals));
        lines.push(format!("where: {}", outcome.families.iter().map(part).collect::<Vec<_>>().join(", ")));
    }
    lines.extend(outcome.cause.clone());
    lines
}

/// The mean difference with its interval.
pub fn difference(outcome: &Outcome) -> Option<String> {
    let decimals = decimals(&outcome.gate);
    let (difference, interval) = outcome.difference.zip(outcome.interval)?;
    let signed = |value: f64| signed(value, decimals);
    Some(format!("{} [{}, {}]", signed(difference), signed(interval.low), signed(interval.high)))
}

/// A difference with its sign, and without one where nothing is left to have it.
fn signed(value: f64, decimals: usize) -> String {
    let text = format!("{value:+.decimals$}");
    if text.trim_start_matches(['+', '-', '0', '.']).is_empty() { text[1..].to_owned() } else { text }
}

/// What must hold, in signs: of the value, or of the difference where it has a sign.
pub fn bound(gate: &Gate) -> String {
    let higher = higher(gate);
    match gate.demand {
        Demand::AtMost(bound) => format!("<= {bound}"),
        Demand::AtLeast(bound) => format!(">= {bound}"),
        Demand::NotWorseThanBaselineBy(margin) if higher => format!(">= -{margin}"),
        Demand::NotWorseThanBaselineBy(margin) => format!("<= +{margin}"),
        Demand::BetterThan { by, .. } if higher => format!("> +{by}"),
        Demand::BetterThan { by, .. } => format!("< -{by}"),
    }
}

/// What must hold, in words.
fn bound_in_words(gate: &Gate) -> String {
    let more = if higher(gate) { "higher" } else { "lower" };
    let less = if higher(gate) { "lower" } else { "higher" };
    match &gate.demand {
        Demand::AtMost(bound) => format!("be at most {bound}"),
        Demand::AtLeast(bound) => format!("be at least {bound}"),
        Demand::NotWorseThanBaselineBy(margin) => format!("not be {less} than the baseline by more than {margin}"),
        Demand::BetterThan { mapper, by } => {
            format!("be {more} than {mapper} by more than {by}, with all of the interval")
        }
    }
}

fn higher(gate: &Gate) -> bool {
    matches!(gate.criterion.judged, Some((score::Better::Higher, _)))
}

/// One more than tables of scores have: differences are small.
fn decimals(gate: &Gate) -> usize {
    (gate.criterion.decimals + 1).min(4)
}
