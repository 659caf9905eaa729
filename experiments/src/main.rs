//! `cargo run -p experiments -- NAME`.

use std::process::ExitCode;

use clap::Parser as _;
use experiments::cli;
use experiments::commands::{
    calibrate, check, compare, convert, estimate, gate, list, ray, replay, report, room, scene, sensor, speed, sweep,
    tune,
};

fn main() -> ExitCode {
    let outcome = match cli::Cli::parse().command {
        cli::Command::Room(options) => room::run(&options),
        cli::Command::Compare(options) => compare::run(&options),
        cli::Command::Gate(options) => gate::run(&options),
        cli::Command::Sweep(options) => sweep::run(&options),
        cli::Command::Tune(options) => tune::run(&options),
        cli::Command::Ray(options) => ray::run(&options),
        cli::Command::Sensor(options) => sensor::run(&options),
        cli::Command::Speed(options) => speed::run(&options),
        cli::Command::Replay(options) => replay::run(&options),
        cli::Command::Calibrate(options) => calibrate::run(&options),
        cli::Command::Report(options) => report::run(&options),
        cli::Command::Convert(options) => convert::run(&options),
        cli::Command::Check(options) => check::run(&options),
        cli::Command::Scene(cli::SceneCommand::Generate(options)) => scene::generate::run(&options),
        cli::Command::Scene(cli::SceneCommand::FromMap(options)) => {
            scene::from_map::run(&options, scene::from_map::Kind::Map)
        }
        cli::Command::Scene(cli::SceneCommand::FromPlan(options)) => {
            scene::from_map::run(&options, scene::from_map::Kind::Plan)
        }
        cli::Command::Estimate(options) => estimate::run(&options),
        cli::Command::List(options) => list::run(&options),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
