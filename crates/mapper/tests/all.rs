//! The tests in one binary; one module: `cargo test --workspace --test all fast::`.

mod batch;
mod catalogue;
mod cone;
mod difference;
mod dynamic;
mod enumeration;
mod estimate;
mod fast;
mod fork;
mod invariants;
mod laser;
mod lateral;
mod least_squares;
mod mosaic;
mod printed;
mod quick;
mod together;
mod tuning;
mod two_by_two;
mod work;
