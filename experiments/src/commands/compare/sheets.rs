//! The tables of a comparison, for reading.

use score::navigation::Navigation;
use score::{MovingRegion, Region};

use super::plan::REFERENCE;
use super::repeats::Readings;
use super::rows::{Difference, Repeat, Rows};
use super::sensors;
use crate::page::{Cell, Sheet, Tone};
use crate::worlds::criteria::{CRITERIA, Criterion, criterion};

/// The region that mappers are judged by first: all that could be seen.
pub const OBSERVABLE: &str = "observable";

/// The scope of all worlds.
pub const ALL: &str = "all";

/// The metrics of the table of means.
const SHOWN: [&str; 7] = ["log_loss", "brier", "ece", "iou", "retention", "phantom_area", "missed_area"];

/// The metrics of the table of drives, beside which recall says what a threshold finds.
const DRIVEN: [&str; 5] = ["reached", "colliding", "detour", "recall_50", "recall_65"];

/// The metrics of the table of what moves.
const MOVED: [&str; 7] =
    ["static_accuracy", "dynamic_accuracy", "harmonic_accuracy", "trail_area", "ghost_area", "lag_looks", "cleared_3"];

/// Variants that take one idea away, or add one, and which.
const ABLATIONS: [(&str, &str); 9] = [
    ("no-occlusion", "occlusion off: each cell's own likelihoods on the chain"),
    ("independent", "correlation off: occlusion without continuity"),
    ("conventional", "both off"),
    ("visibility-touched", "least squares over the edges that rays run along"),
    ("visibility-all-edges", "least squares over all edges"),
    ("visibility-printed", "Eqs. (4)-(17) as printed"),
    ("visibility-lateral", "continuity across rays too"),
    ("lateral-rays", "the same by rays of a scan alone"),
    ("lateral-edges", "the same by edges on no ray alone"),
];

/// The metrics of the table of ablations.
const ABLATED: [&str; 5] = ["log_loss", "brier", "retention", "phantom_area", "missed_area"];

/// How much of a table there is room for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Width {
    /// 80 columns.
    Terminal,
    /// All columns.
    Page,
}

/// A mean per mapper and metric over the worlds of a scope.
pub fn means(rows: &Rows, mappers: &[&str], scope: &str, region: &str) -> Sheet {
    let shown: Vec<&Criterion> = CRITERIA.iter().filter(|c| SHOWN.contains(&c.metric)).collect();
    let row = |mapper: &&str| {
        let values = shown.iter().map(|c| number(rows.mean(scope, region, mapper, c.metric), c.decimals));
        [Cell::from(*mapper)].into_iter().chain(values).collect()
    };
    let title = |c: &&Criterion| if c.unit == "m²" { format!("{} m²", c.title) } else { c.title.to_owned() };
    Sheet {
        caption: format!("Means over {}, {}", worlds(scope), region_in_words(region)),
        note: String::new(),
        heads: ["mapper".to_owned()].into_iter().chain(shown.iter().map(title)).collect(),
        rows: mappers.iter().map(row).collect(),
    }
}

/// Every mapper against the reference by one metric.
pub fn differences(rows: &Rows, mappers: &[&str], scope: &str, region: &str, metric: &str, width: Width) -> Sheet {
    let (title, decimals) = criterion(metric).map_or(("", 3), |c| (c.title, c.decimals));
    let margin =
        criterion(metric).and_then(|c| c.judged).map_or_else(String::new, |(_, m)| format!("; equivalent within {m}"));
    let place = match width {
        Width::Terminal => String::new(), // said by the table before
        Width::Page => format!(", {}", region_in_words(region)),
    };
    let narrow = ["mapper", "pairs", "difference, 95 % interval", "p Holm", "verdict"];
    let wide = ["mapper", "pairs", "difference, 95 % interval", "p Holm", "d_z", "rank-biserial", "verdict"];
    let row = |d: &Difference| {
        let mut row: Vec<Cell> = vec![
            d.mapper.as_str().into(),
            d.pairs.map_or_else(|| "-".into(), |pairs| pairs.to_string().into()),
            interval(d, decimals).into(),
            d.p_holm.map_or_else(|| "-".to_owned(), p).into(),
        ];
        if width == Width::Page {
            row.extend([d.cohen_dz, d.rank_biserial].map(|size| number(size, 2)));
        }
        row.push(verdict(d));
        row
    };
    let found = mappers.iter().filter_map(|mapper| rows.difference(scope, region, mapper, metric));
    Sheet {
        caption: format!("{title}: mapper minus {REFERENCE}, {}{place}{margin}", worlds(scope)),
        note: String::new(),
        heads: if width == Width::Page { wide.map(str::to_owned).to_vec() } else { narrow.map(str::to_owned).to_vec() },
        rows: found.map(row).collect(),
    }
}

