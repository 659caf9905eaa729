//! Pictures of a sweep's table: metrics against the parameter that was varied first.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use plotters::prelude::SeriesLabelPosition;

use super::TABLE;
use super::parameters::PARAMETERS;
use crate::failure::Failure;
use crate::figures::chart::{self, Axis, Chart, Mark, Series};
use crate::figures::ink::LINES;
use crate::staging::Temporary;

/// Columns that are drawn, with their titles and regions.
const PANELS: [(&str, &str, &str); 3] = [
    ("log_loss", "observable", "log loss, all that could be seen (nats/cell)"),
    ("brier", "observable", "Brier score, all that could be seen"),
    ("log_loss", "visible", "free space: geometric mean of P(free)"),
];

/// Marks of the values of the second parameter.
const MARKS: [Mark; 4] = [Mark::Ring, Mark::Triangle, Mark::Cross, Mark::Plus];

/// A table in memory: what was varied, and means by mapper and values.
struct Means {
    /// The parameter along the axis, and the one that makes lines.
    axes: [Option<String>; 2],
    /// Sums over worlds, and their numbers.
    values: BTreeMap<Key, (f64, u64)>,
    /// All mappers.
    mappers: BTreeSet<String>,
}

/// What is drawn as one point.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    metric: &'static str,
    region: String,
    mapper: String,
    /// Values of what makes lines.
    line: String,
    /// The value along the axis.
    x: String,
}

/// Draws a picture for each mapper and gives their names.
///
/// # Errors
/// No table; a drawing that fails; I/O.
pub fn draw(folder: &Path) -> Result<Vec<String>, Failure> {
    let means = read(&folder.join(TABLE))?;
    let Some(first) = &means.axes[0] else { return Ok(Vec::new()) };
    let mut names = Vec::new();
    for mapper in &means.mappers {
        let charts: Vec<Chart> = PANELS.iter().filter_map(|panel| means.chart(first, mapper, panel)).collect();
        if charts.is_empty() {
            continue;
        }
        let picture = chart::draw(&charts, (640, 520))?;
        let name = format!("{mapper}.png");
        let target = folder.join(&name);
        let partial = Temporary::beside(&target);
        let written = std::fs::write(partial.path(), picture).and_then(|()| partial.publish(&target));
        written.map_err(|e| Failure::write(&target, &e))?;
        names.push(name);
    }
    Ok(names)
}

impl Means {
    fn chart(&self, first: &str, mapper: &str, (metric, region, title): &(&str, &str, &str)) -> Option<Chart> {
        let mut lines: BTreeMap<String, Vec<(f64, f64)>> = BTreeMap::new();
        for (key, (sum, count)) in &self.values {
            if (key.metric, key.region.as_str(), key.mapper.as_str()) == (*metric, *region, mapper) {
                let mean = sum / *count as f64;
                let y = if *region == "visible" { libm::exp(-mean) } else { mean };
                lines.entry(key.line.clone()).or_default().push((key.x.parse().ok()?, y));
            }
        }
        let mut lines: Vec<(String, Vec<(f64, f64)>)> = lines.into_iter().collect();
        lines.sort_by(|a, b| numeric(&a.0).total_cmp(&numeric(&b.0)).then_with(|| a.0.cmp(&b.0)));
        lines.iter_mut().for_each(|(_, points)| points.sort_by(|a, b| a.0.total_cmp(&b.0)));
        let all = || lines.iter().flat_map(|(_, points)| points);
        let (least, most) = all().fold((f64::INFINITY, 0.0f64), |(a, b), (x, _)| (a.min(*x), b.max(*x)));
        let top = all().fold(0.0f64, |top, (_, y)| top.max(*y));
        if lines.is_empty() || most <= 0.0 || lines.iter().all(|(_, points)| points.len() < 2) {
            return None;
        }
        let label = label(first);
        let x = if least > 0.0 && most / least > 5.0 {
            Axis::logarithmic(&label, 0.9 * least..1.1 * most)
        } else {
            Axis::linear(&label, 0.0..1.05 * most)
        };
        let y = if *region == "visible" { 0.0..1.02 } else { 0.0..1.15 * top.max(1e-9) };
        let second = self.axes[1].as_deref().unwrap_or_default();
        let series = lines.iter().enumerate().map(|(k, (value, points))| Series {
            name: format!("{second} {value}").trim().to_owned(),
            points: points.iter().map(|(x, y)| (*x, Some(*y))).collect(),
            mark: MARKS[k / LINES.len() % MARKS.len()],
            colour: LINES[k % LINES.len()],
        });
        Some(Chart {
            title: (*title).to_owned(),
            x,
            y: Axis::linear("", y),
            bands: Vec::new(),
            series: series.collect(),
            legend: SeriesLabelPosition::LowerRight,
        })
    }
}

