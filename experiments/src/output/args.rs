//! Options that several commands share, and the bounds of their values.

use std::convert::Infallible;
use std::path::Path;

use clap::parser::ValueSource;
use clap::{ArgMatches, Args, ValueEnum};
use mapper::{CorrelationLaw, Prior, Reconciliation};

use super::{browser, note};

/// How a table is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Format {
    /// For reading
    #[default]
    Text,
    /// Comma-separated values
    Csv,
    /// JSON: {"schema_version": 1, "rows": [...]}
    Json,
}

/// `--format`.
#[derive(Debug, Clone, Copy, Default, Args)]
pub struct FormatOption {
    /// Form of the table on stdout
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// `--open`.
#[derive(Debug, Clone, Copy, Default, Args)]
pub struct OpenOption {
    /// Show the page in the browser when it is written
    #[arg(long)]
    pub open: bool,
}

impl OpenOption {
    /// Shows a page, where that is asked for.
    pub(crate) fn show(self, page: &Path) {
        if self.open {
            browser::show(page);
        }
    }
}

/// `--quiet` and `--verbose`, of every command.
#[derive(Debug, Clone, Copy, Default, Args)]
pub struct LoudnessOptions {
    /// Say neither progress nor notes; warnings and errors stay
    #[arg(short, long, global = true, conflicts_with = "verbose", display_order = 1000)]
    pub quiet: bool,
    /// Say too which files are read and written, and how long it took
    #[arg(short, long, global = true, display_order = 1000)]
    pub verbose: bool,
}

/// `--threads`.
#[derive(Debug, Clone, Copy, Default, Args)]
pub struct ThreadsOption {
    /// Threads to use, all processors if not given; results do not depend on it
    #[arg(id = "threads", long, value_name = "N", allow_negative_numbers = true, value_parser = count(MOST_THREADS))]
    pub count: Option<u32>,
}

/// The options that stand on the command line, by their field's name, whether or not their values are the usual ones.
#[derive(Debug, Clone, Default)]
pub struct Given(Vec<String>);

impl Given {
    /// Those that were given to a command.
    pub(crate) fn of(matches: &ArgMatches) -> Self {
        let given = |id: &&clap::Id| matches.value_source(id.as_str()) == Some(ValueSource::CommandLine);
        Self(matches.ids().filter(given).map(ToString::to_string).collect())
    }

    /// Whether an option was given, by its field's name.
    pub(crate) fn has(&self, field: &str) -> bool {
        self.0.iter().any(|given| given == field)
    }

    /// Warns of those among `fields` that were given, since they have no effect on `place`, which is `what`.
    pub(crate) fn warn(&self, fields: &[&str], place: &str, what: &str) {
        if let Some(line) = self.idle(fields, place, what) {
            note(line);
        }
    }

    fn idle(&self, fields: &[&str], place: &str, what: &str) -> Option<String> {
        let given = fields.iter().filter(|field| self.has(field));
        let names: Vec<String> = given.map(|field| format!("--{}", field.replace('_', "-"))).collect();
        let verb = if names.len() == 1 { "has" } else { "have" };
        let line = || format!("warning: {}: {verb} no effect on {place}, {what}; leave out", names.join(", "));
        (!names.is_empty()).then(line)
    }
}

/// What the mappers assume before the first reading.
#[derive(Debug, Clone, Args)]
pub struct PriorOptions {
    /// Probability that an unseen cell is occupied
    #[arg(long = "prior", help_heading = "What mappers assume before the first reading", value_name = "P", default_value_t = Prior::default().occupancy, allow_negative_numbers = true, value_parser = probability)]
    pub occupancy: f64,
    /// Correlation of cells 5 cm apart
    #[arg(long, help_heading = "What mappers assume before the first reading", value_name = "C", default_value_t = Prior::default().correlation, allow_negative_numbers = true, value_parser = probability)]
    pub correlation: f64,
    /// How the correlation follows the cell size
    #[arg(long, help_heading = "What mappers assume before the first reading", value_enum, default_value_t)]
    pub correlation_law: Law,
    /// What becomes of neighbouring cells that no ray of a scan runs along
    #[arg(long, help_heading = "What mappers assume before the first reading", value_enum, default_value_t)]
    pub reconciliation: Edges,
}

/// Names of [`CorrelationLaw`] on the command line.
#[derive(Debug, Clone, Copy, Default, ValueEnum)]
pub enum Law {
    /// exp(-d / l): the same world at every cell size
    #[default]
    Scaled,
    /// the same number at every cell size
    Fixed,
}

/// Names of [`Reconciliation`] on the command line.
#[derive(Debug, Clone, Copy, Default, ValueEnum)]
pub enum Edges {
    /// they enter the least squares with their state before the scan, as Eq. (20) reads
    #[default]
    AllEdges,
    /// they are left out
    Touched,
}

impl PriorOptions {
    /// The prior of the mappers.
    pub fn prior(&self) -> Prior {
        let correlation_law = match self.correlation_law {
            Law::Scaled => CorrelationLaw::Scaled,
            Law::Fixed => CorrelationLaw::Fixed,
        };
        Prior { occupancy: self.occupancy, correlation: self.correlation, correlation_law }
    }

    /// The treatment of edges on no ray.
    pub fn reconciliation(&self) -> Reconciliation {
        match self.reconciliation {
            Edges::AllEdges => Reconciliation::AllEdges,
            Edges::Touched => Reconciliation::Touched,
        }
    }
}

/// The range cut: what engineers do about far readings.
#[derive(Debug, Clone, Copy, Default, Args)]
pub struct CutOption {
    /// Throw readings beyond this away before any mapper sees them, m; of a camera the depth [default: all are used]
    #[arg(long = "max-range", value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub max_range_m: Option<f64>,
}

/// More threads than any machine has processors only cost memory.
pub(crate) const MOST_THREADS: u32 = 1024;

/// A whole number from 1 to `most`.
pub(crate) fn count(most: u32) -> clap::builder::RangedI64ValueParser<u32> {
    clap::value_parser!(u32).range(1..=i64::from(most))
}

/// A number from 0 to 1.
pub(crate) fn probability(text: &str) -> Result<f64, String> {
    number(text, "from 0 to 1", |v| (0.0..=1.0).contains(&v))
}

/// A share that is not nothing, as a value parser of clap.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    number(text, "above 0, at most 1", |value| value > 0.0 && value <= 1.0)
}

/// A name of a list, without the blanks about it.
pub(crate) fn trimmed(text: &str) -> Result<String, Infallible> {
    Ok(text.trim().to_owned())
}

/// A finite number above 0.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    number(text, "above 0 and finite", |v| v > 0.0 && v.is_finite())
}

/// A number that `accept` takes; `bound` states which those are.
pub(crate) fn number(text: &str, bound: &str, accept: impl Fn(f64) -> bool) -> Result<f64, String> {
    text.parse().ok().filter(|&v| accept(v)).ok_or_else(|| format!("must be a number {bound}"))
}
