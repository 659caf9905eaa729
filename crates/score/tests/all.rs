//! The tests in one binary; one module: `cargo test --workspace --test all metrics::`.

mod align;
mod metrics;
mod moving;
mod navigation;
mod regions;
mod statistics;
