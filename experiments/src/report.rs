//! The report: one HTML page that needs nothing else.

use askama::Template;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;

use crate::claims::Claim;
use crate::failure::Failure;
use crate::record::{Record, Stage};
use crate::summary;
use crate::trial::{Ground, Trial};

/// A picture of the report.
pub struct Picture {
    /// Its file name.
    pub name: &'static str,
    /// What it shows.
    pub caption: String,
    /// The PNG.
    pub bytes: Vec<u8>,
}

#[derive(Template)]
#[template(path = "report.html")]
struct Page<'a> {
    scene: &'a str,
    description: &'a str,
    seeds: String,
    drive: String,
    claims: &'a [Claim],
    pictures: Vec<Embedded<'a>>,
    stages: Vec<StageTables<'a>>,
    files: &'a [String],
    configuration: String,
}

struct Embedded<'a> {
    name: &'a str,
    caption: &'a str,
    base64: String,
}

struct StageTables<'a> {
    stage: &'a Stage,
    regions: Vec<RegionTable>,
}

struct RegionTable {
    region: String,
    support: String,
    heads: Vec<String>,
    rows: Vec<Vec<String>>,
}

/// Renders the page.
///
/// # Errors
/// A template that cannot be filled.
pub fn render(
    ground: &Ground,
    trials: &[Trial],
    stages: &[Stage],
    record: &Record,
    pictures: &[Picture],
) -> Result<String, Failure> {
    let scene = &ground.scene;
    let page = Page {
        scene: &scene.name,
        description: &scene.description,
        seeds: match trials.len() {
            1 => format!("seed {}", record.seed),
            n => format!(
                "{n} seeds from {}; tables give mean ± standard deviation, pictures the first seed",
                record.seed
            ),
        },
        drive: format!(
            "{} scans of {} columns, {} × {} cells of {} m",
            ground.scans(),
            scene.camera.columns,
            scene.grid.width,
            scene.grid.height,
            scene.grid.cell_m
        ),
        claims: &record.claims,
        pictures: pictures
            .iter()
            .map(|p| Embedded { name: p.name, caption: &p.caption, base64: BASE64_STANDARD.encode(&p.bytes) })
            .collect(),
        stages: stages.iter().enumerate().rev().map(|(i, stage)| tables(trials, i, stage)).collect(),
        files: &record.files,
        configuration: serde_json::to_string_pretty(&record.configuration).map_err(Failure::internal)?,
    };
    page.render().map_err(Failure::internal)
}

/// One table per region at a stage: a row per mapper, a column per metric.
fn tables<'a>(trials: &[Trial], stage_index: usize, stage: &'a Stage) -> StageTables<'a> {
    let Some(map) = trials.first().and_then(|t| t.runs.first()).and_then(|run| run.stages.get(stage_index)) else {
        return StageTables { stage, regions: Vec::new() };
    };
    let mut regions: Vec<String> = Vec::new();
    for score in &map.scores {
        if !regions.contains(&score.region) {
            regions.push(score.region.clone());
        }
    }
    let table = |region: String| {
        let scores: Vec<_> = map.scores.iter().filter(|score| score.region == region).collect();
        let heads = scores.iter().map(|score| match score.metric.unit {
            "1" => score.metric.name.replace('_', " "),
            unit => format!("{}, {unit}", score.metric.name.replace('_', " ")),
        });
        let row = |mapper: &str| {
            let values = scores.iter().map(|score| {
                let over_seeds = summary::over_seeds(trials, mapper, stage_index, &region, score.metric.name);
                summary::spread(over_seeds, 4)
            });
            [mapper.to_owned()].into_iter().chain(values).collect()
        };
        RegionTable {
            support: scores.first().map_or_else(String::new, |score| format!("{} cells", score.metric.support)),
            heads: heads.collect(),
            rows: trials[0].runs.iter().map(|run| row(run.mapper)).collect(),
            region,
        }
    };
    let order = |region: &String| match region.as_str() {
        "observable" => 0,
        "visible" | "surface" | "shell" | "hidden" | "all" => 2,
        _ => 1,
    };
    regions.sort_by_key(order);
    StageTables { stage, regions: regions.into_iter().map(table).collect() }
}
