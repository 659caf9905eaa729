//! What `compare` prints: the numbers that a person looks at first, 80 columns wide.

use std::fmt::Write as _;

use super::Findings;
use super::criteria::{CRITERIA, Criterion};
use super::judgement::{self, Judgement, Scope};
use super::plan::{Plan, REFERENCE};
use super::tables::over_worlds;
use crate::table::aligned;

/// The metrics of the table of means.
const SHOWN: [&str; 7] = ["log_loss", "brier", "ece", "iou", "retention", "phantom_area", "missed_area"];

/// The metrics that the mappers are compared by.
const COMPARED: [&str; 2] = ["log_loss", "brier"];

/// A table for reading: a title, heads and rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// What it shows.
    pub title: String,
    /// One per column; a line break where a head takes two lines.
    pub heads: Vec<String>,
    /// One value per column.
    pub rows: Vec<Vec<String>>,
}

/// Means and differences over all worlds; of a set with conditions, those of each condition; claims.
pub fn summary(plan: &Plan, findings: &Findings) -> String {
    let mut text = heading(plan, findings.worlds.len()) + "\n\n";
    for Section { title, heads, rows } in sections(plan, findings) {
        let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
        let _ = writeln!(text, "{title}\n{}", aligned(&heads, &rows));
    }
    for claim in &findings.claims {
        let _ = writeln!(text, "{}  {}: {}", if claim.holds { "holds" } else { "FAILS" }, claim.claim, claim.measured);
    }
    text
}

/// One line on what was compared.
pub fn heading(plan: &Plan, worlds: usize) -> String {
    let families = plan.families.len();
    let conditions = match plan.conditions.len() {
        1 => String::new(),
        n => format!(" x {n} conditions"),
    };
    let batch = match plan.has_batch() {
        true => format!(" (batch mappers: {} seeds)", plan.batch_seeds),
        false => String::new(),
    };
    let (set, seeds, mappers) = (plan.set.name(), plan.seeds, plan.mappers.len());
    format!(
        "compare: {set} set, {families} families{conditions} x {seeds} seeds = {worlds} worlds, {mappers} mappers{batch}"
    )
}

/// The tables of the summary.
pub fn sections(plan: &Plan, findings: &Findings) -> Vec<Section> {
    let all = &findings.scopes[0];
    let mut sections = vec![means(plan, findings, all)];
    sections.extend(COMPARED.map(|metric| differences(plan, findings, all, metric)));
    if findings.scopes.len() > 1 {
        sections.push(parts(plan, findings, "log_loss"));
    }
    sections
}

fn means(plan: &Plan, findings: &Findings, scope: &Scope) -> Section {
    let shown: Vec<(usize, &Criterion)> =
        CRITERIA.iter().enumerate().filter(|(_, criterion)| SHOWN.contains(&criterion.metric)).collect();
    let row = |mapper: &str| {
        let values = shown.iter().map(|(number, criterion)| {
            let spread = over_worlds(&findings.worlds, scope, mapper, "observable", *number);
            spread.map_or_else(|| "-".to_owned(), |s| format!("{:.*}", criterion.decimals, s.mean))
        });
        [mapper.to_owned()].into_iter().chain(values).collect()
    };
    Section {
        title: "Means over all worlds, all that could be seen (areas in m²)".to_owned(),
        heads: ["mapper"].into_iter().chain(shown.iter().map(|(_, c)| c.title)).map(str::to_owned).collect(),
        rows: plan.names().into_iter().map(row).collect(),
    }
}

fn differences(plan: &Plan, findings: &Findings, scope: &Scope, metric: &str) -> Section {
    let find = |mapper: &&str| judgement::find(&findings.judgements, &scope.name, "observable", mapper, metric);
    let judged: Vec<&Judgement> = plan.names().iter().filter_map(find).collect();
    let title = judged.first().map_or("", |j| j.criterion.title);
    let margin = judged.first().and_then(|j| j.criterion.judged).map_or(0.0, |(_, margin)| margin);
    Section {
        title: format!("{title}: mapper minus {REFERENCE}, 95 % interval; equivalent within {margin}"),
        heads: ["mapper", "pairs", "difference and interval", "p (Holm)", "d_z", "mapper is"]
            .map(str::to_owned)
            .to_vec(),
        rows: judged.into_iter().map(row).collect(),
    }
}

/// The number of pairs, the difference with its interval, adjusted p, effect size and verdict.
pub fn row(j: &Judgement) -> Vec<String> {
    let of = |value: &dyn Fn(&score::Comparison) -> String| j.comparison.as_ref().map_or_else(|| "-".to_owned(), value);
    vec![
        j.mapper.clone(),
        of(&|c| c.pairs.to_string()),
        difference(j),
        j.adjusted_p.map_or_else(|| "-".to_owned(), p),
        of(&|c| c.cohen_dz.map_or_else(|| "-".to_owned(), |d| format!("{d:+.1}"))),
        j.verdict.map_or_else(|| "-".to_owned(), |verdict| verdict.to_string()),
    ]
}

/// A difference with its interval.
pub fn difference(j: &Judgement) -> String {
    let Some(c) = &j.comparison else { return "-".to_owned() };
    let d = j.criterion.decimals;
    format!("{:+.d$} [{:+.d$}, {:+.d$}]", c.mean_difference, c.interval.low, c.interval.high)
}

fn p(p: f64) -> String {
    if p < 0.0001 { "< 0.0001".to_owned() } else { format!("{p:.4}") }
}

/// The difference of every mapper in every part: a row per mapper, a column per family or condition.
fn parts(plan: &Plan, findings: &Findings, metric: &str) -> Section {
    let scopes: Vec<&Scope> = findings.scopes[1..].iter().filter(|scope| plan.is_part(&scope.name)).collect();
    let cell = |mapper: &str, scope: &Scope| {
        let j = judgement::find(&findings.judgements, &scope.name, "observable", mapper, metric);
        j.and_then(|j| j.comparison.as_ref()).map_or_else(
            || "-".to_owned(),
            |c| {
                let sure = if c.interval.excludes_zero() { "" } else { "?" };
                format!("{:+.2}{sure}", c.mean_difference)
            },
        )
    };
    let rivals = plan.names().into_iter().filter(|name| *name != REFERENCE);
    Section {
        title: format!("Difference in log loss from {REFERENCE}, part by part; ? where the interval holds zero"),
        heads: ["mapper".to_owned()].into_iter().chain(scopes.iter().map(|s| s.name.replacen('-', "\n", 1))).collect(),
        rows: rivals
            .map(|mapper| [mapper.to_owned()].into_iter().chain(scopes.iter().map(|s| cell(mapper, s))).collect())
            .collect(),
    }
}
