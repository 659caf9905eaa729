//! The page, from what the folder holds: the record, the tables, the pictures.

use std::path::Path;

use grid::GridSpec;
use serde::Deserialize;
use serde_json::Value;

use super::driven;
use super::figures::CAPTIONS;
use super::outputs::VIEWER;
use super::text::{COLUMNS, title};
use crate::failure::Failure;
use crate::page::{self, Cell, Folder, Page, Part, Picture, Section, Sheet, command_line};

/// Tables, as their files hold them.
#[derive(Default)]
pub(super) struct Tables {
    /// `metrics.csv`.
    pub(super) metrics: Vec<u8>,
    /// `differences.csv`, of several maps.
    pub(super) differences: Option<Vec<u8>>,
    /// `profiles.csv`, where there were scans.
    pub(super) profiles: Option<Vec<u8>>,
}

/// What the page needs of the record.
#[derive(Deserialize)]
struct Made {
    configuration: Configuration,
    grid: Lying,
    truth: Cells,
    shown: Vec<String>,
    /// What was driven, in words; nothing where nothing was.
    driven: Option<String>,
}

#[derive(Deserialize)]
struct Lying {
    spec: GridSpec,
}

#[derive(Deserialize)]
struct Configuration {
    truth: String,
}

#[derive(Deserialize)]
struct Cells {
    free: usize,
    occupied: usize,
    unknown: usize,
}

/// A row of `metrics.csv`.
#[derive(Deserialize)]
struct Metric {
    map: String,
    region: String,
    metric: String,
    value: Option<f64>,
}

/// A row of `profiles.csv`.
#[derive(Deserialize)]
struct Bin {
    map: String,
    covariate: String,
    from: f64,
    to: Option<f64>,
    cells: usize,
    log_loss: Option<f64>,
}

const LEAD: &str = "Maps of any maker against the truth, on the same cells.";
const SCORES: &str = "Log loss, Brier score, calibration error (ece), phantom and missed area and collisions are better when lower, the others when higher; a dash \
    is a metric that is not defined there. Differences are over the cells that both maps are scored on; their intervals are 95 % by a bootstrap of \
    tiles of this one world, and say nothing of other worlds.";

/// The page of a folder that `score` left, made anew from its tables and pictures; no map is read again.
///
/// # Errors
/// A folder that `score` did not leave, or whose tables somebody has changed.
pub fn renewed_page(folder: &Folder, record: &Value) -> Result<String, Failure> {
    let listed = |name: &str| record["files"].as_array().into_iter().flatten().any(|file| file == name);
    let table = |name: &str| listed(name).then(|| folder.proved(name)).transpose();
    let tables = Tables {
        metrics: folder.proved("metrics.csv")?,
        differences: table("differences.csv")?,
        profiles: table("profiles.csv")?,
    };
    let made: Made = folder.understand(record)?;
    let viewed = table(VIEWER)?.map(String::from_utf8).transpose();
    let viewed = viewed.map_err(|error| folder.refuse(VIEWER, &format!("is no text: {error}")))?;
    laid(&made, record, &tables, folder.pictures(record, &CAPTIONS)?, viewed)
        .map_err(|error| folder.refuse("metrics.csv", &format!("is no table of 'score': {error}")))
        .and_then(|page| page::page(&page))
}

/// The page of a run, whose record is `record` with the names of all files.
///
/// # Errors
/// A defect of ours.
pub(super) fn page(
    record: &Value,
    tables: &Tables,
    pictures: Vec<Picture>,
    viewed: Option<String>,
) -> Result<String, Failure> {
    let made = Made::deserialize(record).map_err(Failure::internal)?;
    page::page(&laid(&made, record, tables, pictures, viewed).map_err(Failure::internal)?)
}

