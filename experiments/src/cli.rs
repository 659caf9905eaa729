//! The command line: options and their ranges.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use mapper::{CorrelationLaw, Prior, Reconciliation};

use crate::commands::calibrate::CalibrateOptions;
use crate::commands::compare::options::CompareOptions;
use crate::commands::convert::ConvertOptions;
use crate::commands::gate::GateOptions;
use crate::commands::ray::RayOptions;
use crate::commands::replay::ReplayOptions;
use crate::commands::sensor::SensorOptions;
use crate::commands::speed::SpeedOptions;
use crate::commands::sweep::SweepOptions;
use crate::commands::tune::TuneOptions;

/// Tells good maps from bad ones: simulates a robot with a stereo camera, maps what it sees by
/// several rules, and scores the maps against the truth.
#[derive(Debug, Parser)]
#[command(
    name = "experiments",
    version,
    max_term_width = 100,
    after_help = "Exit codes: 0 done, 1 internal or I/O error, 2 usage or bad input, 3 a claim does not hold or a gate fails, \
                  75 interrupted, run again to go on, 130 Ctrl-C."
)]
pub struct Cli {
    /// What to run.
    #[command(subcommand)]
    pub command: Command,
}

/// The experiments.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// The paper's room experiment (Section 3.3, Figures 11-14): simulate, map, score, show
    Room(RoomOptions),
    /// All mappers over many generated worlds, with the statistics to say which is better, where and by how much
    Compare(CompareOptions),
    /// Check maps against bounds and baselines, for the build to fail when they get worse
    Gate(GateOptions),
    /// Many settings over many worlds, in shards that run anywhere, as one table
    Sweep(SweepOptions),
    /// Fit the parameters of mappers on the tuning set, which no result is reported on
    Tune(TuneOptions),
    /// One viewing ray and one reading by every rule (Section 3.2, Figures 8-10)
    Ray(RayOptions),
    /// What a camera's reading says of range: its density and its kernel (Section 3.1, Figures 6 and 7)
    Sensor(SensorOptions),
    /// What every mapper costs on this machine, side by side: time per cell, ray and scan, and memory
    Speed(SpeedOptions),
    /// Map what a real robot recorded, and score the maps by how well they predict scans kept back
    Replay(Box<ReplayOptions>),
    /// Fit a sensor's kernel and the prior to a log, or to disparities with known truth
    Calibrate(CalibrateOptions),
    /// Make the page of a folder of results anew, from what the folder says it was made from
    Report(ReportOptions),
    /// Convert a map between ROS YAML and image, NPY and PNG, cell by cell
    Convert(ConvertOptions),
    /// Check a scene file and say what it holds, without mapping anything
    Check(CheckOptions),
    /// Make a scene file: from a family of scenes, a robot's map or a floor plan
    #[command(subcommand)]
    Scene(SceneCommand),
    /// Estimate prior, correlation and mean obstacle length (Section 3.2) from a scene's ground truth
    Estimate(CheckOptions),
    /// List experiments, mappers, scenes and families of scenes at hand
    List(ListOptions),
}

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

/// Options of `room`.
#[derive(Debug, Args)]
pub struct RoomOptions {
    /// Scene file, or file of a family of scenes
    #[arg(long, value_name = "FILE", default_value = "scenes/room.toml")]
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
        value_delimiter = ',',
        default_value = "visibility,visibility-lateral,visibility-printed,conventional"
    )]
    pub mappers: Vec<String>,
    /// What the mappers believe before the first reading
    #[command(flatten)]
    pub belief: Belief,
    /// Folder for tables, maps, pictures and report, written whole or not at all [default: results/ and the scene's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Form of the table on stdout; csv and json give all metrics
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
    /// Threads to use, all processors if not given; results do not depend on it
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = count(MOST_THREADS))]
    pub threads: Option<u32>,
}

/// Options of `report`.
#[derive(Debug, Args)]
pub struct ReportOptions {
    /// Folder that `room` or `compare` left
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Page to write [default: report.html in the folder]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Replace the page if it is there already and is none that the folder's record lists
    #[arg(long, requires = "out")]
    pub force: bool,
}

/// What the mappers believe before the first reading.
#[derive(Debug, Clone, Args)]
pub struct Belief {
    /// Probability that an unseen cell is occupied
    #[arg(long, value_name = "P", default_value_t = Prior::default().occupancy, allow_negative_numbers = true, value_parser = probability)]
    pub prior: f64,
    /// Correlation of cells 5 cm apart
    #[arg(long, value_name = "C", default_value_t = Prior::default().correlation, allow_negative_numbers = true, value_parser = probability)]
    pub correlation: f64,
    /// How the correlation follows the cell size
    #[arg(long, value_enum, default_value_t)]
    pub correlation_law: Law,
    /// What becomes of neighbouring cells that no ray of a scan runs along
    #[arg(long, value_enum, default_value_t)]
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

impl Belief {
    /// The prior of the mappers.
    pub fn prior(&self) -> Prior {
        let correlation_law = match self.correlation_law {
            Law::Scaled => CorrelationLaw::Scaled,
            Law::Fixed => CorrelationLaw::Fixed,
        };
        Prior { occupancy: self.prior, correlation: self.correlation, correlation_law }
    }

