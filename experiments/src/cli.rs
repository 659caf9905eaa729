//! The command line: the tree of commands.

mod help;

use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};

use crate::commands::calibrate::{self, CalibrateOptions};
use crate::commands::check::{self, CheckOptions, Readers};
use crate::commands::compare::{self, CompareOptions};
use crate::commands::completions::{self, CompletionsOptions};
use crate::commands::convert::{self, ConvertOptions};
use crate::commands::estimate;
use crate::commands::features::{self, FeaturesOptions};
use crate::commands::gate::{self, GateOptions};
use crate::commands::guide::{self, GuideOptions};
use crate::commands::list::{self, ListOptions};
use crate::commands::ray::{self, RayOptions};
use crate::commands::replay::{self, ReplayOptions};
use crate::commands::report::{self, ReportOptions};
use crate::commands::room::{self, RoomOptions};
use crate::commands::scene::{self, SceneCommand};
use crate::commands::schema::{self, SchemaOptions, Schemas};
use crate::commands::score::{self, ScoreOptions};
use crate::commands::sensor::{self, SensorOptions};
use crate::commands::slam::{self, SlamOptions};
use crate::commands::slam_worlds::{self, SlamWorldsOptions};
use crate::commands::speed::{self, SpeedOptions};
use crate::commands::sweep::{self, SweepOptions};
use crate::commands::tune::{self, TuneOptions};
use crate::exit;
use crate::failure::Failure;
use crate::jobs::memory;
use crate::output::args::{Given, LoudnessOptions};
use crate::output::loudness::{self, Loudness};
use crate::output::{detail, table};
use crate::programs::watcher;
use crate::worlds::scenes::SceneOptions;
use crate::worlds::shipped;

/// The names that the program goes by.
const NAMES: [&str; 2] = ["experiments", "sightgrid"];

/// No help is wider, in columns.
const WIDEST: usize = 100;

/// Tells good maps from bad ones: simulates a robot with a stereo camera, maps what it sees by
/// several rules, and scores the maps against the truth.
#[derive(Debug, Parser)]
#[command(
    version = env!("SIGHTGRID_VERSION"),
    max_term_width = WIDEST,
    after_help = "Exit codes: 0 done, 1 internal or I/O error, 2 usage or bad input, 3 a claim does not hold or a gate fails, \
                  75 interrupted, run again to go on, 130 Ctrl-C."
)]
struct Cli {
    /// How much is said on stderr
    #[command(flatten)]
    loudness: LoudnessOptions,
    /// What to run.
    #[command(subcommand)]
    command: Command,
}

/// The experiments.
#[derive(Debug, Subcommand)]
enum Command {
    /// Map one place by several rules: every map scored, drawn and shown in a report (paper: Section 3.3, Figures 11-14)
    Room(RoomOptions),
    /// Say which mapper is better, where, by how much and how surely, over many generated worlds
    Compare(CompareOptions),
    /// Fail the build when maps get worse: against bounds, baselines or another mapper
    Gate(GateOptions),
    /// One table of many settings over many worlds, in shards that run anywhere
    Sweep(SweepOptions),
    /// Fit the parameters of mappers, on worlds that no result is reported on
    Tune(TuneOptions),
    /// Show what every rule makes of one reading on one viewing ray (paper: Section 3.2, Figures 8-10)
    Ray(RayOptions),
    /// Show what a camera's reading says of range: its density and its kernel (paper: Section 3.1, Figures 6 and 7)
    Sensor(SensorOptions),
    /// Measure what every mapper costs on this machine: time per cell, ray and scan, and memory
    Speed(SpeedOptions),
    /// Map what a real robot recorded, and score the maps by how well they predict scans kept back
    Replay(Box<ReplayOptions>),
    /// Find where a robot went and what lies there together, from scans and odometry: a particle filter with a map to each particle
    Slam(Box<SlamOptions>),
    /// Find landmarks, and with them where a robot went, from point features: Kalman filters from known poses, or FastSLAM
    Features(Box<FeaturesOptions>),
    /// Score `slam` on generated worlds: trajectories and maps against the truth, by stereo camera and laser
    SlamWorlds(SlamWorldsOptions),
    /// Score maps of any maker against the truth: a scene, or a map that is believed
    Score(Box<ScoreOptions>),
    /// Fit a sensor's kernel and the prior to a log, or to disparities with known truth
    Calibrate(CalibrateOptions),
    /// Make the page of a folder of results anew, from what the folder says it was made from
    Report(ReportOptions),
    /// Convert a map between ROS YAML and image, NPY and PNG, cell by cell
    Convert(ConvertOptions),
    /// Check a scene, family, sweep or gates and say what the file holds, without mapping anything
    Check(CheckOptions),
    /// Make a scene file: a new one, or from a family of scenes, a robot's map or a floor plan
    #[command(subcommand)]
    Scene(SceneCommand),
    /// Estimate prior, correlation and mean obstacle length from a scene's ground truth (paper: Section 3.2)
    Estimate(SceneOptions),
    /// Print the JSON schema of a kind of file, by which editors complete it
    Schema(SchemaOptions),
    /// Print the completions of a shell, for its start-up file
    Completions(CompletionsOptions),
    /// Print a manual page: man > sightgrid.1
    Man,
    /// Print a page of the guide, or which there are
    Guide(GuideOptions),
    /// List commands, mappers, scenes, families and sweeps at hand
    List(ListOptions),
}

