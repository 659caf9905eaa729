//! Pictures of a sweep's table: metrics against one parameter, with a line for each value of the other numbers and a
//! row for each of the words.

mod together;

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::parameters::{self, PARAMETERS};
use crate::failure::Failure;
use crate::figures::chart::{At, Axis, Chart, Series, sheet};
use crate::figures::style::{self, Style};
use crate::figures::{Drawing, Paper};
use crate::worlds::aligned::ALIGNED;
use crate::worlds::criteria::MOVING;
use crate::worlds::estimate::Moments;

/// Columns that are drawn, with their regions and titles.
const PANELS: [Panel; 7] = [
    error("log_loss", "observable", "Log loss", "log loss, nats/cell"),
    error("brier", "observable", "Brier score", "Brier score"),
    error("log_loss", ALIGNED, "Log loss, aligned", "log loss, nats/cell"),
    Panel {
        ordinate: Ordinate::Probability,
        ..error("log_loss", FREE, "How free free cells are", "mean probability of being free")
    },
    Panel {
        ordinate: Ordinate::Probability,
        ..error("harmonic_accuracy", "swept", "Static and dynamic accuracy", "harmonic mean, share of cells")
    },
    error("trail_area", "swept", "Trails", "trail area, m²"),
    error("lag_looks", "changed", "Lag after a change", "lag, looks"),
];

/// Columns of a sheet.
const ACROSS: usize = 3;

const fn error(metric: &'static str, region: &'static str, title: &'static str, unit: &'static str) -> Panel {
    Panel { metric, region, title, unit, ordinate: Ordinate::Error }
}

/// The region of free cells that rays crossed. Of its log loss, `exp(-x)` is drawn: the geometric mean of `P(free)`.
const FREE: &str = "visible";

/// What stands upwards.
#[derive(Clone, Copy)]
enum Ordinate {
    Error,
    Probability,
}

struct Panel {
    metric: &'static str,
    region: &'static str,
    title: &'static str,
    unit: &'static str,
    ordinate: Ordinate,
}

/// A table in memory.
struct Means {
    /// The parameter along the axis.
    axis: String,
    /// Names of the numbers that make lines.
    line: String,
    /// Sums over worlds, and their numbers; of bins of range and looks, over cells.
    values: BTreeMap<PointKey, Moments>,
    /// All mappers.
    mappers: BTreeSet<String>,
    /// All combinations of words.
    rows: BTreeSet<String>,
}

/// What is drawn as one point.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct PointKey {
    metric: &'static str,
    region: String,
    mapper: String,
    /// Values of the words that make rows of the sheet ...
    row: String,
    /// ... and of the numbers that make lines.
    line: String,
    /// The value along the axis.
    x: String,
}

/// The files of a mapper's sheets.
pub fn names(mapper: &str) -> [String; 2] {
    [format!("{mapper}.png"), format!("{mapper}-range-by-looks.png")]
}

/// The file of the sheet of all mappers.
pub fn name_of_all() -> String {
    together::NAME.to_owned()
}

/// Size of a chart.
const SIZE: (f64, f64) = (480.0, 430.0);

/// Draws the sheets of each mapper from a merged table, with the names of their files.
///
/// # Errors
/// No table; I/O.
pub fn draw(table: &Path, paper: &Paper) -> Result<Vec<(String, Drawing)>, Failure> {
    let Some(means) = read(table)? else { return Ok(Vec::new()) };
    let mut sheets = Vec::new();
    for mapper in &means.mappers {
        let kinds = [(means.charts(mapper), ACROSS, SIZE), (means.range_by_looks(mapper), 1, (700.0, 520.0))];
        for ((charts, columns, size), name) in kinds.into_iter().zip(names(mapper)) {
            if !charts.is_empty() {
                sheets.push((name, sheet(&charts, columns, size, paper)));
            }
        }
    }
    let all = means.together();
    if !all.is_empty() {
        sheets.push((name_of_all(), sheet(&all, together::PANELS.len(), SIZE, paper)));
    }
    Ok(sheets)
}

