//! `cargo run -p experiments -- NAME`.

fn main() -> std::process::ExitCode {
    experiments::main()
}
