//! What the four numbers of `gibbs` were chosen on: log loss over what could be seen, on tuning worlds, maps whose chains do not agree
//! among them.
//!
//! `cargo run -p experiments --features fitting --example gibbs_parameters -- [LAYOUTS]`: a row per candidate, a column per family. Stages are short; a run takes minutes.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program for the terminal")]

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

use experiments::commands::tune::fit::errors;
use experiments::worlds::scenes::{FAMILIES, SCENES, families};
use experiments::worlds::site::WorldId;
use mapper::{Candidate, Sampling, Unmixed};
use scene::Set;

/// Weight of a reading, leak, strength of the field, shift.
const TRIED: [[f64; 4]; 7] = [
    [1.0, 0.1, 0.7, -0.2],
    [0.5, 0.2, 0.7, -0.2],
    [0.5, 0.1, 0.7, -0.2],
    [0.3, 0.1, 0.7, -0.2],
    [0.3, 0.05, 0.7, -0.2],
    [0.2, 0.1, 0.7, -0.2],
    [0.2, 0.05, 0.7, -0.2],
];

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let layouts: u64 = std::env::args().nth(1).map_or(Ok(1), |number| number.parse())?;
    let paths: Vec<PathBuf> =
        FAMILIES.split(',').map(|name| PathBuf::from(SCENES).join(format!("{name}.toml"))).collect();
    let families = families(&paths)?;
    let names: Vec<&str> = families.iter().map(|family| family.name.as_str()).collect();
    println!("weight,leak,strength,shift,{},mean", names.join(","));
    for [weight, leak, strength, shift] in TRIED {
        let short = Sampling { most: 100, unmixed: Unmixed::Shown, ..Sampling::TUNED };
        let candidate = Candidate::of(Sampling { weight, leak, strength, shift, ..short });
        let mut means = Vec::new();
        for family in &families {
            let mut sum = 0.0;
            for seed in Set::Tuning.seeds(layouts) {
                let condition = "as-believed".to_owned();
                let world = WorldId { family: family.name.clone(), condition, cell_um: None, seed };
                sum += errors(&world, family, std::slice::from_ref(&candidate))?[0].log_loss;
            }
            means.push(sum / layouts as f64);
        }
        means.push(means.iter().sum::<f64>() / means.len() as f64);
        let means: Vec<String> = means.iter().map(|mean| format!("{mean:.4}")).collect();
        println!("{weight},{leak},{strength},{shift},{}", means.join(","));
    }
    Ok(())
}
