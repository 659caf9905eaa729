//! Scores of a trajectory, every digit of them: against another, or against relations.
//!
//! `cargo run -p experiments --example trajectories -- ESTIMATE REFERENCE`: both trajectories in the TUM format; or a log, of which the
//! odometry is scored, or a trajectory, against a file whose name ends in `.relations`. `.ci/trajectories` compares with `evo`.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program for the terminal")]

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use logs::trajectory::relations;
use logs::{Log, Options, Trajectory};
use score::trajectory::{
    LOOP_S, Pose, PoseErrors, Relation, Spread, Stamped, Step, absolute, aligned, associated, related, relative,
};

/// Poses further apart in time are no pair, s: `evo`'s default.
const MOST_S: f64 = 0.01;

fn main() -> ExitCode {
    match scores() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn scores() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let (Some(estimate), Some(reference)) = (arguments.next(), arguments.next()) else {
        return Err("give two files: trajectories ESTIMATE REFERENCE".into());
    };
    let [estimate, reference] = [Path::new(&estimate), Path::new(&reference)];
    println!("metric,count,rmse,mean,deviation,median,max");
    if reference.extension().is_some_and(|end| end == "relations") {
        return against_relations(estimate, reference);
    }
    let pairs = associated(&poses(estimate)?, &poses(reference)?, MOST_S)?;
    print("ate", &absolute(&pairs)?);
    print("ate-aligned", &absolute(&aligned(&pairs)?)?);
    print("rpe-1-pose", &relative(&pairs, Step::Poses(1))?);
    print("rpe-10-poses", &relative(&pairs, Step::Poses(10))?);
    print("rpe-1-m", &relative(&pairs, Step::Metres(1.0))?);
    print("rpe-1-s", &relative(&pairs, Step::Seconds(1.0))?);
    Ok(())
}

fn against_relations(estimate: &Path, file: &Path) -> Result<(), Box<dyn Error>> {
    let poses = poses(estimate).or_else(|_| odometry(estimate))?;
    let known: Vec<Relation> = relations::open(file)?
        .iter()
        .map(|relation| Relation { from_s: relation.from_s, to_s: relation.to_s, motion: pose(relation.motion) })
        .collect();
    let found = related(&poses, &known, MOST_S, LOOP_S)?;
    for (name, errors) in
        [("relations", found.all), ("relations-loops", found.loops), ("relations-others", found.others)]
    {
        if let Some(errors) = errors {
            print(name, &errors.errors);
            row(&format!("{name}-translation-m2"), &errors.squares.0);
            row(&format!("{name}-rotation-rad2"), &errors.squares.1);
        }
    }
    if found.left_out > 0 {
        eprintln!("{} relations left out: no pose within {MOST_S} s of one of their times", found.left_out);
    }
    Ok(())
}

fn poses(path: &Path) -> Result<Vec<Stamped>, logs::LogError> {
    let stamped = |&(time_s, at): &(f64, sensor::Pose)| Stamped { time_s, pose: pose(at) };
    Ok(Trajectory::open(path)?.poses().iter().map(stamped).collect())
}

/// Where the odometry of a log puts the robot at each scan.
fn odometry(path: &Path) -> Result<Vec<Stamped>, logs::LogError> {
    let mut log = Log::open(path, &Options::default())?;
    let mut poses: Vec<Stamped> = Vec::new();
    while let Some(event) = log.next_event() {
        let event = event?;
        let time_s = log.report().start_s + event.scan.time_s;
        if let Some(at) = event.odometry
            && poses.last().is_none_or(|last| last.time_s < time_s)
        {
            poses.push(Stamped { time_s, pose: pose(at) });
        }
    }
    Ok(poses)
}

fn pose(at: sensor::Pose) -> Pose {
    Pose { x_m: at.x_m, y_m: at.y_m, theta_rad: at.theta_rad }
}

fn print(name: &str, errors: &PoseErrors) {
    row(&format!("{name}-translation-m"), &errors.translation_m);
    row(&format!("{name}-rotation-rad"), &errors.rotation_rad);
}

fn row(name: &str, spread: &Spread) {
    let Spread { count, rmse, mean, deviation, median, max } = spread;
    println!("{name},{count},{rmse},{mean},{deviation},{median},{max}");
}
