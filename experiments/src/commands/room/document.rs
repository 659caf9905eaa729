//! The page of a room folder, from what the folder holds: the record, the metrics, the pictures.

use serde::Deserialize;
use serde_json::Value;

use super::{sensors, summary};
use crate::failure::Failure;
use crate::figures;
use crate::page::{Cell, Page, Part, Picture, Section, Sheet, Viewer, command_line};
use crate::worlds::claims;
use crate::worlds::ground::Ground;
use crate::worlds::run::Stage;

/// A row of `metrics.csv`.
#[derive(Debug, Deserialize)]
pub(crate) struct MetricRow {
    mapper: String,
    stage: String,
    region: String,
    metric: String,
    value: Option<f64>,
    unit: String,
    support: usize,
}

/// The rows of `metrics.csv`.
pub(crate) fn rows(csv: &[u8]) -> Result<Vec<MetricRow>, csv::Error> {
    csv::Reader::from_reader(csv).into_deserialize().collect()
}

/// Names and captions of the pictures, in the order of the page.
pub(crate) const PICTURES: [(&str, &str); 5] = [
    ("scene.png", figures::scene::CAPTION),
    ("maps.png", figures::maps::CAPTION),
    ("regions.png", figures::regions::CAPTION),
    ("movement.png", figures::movement::CAPTION),
    ("timeline.png", figures::timeline::CAPTION),
];

const SCORES: &str = "Regions follow from noise-free rays, never from a map, so that all mappers are scored on the same cells. \
    Log loss, Brier score, calibration error (ece), phantom and missed area and collisions are better when lower, the others when higher; a dash \
    is a metric that is not defined there. Drives (reached, colliding, detour; under all) go between pairs of places that follow from the truth: they are \
    planned on the map and driven as the robot's disc in the exact world; those with footprint_ by the probability that an obstacle stands under the disc; recall is the share of surface cells above 0.5 and 0.65.";

/// Puts the page together. `record` is `run.json`.
pub(crate) fn page(
    ground: &Ground,
    stages: &[Stage],
    record: &Value,
    metrics: &[MetricRow],
    pictures: Vec<Picture>,
    viewer: Viewer,
) -> Result<Page, Failure> {
    let scene = &ground.scene;
    let seeds = match (&record["configuration"]["seeds"], &record["seed"]) {
        (seeds, first) if seeds.as_u64() == Some(1) => format!("seed {first}"),
        (seeds, first) => {
            format!(
                "{seeds} seeds from {first}; tables give mean ± standard deviation, pictures and maps the first seed"
            )
        }
    };
    let grid = &scene.grid;
    let folds = stages.iter().enumerate().rev().map(|(i, stage)| Part::Fold {
        summary: format!("Stage {}: {}, after {} scans", stage.name, stage.label, stage.scans),
        open: i + 1 == stages.len(),
        parts: sheets(metrics, &stage.name),
    });
    let apart = viewer.worlds.first().and_then(|world| sensors::section(ground, world));
    let pictures = Section {
        heading: "Pictures".to_owned(),
        parts: pictures.into_iter().map(Part::Picture).collect(),
        ..Section::default()
    };
    let scores = Section { heading: "Scores".to_owned(), lead: SCORES.to_owned(), parts: folds.collect() };
    Ok(Page {
        title: scene.name.clone(),
        lead: scene.description.clone(),
        facts: format!(
            "{seeds} · {} scans of {}, {} × {} cells of {} m",
            ground.scans(),
            summary::rays(scene),
            grid.width,
            grid.height,
            grid.cell_m
        ),
        claims: claims::of_record(record),
        viewer: Some(viewer),
        sections: [Some(pictures), apart, Some(scores)].into_iter().flatten().collect(),
        configuration: serde_json::to_string_pretty(&record["configuration"]).map_err(Failure::internal)?,
        files: record["files"].as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect(),
        command: command_line(record),
        ..Page::default()
    })
}

/// Different values in the order of their first appearance.
fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found = Vec::new();
    for name in names {
        if !found.contains(&name) {
            found.push(name);
        }
    }
    found
}

/// One table per region at a stage: a row per mapper, a column per metric.
fn sheets(metrics: &[MetricRow], stage: &str) -> Vec<Sheet> {
    let here: Vec<&MetricRow> = metrics.iter().filter(|row| row.stage == stage).collect();
    let mut regions = distinct(here.iter().map(|row| row.region.as_str()));
    regions.sort_by_key(|region| match *region {
        "observable" => 0,
        "visible" | "surface" | "shell" | "hidden" | "all" => 2,
        _ => 1,
    });
    regions.into_iter().map(|region| sheet(&here, region)).collect()
}

fn sheet(here: &[&MetricRow], region: &str) -> Sheet {
    let here: Vec<&MetricRow> = here.iter().filter(|row| row.region == region).copied().collect();
    let columns = distinct(here.iter().map(|row| row.metric.as_str()));
    let head = |metric: &&str| {
        let unit = here.iter().find(|row| row.metric == *metric).map_or("1", |row| row.unit.as_str());
        let name = metric.replace('_', " ");
        if unit == "1" { name } else { format!("{name}, {unit}") }
    };
    let row = |mapper: &str| -> Vec<Cell> {
        let values = columns.iter().map(|metric| {
            let rows = here.iter().filter(|row| row.mapper == mapper && row.metric == *metric);
            let values: Vec<f64> = rows.filter_map(|row| row.value).collect();
            summary::spread(score::Summary::of(&values), 4).into()
        });
        [mapper.into()].into_iter().chain(values).collect()
    };
    Sheet {
        caption: region.to_owned(),
        note: here.first().map_or_else(String::new, |row| format!("{} cells", row.support)),
        heads: [String::from("mapper")].into_iter().chain(columns.iter().map(head)).collect(),
        rows: distinct(here.iter().map(|row| row.mapper.as_str())).into_iter().map(row).collect(),
    }
}
