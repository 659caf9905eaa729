//! What the terminal shows, in 80 columns.

use std::fmt::Write as _;

use score::{Resampling, Tiles};

use super::options::{ScoreOptions, Unknown};
use super::rows::{Difference, Row};
use super::scored::Scored;
use super::truth::Truth;
use super::{alignment, driven};
use crate::output::table::{width, wrapped};
use crate::page::{Cell, Sheet};
use crate::worlds::criteria::criterion;
use crate::worlds::ranked::{Head, SortOption, legend};

/// Columns of the terminal.
fn columns() -> usize {
    width().map_or(80, |width| width.min(80))
}

/// Longest name of a map in a table; of a longer one the end stands.
const NAME: usize = 17;

/// What stands in the table: heading, metric, decimals.
pub(super) const COLUMNS: [(&str, &str, usize); 8] = [
    ("log loss", "log_loss", 3),
    ("Brier", "brier", 4),
    ("ECE", "ece", 3),
    ("AUC", "auc", 3),
    ("IoU", "iou", 3),
    ("phantom", "phantom_area", 2),
    ("missed", "missed_area", 2),
    ("known", "known", 3),
];

/// Metrics of which differences are shown.
const DIFFERENCES: [&str; 5] = ["log_loss", "brier", "iou", "phantom_area", "missed_area"];

/// What the regions of a table are called.
pub(super) fn title(region: &str) -> String {
    match region {
        "all" => "All known cells".to_owned(),
        "observable" => "All that could be seen".to_owned(),
        other => format!("Region {other}"),
    }
}

/// Everything: what was scored, how, the scores, and the differences.
pub(super) fn text(scored: &Scored, truth: &Truth, options: &ScoreOptions) -> String {
    let mut text = String::new();
    let [free, occupied, unknown] = truth.counts();
    let spec = &truth.frame.spec;
    let head = format!(
        "truth: {}, {} x {} cells of {} m: {free} free, {occupied} occupied, {unknown} not known",
        options.truth.display(),
        spec.width,
        spec.height,
        spec.cell_m
    );
    say(&mut text, &head);
    for map in &scored.maps {
        let how = format!("{}: {}", map.name, facts(&map.rows, map.how, map.assumed, options));
        say(&mut text, &how);
        if let Some((frame, moved)) = &map.alignment {
            let was = |metric: &str| find(&map.rows, "all", metric).and_then(|row| row.metric.value);
            let change = |before: &str, now: &str| {
                was(before).zip(was(now)).map_or_else(|| "-".to_owned(), |(b, n)| format!("{b:.4} before, {n:.4} now"))
            };
            let found = alignment::worded(moved, frame, spec.cell_m);
            let [loss, iou] = [("unaligned_log_loss", "log_loss"), ("unaligned_iou", "iou")].map(|(b, n)| change(b, n));
            say(&mut text, &format!("  {found}; log loss {loss}, IoU {iou}"));
        }
    }
    for region in &scored.shown {
        let _ = writeln!(text, "\n{} (areas in m²)", title(region));
        let rows: Vec<Vec<String>> = scored.maps.iter().map(|map| row(&map.name, &map.rows, region)).collect();
        text += &options.order.ranked(&scores(), &rows);
    }
    if let Some(drives) = &scored.drives {
        let maps: Vec<&str> = scored.maps.iter().map(|map| map.name.as_str()).collect();
        let value = |map: &str, region: &str, metric: &str| {
            let of_map = scored.maps.iter().find(|scored| scored.name == map)?;
            find(&of_map.rows, region, metric)?.metric.value
        };
        text += &driven(&driven::sheet(&maps, &drives.worded(), &value), &options.order);
    }
    text += legend(&text);
    if scored.maps.len() > 1 {
        text +=
            &differences(&scored.differences, &scored.maps[0].name, &scored.shown[0], &Tiles::of(spec), &options.order);
    }
    text
}

/// The heads of the scores.
fn scores() -> Vec<Head<'static>> {
    let columns = COLUMNS.iter().map(|(title, metric, _)| Head::metric(title, metric));
    std::iter::once(Head::plain("map")).chain(columns).collect()
}

/// The heads of all tables that are printed.
pub(super) fn heads(options: &ScoreOptions) -> Vec<Head<'static>> {
    let driven = driven::metrics().filter(|_| options.drives.plan_pairs > 0).map(|c| Head::metric(c.title, c.metric));
    scores().into_iter().chain(driven).chain(options.maps.get(1).map(|_| DIFFERENCE)).collect()
}

/// The differences from the first map.
const DIFFERENCE: Head<'static> = Head::plain("difference");

