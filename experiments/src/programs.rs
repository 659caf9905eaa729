//! Programs of somebody else's as mappers: each works in a process of its own, by the messages of `experiments/MAPPERS.md`.
//!
//! Such a program is not trusted: it may hang, flood its outputs, leave children behind or write anything for a map. What it
//! does wrong is a fault, which costs its own map alone.

mod batch;
mod described;
mod exchange;
mod fault;
mod kept;
mod online;
pub mod options;
mod orphans;
mod process;
pub mod program;
mod talk;
