//! The page of a folder that `room` left, made anew.

use std::path::PathBuf;

use mapper::Prior;
use serde::Deserialize;
use serde_json::Value;

use super::options::RoomOptions;
use super::plan::RoomPlan;
use super::record::Parts;
use super::{document, outputs};
use crate::failure::Failure;
use crate::output::args::{CutOption, Format, PriorOptions, ThreadsOption};
use crate::page::{self, Folder, ViewedWorld, Viewer};
use crate::programs::options::ProgramOptions;
use crate::worlds::run::Keep;

/// What the page of a room needs of its record.
#[derive(Deserialize)]
struct Made {
    seed: u64,
    configuration: Configuration,
    grid: grid::GridSpec,
}

#[derive(Deserialize)]
struct Configuration {
    scene: PathBuf,
    layout: Option<u64>,
    seeds: u32,
    mappers: Vec<String>,
    #[serde(default)]
    programs: Vec<Value>,
    prior: Prior,
    reconciliation: String,
    max_range_m: Option<f64>,
}

impl Made {
    /// The options that lead to the same run.
    fn options(self, prior: PriorOptions) -> RoomOptions {
        let Configuration { scene, layout, seeds, mappers, max_range_m, .. } = self.configuration;
        let (seed, grid) = (self.seed, Some(self.grid.cell_m));
        RoomOptions {
            scene,
            layout,
            seed,
            seeds,
            grid,
            mappers,
            programs: ProgramOptions::default(),
            prior,
            cut: CutOption { max_range_m },
            out: None,
            format: Format::Text,
            threads: ThreadsOption::default(),
        }
    }
}

/// The page, from the folder's numbers and its first seed.
///
/// # Errors
/// A folder that `room` did not leave, or whose numbers this program does not find again.
pub fn page(folder: &Folder, record: &Value) -> Result<String, Failure> {
    let made: Made = folder.understand(record)?;
    folder.without_programs(&made.configuration.programs)?;
    let prior = folder.prior(&made.configuration.prior, &made.configuration.reconciliation)?;
    let options = made.options(prior);
    let plan = RoomPlan::of(&options)?;
    let keep = Keep { timeline: false, frames: plan.frames.clone() };
    let trial = plan.ground.trial(options.seed, &plan.mappers, &plan.setup, &keep, &|_, _| ())?;
    let stages = plan.ground.stages(&trial);
    folder.same_configuration(record, &Parts::of(&options, &plan.ground, &plan.mappers, &stages, &[]))?;
    let csv = folder.read("metrics.csv")?;
    folder.same_numbers(&csv, &outputs::metrics(&plan.ground, std::slice::from_ref(&trial), &stages))?;
    let rows = document::rows(&csv).map_err(|e| folder.refuse("metrics.csv", &e.to_string()))?;
    let viewer = Viewer { worlds: vec![ViewedWorld::new(&plan.ground, &trial, &stages, &plan.frames)] };
    let pictures = folder.pictures(record, &document::PICTURES)?;
    page::page(&document::page(&plan.ground, &stages, record, &rows, pictures, viewer)?)
}
