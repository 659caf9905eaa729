//! What the numbers of `visibility-window` were chosen on: log loss over what could be seen, on tuning worlds.
//!
//! `cargo run -p experiments --features fitting --example window_parameters -- [LAYOUTS]`: a row per candidate, a column per family. One layout of each
//! family takes a minute.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program for the terminal")]

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

use experiments::commands::tune::fit::errors;
use experiments::worlds::scenes::{FAMILIES, SCENES, families};
use experiments::worlds::site::WorldId;
use mapper::{Candidate, FixedLag};
use scene::Set;

/// The chosen numbers, with one of them changed at a time.
fn tried() -> Vec<FixedLag> {
    let chosen = FixedLag::TUNED;
    let mut tried = vec![chosen];
    tried.extend([1, 8, 12, 40].map(|scans| FixedLag { scans, ..chosen }));
    tried.extend([2, 3, 8].map(|sweeps| FixedLag { sweeps, ..chosen }));
    tried.extend([0.0, 0.25, 0.4, 0.6, 1.0].map(|share| FixedLag { share, ..chosen }));
    tried.extend([32.0, 128.0].map(|draws| FixedLag { draws, ..chosen }));
    tried.extend([0.25, 0.4].map(|weight| FixedLag { weight, ..chosen }));
    tried.extend([0.0, 0.2].map(|leak| FixedLag { leak, ..chosen }));
    tried.extend([0.35, 0.45, 0.55, 0.7].map(|strength| FixedLag { strength, ..chosen }));
    tried.extend([-0.3, 0.0].map(|shift| FixedLag { shift, ..chosen }));
    tried
}

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
    println!("scans,sweeps,share,draws,weight,leak,strength,shift,{},mean", names.join(","));
    for rule in tried() {
        let candidate = Candidate::of(rule);
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
        let FixedLag { scans, sweeps, share, draws, weight, leak, strength, shift, .. } = rule;
        println!("{scans},{sweeps},{share},{draws},{weight},{leak},{strength},{shift},{}", means.join(","));
    }
    Ok(())
}
