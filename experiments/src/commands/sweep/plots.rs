//! Pictures of a sweep's table: metrics against one parameter, with a line for each value of the other numbers and a
//! row for each of the words.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use plotters::prelude::SeriesLabelPosition;

use super::parameters::PARAMETERS;
use crate::failure::Failure;
use crate::figures::chart::{self, Axis, Chart, Mark, Series};
use crate::figures::ink::LINES;

/// Columns that are drawn, with their regions and titles.
const PANELS: [Panel; 3] = [
    Panel { metric: "log_loss", region: "observable", title: "log loss, nats per cell" },
    Panel { metric: "brier", region: "observable", title: "Brier score" },
    Panel { metric: "log_loss", region: FREE, title: "probability that free cells are free" },
];

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
}

/// A table in memory.
struct Means {
    /// The parameter along the axis.
    axis: String,
    /// Names of the numbers that make lines.
    line: String,
    /// Sums over worlds, and their numbers; of bins of range and looks, over cells.
    values: BTreeMap<PointKey, (f64, f64)>,
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

/// Draws the sheets of each mapper from a merged table: names of files and PNG.
///
/// # Errors
/// No table; a drawing that fails; I/O.
pub fn draw(table: &Path) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let Some(means) = read(table)? else { return Ok(Vec::new()) };
    let mut sheets = Vec::new();
    for mapper in &means.mappers {
        let kinds = [(means.charts(mapper), PANELS.len()), (means.range_by_looks(mapper), 1)];
        for ((charts, columns), name) in kinds.into_iter().zip(names(mapper)) {
            if !charts.is_empty() {
                sheets.push((name, chart::sheet(&charts, columns.min(charts.len()), (640, 520))?));
            }
        }
    }
    Ok(sheets)
}

/// The mean over fewer cells than this says nothing.
const FEWEST_CELLS: f64 = 300.0;

/// Points of a line, in order of x.
type Points = Vec<(f64, Option<f64>)>;

impl Means {
    fn charts(&self, mapper: &str) -> Vec<Chart> {
        let of = |row: &String| PANELS.iter().filter_map(|panel| self.chart(mapper, row, panel)).collect::<Vec<_>>();
        self.rows.iter().flat_map(of).collect()
    }

    fn chart(&self, mapper: &str, row: &str, panel: &Panel) -> Option<Chart> {
        let mut lines: BTreeMap<&str, Points> = BTreeMap::new();
        for (key, (sum, count)) in &self.values {
            let own = (key.metric, key.region.as_str(), key.mapper.as_str(), key.row.as_str());
            if own == (panel.metric, panel.region, mapper, row) {
                let mean = sum / count;
                let y = if panel.region == FREE { libm::exp(-mean) } else { mean };
                lines.entry(&key.line).or_default().push((key.x.parse().ok()?, Some(y)));
            }
        }
        // The legend stands where there is room for it, in the last panel.
        let name = |value: &str| if panel.region == FREE { format!("{} {value}", self.line) } else { value.to_owned() };
        let lines = lines.into_iter().map(|(value, points)| (name(value).trim().to_owned(), points));
        let kind = if panel.region == FREE { Ordinate::Probability } else { Ordinate::Error };
        let title = if row.is_empty() { panel.title.to_owned() } else { format!("{}: {row}", panel.title) };
        let mut chart = lined(title, &label(&self.axis), lines.collect(), kind)?;
        if panel.region != FREE {
            chart.series.iter_mut().for_each(|series| series.name.clear());
        }
        Some(chart)
    }

    /// Log loss against range, a line for each number of looks.
    fn range_by_looks(&self, mapper: &str) -> Vec<Chart> {
        let mut sums: BTreeMap<String, BTreeMap<String, (f64, f64)>> = BTreeMap::new();
        for (key, (sum, count)) in
            self.values.iter().filter(|(key, _)| key.metric == "log_loss" && key.mapper == mapper)
        {
            let Some((range, looks)) = key.region.strip_prefix("range ").and_then(|rest| rest.split_once(" looks "))
            else {
                continue;
            };
            let bin = sums.entry(looks.to_owned()).or_default().entry(range.to_owned()).or_default();
            *bin = (bin.0 + sum, bin.1 + count);
        }
        let point = |(range, (sum, count)): (&String, &(f64, f64))| {
            let (from, to) = range.split_once('-').filter(|_| *count >= FEWEST_CELLS)?;
            let from: f64 = from.parse().ok()?;
            Some((0.5 * (from + to.parse().unwrap_or(1.5 * from)), Some(sum / count)))
        };
        let line = |(looks, ranges): (String, BTreeMap<String, (f64, f64)>)| {
            (format!("looks {looks}"), ranges.iter().filter_map(point).collect())
        };
        let lines = sums.into_iter().map(line).collect();
        lined(
            "log loss by number of looks, nats per cell".to_owned(),
            "range from which a cell was seen best, m",
            lines,
            Ordinate::Error,
        )
        .into_iter()
        .collect()
    }
}

