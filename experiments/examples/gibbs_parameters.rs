//! What the four numbers of `gibbs` were chosen on: log loss over what could be seen, on tuning worlds, maps whose chains do not agree
//! among them.
//!
//! `cargo run -p experiments --features fitting --example gibbs_parameters -- [LAYOUTS]`: a row per candidate, a column per family. Stages are short; a run takes minutes.
#![allow(clippy::print_stdout, reason = "a program for the terminal")]

mod fitting;

use std::error::Error;

use mapper::{Candidate, Sampling, Unmixed};

use fitting::Worlds;

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

fn main() -> Result<(), Box<dyn Error>> {
    let worlds = Worlds::asked_for()?;
    println!("weight,leak,strength,shift,{}", worlds.heads());
    for [weight, leak, strength, shift] in TRIED {
        let short = Sampling { most: 100, unmixed: Unmixed::Shown, ..Sampling::TUNED };
        let candidate = Candidate::of(Sampling { weight, leak, strength, shift, ..short });
        println!("{weight},{leak},{strength},{shift},{}", worlds.losses(&candidate)?);
    }
    Ok(())
}
