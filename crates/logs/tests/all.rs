//! The tests in one binary; one module: `cargo test --workspace --test all carmen::`.

mod bag;
#[path = "../../bags/tests/writer/mod.rs"]
mod bag_writer;
mod carmen;
mod findings;
mod found_by_fuzzing;
mod sonar;
mod table;
mod trajectory;
mod writer;
