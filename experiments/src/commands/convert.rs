//! `convert IN OUT`: maps from one form into another.

mod input;
mod options;
mod output;

pub use options::ConvertOptions;

use std::path::{Path, PathBuf};

use grid::ros_map::{Coding, Mode, Thresholds};

use crate::failure::Failure;
use crate::jobs::interruption;
use crate::output::single::{self, Existing, Whole};
use crate::output::table;
use crate::output::{note, warn};
use crate::worlds::map_file::{MapFile, Shading, extension};

/// Reads a map, writes it, and prints what was written.
///
/// # Errors
/// Bad input before anything is written; a file that cannot be written.
pub fn run(options: &ConvertOptions) -> Result<(), Failure> {
    interruption::watch();
    if options.negate && options.mode == Some(Shading::Raw) {
        let message =
            "--negate: must not stand with --mode raw: nav2 does not look at it there, map_server does; leave it out";
        return Err(Failure::BadInput(message.to_owned()));
    }
    let kind = output::Kind::of(&options.output)?;
    effective(options, kind)?;
    let map = input::read(options)?;
    warn(&map.warnings);
    let thresholds = Thresholds {
        occupied: options.occupied_thresh.unwrap_or(map.thresholds.occupied),
        free: options.free_thresh.unwrap_or(map.thresholds.free),
    };
    if thresholds.free > thresholds.occupied {
        return Err(Failure::BadInput(format!(
            "--free-thresh: {}: must be at most the threshold of occupied cells, {}; map_server has 0.196 and 0.65",
            thresholds.free, thresholds.occupied
        )));
    }
    if let Some(warning) = unseen_as_free(&map, &thresholds) {
        note(format_args!("warning: {}: {warning}", options.input.display()));
    }
    let coding = Coding { mode: options.mode.unwrap_or_default().into(), negate: options.negate, thresholds };
    let files = output::files(&map, kind, options, &coding)?;
    let sources: Vec<&Path> = map.sources.iter().map(PathBuf::as_path).collect();
    single::put(&files, &sources, Existing::forced(options.force))?;
    table::print(&summary(&map, kind, options, &coding, &files))
}

/// Refuses options that would have no effect.
fn effective(options: &ConvertOptions, kind: output::Kind) -> Result<(), Failure> {
    let from = extension(&options.input);
    if options.read_as.is_some() && ["yaml", "yml", "npy"].contains(&from.as_str()) {
        let remedy =
            if from == "npy" { "leave it out" } else { "change `mode` in the YAML file, or convert its image" };
        return Err(Failure::BadInput(format!(
            "--read-as: must stand with an image without YAML, not .{from}; {remedy}"
        )));
    }
    for (given, name) in [(options.mode.is_some(), "--mode"), (options.negate, "--negate")] {
        if given && kind == output::Kind::Npy {
            return Err(Failure::BadInput(format!(
                "{name}: must stand with an image to write, not .npy; leave it out"
            )));
        }
    }
    if options.row_order.is_some() && from != "npy" && kind != output::Kind::Npy {
        return Err(Failure::BadInput(
            "--row-order: must stand with an .npy file to read or write; leave it out".to_owned(),
        ));
    }
    Ok(())
}

/// A map that marks no cell as unknown, and whose free cells mostly hold one value: probably that of cells that nobody
/// has seen.
fn unseen_as_free(map: &MapFile, thresholds: &Thresholds) -> Option<String> {
    let cells = map.occupancy.values();
    if cells.iter().any(Option::is_none) {
        return None;
    }
    let free = cells.iter().flatten().filter(|share| thresholds.state(Some(**share)) == Some(false));
    let mut free: Vec<f32> = free.copied().collect();
    free.sort_by(f32::total_cmp);
    let most = free.chunk_by(|a, b| a.to_bits() == b.to_bits()).max_by_key(|same| same.len())?;
    // A map of nothing but states is sure of its free cells.
    let doubtful = most[0] > 0.0 && 2 * most.len() > free.len();
    doubtful.then(|| {
        format!(
            "{} of {} free cells hold exactly {}, and none is unknown: if nobody has seen them, they are not free; mark cells that were never seen as NaN",
            most.len(),
            free.len(),
            most[0]
        )
    })
}

fn summary(map: &MapFile, kind: output::Kind, options: &ConvertOptions, coding: &Coding, files: &[Whole]) -> String {
    let spec = map.occupancy.spec();
    let states = map.occupancy.map(|&share| coding.thresholds.state(share));
    let count = |state: Option<bool>| states.values().iter().filter(|s| **s == state).count();
    let names: Vec<String> = files.iter().map(|file| file.path.display().to_string()).collect();
    let mut text = format!(
        "{}: {} x {} cells: {} free, {} occupied, {} unknown\n",
        names.join(", "),
        spec.width,
        spec.height,
        count(Some(false)),
        count(Some(true)),
        count(None)
    );
    let graded = graded(map);
    if kind != output::Kind::Npy && coding.mode == Mode::Trinary && graded > 0 {
        let kept = if options.mode.is_none() && kind == output::Kind::Map {
            "to a whole percent in the second map"
        } else {
            "nowhere"
        };
        text += &format!("{graded} cells had a share between 0 and 1: kept {kept}\n");
    }
    if kind != output::Kind::Map
        && let Some((spec, yaw_rad)) = map.place
    {
        let [x, y] = spec.origin_m;
        text += &format!("it says no place; to read it, --resolution {} --origin {x},{y},{yaw_rad}\n", spec.cell_m);
    }
    text
}

/// Cells of which a state does not say all.
fn graded(map: &MapFile) -> usize {
    map.occupancy.values().iter().flatten().filter(|share| **share > 0.0 && **share < 1.0).count()
}
