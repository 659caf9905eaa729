//! What is assumed of cells before any reading.

pub mod estimate;
pub(crate) mod lateral;
pub(crate) mod prior;
pub(crate) mod probability;
pub(crate) mod renewal;
pub(crate) mod repeats;
