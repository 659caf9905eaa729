//! Options of `convert`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use grid::ros_map::Mode;

use crate::output::args::{positive, probability};

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
    pub(super) fn apply(self, cells: Vec<Option<f32>>, width: usize) -> Vec<Option<f32>> {
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
