//! All mappers in one picture, where aligned maps are scored: what wrong poses do to each, before and after alignment.

use super::{At, Chart, Line, Means, Ordinate, Panel, along, error, numbers, styled};
use crate::figures::style;
use crate::worlds::aligned::ALIGNED;

/// The file of the sheet.
pub(super) const NAME: &str = "all-mappers.png";

/// A row of the sheet.
pub(super) const PANELS: [Panel; 4] = [
    error("log_loss", "observable", "Log loss", "log loss, nats/cell"),
    error("log_loss", ALIGNED, "Log loss, aligned", "log loss, nats/cell"),
    retention("observable", "Retention"),
    retention(ALIGNED, "Retention, aligned"),
];

const fn retention(region: &'static str, title: &'static str) -> Panel {
    Panel { ordinate: Ordinate::Probability, ..error("retention", region, title, "share of free cells kept") }
}

impl Means {
    /// Whether aligned maps are among those scored.
    fn has_aligned(&self) -> bool {
        self.values.keys().any(|key| key.region == ALIGNED)
    }

    /// A row of charts for every combination of what is not along the axis, a line for every mapper.
    pub(super) fn together(&self) -> Vec<Chart> {
        if !self.has_aligned() {
            return Vec::new();
        }
        let mut rows: Vec<(&str, &str)> = self.values.keys().map(|key| (key.row.as_str(), key.line.as_str())).collect();
        rows.sort_by(|a, b| a.0.cmp(b.0).then(numbers(a.1).partial_cmp(&numbers(b.1)).unwrap_or(a.1.cmp(b.1))));
        rows.dedup();
        rows.iter().flat_map(|row| PANELS.iter().filter_map(|panel| self.of_all(*row, panel))).collect()
    }

    fn of_all(&self, (row, line): (&str, &str), panel: &Panel) -> Option<Chart> {
        let names: Vec<&str> = self.mappers.iter().map(String::as_str).collect();
        let points = |mapper: &&str| -> Line {
            let own = |key: &&super::PointKey| {
                (key.metric, key.region.as_str(), key.mapper.as_str()) == (panel.metric, panel.region, *mapper)
                    && (key.row.as_str(), key.line.as_str()) == (row, line)
            };
            let at = |key: &super::PointKey| {
                let mean = self.values.get(key)?.estimate()?;
                Some(At { x: key.x.parse().ok()?, y: mean.value, interval: None })
            };
            ((*mapper).to_owned(), self.values.keys().filter(own).filter_map(at).collect())
        };
        let lines = names.iter().map(points).collect();
        let also = [row.to_owned(), if line.is_empty() { String::new() } else { format!("{} {line}", self.line) }];
        let also: Vec<String> = also.into_iter().filter(|part| !part.is_empty()).collect();
        let title =
            if also.is_empty() { panel.title.to_owned() } else { format!("{}: {}", panel.title, also.join(", ")) };
        let styles = style::of_mappers(&names);
        styled((title, panel.unit), along(&self.axis), lines, panel.ordinate, |k| styles[k])
    }
}
