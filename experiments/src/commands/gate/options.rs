//! Options of `gate`.

use std::path::{Path, PathBuf};

use clap::Parser;

use crate::output::args::{FormatOption, ThreadsOption, trimmed};
use crate::programs::options::ProgramOptions;

/// Checks maps against bounds and baselines, for the build to fail when they get worse
#[derive(Debug, Clone, Parser)]
#[command(
    max_term_width = 100,
    after_help = "Exit codes: 0 all gates pass, 1 internal or I/O error, 2 usage or bad input, 3 a gate fails (0 with --report-only), 130 Ctrl-C."
)]
pub struct GateOptions {
    /// File of the gates
    #[arg(long, value_name = "FILE", default_value = "results/gates.toml")]
    pub gates: PathBuf,
    /// File of the baselines [default: that of the gates with -baseline.csv for its ending]
    #[arg(long, value_name = "FILE")]
    pub baseline: Option<PathBuf>,
    /// Only the gates of these names, comma-separated
    #[arg(long, value_name = "NAME,NAME", value_delimiter = ',', value_parser = trimmed)]
    pub only: Vec<String>,
    /// Take what is measured now as the baseline, and show what changes; with --only, for those gates alone
    #[arg(long, conflicts_with_all = ["junit", "summary", "stream"])]
    pub update: bool,
    /// Other readings of the same worlds: what a change of the random numbers alone does to the gates
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub stream: u32,
    /// Also write the outcome as JUnit XML
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Also write the outcome in Markdown; appended if FILE is the one that GITHUB_STEP_SUMMARY names
    #[arg(long, value_name = "FILE")]
    pub summary: Option<PathBuf>,
    /// Tell of gates that fail, and end as if all had passed: for builds that are to be told and not stopped
    #[arg(long, conflicts_with = "update")]
    pub report_only: bool,
    /// Programs of one's own that gates may name
    #[command(flatten)]
    pub programs: ProgramOptions,
    /// How the table is printed
    #[command(flatten)]
    pub print: FormatOption,
    /// How many threads work
    #[command(flatten)]
    pub threads: ThreadsOption,
}

impl GateOptions {
    /// The file of the baselines.
    pub fn baseline(&self) -> PathBuf {
        self.baseline.clone().unwrap_or_else(|| beside(&self.gates))
    }

    /// The number of threads.
    pub(super) fn threads(&self) -> usize {
        let all = || std::thread::available_parallelism().map_or(1, usize::from);
        self.threads.count.map_or_else(all, |threads| threads as usize)
    }
}

fn beside(gates: &Path) -> PathBuf {
    let mut name = gates.file_stem().unwrap_or_default().to_owned();
    name.push("-baseline.csv");
    gates.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_baseline_lies_beside_the_gates() {
        assert_eq!(beside(Path::new("results/gates.toml")), Path::new("results/gates-baseline.csv"));
        assert_eq!(beside(Path::new("mine")), Path::new("mine-baseline.csv"));
    }
}
