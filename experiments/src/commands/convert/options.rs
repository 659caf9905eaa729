//! Options of `convert`.

use std::path::PathBuf;

use clap::Args;

use crate::output::args::probability;
use crate::worlds::map_file::{Origin, RowOrder, Shading, origin, side};

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
