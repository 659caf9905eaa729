//! The page of a room folder.

use std::path::PathBuf;

use mapper::Prior;
use serde::Deserialize;
use serde_json::Value;

use super::source::Folder;
use crate::cli::{Belief, Format, RoomOptions};
use crate::commands::room::{self, Plan, document};
use crate::failure::Failure;
use crate::page::{self, Viewer, World};

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
    prior: Prior,
    reconciliation: String,
}

impl Made {
    /// The options that lead to the same run.
    fn options(self, belief: Belief) -> RoomOptions {
        let Configuration { scene, layout, seeds, mappers, .. } = self.configuration;
        let (seed, grid) = (self.seed, Some(self.grid.cell_m));
        RoomOptions {
            scene,
            layout,
            seed,
            seeds,
            grid,
            mappers,
            belief,
            out: None,
            format: Format::Text,
            threads: None,
        }
    }
}

/// The page, from the folder's numbers and its first seed.
pub(super) fn page(folder: &Folder, record: &Value) -> Result<String, Failure> {
    let made: Made = folder.understand(record)?;
    let belief = folder.belief(&made.configuration.prior, &made.configuration.reconciliation)?;
    let options = made.options(belief);
    let plan = Plan::of(&options)?;
    let (trial, metrics) = room::first_seed(&plan, &options)?;
    let stages = room::stages(&plan.ground, &trial);
    folder.same_configuration(record, &room::record(&options, &plan.ground, &plan.mappers, &stages, &[]))?;
    let csv = folder.read("metrics.csv")?;
    folder.same_numbers(&csv, &metrics)?;
    let rows = document::rows(&csv).map_err(|e| folder.refuse("metrics.csv", &e.to_string()))?;
    let viewer = Viewer { worlds: vec![World::new(&plan.ground, &trial, &stages, &plan.frames)] };
    let pictures = folder.pictures(record, &document::PICTURES)?;
    page::page(&document::page(&plan.ground, &stages, record, &rows, pictures, viewer)?)
}