/// What the page calls the truth.
pub(super) fn name_of(truth: &Path) -> String {
    truth.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn laid(
    made: &Made,
    record: &Value,
    tables: &Tables,
    pictures: Vec<Picture>,
    viewed: Option<String>,
) -> Result<Page, csv::Error> {
    let files = record["files"].as_array().into_iter().flatten().filter_map(Value::as_str);
    let name = name_of(Path::new(&made.configuration.truth));
    Ok(Page {
        title: format!("Maps against {name}"),
        lead: LEAD.to_owned(),
        facts: facts(made),
        claims: Vec::new(),
        viewed,
        sections: vec![
            section("Scores", SCORES, sheets(made, tables)?),
            section("Pictures", "", pictures.into_iter().map(Part::Picture).collect()),
        ],
        configuration: format!("{:#}", record["configuration"]),
        files: files.map(str::to_owned).collect(),
        command: command_line(record),
        ..Page::default()
    })
}

fn section(heading: &str, lead: &str, parts: Vec<Part>) -> Section {
    Section { heading: heading.to_owned(), lead: lead.to_owned(), parts }
}

fn facts(made: &Made) -> String {
    let Cells { free, occupied, unknown } = made.truth;
    let spec = &made.grid.spec;
    format!(
        "{} x {} cells of {} m: {free} free, {occupied} occupied, {unknown} not known",
        spec.width, spec.height, spec.cell_m
    )
}

/// What the terminal shows, and everything behind a line.
fn sheets(made: &Made, tables: &Tables) -> Result<Vec<Part>, csv::Error> {
    let rows: Vec<Metric> =
        csv::Reader::from_reader(tables.metrics.as_slice()).into_deserialize().collect::<Result<_, _>>()?;
    let mut maps: Vec<&str> = rows.iter().map(|row| row.map.as_str()).collect();
    maps.dedup();
    let mut parts: Vec<Part> =
        made.shown.iter().map(|region| Part::Sheet(region_sheet(&rows, &maps, region))).collect();
    if let Some(profiles) = &tables.profiles {
        parts.push(Part::Sheet(range_sheet(profiles, &maps)?));
    }
    let value = |map: &str, region: &str, metric: &str| {
        rows.iter().find(|row| row.map == map && row.region == region && row.metric == metric)?.value
    };
    parts.extend(made.driven.as_ref().map(|worded| Part::Sheet(driven::sheet(&maps, worded, &value))));
    let fold = |summary: String, table: &[u8]| {
        Ok::<_, csv::Error>(Part::Fold { summary, open: false, parts: vec![whole(table)?] })
    };
    if let Some(differences) = &tables.differences {
        parts.push(fold(format!("Differences from {}", maps.first().unwrap_or(&"")), differences)?);
    }
    parts.push(fold("Every metric of every region".to_owned(), &tables.metrics)?);
    Ok(parts)
}

/// The scores over a region: a row per map.
fn region_sheet(rows: &[Metric], maps: &[&str], region: &str) -> Sheet {
    let row = |map: &&str| -> Vec<Cell> {
        let cells = COLUMNS.iter().map(|(_, metric, decimals)| {
            let found = rows.iter().find(|row| row.map == *map && row.region == region && row.metric == *metric);
            number(found.and_then(|row| row.value), *decimals)
        });
        std::iter::once(Cell::from(*map)).chain(cells).collect()
    };
    Sheet {
        caption: title(region),
        note: "areas in m²".to_owned(),
        heads: std::iter::once("map").chain(COLUMNS.iter().map(|column| column.0)).map(str::to_owned).collect(),
        rows: maps.iter().map(row).collect(),
    }
}

/// Error against range: a row per map, a column per bin in which there are cells.
fn range_sheet(profiles: &[u8], maps: &[&str]) -> Result<Sheet, csv::Error> {
    let bins: Vec<Bin> = csv::Reader::from_reader(profiles).into_deserialize().collect::<Result<_, _>>()?;
    let of_range = |bin: &&Bin| bin.covariate == "range_m" && bin.cells > 0;
    let mut columns: Vec<(f64, Option<f64>)> = bins.iter().filter(of_range).map(|bin| (bin.from, bin.to)).collect();
    columns.sort_by(|a, b| a.0.total_cmp(&b.0));
    columns.dedup_by(|a, b| a.0.total_cmp(&b.0).is_eq());
    let head = |(from, to): &(f64, Option<f64>)| match to {
        Some(to) => format!("{from} to {to} m"),
        None => format!("from {from} m"),
    };
    let row = |map: &&str| -> Vec<Cell> {
        let cells = columns.iter().map(|(from, _)| {
            let of_map = |bin: &&Bin| bin.map == *map && bin.from.total_cmp(from).is_eq();
            number(bins.iter().filter(of_range).find(of_map).and_then(|bin| bin.log_loss), 3)
        });
        std::iter::once(Cell::from(*map)).chain(cells).collect()
    };
    Ok(Sheet {
        caption: "Log loss by the range from which a cell was seen best".to_owned(),
        note: "nats per cell, over all that could be seen".to_owned(),
        heads: std::iter::once("map".to_owned()).chain(columns.iter().map(head)).collect(),
        rows: maps.iter().map(row).collect(),
    })
}

fn number(value: Option<f64>, decimals: usize) -> Cell {
    value.map_or_else(|| "-".into(), |value| format!("{value:.decimals$}").into())
}

/// All of a table; a value that does not exist is a dash.
fn whole(table: &[u8]) -> Result<Sheet, csv::Error> {
    let mut reader = csv::Reader::from_reader(table);
    let heads = reader.headers()?.iter().map(|name| name.replace('_', " ")).collect();
    let cell = |field: &str| Cell::from(if field.is_empty() { "-" } else { field });
    let row = |record: Result<csv::StringRecord, csv::Error>| Ok(record?.iter().map(cell).collect());
    Ok(Sheet { heads, rows: reader.records().map(row).collect::<Result<_, csv::Error>>()?, ..Sheet::default() })
}
