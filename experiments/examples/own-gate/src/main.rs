//! A mapper of your own among the built-in ones: behind gates, and as a program for the other commands. From this folder:
//!
//! `cargo run -- --gates gates.toml` runs the gates, `cargo run -- --gates gates.toml --update` takes the maps as they
//! are now for the baseline, and `--help` shows the rest. Exit code 3 fails the build.
//!
//! `experiments room --mapper counting='online: target/debug/own-gate map'` maps a room with it, and so do `compare` and `sweep`.

mod counting;

use std::process::ExitCode;

fn main() -> ExitCode {
    match std::env::args().nth(1).as_deref() {
        Some("map") => experiments::program(&counting::COUNTING),
        _ => experiments::gate::program(&[counting::COUNTING]),
    }
}
