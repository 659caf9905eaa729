//! Options of `tune`.

use std::path::PathBuf;

use clap::Args;
use scene::Set;

use super::candidates::Tuned;
use crate::figures::Paper;
use crate::output::args::{Format, ThreadsOption, count};
use crate::worlds::scenes::{FAMILIES, scene};

/// Options of `tune`.
#[derive(Debug, Args)]
pub struct TuneOptions {
    /// Families of generated scenes, comma-separated: names of `list`, or files
    #[arg(long, value_name = "A,B", value_delimiter = ',', value_parser = scene(), default_value = FAMILIES)]
    pub families: Vec<PathBuf>,
    /// Worlds of each family; mappers that take all scans at once are fitted on the first three of them
    #[arg(long, value_name = "N", default_value_t = 10, allow_negative_numbers = true, value_parser = count(Set::SIZE as u32))]
    pub seeds: u32,
    /// What to fit, comma-separated [default: all]
    #[arg(long, value_name = "A,B", value_delimiter = ',', value_parser = Tuned::parse)]
    pub mappers: Vec<Tuned>,
    /// How pictures are made
    #[command(flatten)]
    pub paper: Paper,
    /// Folder for table and picture, written whole or not at all
    #[arg(long, value_name = "DIR", default_value = "results/tuning")]
    pub out: PathBuf,
    /// Form of the table on stdout; csv and json give all candidates
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
    /// How many threads work
    #[command(flatten)]
    pub threads: ThreadsOption,
}
