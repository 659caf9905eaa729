//! The page of a folder that `room` left, made anew.

use std::path::PathBuf;

use mapper::Prior;
use mapper::catalogue::Entry;
use serde::Deserialize;
use serde_json::Value;

use super::options::RoomOptions;
use super::plan::RoomPlan;
use super::record::Parts;
use super::{document, outputs};
use crate::failure::Failure;
use crate::figures::Paper;
use crate::output::args::{CutOption, Format, OpenOption, PriorOptions, ThreadsOption};
use crate::output::recording::RecordingOption;
use crate::page::{self, Folder, ViewedWorld, Viewer};
use crate::programs::options::{ProgramOptions, ProgramRecord};
use crate::worlds::drives::DriveOptions;
use crate::worlds::ranked::SortOption;
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
    programs: Vec<ProgramRecord>,
    prior: Prior,
    reconciliation: String,
    #[serde(default)]
    drives: DriveOptions,
    #[serde(default)]
    max_range_m: Option<f64>,
}

impl Made {
    /// The options that lead to the same run.
    fn options(self, prior: PriorOptions) -> Result<RoomOptions, Failure> {
        let Configuration { scene, layout, seeds, mappers, programs, drives, max_range_m, .. } = self.configuration;
        let (seed, grid) = (self.seed, Some(self.grid.cell_m));
        Ok(RoomOptions {
            scene,
            layout,
            seed,
            seeds,
            grid,
            mappers,
            programs: ProgramOptions::recorded(&programs)?,
            prior,
            drives,
            cut: CutOption { max_range_m },
            out: None,
            paper: Paper::default(),
            format: Format::Text,
            order: SortOption::default(),
            recording: RecordingOption::default(),
            open: OpenOption::default(),
            threads: ThreadsOption::default(),
        })
    }
}

/// The page, from the folder's numbers and its first seed. Programs are not started: what they gave is in the folder.
///
/// # Errors
/// A folder that `room` did not leave, or whose numbers this program does not find again.
pub fn page(folder: &Folder, record: &Value) -> Result<String, Failure> {
    let made: Made = folder.understand(record)?;
    let prior = folder.prior(&made.configuration.prior, &made.configuration.reconciliation)?;
    let recorded = made.configuration.programs.clone();
    let programs: Vec<&str> = recorded.iter().map(|program| program.name.as_str()).collect();
    let options = made.options(prior)?;
    let plan = RoomPlan::of(&options)?;
    let keep = Keep { timeline: false, frames: plan.frames.clone() };
    let names: Vec<&str> = plan.mappers.iter().map(|entry| entry.name).collect();
    let built_in: Vec<&Entry> = plan.mappers.iter().copied().filter(|entry| !programs.contains(&entry.name)).collect();
    let trial = plan.ground.trial(options.seed, &built_in, &plan.setup, &keep, &|_, _| ())?;
    let stages = plan.ground.stages(&trial);
    let mut parts = Parts::of(&options, &plan.ground, &plan.mappers, &stages, &[]);
    parts.configuration.programs.clone_from(&recorded); // as they were: files may have changed since
    folder.same_configuration(record, &parts)?;
    let csv = folder.read("metrics.csv")?;
    let metrics = outputs::metrics(&plan.ground, std::slice::from_ref(&trial), &stages);
    folder.same_numbers(&csv, &metrics, &programs)?;
    let rows = document::rows(&csv).map_err(|e| folder.refuse("metrics.csv", &e.to_string()))?;
    let mut viewer = Viewer {
        worlds: vec![ViewedWorld::new(&plan.ground, &trial, &stages, &plan.frames)?],
        budget: page::WORLD_BYTES,
    };
    page::kept::add(folder, &mut viewer, &programs, &names)?;
    let pictures = folder.pictures(record, &document::PICTURES)?;
    page::page(&document::page(&plan.ground, &stages, record, &rows, pictures, viewer)?)
}
