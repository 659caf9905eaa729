//! What the numbers of `visibility-window` were chosen on: log loss over what could be seen, on tuning worlds.
//!
//! `cargo run -p experiments --features fitting --example window_parameters -- [LAYOUTS]`: a row per candidate, a column per family. One layout of each
//! family takes a minute.
#![allow(clippy::print_stdout, reason = "a program for the terminal")]

mod fitting;

use std::error::Error;

use mapper::{Candidate, FixedLag};

use fitting::Worlds;

/// The chosen numbers, with one of them changed at a time.
fn tried() -> Vec<FixedLag> {
    let chosen = FixedLag::TUNED;
    let mut tried = vec![chosen];
    tried.extend([1, 6, 9, 20, 40].map(|scans| FixedLag { scans, ..chosen }));
    tried.extend([2, 4].map(|sweeps| FixedLag { sweeps, ..chosen }));
    tried.extend([0.0, 0.2, 0.5, 0.65, 1.0].map(|share| FixedLag { share, ..chosen }));
    tried.extend([6.0, 24.0, 64.0].map(|draws| FixedLag { draws, ..chosen }));
    tried.extend([0.25, 0.4, 0.7].map(|weight| FixedLag { weight, ..chosen }));
    tried.extend([0.05, 0.1].map(|leak| FixedLag { leak, ..chosen }));
    tried.extend([0.4, 0.45, 0.55, 0.6].map(|strength| FixedLag { strength, ..chosen }));
    tried.extend([-0.2, 0.2].map(|shift| FixedLag { shift, ..chosen }));
    tried
}

fn main() -> Result<(), Box<dyn Error>> {
    let worlds = Worlds::asked_for()?;
    println!("scans,sweeps,share,draws,weight,leak,strength,shift,{}", worlds.heads());
    for rule in tried() {
        let FixedLag { scans, sweeps, share, draws, weight, leak, strength, shift, .. } = rule;
        let losses = worlds.losses(&Candidate::of(rule))?;
        println!("{scans},{sweeps},{share},{draws},{weight},{leak},{strength},{shift},{losses}");
    }
    Ok(())
}