    /// The treatment of edges on no ray.
    pub fn reconciliation(&self) -> Reconciliation {
        match self.reconciliation {
            Edges::AllEdges => Reconciliation::AllEdges,
            Edges::Touched => Reconciliation::Touched,
        }
    }
}

/// Options of `check` and `estimate`.
#[derive(Debug, Args)]
pub struct CheckOptions {
    /// Scene file, or file of a family of scenes
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// Which scene of the family [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub layout: Option<u64>,
    /// Side of a cell in metres, instead of the scene's
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub grid: Option<f64>,
    /// Form of the table on stdout
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// What `scene` does.
#[derive(Debug, Subcommand)]
pub enum SceneCommand {
    /// Print the scene file of a layout
    Generate(GenerateOptions),
    /// Make a scene of a ROS map (YAML, with PGM or PNG): a route through all that the robot can reach
    FromMap(FromMapOptions),
    /// Make a scene of a floor plan (JSON with `verts`, as HouseExpo has them)
    FromPlan(FromMapOptions),
}

/// Options of `scene from-map` and `scene from-plan`.
#[derive(Debug, Args)]
pub struct FromMapOptions {
    /// The map's YAML file, or the floor plan
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Scene file to write instead of stdout; it names the map relative to itself
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Replace the scene file if it is there already
    #[arg(long, requires = "out")]
    pub force: bool,
    /// Radius of the robot, m
    #[arg(long, value_name = "M", default_value_t = 0.2, allow_negative_numbers = true, value_parser = radius)]
    pub radius: f64,
    /// What the robot keeps from everything beside its radius, m
    #[arg(long, value_name = "M", default_value_t = 0.05, allow_negative_numbers = true, value_parser = clearance)]
    pub clearance: f64,
    /// All of the floor is to be seen from at most this far away, m
    #[arg(long, value_name = "M", default_value_t = 4.0, allow_negative_numbers = true, value_parser = range)]
    pub range: f64,
    /// Cut the route at this length, m
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = route_length)]
    pub max_length: Option<f64>,
    /// Where to start, m; not given, where the route gets short
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = point)]
    pub start: Option<[f64; 2]>,
    /// Image columns of the camera
    #[arg(long, value_name = "N", default_value_t = 120, allow_negative_numbers = true, value_parser = count(100_000))]
    pub camera_columns: u32,
    /// Horizontal field of view of the camera, degrees
    #[arg(long, value_name = "DEG", default_value_t = 80.0, allow_negative_numbers = true, value_parser = field_of_view)]
    pub camera_field_of_view: f64,
}

/// Options of `scene generate`.
#[derive(Debug, Args)]
pub struct GenerateOptions {
    /// File of a family of scenes
    #[arg(value_name = "FAMILY")]
    pub family: PathBuf,
    /// Which scene of the family
    #[arg(long, value_name = "N", default_value_t = scene::Set::FIRST_TEST, allow_negative_numbers = true)]
    pub layout: u64,
    /// Factor on the size of the obstacles; they cover as much of the floor
    #[arg(long, value_name = "F", default_value_t = 1.0, allow_negative_numbers = true, value_parser = size_factor)]
    pub size_factor: f64,
    /// File to write instead of stdout
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Replace the file if it is there already
    #[arg(long, requires = "out")]
    pub force: bool,
}

/// Options of `list`.
#[derive(Debug, Args)]
pub struct ListOptions {
    /// Form of the table on stdout
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// A million maps in one run is a sweep, not a table with a spread.
const MOST_SEEDS: u32 = 10_000;

/// More threads than any machine has processors only cost memory.
pub(crate) const MOST_THREADS: u32 = 1024;

pub(crate) fn count(most: u32) -> clap::builder::RangedI64ValueParser<u32> {
    clap::value_parser!(u32).range(1..=i64::from(most))
}

pub(crate) fn probability(text: &str) -> Result<f64, String> {
    number(text, "from 0 to 1", |v| (0.0..=1.0).contains(&v))
}

fn size_factor(text: &str) -> Result<f64, String> {
    number(text, "from 0.1 to 10", |v| (0.1..=10.0).contains(&v))
}

pub(crate) fn positive(text: &str) -> Result<f64, String> {
    number(text, "above 0 and finite", |v| v > 0.0 && v.is_finite())
}

fn radius(text: &str) -> Result<f64, String> {
    number(text, "in m from 0.001 to 1000", |v| (0.001..=1000.0).contains(&v))
}

fn clearance(text: &str) -> Result<f64, String> {
    number(text, "in m from 0.005 to 10", |v| (0.005..=10.0).contains(&v))
}

fn range(text: &str) -> Result<f64, String> {
    number(text, "in m from 0.1 to 100", |v| (0.1..=100.0).contains(&v))
}

fn route_length(text: &str) -> Result<f64, String> {
    number(text, "in m from 0.1 to 1000000", |v| (0.1..=1e6).contains(&v))
}

fn field_of_view(text: &str) -> Result<f64, String> {
    number(text, "in degrees from 0.1 to 175", |v| (0.1..=175.0).contains(&v))
}

fn point(text: &str) -> Result<[f64; 2], String> {
    let coordinate = |text: &str| text.trim().parse().ok().filter(|v: &f64| v.is_finite());
    let point = text.split_once(',').and_then(|(x, y)| Some([coordinate(x)?, coordinate(y)?]));
    point.ok_or_else(|| "must be two numbers in m, such as 1.5,-2".to_owned())
}

fn number(text: &str, bound: &str, accept: impl Fn(f64) -> bool) -> Result<f64, String> {
    text.parse().ok().filter(|&v| accept(v)).ok_or_else(|| format!("must be a number {bound}"))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    #[test]
    fn the_definition_is_consistent() {
        super::Cli::command().debug_assert();
    }
}
