//! The same program under the project's name: `cargo install --path experiments --bin sightgrid`.

fn main() -> std::process::ExitCode {
    experiments::main()
}