/// The mean over fewer cells than this says nothing.
const FEWEST_CELLS: f64 = 300.0;

/// A line before it has a style: its name, and its points in order of x.
type Line = (String, Vec<At>);

impl Means {
    fn charts(&self, mapper: &str) -> Vec<Chart> {
        let of = |row: &String| PANELS.iter().filter_map(|panel| self.chart(mapper, row, panel)).collect::<Vec<_>>();
        self.rows.iter().flat_map(of).collect()
    }

    fn chart(&self, mapper: &str, row: &str, panel: &Panel) -> Option<Chart> {
        let mut lines: BTreeMap<&str, Vec<At>> = BTreeMap::new();
        for (key, moments) in &self.values {
            let own = (key.metric, key.region.as_str(), key.mapper.as_str(), key.row.as_str());
            if own == (panel.metric, panel.region, mapper, row) {
                let mean = moments.estimate()?;
                let mean = if panel.region == FREE { mean.map(|loss| libm::exp(-loss)) } else { mean };
                let at = At { x: key.x.parse().ok()?, y: mean.value, interval: mean.interval };
                lines.entry(&key.line).or_default().push(at);
            }
        }
        let name = |value: &str| format!("{} {value}", self.line).trim().to_owned();
        let lines = lines.into_iter().map(|(value, points)| (name(value), points)).collect();
        let title = if row.is_empty() { panel.title.to_owned() } else { format!("{}: {row}", panel.title) };
        lined((title, panel.unit), along(&self.axis), lines, panel.ordinate, style::of_mappers(&[mapper])[0])
    }

    /// Log loss against range, a line for each number of looks.
    fn range_by_looks(&self, mapper: &str) -> Vec<Chart> {
        // Bins of several settings are of the same worlds: their mean has no interval of independent draws.
        let mut sums: BTreeMap<String, BTreeMap<String, (Moments, usize)>> = BTreeMap::new();
        for (key, moments) in self.values.iter().filter(|(key, _)| key.metric == "log_loss" && key.mapper == mapper) {
            let Some((range, looks)) = key.region.strip_prefix("range ").and_then(|rest| rest.split_once(" looks "))
            else {
                continue;
            };
            let bin = sums.entry(looks.to_owned()).or_default().entry(range.to_owned()).or_default();
            *bin = (bin.0.and(moments), bin.1 + 1);
        }
        let point = |(range, (moments, settings)): (&String, &(Moments, usize))| {
            let (from, to) = range.split_once('-').filter(|_| moments.count() >= FEWEST_CELLS)?;
            let (from, to): (f64, f64) = (from.parse().ok()?, to.parse().ok()?);
            let mean = moments.estimate()?;
            Some(At { x: 0.5 * (from + to), y: mean.value, interval: mean.interval.filter(|_| *settings == 1) })
        };
        let line = |(looks, ranges): (String, BTreeMap<String, (Moments, usize)>)| {
            (format!("looks {looks}"), ranges.iter().filter_map(point).collect())
        };
        let lines = sums.into_iter().map(line).collect();
        let (title, unit) = ("Log loss by number of looks", "log loss, nats/cell");
        let x = Along { label: "range from which a cell was seen best, m".to_owned(), all: None };
        lined((title.to_owned(), unit), x, lines, Ordinate::Error, Style::numbered(0)).into_iter().collect()
    }
}

/// What a parameter is called beside a chart.
fn named(key: &str) -> String {
    match key {
        "grid" => "cell size".to_owned(),
        "max_range" => "readings used up to".to_owned(),
        "assumed_length" => "assumed length of obstacles".to_owned(),
        "people_per_100_m2" => "people per 100 m²".to_owned(),
        "people_speed_m_s" => "speed of people".to_owned(),
        _ => key.replace('_', " "),
    }
}

