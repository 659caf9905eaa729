//! `gate` with a mapper of your own among the built-in ones. From this folder:
//!
//! `cargo run -- --gates gates.toml` runs the gates, `cargo run -- --gates gates.toml --update` takes the maps as they
//! are now for the baseline, and `--help` shows the rest. Exit code 3 fails the build.

mod counting;

fn main() -> std::process::ExitCode {
    experiments::gate::program(&[counting::COUNTING])
}
