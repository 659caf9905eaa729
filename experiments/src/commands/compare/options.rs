//! Options of `compare`.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};

use crate::figures::Paper;
use crate::output::args::{CutOption, Format, OpenOption, PriorOptions, ThreadsOption, count, trimmed};
use crate::programs::options::ProgramOptions;
use crate::worlds::condition::departures;
use crate::worlds::drives::DriveOptions;
use crate::worlds::ranked::SortOption;
use crate::worlds::scenes::{FAMILIES, scene};

/// Options of `compare`.
#[derive(Debug, Args)]
pub struct CompareOptions {
    /// Which worlds
    #[arg(long, value_enum, default_value_t)]
    pub set: Worlds,
    /// Families of generated scenes, comma-separated: names of `list`, or files
    #[arg(
        long,
        value_name = "A,B",
        value_delimiter = ',',
        value_parser = scene(),
        default_value = FAMILIES
    )]
    pub families: Vec<PathBuf>,
    /// What differs from what the mappers believe, comma-separated, in the robustness set [default: all but people, poses and drift]
    #[arg(long, value_name = "A,B", value_delimiter = ',', value_parser = PossibleValuesParser::new(departures().map(|condition| condition.name)))]
    pub conditions: Vec<String>,
    /// Worlds of each family under each condition [default: 30 test, 8 robustness, 10 tuning, 8 sensors; 4 or 1 with --quick]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = count(10_000))]
    pub seeds: Option<u32>,
    /// Batch mappers run on the first N of them only [default: a third]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..=10_000))]
    pub batch_seeds: Option<u32>,
    /// Mappers, comma-separated; visibility, which all are compared with, must be among them [default: all but some as published of which there are fitted ones, and those for a world that moves or for several sensors, see `list`; of sensors, visibility, independent, conventional, log-odds-octomap and the rules for several]
    #[arg(long, value_name = "A,B", value_delimiter = ',', value_parser = trimmed)]
    pub mappers: Vec<String>,
    /// Programs of one's own that are compared too
    #[command(flatten)]
    pub programs: ProgramOptions,
    /// A first impression within a minute: fewer worlds, one of each family for batch mappers, fewer repeats
    #[arg(long)]
    pub quick: bool,
    /// What the mappers assume before the first reading
    #[command(flatten)]
    pub prior: PriorOptions,
    /// Drives that are planned on every map
    #[command(flatten)]
    pub drives: DriveOptions,
    /// Which readings they see
    #[command(flatten)]
    pub cut: CutOption,
    /// Folder for tables, pictures and report, written whole or not at all [default: results/compare and the set's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// How pictures are made
    #[command(flatten)]
    pub paper: Paper,
    /// Form of the table on stdout; csv and json give all differences
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

/// A set of generated worlds, see [`scene::Set`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Worlds {
    /// worlds that no parameter was fitted on
    #[default]
    Test,
    /// worlds that differ from what the mappers believe
    Robustness,
    /// worlds that parameters are fitted on
    Tuning,
    /// worlds with glass and thin legs, for robots with a camera, a laser, sonars, each pair and all
    Sensors,
}

impl Worlds {
    /// Its name in files and folders.
    pub fn name(self) -> &'static str {
        match self {
            Self::Test => "test",
            Self::Robustness => "robustness",
            Self::Tuning => "tuning",
            Self::Sensors => "sensors",
        }
    }

    /// What it is for, in a sentence.
    pub fn about(self) -> &'static str {
        match self {
            Self::Test => "Generated worlds on which no parameter was fitted; the mappers know the camera's noise.",
            Self::Robustness => {
                "Generated worlds in which one thing differs from what the mappers believe: the share of correct matches, the noise of \
                 the disparity, the size of the obstacles, or mismatches that come in runs and copy neighbouring surfaces."
            }
            Self::Sensors => {
                "Generated worlds on which no parameter was fitted, with panes of glass and thin legs that not every reading ends on, for robots with a camera, a laser, a ring \
                 of sonars, each pair of them and all three."
            }
            Self::Tuning => "The generated worlds that parameters are fitted on: not for reporting.",
        }
    }
}