/// The table of drives.
fn driven(sheet: &Sheet, order: &SortOption) -> String {
    let heads: Vec<Head> = sheet.heads.iter().map(|head| Head::titled(head)).collect();
    let cells = |row: &Vec<Cell>| {
        let mut cells: Vec<String> = row.iter().map(|cell| cell.text.clone()).collect();
        cells[0] = short(&cells[0]);
        cells
    };
    let rows: Vec<Vec<String>> = sheet.rows.iter().map(cells).collect();
    format!("\n{}\n{}{}\n", sheet.caption, order.ranked(&heads, &rows), wrapped(&sheet.note, columns()).join("\n"))
}

/// Adds a paragraph in lines of the terminal's width, the second and later ones indented.
fn say(text: &mut String, paragraph: &str) {
    for (k, line) in wrapped(paragraph, columns() - 2).iter().enumerate() {
        let _ = writeln!(text, "{}{line}", if k > 0 { "  " } else { "" });
    }
}

/// How a map came into the truth's cells, and what it does not know.
fn facts(rows: &[Row], how: Resampling, assumed: bool, options: &ScoreOptions) -> String {
    let of = |metric| find(rows, "all", metric);
    let count = |metric| {
        of(metric).map_or(0, |row| (row.metric.value.unwrap_or(0.0) * row.metric.support as f64).round() as usize)
    };
    let cells = of("known").map_or(0, |row| row.metric.support);
    let place = if assumed { ", no place of its own: laid on the truth" } else { "" };
    let (unknown, outside) = (cells - count("known"), count("outside"));
    let beyond = if outside > 0 { format!(", {outside} of them beyond its border") } else { String::new() };
    let treated = match options.unknown {
        _ if unknown == 0 => String::new(),
        Unknown::Prior => format!("; they count as occupied with probability {}", options.prior),
        Unknown::Skip => "; they are not scored".to_owned(),
        Unknown::Occupied => "; they count as occupied".to_owned(),
    };
    format!("{}{place}; nothing known of {unknown} of the {cells} cells of the truth{beyond}{treated}", worded(how))
}

/// A way of resampling in words.
pub(super) fn worded(how: Resampling) -> String {
    match how {
        Resampling::CellByCell => "cell by cell".to_owned(),
        Resampling::Nearest => "resampled, the map's cell about the centre of the truth's".to_owned(),
        Resampling::Points { points, finer } => {
            let of = match finer {
                score::Finer::Mean => "mean",
                score::Finer::Greatest => "greatest",
            };
            format!("resampled, {of} of {points} x {points} points a cell of the truth")
        }
    }
}

fn find<'a>(rows: &'a [Row], region: &str, metric: &str) -> Option<&'a Row> {
    rows.iter().find(|row| row.region == region && row.metric.name == metric)
}

fn row(name: &str, rows: &[Row], region: &str) -> Vec<String> {
    let value = |(_, metric, decimals): &(&str, &str, usize)| {
        let value = find(rows, region, metric).and_then(|row| row.metric.value);
        value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
    };
    [short(name)].into_iter().chain(COLUMNS.iter().map(value)).collect()
}

/// The end of a long name.
fn short(name: &str) -> String {
    let letters: Vec<char> = name.chars().collect();
    if letters.len() <= NAME {
        name.to_owned()
    } else {
        "…".to_owned() + &String::from_iter(&letters[letters.len() - NAME + 1..])
    }
}

/// Maps minus the first map.
fn differences(differences: &[Difference], baseline: &str, region: &str, tiles: &Tiles, order: &SortOption) -> String {
    let here = differences.iter().filter(|row| row.region == region && DIFFERENCES.contains(&row.metric));
    let row = |row: &Difference| {
        let (name, decimals) = criterion(row.metric).map_or((row.metric, 3), |c| (c.title, c.decimals));
        let signed = |value: f64| format!("{:+.decimals$}", value + 0.0);
        let interval = row.interval.map(|i| format!("{} .. {}", signed(i.low), signed(i.high)));
        vec![
            short(&row.map),
            name.to_owned(),
            row.difference.map_or_else(|| "-".to_owned(), signed),
            interval.unwrap_or_else(|| "-".to_owned()),
            row.verdict().unwrap_or("-").to_owned(),
        ]
    };
    let rows: Vec<Vec<String>> = here.map(row).collect();
    let number = differences.iter().find(|row| row.region == region).map_or(0, |row| row.tiles);
    let mut text = format!("\n{}: minus {baseline}\n", title(region));
    text += &order.ranked(&["map", "metric", DIFFERENCE.title, "95 % interval", ""].map(Head::plain), &rows);
    let note = format!(
        "Intervals: a bootstrap of {number} tiles of {:.2} m x {:.2} m of this one world.",
        tiles.side_m(),
        tiles.side_m()
    );
    text + &wrapped(&note, columns()).join("\n") + "\n"
}
