//! Work that takes a while, on several threads, and can be interrupted.

pub mod engine;
pub mod interruption;
pub mod memory;
pub mod progress;
pub mod seal;
pub mod threads;
