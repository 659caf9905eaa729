//! Options of `room`.

use std::path::PathBuf;

use clap::Args;

use crate::figures::Paper;
use crate::output::args::{CutOption, Format, OpenOption, PriorOptions, ThreadsOption, count, positive, trimmed};
use crate::output::recording::RecordingOption;
use crate::programs::options::ProgramOptions;
use crate::worlds::drives::DriveOptions;
use crate::worlds::ranked::SortOption;
use crate::worlds::scenes::scene;

/// A million maps in one run is a sweep, not a table with a spread.
const MOST_SEEDS: u32 = 10_000;

/// Options of `room`.
#[derive(Debug, Args)]
pub struct RoomOptions {
    /// Scene or family of scenes: a name of `list`, or a file
    #[arg(long, value_name = "SCENE", default_value = "room", value_parser = scene())]
    pub scene: PathBuf,
    /// Which scene of the family [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub layout: Option<u64>,
    /// Seed of the first run
    #[arg(long, value_name = "N", default_value_t = 1, allow_negative_numbers = true)]
    pub seed: u64,
    /// Number of runs, with consecutive seeds; tables then give mean and spread
    #[arg(long, value_name = "N", default_value_t = 1, allow_negative_numbers = true, value_parser = count(MOST_SEEDS))]
    pub seeds: u32,
    /// Side of a cell in metres, instead of the scene's
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub grid: Option<f64>,
    /// Mappers, comma-separated (see `list`)
    #[arg(
        long,
        value_name = "A,B",
        value_delimiter = ',', value_parser = trimmed,
        default_value = "visibility,visibility-lateral,visibility-printed,conventional"
    )]
    pub mappers: Vec<String>,
    /// Programs of one's own that map too
    #[command(flatten)]
    pub programs: ProgramOptions,
    /// What the mappers assume before the first reading
    #[command(flatten)]
    pub prior: PriorOptions,
    /// Drives that are planned on the maps of every stage
    #[command(flatten)]
    pub drives: DriveOptions,
    /// Which readings they see
    #[command(flatten)]
    pub cut: CutOption,
    /// Folder for tables, maps, pictures and report, written whole or not at all [default: results/ and the scene's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// What is recorded beside
    #[command(flatten)]
    pub recording: RecordingOption,
    /// How pictures are made
    #[command(flatten)]
    pub paper: Paper,
    /// Form of the table on stdout; csv and json give all metrics
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
    /// How rows are ordered
    #[command(flatten)]
    pub order: SortOption,
    /// Whether the page is shown
    #[command(flatten)]
    pub open: OpenOption,
    /// How many threads work
    #[command(flatten)]
    pub threads: ThreadsOption,
}
