//! The tests in one binary; one module: `cargo test --workspace --test all room::`.

mod features;
mod oracle;
mod room;
mod together;
mod worlds;
