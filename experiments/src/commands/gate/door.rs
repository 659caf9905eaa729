//! Gates as a program or a test of your own, on mappers of your own: [`program`] is the whole command line, [`judge`]
//! gives the outcomes as values.

pub use super::file::{Demand, Gate};
pub use super::options::GateOptions;
pub use super::verdict::{Outcome, Verdict};
pub use super::{judge, mappers, program, run_with};
pub use crate::output::args::{Format, FormatOption, ThreadsOption};
pub use crate::programs::options::ProgramOptions;
