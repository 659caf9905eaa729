//! The tests in one binary; one module: `cargo test --workspace --test all cli::`.

mod attic;
mod calibrate;
mod checked;
mod cli;
mod closet;
mod compare;
mod convert;
#[path = "../examples/own-gate/src/counting.rs"]
mod counting;
mod estimate;
mod features;
mod gate;
mod guide;
mod imports;
#[path = "../../crates/mapper/tests/mosaic/mod.rs"]
mod mosaic;
mod moving;
mod nook;
mod nothing_lost;
mod odometry;
mod packages;
mod page;
mod poses;
mod programs;
mod programs_everywhere;
mod ray;
mod readme;
mod recorded;
mod replay;
mod schemas;
mod score;
mod slam;
mod speed;
mod standing;
mod structure;
mod sweep;
mod thousand;
mod tuning;
mod unseen;