/// What a parameter is called in the name of a line, where there is less room.
fn line_of(key: &str) -> String {
    if key.starts_with("people") { named(key) } else { key.replace('_', " ") }
}

/// What stands along the axis.
struct Along {
    /// Quantity and unit.
    label: String,
    /// From here on a value stands for everything.
    all: Option<f64>,
}

/// A chart of lines, in the order of the numbers in their names; none where there is no line to draw.
fn lined(titles: (String, &str), along: Along, mut lines: Vec<Line>, kind: Ordinate, alone: Style) -> Option<Chart> {
    lines.retain(|(_, points)| points.len() > 1);
    lines.sort_by(|a, b| numbers(&a.0).partial_cmp(&numbers(&b.0)).unwrap_or(Ordering::Equal));
    let only = lines.len() == 1;
    styled(titles, along, lines, kind, |k| if only { alone } else { Style::numbered(k) })
}

/// A chart of lines in their order, each in its style; none where there is no line to draw.
fn styled(
    (title, unit): (String, &str),
    along: Along,
    mut lines: Vec<Line>,
    kind: Ordinate,
    style: impl Fn(usize) -> Style,
) -> Option<Chart> {
    lines.iter_mut().for_each(|(_, points)| points.sort_by(|a, b| a.x.total_cmp(&b.x)));
    let all = || lines.iter().flat_map(|(_, points)| points);
    let ends = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
    };
    let on_scale = |at: &&At| along.all.is_none_or(|from| at.x < from);
    let (left, right) = ends(&mut all().filter(on_scale).map(|at| at.x));
    let (bottom, top) =
        ends(&mut all().flat_map(|at| [Some(at.y), at.interval.map(|i| i.0), at.interval.map(|i| i.1)]).flatten());
    if lines.is_empty() || right <= left {
        return None;
    }
    let x = if left > 0.0 && right / left > 5.0 {
        Axis::logarithmic(&along.label, left / 1.1..1.1 * right)
    } else {
        let margin = 0.05 * (right - left);
        Axis::linear(&along.label, left - margin..right + margin)
    };
    let x = Axis {
        apart: along.all.filter(|from| all().any(|at| at.x >= *from)).map(|from| (from, "all".to_owned())),
        ..x
    };
    let y = match kind {
        Ordinate::Probability => (1.0 - 1.15 * (1.0 - bottom)).max(0.0)..1.0,
        Ordinate::Error => 0.0..1.08 * top.max(1e-9),
    };
    let series = lines.into_iter().enumerate().map(|(k, (name, points))| Series { name, points, style: style(k) });
    Some(Chart::new(&title, x, Axis::linear(unit, y), series.collect()))
}

/// The numbers in a text, to sort by.
fn numbers(text: &str) -> Vec<f64> {
    text.split([' ', ',', '-']).filter_map(|word| word.parse().ok()).collect()
}

/// A parameter with its unit.
fn along(key: &str) -> Along {
    let name = named(key);
    let unit = parameters::parameter(key).and_then(unit).map_or_else(String::new, |unit| format!(", {unit}"));
    Along { label: name + &unit, all: (key == "max_range").then_some(parameters::ALL_READINGS_M) }
}

/// The unit of a parameter, which stands behind what is said about it.
fn unit(parameter: &parameters::Parameter) -> Option<&'static str> {
    const UNITS: [&str; 8] = ["m", "px", "px m", "m/s", "s", "degrees per s", "degrees", "rad"];
    let pieces = parameter.about.split([':', ';']);
    let behind = pieces.filter_map(|piece| Some(piece.rsplit_once(", ")?.1.trim()));
    behind.filter_map(|unit| UNITS.into_iter().find(|known| *known == unit)).next()
}

