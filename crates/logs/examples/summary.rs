//! What a log holds: counts, duration, path, extent, and how fast it was read.
//!
//! `cargo run --release -p logs --example summary -- FILE [TRAJECTORY]`
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program for the terminal")]

use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;

use logs::{Body, Log, Options, Trajectory};

fn main() -> ExitCode {
    match summarise() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn summarise() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let path = arguments.next().ok_or("give a log: summary FILE [TRAJECTORY]")?;
    let start = Instant::now();
    let mut log = Log::open(path.as_ref(), &Options::default())?;
    if let Some(trajectory) = arguments.next() {
        log = log.along(Trajectory::open(trajectory.as_ref())?, Body::Sensor)?;
    }
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let (mut path_m, mut before) = (0.0, None::<[f64; 2]>);
    for scan in &mut log {
        let at = scan?.pose.position_m();
        path_m += before.map_or(0.0, |[x, y]| libm::hypot(at[0] - x, at[1] - y));
        before = Some(at);
        low = [0, 1].map(|k| low[k].min(at[k]));
        high = [0, 1].map(|k| high[k].max(at[k]));
    }
    let seconds = start.elapsed().as_secs_f64();
    println!("{:?}\n{}", log.sensor(), log.report());
    println!("path {path_m:.1} m, poses from ({:.1}, {:.1}) to ({:.1}, {:.1}) m", low[0], low[1], high[0], high[1]);
    println!("{:.0} lines/s, {:.0} beams/s", log.report().lines as f64 / seconds, log.report().beams as f64 / seconds);
    Ok(())
}
