//! `convert IN OUT`: maps from one form into another.

mod input;
mod output;

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use grid::ros_map::{Coding, Mode, Thresholds};
use grid::{GridSpec, Raster};

use crate::cli::{positive, probability};
use crate::failure::Failure;
use crate::jobs::interruption;
use crate::output::single::{self, Existing, Whole};
use crate::output::table;

/// Options of `convert`.
#[derive(Debug, Args)]
pub struct ConvertOptions {
    /// Map to read: .yaml with its image, .npy, or .pgm and .png without YAML
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Map to write: .yaml (image beside it), .pgm (YAML beside it), .npy or .png
    #[arg(value_name = "OUT")]
    pub output: PathBuf,
    /// What the shades of a written image mean [default: trinary, with a second file in raw for a .yaml where that says more]
    #[arg(long, value_enum)]
    pub mode: Option<Shading>,
    /// What the shades of an image read without YAML mean
    #[arg(long, value_enum, default_value_t, value_name = "MODE")]
    pub read_as: Shading,
    /// A cell is occupied above this share [default: that of IN, or 0.65]
    #[arg(long, value_name = "P", allow_negative_numbers = true, value_parser = probability)]
    pub occupied_thresh: Option<f64>,
    /// A cell is free below this share [default: that of IN, or 0.196]
    #[arg(long, value_name = "P", allow_negative_numbers = true, value_parser = probability)]
    pub free_thresh: Option<f64>,
    /// Write occupied cells bright
    #[arg(long)]
    pub negate: bool,
    /// Side of a cell in metres, instead of IN's; the cells stay
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = side)]
    pub resolution: Option<f64>,
    /// Lower-left corner in metres and angle in radians, instead of IN's; the cells stay
    #[arg(long, value_name = "X,Y,YAW", allow_hyphen_values = true, value_parser = origin)]
    pub origin: Option<Origin>,
    /// Replace files that have the names already; those that are read never
    #[arg(long)]
    pub force: bool,
}

/// Names of [`Mode`] on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Shading {
    /// black, white and grey for occupied, free and unknown
    #[default]
    Trinary,
    /// percent as shades between the thresholds, transparent for unknown
    Scale,
    /// percent as brightness of 255
    Raw,
}

impl From<Shading> for Mode {
    fn from(shading: Shading) -> Self {
        match shading {
            Shading::Trinary => Self::Trinary,
            Shading::Scale => Self::Scale,
            Shading::Raw => Self::Raw,
        }
    }
}

/// Where a map lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Origin {
    /// Lower-left corner, m.
    pub corner_m: [f64; 2],
    /// Angle about it, rad.
    pub yaw_rad: f64,
}

/// The bounds of map files, so that what is written can be read.
fn side(text: &str) -> Result<f64, String> {
    positive(text)
        .ok()
        .filter(|m| (1e-4..=100.0).contains(m))
        .ok_or_else(|| "must be a number from 0.0001 to 100".into())
}

fn origin(text: &str) -> Result<Origin, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, yaw_rad]) if x.abs() <= 1e8 && y.abs() <= 1e8 && yaw_rad.abs() <= 6.3 => {
            Ok(Origin { corner_m: [x, y], yaw_rad })
        }
        _ => Err("must be three numbers X,Y,YAW: metres up to 1e8 either way and radians up to 6.3".into()),
    }
}

/// A map on its way.
struct Map {
    occupancy: Raster<Option<f32>>,
    /// None for a map that has no place.
    place: Option<(GridSpec, f64)>,
    thresholds: Thresholds,
    /// The files that it was read from.
    sources: Vec<PathBuf>,
}

/// Reads, writes, and says on stdout what was written.
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
    let map = input::read(options)?;
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
        let _ = writeln!(io::stderr(), "warning: {}: {warning}", options.input.display());
    }
    let coding = Coding { mode: options.mode.unwrap_or_default().into(), negate: options.negate, thresholds };
    let files = output::files(&map, kind, options, &coding)?;
    let sources: Vec<&Path> = map.sources.iter().map(PathBuf::as_path).collect();
    single::put(&files, &sources, Existing::forced(options.force))?;
    table::print(&summary(&map, kind, options, &coding, &files))
}

/// A map that marks no cell as unknown, and whose free cells mostly hold one value: probably that of cells that nobody
/// has seen.
fn unseen_as_free(map: &Map, thresholds: &Thresholds) -> Option<String> {
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

fn summary(map: &Map, kind: output::Kind, options: &ConvertOptions, coding: &Coding, files: &[Whole]) -> String {
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
fn graded(map: &Map) -> usize {
    map.occupancy.values().iter().flatten().filter(|share| **share > 0.0 && **share < 1.0).count()
}

/// The extension of a file's name, in small letters.
fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
}
