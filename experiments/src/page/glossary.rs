//! What each metric is: the table of the guide.

/// A row of the glossary.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Term {
    /// Names of the metrics that it explains, as in files.
    pub(super) names: Vec<String>,
    /// What it is.
    pub(super) formula: String,
    /// Its unit.
    pub(super) unit: String,
    /// Which way is better.
    pub(super) better: String,
}

/// Words that tables for reading have for metrics.
const TITLES: [(&str, &str); 18] = [
    ("AUC", "auc"),
    ("Brier", "brier"),
    ("ECE", "ece"),
    ("IoU", "iou"),
    ("cleared", "cleared_3"),
    ("dynamic", "dynamic_accuracy"),
    ("ghost", "ghost_area"),
    ("harmonic", "harmonic_accuracy"),
    ("held free", "free_known"),
    ("held occupied", "free_lost"),
    ("lag", "lag_looks"),
    ("missed", "missed_area"),
    ("phantom", "phantom_area"),
    ("recall > 0.5", "recall_50"),
    ("recall > 0.65", "recall_65"),
    ("shift", "recalibrated_log_loss"),
    ("static", "static_accuracy"),
    ("trail", "trail_area"),
];

impl Term {
    /// Whether it explains a metric.
    pub(super) fn is_of(&self, metric: &str) -> bool {
        self.names.iter().any(|name| name == metric)
    }
}

/// All terms, in the order of the guide.
pub(super) fn terms() -> Vec<Term> {
    let rows = include_str!("../../guide/glossary.md").lines().filter(|line| line.starts_with("| `"));
    rows.map(|row| {
        // A bar within a formula stands behind a backslash.
        let row = row.replace("\\|", "\u{0}");
        let cells: Vec<String> =
            row.trim_matches('|').split('|').map(|cell| cell.trim().replace('\u{0}', "|")).collect();
        let [names, formula, unit, better] = cells.try_into().unwrap_or_default();
        let names = names.split(", ").map(|name| name.trim_matches('`').to_owned()).collect();
        Term { names, formula, unit, better }
    })
    .collect()
}

/// The metric that the head of a column names, if it is one: `log loss`, `phantom, m²`, `AUC`.
pub(super) fn metric_of(head: &str) -> String {
    let head = head.split(", ").next().unwrap_or(head).trim_end_matches(" m²");
    let title = TITLES.iter().find(|(title, _)| *title == head);
    title.map_or_else(|| head.replace(' ', "_"), |(_, metric)| (*metric).to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::worlds::criteria::criteria;

    #[test]
    fn every_metric_is_explained_and_found_by_its_heads() {
        let terms = terms();
        let find = |name: &str| terms.iter().find(|term| term.is_of(name));
        for criterion in criteria() {
            let term = find(criterion.metric).unwrap_or_else(|| panic!("{} is not in the glossary", criterion.metric));
            assert!(!term.formula.is_empty() && !term.better.is_empty(), "{term:?}");
            assert_eq!(metric_of(&criterion.metric.replace('_', " ")), criterion.metric);
        }
        assert_eq!(find("ece").map(|term| term.formula.contains("|mean p - share occupied|")), Some(true));
        let heads = ["phantom m²", "phantom area, m²", "recall > 0.5", "held free", "AUC"].map(metric_of);
        assert_eq!(heads, ["phantom_area", "phantom_area", "recall_50", "free_known", "auc"]);
    }
}