/// Reads a table row by row; what is kept are sums, so that it may be long. None where no number was varied.
fn read(path: &Path) -> Result<Option<Means>, Failure> {
    let refuse = |what: &dyn std::fmt::Display| {
        Failure::BadInput(format!("{}: {what}; make it with `sweep merge`", path.display()))
    };
    let varied = varied(path).map_err(|e| refuse(&e))?;
    let is_number = |values: &BTreeSet<String>| values.iter().all(|value| value.parse::<f64>().is_ok());
    let of_numbers =
        |number: bool| varied.iter().filter(move |(_, values)| is_number(values) == number).map(|(key, _)| key);
    let Some(axis) = of_numbers(true).max_by_key(|key| preference(key)) else { return Ok(None) };
    let follow = followers(path, axis).map_err(|e| refuse(&e))?;
    let lines: Vec<&String> = of_numbers(true).filter(|key| *key != axis && !follow.contains(*key)).collect();
    let words: Vec<&String> = of_numbers(false).collect();
    let mut means = Means {
        axis: axis.clone(),
        line: lines.iter().map(|key| line_of(key)).collect::<Vec<_>>().join(", "),
        values: BTreeMap::new(),
        mappers: BTreeSet::new(),
        rows: BTreeSet::new(),
    };
    let mut reader = csv::Reader::from_path(path).map_err(|e| refuse(&e))?;
    let heads = reader.headers().map_err(|e| refuse(&e))?.clone();
    let column =
        |name: &str| heads.iter().position(|head| head == name).ok_or_else(|| refuse(&format!("no column {name}")));
    let columns = |keys: &[&String]| keys.iter().map(|key| column(key)).collect::<Result<Vec<usize>, _>>();
    let (mapper, region, x, lines, words) =
        (column("mapper")?, column("region")?, column(axis)?, columns(&lines)?, columns(&words)?);
    let mut metrics = vec![("log_loss", column("log_loss")?), ("brier", column("brier")?)];
    metrics.extend(heads.iter().position(|head| head == "retention").map(|column| ("retention", column)));
    // Only sweeps over worlds that move have them.
    let of_movement = MOVING.iter().map(|criterion| criterion.metric);
    metrics.extend(of_movement.filter_map(|metric| Some((metric, heads.iter().position(|head| head == metric)?))));
    let cells = column("cells")?;
    for row in reader.records() {
        let row = row.map_err(|e| refuse(&e))?;
        let joined = |columns: &[usize]| columns.iter().map(|at| row[*at].to_owned()).collect::<Vec<_>>().join(", ");
        for &(metric, column) in &metrics {
            let Ok(value) = row[column].parse::<f64>() else { continue };
            let key = PointKey {
                metric,
                region: row[region].to_owned(),
                mapper: row[mapper].to_owned(),
                row: joined(&words),
                line: joined(&lines),
                x: row[x].to_owned(),
            };
            means.mappers.insert(key.mapper.clone());
            means.rows.insert(key.row.clone());
            let weight = if key.region.starts_with("range ") { row[cells].parse().unwrap_or(0.0) } else { 1.0 };
            means.values.entry(key).or_default().add(weight * value, weight);
        }
    }
    Ok(Some(means))
}

