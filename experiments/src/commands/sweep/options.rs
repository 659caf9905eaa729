//! Options of `sweep` and its parts.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::parameters::{Of, PARAMETERS, Parameter, ParameterKind};
use crate::figures::Paper;
use crate::output::args::{FormatOption, MOST_THREADS, ThreadsOption, count};
use crate::programs::options::ProgramOptions;
use crate::worlds::scenes::sweep;

/// More shards than this are a mistake.
const MOST_SHARDS: u32 = 1_000_000;

const FORM: &str = "A sweep file is TOML:\n
  families = [\"clutter\"]                 # or scene = \"scenes/room.toml\", or scenes = [..]
  mappers = [\"visibility\", \"conventional\"]
  seeds = { first = 1, count = 4 }       # of a family also the layouts
  regions = [\"observable\"]               # default: observable, visible, surface
  [set]                                  # the same in every job
  correlation_law = \"fixed\"
  [vary]                                 # every combination
  grid = [0.05, 0.1, 0.2]                # m
  correlation = { from = 0.0, to = 0.9, steps = 4 }   # also log = true
  [paired]                               # lists that go together
  disparity_sigma = [0.25, 1.0]
  believed_sigma = [0.5, 0.5]\n
Mappers know the simulated camera unless a believed_ key says otherwise. The region
range-by-looks is one per bin of range and number of looks.\n\n";

/// The form of a file, and all parameters.
fn form() -> String {
    let word = |kind: &ParameterKind| match kind {
        ParameterKind::Word(words) => {
            format!(": {}", words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(", "))
        }
        _ => String::new(),
    };
    let of = |parameter: &Parameter| match parameter.of {
        Of::File(section) => format!("[{section}] "),
        Of::Layout | Of::Map => String::new(),
    };
    let line = |parameter: &Parameter| {
        format!("  {:<22}  {}{}{}\n", parameter.key, of(parameter), parameter.about, word(&parameter.kind))
    };
    let parameters: String = PARAMETERS.iter().map(line).collect();
    format!("{FORM}Parameters; those with a [table] are in the place of what scene or family say there:\n{parameters}")
}

/// Options of `sweep`.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true, after_help = form())]
pub struct SweepOptions {
    /// A part of it
    #[command(subcommand)]
    pub part: Option<Part>,
    /// Sweep to plan, run, merge and plot here: a name of `list`, or a file; goes on where it was
    #[arg(value_name = "SWEEP", required = true, value_parser = sweep())]
    pub file: Option<PathBuf>,
    /// Folder for manifest, shards, table and pictures [default: results/sweep- and the file's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of shards [default: one for 100 jobs, at least 64]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = count(MOST_SHARDS))]
    pub shards: Option<u32>,
    /// Take the place of another sweep in the folder, whose results then do not count any more
    #[arg(long)]
    pub replace: bool,
    /// Programs of one's own that map too
    #[command(flatten)]
    pub programs: ProgramOptions,
    /// How many threads work
    #[command(flatten)]
    pub threads: ThreadsOption,
    /// How pictures are made
    #[command(flatten)]
    pub paper: Paper,
}

/// What can be done apart.
#[derive(Debug, Subcommand)]
pub enum Part {
    /// Write the manifest: every job, with its shard
    Plan(PlanOptions),
    /// Run the shards that are not done, or some of them
    Run(RunOptions),
    /// Say how far a sweep is
    Status(StatusOptions),
    /// Print the shards that are not done, as Slurm writes ranges
    Missing(FolderOptions),
    /// Make one table of all shards
    Merge(MergeOptions),
    /// Draw the table
    Plot(PlotOptions),
    /// Run the shards that are not done on a Slurm cluster, then merge and draw
    Slurm(SlurmOptions),
}

/// Options of `sweep plan`.
#[derive(Debug, Args)]
pub struct PlanOptions {
    /// Sweep: a name of `list`, or a file
    #[arg(value_name = "SWEEP", value_parser = sweep())]
    pub file: PathBuf,
    /// Folder for the manifest [default: results/sweep- and the file's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of shards [default: one for 100 jobs, at least 64]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = count(MOST_SHARDS))]
    pub shards: Option<u32>,
    /// Take the place of another manifest, whose results then do not count any more
    #[arg(long)]
    pub replace: bool,
    /// Programs of one's own that map too, wherever shards run
    #[command(flatten)]
    pub programs: ProgramOptions,
}

/// Options of `sweep run`.
#[derive(Debug, Args)]
pub struct RunOptions {
    /// Folder of the sweep
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Run this shard only; may be given several times [default: all that are not done]
    #[arg(long, value_name = "I")]
    pub shard: Vec<u32>,
    /// How many threads work
    #[command(flatten)]
    pub threads: ThreadsOption,
}

/// Options of `sweep status`.
#[derive(Debug, Args)]
pub struct StatusOptions {
    /// Folder of the sweep
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// How the table is printed
    #[command(flatten)]
    pub print: FormatOption,
}

/// Options of parts that need no more than the folder.
#[derive(Debug, Args)]
pub struct FolderOptions {
    /// Folder of the sweep
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
}

/// Options of `sweep plot`.
#[derive(Debug, Args)]
pub struct PlotOptions {
    /// Folder of the sweep
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// How pictures are made
    #[command(flatten)]
    pub paper: Paper,
}

/// Options of `sweep merge`.
#[derive(Debug, Args)]
pub struct MergeOptions {
    /// Folder of the sweep
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// File to write [default: table.csv in the folder]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Replace the file if it is there already
    #[arg(long, requires = "out")]
    pub force: bool,
}

/// Options of `sweep slurm`.
#[derive(Debug, Args)]
pub struct SlurmOptions {
    /// Folder of the sweep, which all nodes see under the same name
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Print the scripts and submit nothing
    #[arg(long)]
    pub dry_run: bool,
    /// Submit what failed again, until so many rounds are over
    #[arg(long, value_name = "N", default_value_t = 3, allow_negative_numbers = true, value_parser = count(100))]
    pub rounds: u32,
    /// Threads of each task
    #[arg(long, value_name = "N", default_value_t = 1, allow_negative_numbers = true, value_parser = count(MOST_THREADS))]
    pub threads: u32,
    /// At most so many tasks at a time
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = count(1_000_000))]
    pub throttle: Option<u32>,
    /// Indices of an array stay below this [default: the site's MaxArraySize]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = count(4_000_000))]
    pub max_array: Option<u32>,
    /// An option for sbatch, such as --sbatch=--partition=short; may be given several times
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    pub sbatch: Vec<String>,
    /// Seconds between looks at the queue
    #[arg(long, value_name = "S", default_value_t = 10.0, allow_negative_numbers = true, value_parser = seconds)]
    pub poll: f64,
    /// Seconds to wait for a controller that does not answer
    #[arg(long = "patience", value_name = "S", default_value_t = 600)]
    pub patience_s: u64,
}

#[cfg(test)]
impl Default for SlurmOptions {
    fn default() -> Self {
        Self {
            folder: PathBuf::new(),
            dry_run: false,
            rounds: 3,
            threads: 1,
            throttle: None,
            max_array: None,
            sbatch: Vec::new(),
            poll: 10.0,
            patience_s: 600,
        }
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    let fits = |seconds: &f64| (0.1..=3600.0).contains(seconds);
    text.parse().ok().filter(fits).ok_or_else(|| "must be a number of seconds from 0.1 to 3600".to_owned())
}