/// The commands that leave a page, each with what makes its page anew.
const PAGES: [(&str, report::Renewal); 3] =
    [("room", room::renewed_page), ("compare", compare::renewed_page), ("score", score::renewed_page)];

/// Runs the command that the command line names.
pub fn main() -> ExitCode {
    if let Some(code) = watcher::if_asked() {
        return code;
    }
    strict::bring(shipped::FILES);
    let matches = help::grouped(command(), table::width().unwrap_or(WIDEST).min(WIDEST)).get_matches();
    let Cli { loudness, mut command } = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    match loudness {
        LoudnessOptions { quiet: true, .. } => loudness::set(Loudness::Quiet),
        LoudnessOptions { verbose: true, .. } => loudness::set(Loudness::Verbose),
        LoudnessOptions { .. } => {}
    }
    let given = matches.subcommand().map(|(_, options)| Given::of(options)).unwrap_or_default();
    match &mut command {
        Command::Replay(options) => options.given = given,
        Command::Slam(options) => options.given = given,
        Command::Features(options) => options.given = given,
        Command::Calibrate(options) => options.given = given,
        Command::Speed(options) => options.given = given,
        _ => {}
    }
    let start = Instant::now();
    let code = exit::code(memory::guarded(|| run(command)));
    detail(format_args!("{:.2} s in all", start.elapsed().as_secs_f64()));
    code
}

/// The command line, by the name that it was started by.
fn command() -> clap::Command {
    let started = std::env::args_os().next().unwrap_or_default();
    let own = Path::new(&started).file_stem().is_some_and(|stem| stem == NAMES[1]);
    Cli::command().name(NAMES[usize::from(own)])
}

fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Room(options) => room::run(&options),
        Command::Compare(options) => compare::run(&options),
        Command::Gate(options) => gate::run(&options),
        Command::Sweep(options) => sweep::run(&options),
        Command::Tune(options) => tune::run(&options),
        Command::Ray(options) => ray::run(&options),
        Command::Sensor(options) => sensor::run(&options),
        Command::Speed(options) => speed::run(&options),
        Command::Replay(options) => replay::run(*options),
        Command::Slam(options) => slam::run(*options),
        Command::Features(options) => features::run(&options),
        Command::SlamWorlds(options) => slam_worlds::run(&options),
        Command::Score(options) => score::run(&options),
        Command::Calibrate(options) => calibrate::run(options),
        Command::Report(options) => report::run(&options, &PAGES),
        Command::Convert(options) => convert::run(&options),
        Command::Check(options) => check::run(&options, &Readers { sweep: sweep::held, gate: gate::held }),
        Command::Scene(command) => scene::run(&command),
        Command::Estimate(options) => estimate::run(&options),
        Command::Schema(options) => schema::run(&options, &Schemas { sweep: sweep::schema, gate: gate::schema }),
        Command::Completions(options) => completions::run(&options, self::command()),
        Command::Man => completions::man(self::command()),
        Command::Guide(options) => guide::run(&options),
        Command::List(options) => list::run(&options, Cli::command().get_subcommands()),
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    #[test]
    fn the_definition_is_consistent() {
        super::Cli::command().debug_assert();
    }
}
