//! The command line of `sensor`.

use std::path::PathBuf;

use clap::Args;

use crate::figures::Paper;
use crate::output::args::{FormatOption, positive};
use crate::worlds::scenes::scene;

/// Options of `sensor`.
#[derive(Debug, Args)]
pub struct SensorOptions {
    /// Scene whose camera is shown: a name of `list`, or a file
    #[arg(value_name = "SCENE", default_value = "room", value_parser = scene())]
    pub scene: PathBuf,
    /// Range in metres of the obstacle whose readings Figure 6 shows [default: where the disparity is a sixth of the search range]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub range: Option<f64>,
    /// Folder for tables, pictures and record, written whole or not at all [default: results/sensor]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// How pictures are made
    #[command(flatten)]
    pub paper: Paper,
    /// How the table is printed
    #[command(flatten)]
    pub print: FormatOption,
}
