//! The answer that the page begins with: which mapper is better, by how much, how surely.

use mapper::catalogue::Kind;

use super::plan::{Plan, REFERENCE};
use super::rows::{Difference, Rows};
use super::sheets::{self, ALL, OBSERVABLE};
use crate::worlds::criteria::criterion;

/// The metrics that the answer is given by.
const BY: [&str; 2] = ["log_loss", "brier"];

/// A sentence per metric.
pub(super) fn answer(plan: &Plan, rows: &Rows) -> Vec<String> {
    // What has noise-free readings, or none at all, is no rival.
    let is_rival = |entry: &&&mapper::catalogue::Entry| entry.kind != Kind::NoiseFree && entry.name != "prior";
    let rivals: Vec<&str> =
        plan.mappers.iter().filter(is_rival).map(|entry| entry.name).filter(|name| *name != REFERENCE).collect();
    BY.iter().filter_map(|metric| sentence(rows, &rivals, metric)).collect()
}

fn sentence(rows: &Rows, rivals: &[&str], metric: &str) -> Option<String> {
    let criterion = criterion(metric)?;
    let found = rivals.iter().filter_map(|name| rows.difference(ALL, OBSERVABLE, name, metric));
    let mut judged: Vec<(&Difference, f64)> = found.filter_map(|d| Some((d, d.difference?))).collect();
    judged.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (nearest, _) = *judged.first()?;
    let with = |verdict: &str| -> Vec<&str> {
        judged.iter().filter(|(d, _)| d.verdict.as_deref() == Some(verdict)).map(|(d, _)| d.mapper.as_str()).collect()
    };
    let (worse, better) = (with("worse"), with("better"));
    let mut said = match better.as_slice() {
        [] => format!("By {} no mapper is better than {REFERENCE}", criterion.title),
        names => format!("By {}, {} {} better than {REFERENCE}", criterion.title, listed(names), verb(names)),
    };
    if !worse.is_empty() {
        said += &format!(", which is better than {} of {}: {}", worse.len(), judged.len(), listed(&worse));
    }
    for (verdict, what) in [("equivalent", "equivalent to it"), ("undecided", "undecided")] {
        let names = with(verdict);
        if !names.is_empty() {
            said += &format!("; {} {} {what}", listed(&names), verb(&names));
        }
    }
    let unit = if criterion.unit == "1" { String::new() } else { format!(" {}", criterion.unit) };
    let p = nearest.p_holm.map_or_else(String::new, |p| match p {
        p if p < 0.0001 => ", p < 0.0001".to_owned(),
        p => format!(", p {p:.4}"),
    });
    Some(format!(
        "{said}. Lowest of the others: {}, {}{unit} against {REFERENCE} over {} pairs of maps{p}.",
        nearest.mapper,
        sheets::interval(nearest, criterion.decimals),
        nearest.pairs.unwrap_or(0)
    ))
}

fn verb(names: &[&str]) -> &'static str {
    if names.len() == 1 { "is" } else { "are" }
}

fn listed(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [all @ .., last] => format!("{} and {last}", all.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn difference(mapper: &str, difference: f64, verdict: &str) -> Difference {
        Difference {
            scope: ALL.to_owned(),
            region: OBSERVABLE.to_owned(),
            metric: "log_loss".to_owned(),
            mapper: mapper.to_owned(),
            pairs: Some(12),
            difference: Some(difference),
            low: Some(difference - 0.1),
            high: Some(difference + 0.1),
            p_holm: Some(0.00001),
            rank_biserial: None,
            cohen_dz: None,
            verdict: Some(verdict.to_owned()),
        }
    }

    #[test]
    fn it_names_who_is_better_by_how_much_and_how_surely() {
        let rows = Rows {
            differences: vec![
                difference("conventional", 0.9, "worse"),
                difference("lateral", -0.2, "better"),
                difference("mrf", 0.3, "worse"),
                difference("touched", 0.0, "equivalent"),
            ],
            ..Rows::default()
        };
        let names = ["conventional", "lateral", "mrf", "touched"];
        assert_eq!(
            sentence(&rows, &names, "log_loss").as_deref(),
            Some(
                "By log loss, lateral is better than visibility, which is better than 2 of 4: mrf and conventional; touched is \
                 equivalent to it. Lowest of the others: lateral, -0.200 [-0.300, -0.100] nats/cell against visibility over 12 \
                 pairs of maps, p < 0.0001."
            )
        );
        let worse = sentence(&rows, &["conventional"], "log_loss").expect("a sentence");
        assert!(
            worse.starts_with("By log loss no mapper is better than visibility, which is better than 1 of 1"),
            "{worse}"
        );
        assert_eq!(sentence(&rows, &names, "brier"), None);
    }
}
