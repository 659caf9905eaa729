//! Simulate, map, score and show: the library behind the command line.
//!
//! Programs of your own may rely on [`gate`], which runs gates on mappers of yours, on [`program`], which makes a mapper of yours
//! one for `--mapper`, and on [`main`], which is the whole command line. All else serves the tests and benches of this package and may change at any time.

#[doc(hidden)]
pub mod cli;
#[doc(hidden)]
pub mod commands;
mod exit;
#[doc(hidden)]
pub mod failure;
#[doc(hidden)]
pub mod figures;
#[doc(hidden)]
pub mod jobs;
#[doc(hidden)]
pub mod output;
#[doc(hidden)]
pub mod page;
#[doc(hidden)]
pub mod programs;
#[doc(hidden)]
pub mod worlds;

pub use cli::main;
pub use commands::gate::door as gate;
pub use programs::serve::program;
