//! `convert IN OUT`: maps from one form into another.

mod input;
mod output;

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use grid::ros_map::{Coding, Mode, Thresholds, Warning};
use grid::{GridSpec, Raster};

use crate::cli::{positive, probability};
use crate::failure::{self, Failure};
use crate::{interruption, table};

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
    /// What the shades of an image read without YAML mean [default: trinary]
    #[arg(long, value_enum, value_name = "MODE")]
    pub read_as: Option<Shading>,
    /// Which row of the map an .npy file begins with: of IN if it is one, else of OUT
    #[arg(long, value_enum, value_name = "ROW")]
    pub row_order: Option<RowOrder>,
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

/// The row of the map that an array begins with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum RowOrder {
    /// the top one, as in pictures
    Top,
    /// the lowest one, as y runs [default]
    #[default]
    Bottom,
}

impl RowOrder {
    /// The cells of an array in the other order of rows, if need be.
    fn apply(self, cells: Vec<Option<f32>>, width: usize) -> Vec<Option<f32>> {
        match self {
            Self::Top => cells.chunks(width).rev().flatten().copied().collect(),
            Self::Bottom => cells,
        }
    }
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
    /// What is suspicious about it.
    warnings: Vec<Warning>,
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
    effective(options, kind)?;
    let map = input::read(options)?;
    failure::warn(&map.warnings);
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
    let coding = Coding { mode: options.mode.unwrap_or_default().into(), negate: options.negate, thresholds };
    let files = output::files(&map, kind, options, &coding)?;
    output::publish(&files, &map.sources)?;
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
    if options.row_order.is_some() && from != "npy" && kind != output::Kind::Npy {
        return Err(Failure::BadInput(
            "--row-order: must stand with an .npy file to read or write; leave it out".to_owned(),
        ));
    }
    Ok(())
}

fn summary(
    map: &Map,
    kind: output::Kind,
    options: &ConvertOptions,
    coding: &Coding,
    files: &[output::Whole],
) -> String {
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