/// The difference of every mapper in every part: a column per family or condition.
pub fn parts(rows: &Rows, mappers: &[&str], parts: &[&str], metric: &str, width: Width) -> Sheet {
    let (title, decimals) = criterion(metric).map_or(("", 3), |c| (c.title, c.decimals));
    // Two decimals are what a terminal has room for beside more parts than that.
    let decimals = if width == Width::Terminal && parts.len() > 5 { 2 } else { decimals };
    let cell = |mapper: &str, part: &str| match rows.difference(part, OBSERVABLE, mapper, metric) {
        Some(d) if d.difference.is_some() => {
            let doubt = if d.is_sure() { "" } else { "?" };
            let text = d.difference.map_or_else(String::new, |value| format!("{value:+.decimals$}{doubt}"));
            Cell::toned(text, tone(d))
        }
        _ => "-".into(),
    };
    let rivals = mappers.iter().filter(|name| **name != REFERENCE);
    let row =
        |mapper: &&str| [Cell::from(*mapper)].into_iter().chain(parts.iter().map(|part| cell(mapper, part))).collect();
    Sheet {
        caption: format!("{title}: mapper minus {REFERENCE}, by part; ? where the interval holds zero"),
        note: String::new(),
        heads: ["mapper"].into_iter().chain(parts.iter().copied()).map(str::to_owned).collect(),
        rows: rivals.map(row).collect(),
    }
}

/// Which map may I drive on: a mean per mapper and metric of drives, and how sure it differs from the reference. Planned on the cells of the
/// maps, and by footprint.
pub fn drives(rows: &Rows, mappers: &[&str], width: Width) -> [Sheet; 2] {
    [
        driven(
            rows,
            mappers,
            width,
            "Drives planned on the maps, all worlds; recall of surfaces that rays hit",
            &DRIVEN,
        ),
        driven(
            rows,
            mappers,
            width,
            "The same, planned by the probability of an obstacle under the robot",
            &Navigation::FOOTPRINT_METRICS,
        ),
    ]
}

/// What becomes of what moves: a mean per mapper and metric, each in the region that has it, over the worlds that move; none where nothing does.
pub fn moved(rows: &Rows, mappers: &[&str], width: Width) -> Option<Sheet> {
    let moves = rows.means.iter().any(|mean| mean.region == MovingRegion::Swept.name());
    let caption = "What has moved: static, swept and changed cells (areas in m², lag in looks)";
    moves.then(|| driven(rows, mappers, width, caption, &MOVED))
}

fn driven(rows: &Rows, mappers: &[&str], width: Width, caption: &str, metrics: &[&str]) -> Sheet {
    let metrics: Vec<&Criterion> = metrics.iter().filter_map(|metric| criterion(metric)).collect();
    let cell = |mapper: &str, c: &Criterion| {
        let region = c.region.unwrap_or(OBSERVABLE);
        let mean =
            rows.mean(ALL, region, mapper, c.metric).map_or_else(|| "-".to_owned(), |m| format!("{m:.*}", c.decimals));
        match rows.difference(ALL, region, mapper, c.metric) {
            Some(d) if width == Width::Page => Cell::toned(format!("{mean} ({})", interval(d, c.decimals)), tone(d)),
            Some(d) => Cell::toned(mean, tone(d)),
            None => mean.into(),
        }
    };
    let row =
        |mapper: &&str| [Cell::from(*mapper)].into_iter().chain(metrics.iter().map(|c| cell(mapper, c))).collect();
    let note = match width {
        Width::Terminal => "",
        Width::Page => "in brackets the difference from visibility with its interval",
    };
    Sheet {
        caption: caption.to_owned(),
        note: note.to_owned(),
        heads: ["mapper"].into_iter().chain(metrics.iter().map(|c| c.title)).map(str::to_owned).collect(),
        rows: mappers.iter().map(row).collect(),
    }
}

/// What each idea of the paper is worth: variants of the reference without it.
pub fn ablations(rows: &Rows, mappers: &[&str]) -> Sheet {
    let metrics: Vec<&Criterion> = ABLATED.iter().filter_map(|metric| criterion(metric)).collect();
    let cell = |mapper: &str, c: &Criterion| match rows.difference(ALL, OBSERVABLE, mapper, c.metric) {
        Some(d) => Cell::toned(interval(d, c.decimals), tone(d)),
        None => "-".into(),
    };
    let row = |(mapper, what): &(&str, &str)| {
        let cells = metrics.iter().map(|c| cell(mapper, c));
        [Cell::from(format!("{mapper}: {what}"))].into_iter().chain(cells).collect()
    };
    let title = |c: &&Criterion| if c.unit == "m²" { format!("{}, m²", c.title) } else { c.title.to_owned() };
    Sheet {
        caption: format!("Variant minus {REFERENCE}, all worlds, {}", region_in_words(OBSERVABLE)),
        note: String::new(),
        heads: ["variant".to_owned()].into_iter().chain(metrics.iter().map(title)).collect(),
        rows: ABLATIONS.iter().filter(|(mapper, _)| mappers.contains(mapper)).map(row).collect(),
    }
}