/// What is best drawn along the axis, the higher the better.
fn preference(key: &str) -> Option<usize> {
    const KNOWN: [&str; 10] = [
        "correlation",
        "scans",
        "believed_sigma",
        "disparity_sigma",
        "correct_match",
        "size_factor",
        "assumed_length",
        "people_per_100_m2",
        "grid",
        "pose_sigma_m",
    ];
    KNOWN.iter().position(|known| *known == key)
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

/// Parameters that have one value for each of the axis: they were paired with it.
fn followers(path: &Path, axis: &str) -> Result<BTreeSet<String>, csv::Error> {
    let mut reader = csv::Reader::from_path(path)?;
    let heads = reader.headers()?.clone();
    let Some(x) = heads.iter().position(|head| head == axis) else { return Ok(BTreeSet::new()) };
    let mut values: BTreeMap<usize, BTreeMap<String, String>> = (0..heads.len())
        .filter(|k| *k != x && parameters::parameter(&heads[*k]).is_some())
        .map(|k| (k, BTreeMap::new()))
        .collect();
    for row in reader.records() {
        let row = row?;
        values.retain(|k, of| *of.entry(row[x].to_owned()).or_insert_with(|| row[*k].to_owned()) == row[*k]);
    }
    Ok(values.into_keys().map(|k| heads[k].to_owned()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A table with the columns that are read, of two cell sizes.
    fn drawn(rows: &str) -> Result<(Vec<String>, Vec<Drawing>), Failure> {
        let folder = tempfile::tempdir().expect("temporary folder");
        let text = format!("id,scene,seed,grid,mapper,region,cells,log_loss,brier,error\n{rows}");
        let table = folder.path().join("table.csv");
        std::fs::write(&table, text).expect("writable");
        Ok(draw(&table, &Paper::default())?.into_iter().unzip())
    }

    #[test]
    fn a_sheet_for_each_mapper_that_has_values() {
        let rows = "0,a,1,0.1,prior,observable,9,0.5,0.2,\n1,a,1,0.2,prior,observable,9,0.6,0.3,\n\
                    2,a,1,0.2,visibility,,,,,lost\n";
        let (names, pictures) = drawn(rows).expect("drawn");
        assert_eq!(names, ["prior.png"]);
        assert!(pictures[0].items.len() > 40);
    }

    #[test]
    fn the_mean_over_worlds_is_of_those_with_a_value() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("table.csv");
        let text = "grid,mapper,region,cells,log_loss,brier,error\n0.1,prior,observable,9,0.5,0.2,\n\
                    0.1,prior,observable,9,0.7,0.4,\n0.1,prior,,,,,lost\n0.2,prior,observable,9,0.9,,\n";
        std::fs::write(&path, text).expect("writable");
        let means = read(&path).expect("read").expect("a number was varied");
        let found = means.values.iter().filter_map(|(k, v)| Some((k.metric, k.x.as_str(), v.estimate()?)));
        let found: Vec<_> =
            found.map(|(metric, x, e)| (metric, x, (e.value * 1e9).round() / 1e9, e.interval.is_some())).collect();
        let expected = [("brier", "0.1", 0.3, true), ("log_loss", "0.1", 0.6, true), ("log_loss", "0.2", 0.9, false)];
        assert_eq!(format!("{found:?}"), format!("{expected:?}"));
    }

    #[test]
    fn every_number_has_its_unit_and_all_readings_are_no_range() {
        let labels = ["grid", "max_range", "disparity_sigma", "assumed_length", "quantisation", "correlation"]
            .map(|key| along(key).label);
        let expected = [
            "cell size, m",
            "readings used up to, m",
            "disparity sigma, px",
            "assumed length of obstacles, m",
            "quantisation, px",
            "correlation",
        ];
        assert_eq!(labels, expected);
        let lines =
            vec![("visibility".to_owned(), [1.0, 2.0, 1000.0].map(|x| At { x, y: 0.1, interval: None }).to_vec())];
        let chart =
            lined((String::new(), ""), along("max_range"), lines, Ordinate::Error, Style::numbered(0)).expect("drawn");
        assert!(chart.x.range.end < 3.0);
        assert_eq!(chart.x.apart, Some((1000.0, "all".to_owned())));
    }

    #[test]
    fn no_picture_where_nothing_varies_or_all_failed() {
        assert!(drawn("0,a,1,0.1,prior,observable,9,0.5,0.2,\n").expect("read").0.is_empty());
        assert!(drawn("0,a,1,0.1,prior,,,,,lost\n1,a,1,0.2,prior,,,,,lost\n").expect("read").0.is_empty());
        assert!(drawn("").expect("read").0.is_empty());
    }
}