fn numeric(text: &str) -> f64 {
    text.split_whitespace().next().and_then(|word| word.parse().ok()).unwrap_or(f64::INFINITY)
}

fn label(key: &str) -> String {
    match key {
        "grid" => "cell size, m".to_owned(),
        "disparity_sigma" | "believed_sigma" => format!("{}, px", key.replace('_', " ")),
        "assumed_length" => "assumed length of obstacles, m".to_owned(),
        _ => key.replace('_', " "),
    }
}

/// Reads a table row by row; what is kept are sums, so that it may be long.
fn read(path: &Path) -> Result<Means, Failure> {
    let refuse = |what: &dyn std::fmt::Display| {
        Failure::BadInput(format!("{}: {what}; make it with `sweep merge`", path.display()))
    };
    let varied = varied(path).map_err(|e| refuse(&e))?;
    let mut means = Means { axes: [None, None], values: BTreeMap::new(), mappers: BTreeSet::new() };
    // The axis is a number; of several the one with most values. The rest makes lines.
    let numbers = |values: &BTreeSet<String>| values.iter().all(|value| value.parse::<f64>().is_ok());
    let first = varied.iter().rev().filter(|(_, values)| numbers(values)).max_by_key(|(key, _)| preference(key));
    let Some((first, _)) = first else { return Ok(means) };
    let rest: Vec<&String> = varied.iter().map(|(key, _)| key).filter(|key| *key != first).collect();
    means.axes = [
        Some(first.clone()),
        Some(rest.iter().map(|key| key.replace('_', " ")).collect::<Vec<_>>().join(", "))
            .filter(|name| !name.is_empty()),
    ];
    let mut reader = csv::Reader::from_path(path).map_err(|e| refuse(&e))?;
    let heads = reader.headers().map_err(|e| refuse(&e))?.clone();
    let column =
        |name: &str| heads.iter().position(|head| head == name).ok_or_else(|| refuse(&format!("no column {name}")));
    let (mapper, region, x) = (column("mapper")?, column("region")?, column(first)?);
    let lines: Vec<usize> = rest.iter().map(|key| column(key)).collect::<Result<_, _>>()?;
    let metrics = [("log_loss", column("log_loss")?), ("brier", column("brier")?)];
    for row in reader.records() {
        let row = row.map_err(|e| refuse(&e))?;
        means.mappers.insert(row[mapper].to_owned());
        let line = lines.iter().map(|column| row[*column].to_owned()).collect::<Vec<_>>().join(", ");
        for (metric, column) in metrics {
            let Ok(value) = row[column].parse::<f64>() else { continue };
            let key = Key {
                metric,
                region: row[region].to_owned(),
                mapper: row[mapper].to_owned(),
                line: line.clone(),
                x: row[x].to_owned(),
            };
            let sum = means.values.entry(key).or_insert((0.0, 0));
            *sum = (sum.0 + value, sum.1 + 1);
        }
    }
    Ok(means)
}

/// What is best drawn along the axis.
fn preference(key: &str) -> usize {
    [
        "correlation",
        "scans",
        "believed_sigma",
        "disparity_sigma",
        "correct_match",
        "size_factor",
        "assumed_length",
        "grid",
    ]
    .iter()
    .position(|known| *known == key)
    .map_or(0, |at| at + 1)
}

/// The parameters of a table with more than one value, in the order of its columns.
fn varied(path: &Path) -> Result<Vec<(String, BTreeSet<String>)>, csv::Error> {
    let mut reader = csv::Reader::from_path(path)?;
    let heads = reader.headers()?.clone();
    let known = |head: &str| PARAMETERS.iter().any(|parameter| parameter.key == head);
    let columns: Vec<usize> = (0..heads.len()).filter(|k| known(&heads[*k])).collect();
    let mut values: Vec<(String, BTreeSet<String>)> =
        columns.iter().map(|k| (heads[*k].to_owned(), BTreeSet::new())).collect();
    for row in reader.records() {
        let row = row?;
        for (column, (_, values)) in columns.iter().zip(&mut values) {
            if !values.contains(&row[*column]) {
                values.insert(row[*column].to_owned());
            }
        }
    }
    values.retain(|(_, values)| values.len() > 1);
    Ok(values)
}