/// Mean over worlds and scans of one number, a column per number of repeats.
pub fn repeats(
    rows: &Rows,
    readings: Readings,
    mappers: &[&str],
    title: &str,
    decimals: usize,
    of: fn(&Repeat) -> Option<f64>,
) -> Sheet {
    let counts = repeat_counts(rows, readings);
    let repeated = mappers.iter().filter(|mapper| rows.repeats.iter().any(|r| r.mapper == **mapper));
    let row = |mapper: &&str| {
        let values = counts.iter().map(|count| number(repeated_mean(rows, readings, mapper, *count, of), decimals));
        [Cell::from(*mapper)].into_iter().chain(values).collect()
    };
    let after = match readings {
        Readings::Same => "after the same scan so many times",
        Readings::Standing => "after so many scans of a robot that stands: mismatches stay, noise is fresh",
        Readings::Fresh => "after so many scans from one place, all of them fresh",
        Readings::Driven => "after so many scans of a robot that stood and then drove 5 m",
    };
    Sheet {
        caption: format!("{title} {after}"),
        note: "means over worlds and scans, over what the first scan could see".to_owned(),
        heads: ["mapper".to_owned()].into_iter().chain(counts.iter().map(|n| format!("{n} ×"))).collect(),
        rows: repeated.map(row).collect(),
    }
}

/// How often scans were repeated, rising.
pub fn repeat_counts(rows: &Rows, readings: Readings) -> Vec<usize> {
    let of_readings = rows.repeats.iter().filter(|r| r.readings == readings);
    of_readings.map(|r| r.repeats).collect::<std::collections::BTreeSet<_>>().into_iter().collect()
}

/// Mean over worlds and scans of a number after so many repeats.
pub fn repeated_mean(
    rows: &Rows,
    readings: Readings,
    mapper: &str,
    count: usize,
    of: fn(&Repeat) -> Option<f64>,
) -> Option<f64> {
    let asked = |r: &&Repeat| r.readings == readings && r.mapper == mapper && r.repeats == count;
    let values = rows.repeats.iter().filter(asked).filter_map(of);
    score::Summary::of(&values.collect::<Vec<_>>()).map(|summary| summary.mean)
}

/// A difference with its interval.
pub fn interval(d: &Difference, decimals: usize) -> String {
    match (d.difference, d.low, d.high) {
        (Some(difference), Some(low), Some(high)) => {
            format!("{difference:+.decimals$} [{low:+.decimals$}, {high:+.decimals$}]")
        }
        _ => "-".to_owned(),
    }
}

fn number(value: Option<f64>, decimals: usize) -> Cell {
    value.map_or_else(|| "-".into(), |value| format!("{value:.decimals$}").into())
}

fn p(p: f64) -> String {
    if p < 0.0001 { "<0.0001".to_owned() } else { format!("{p:.4}") }
}

fn verdict(d: &Difference) -> Cell {
    Cell::toned(d.verdict.as_deref().unwrap_or("-"), tone(d))
}

/// Of the verdict on the mapper: worse is against it.
fn tone(d: &Difference) -> Tone {
    match d.verdict.as_deref() {
        Some("better") => Tone::Good,
        Some("worse") => Tone::Bad,
        Some("equivalent") => Tone::Even,
        _ => Tone::Plain,
    }
}

fn worlds(scope: &str) -> String {
    if scope == ALL { "all worlds".to_owned() } else { format!("{scope} worlds") }
}

/// What a region is, in words.
pub fn region_in_words(region: &str) -> &'static str {
    match Region::ALL.iter().find(|r| r.name() == region) {
        Some(Region::Visible) => "free cells that rays crossed",
        Some(Region::Surface) => "surfaces that rays hit",
        Some(Region::Shell) => "just behind surfaces",
        Some(Region::Hidden) => "what no ray could see",
        Some(Region::Observable) => "all that could be seen",
        Some(Region::All) => "all cells",
        None => match MovingRegion::ALL.iter().find(|r| r.name() == region) {
            Some(MovingRegion::Static) => "what nothing that moves has covered",
            Some(MovingRegion::Swept) => "where something has been and is no more",
            Some(MovingRegion::OccupiedNow) => "where something that moves stands now",
            Some(MovingRegion::Changed) => "what looks have found changed",
            None => sensors::region_in_words(region).unwrap_or("a region of the scene"),
        },
    }
}