/// A chart of lines, in the order of the numbers in their names; none where there is no line to draw.
fn lined(title: String, x_label: &str, mut lines: Vec<(String, Points)>, kind: Ordinate) -> Option<Chart> {
    lines.retain(|(_, points)| points.len() > 1);
    lines.sort_by(|a, b| numbers(&a.0).partial_cmp(&numbers(&b.0)).unwrap_or(Ordering::Equal));
    lines.iter_mut().for_each(|(_, points)| points.sort_by(|a, b| a.0.total_cmp(&b.0)));
    let all = || lines.iter().flat_map(|(_, points)| points);
    let ends = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
    };
    let (left, right) = ends(&mut all().map(|(x, _)| *x));
    let (bottom, top) = ends(&mut all().filter_map(|(_, y)| *y));
    if lines.is_empty() || right <= left {
        return None;
    }
    let x = if left > 0.0 && right / left > 10.0 {
        Axis::logarithmic(x_label, 0.9 * left..1.1 * right)
    } else {
        let margin = 0.05 * (right - left);
        Axis::linear(x_label, left - margin..right + margin)
    };
    // A probability near 1 is seen from 1, with room for the legend below; an error from 0.
    let (y, legend) = match kind {
        Ordinate::Probability => ((1.0 - 2.5 * (1.0 - bottom)).max(0.0)..1.0, SeriesLabelPosition::LowerLeft),
        Ordinate::Error => (0.0..1.1 * top.max(1e-9), SeriesLabelPosition::UpperLeft),
    };
    let series = lines.into_iter().enumerate().map(|(k, (name, points))| Series {
        name,
        points,
        mark: if k < LINES.len() { Mark::Ring } else { Mark::Triangle },
        colour: LINES[k % LINES.len()],
    });
    Some(Chart { title, x, y: Axis::linear("", y), bands: Vec::new(), series: series.collect(), legend })
}

/// The numbers in a text, to sort by.
fn numbers(text: &str) -> Vec<f64> {
    text.split([' ', ',', '-']).filter_map(|word| word.parse().ok()).collect()
}

fn label(key: &str) -> String {
    match key {
        "grid" => "cell size, m".to_owned(),
        "disparity_sigma" | "believed_sigma" => format!("{}, px", key.replace('_', " ")),
        "assumed_length" => "assumed length of obstacles, m".to_owned(),
        _ => key.replace('_', " "),
    }
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
    let lines: Vec<&String> = of_numbers(true).filter(|key| *key != axis).collect();
    let words: Vec<&String> = of_numbers(false).collect();
    let mut means = Means {
        axis: axis.clone(),
        line: lines.iter().map(|key| key.replace('_', " ")).collect::<Vec<_>>().join(", "),
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
    let metrics = [("log_loss", column("log_loss")?), ("brier", column("brier")?)];
    let cells = column("cells")?;
    for row in reader.records() {
        let row = row.map_err(|e| refuse(&e))?;
        let joined = |columns: &[usize]| columns.iter().map(|at| row[*at].to_owned()).collect::<Vec<_>>().join(", ");
        for (metric, column) in metrics {
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
            let sum = means.values.entry(key).or_insert((0.0, 0.0));
            *sum = (sum.0 + weight * value, sum.1 + weight);
        }
    }
    Ok(Some(means))
}

/// What is best drawn along the axis, the higher the better.
fn preference(key: &str) -> Option<usize> {
    const KNOWN: [&str; 8] = [
        "correlation",
        "scans",
        "believed_sigma",
        "disparity_sigma",
        "correct_match",
        "size_factor",
        "assumed_length",
        "grid",
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A table with the columns that are read, of two cell sizes.
    fn drawn(rows: &str) -> Result<(Vec<String>, Vec<Vec<u8>>), Failure> {
        let folder = tempfile::tempdir().expect("temporary folder");
        let text = format!("id,scene,seed,grid,mapper,region,cells,log_loss,brier,error\n{rows}");
        let table = folder.path().join("table.csv");
        std::fs::write(&table, text).expect("writable");
        Ok(draw(&table)?.into_iter().unzip())
    }

    #[test]
    fn a_sheet_for_each_mapper_that_has_values() {
        let rows = "0,a,1,0.1,prior,observable,9,0.5,0.2,\n1,a,1,0.2,prior,observable,9,0.6,0.3,\n\
                    2,a,1,0.2,visibility,,,,,lost\n";
        let (names, pictures) = drawn(rows).expect("drawn");
        assert_eq!(names, ["prior.png"]);
        assert!(pictures[0].starts_with(b"\x89PNG"));
    }

    #[test]
    fn the_mean_over_worlds_is_of_those_with_a_value() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("table.csv");
        let text = "grid,mapper,region,cells,log_loss,brier,error\n0.1,prior,observable,9,0.5,0.2,\n\
                    0.1,prior,observable,9,0.7,0.4,\n0.1,prior,,,,,lost\n0.2,prior,observable,9,0.9,,\n";
        std::fs::write(&path, text).expect("writable");
        let means = read(&path).expect("read").expect("a number was varied");
        let sums: Vec<_> = means.values.iter().map(|(k, v)| (k.metric, k.x.as_str(), *v)).collect();
        assert_eq!(
            format!("{sums:?}"),
            r#"[("brier", "0.1", (0.6000000000000001, 2.0)), ("log_loss", "0.1", (1.2, 2.0)), ("log_loss", "0.2", (0.9, 1.0))]"#
        );
    }

    #[test]
    fn no_picture_where_nothing_varies_or_all_failed() {
        assert!(drawn("0,a,1,0.1,prior,observable,9,0.5,0.2,\n").expect("read").0.is_empty());
        assert!(drawn("0,a,1,0.1,prior,,,,,lost\n1,a,1,0.2,prior,,,,,lost\n").expect("read").0.is_empty());
        assert!(drawn("").expect("read").0.is_empty());
    }
}
