//! Which of the maps may I drive on, as tables.

use score::navigation::Navigation;
use score::{Metric, Region};

use super::rows::{Difference, Row};
use super::scored::ScoredMap;
use crate::page::Sheet;
use crate::worlds::criteria::{Criterion, criterion};
use crate::worlds::drives::REGION;

/// What a threshold finds of surfaces, which is shown beside the drives.
const FOUND: [&str; 2] = ["recall_50", "recall_65"];

/// The drives on a map less those on the first: the same pairs, without an interval, since they are all of one world.
pub(super) fn differences([own, first]: [&ScoredMap; 2]) -> Vec<Difference> {
    let region = REGION.name();
    let difference = |metric: &&'static str| {
        let [ours, theirs] = [find(&own.rows, region, metric)?, find(&first.rows, region, metric)?];
        Some(Difference {
            map: own.name.clone(),
            baseline: first.name.clone(),
            region: region.to_owned(),
            metric,
            unit: ours.unit,
            difference: ours.value.zip(theirs.value).map(|(ours, theirs)| ours - theirs),
            interval: None,
            tiles: 0,
            cells: ours.support.min(theirs.support),
        })
    };
    Navigation::METRICS.iter().chain(&Navigation::FOOTPRINT_METRICS).filter_map(difference).collect()
}

/// What is shown.
pub(super) fn metrics() -> impl Iterator<Item = &'static Criterion> {
    Navigation::METRICS.iter().chain(&FOUND).filter_map(|metric| criterion(metric))
}

/// A row per map, and what was driven in words; `value` is that of a map, a region and a metric.
pub(super) fn sheet(maps: &[&str], worded: &str, value: &dyn Fn(&str, &str, &str) -> Option<f64>) -> Sheet {
    let shown: Vec<&Criterion> = metrics().collect();
    let row = |map: &&str| {
        let cell = |c: &&Criterion| {
            let value = value(map, c.region.unwrap_or(Region::All.name()), c.metric);
            value.map_or_else(|| "-".to_owned(), |value| format!("{value:.*}", c.decimals)).into()
        };
        std::iter::once((*map).into()).chain(shown.iter().map(cell)).collect()
    };
    Sheet {
        caption: "Which map may I drive on".to_owned(),
        note: worded.to_owned(),
        heads: ["map"].into_iter().chain(shown.iter().map(|c| c.title)).map(str::to_owned).collect(),
        rows: maps.iter().map(row).collect(),
    }
}

fn find<'a>(rows: &'a [Row], region: &str, metric: &str) -> Option<&'a Metric> {
    rows.iter().find(|row| row.region == region && row.metric.name == metric).map(|row| &row.metric)
}
