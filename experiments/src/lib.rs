//! Simulate, map, score and show.
//!
//! The command line is a thin layer over this library: an experiment turns a merged configuration
//! into values ([`worlds::run::Trial`], [`worlds::claims::Claim`]), and tables, pictures and the report are views
//! of them. Results go to stdout, progress and warnings to stderr.

pub mod cli;
pub mod commands;
pub mod failure;
pub mod figures;
pub mod jobs;
pub mod output;
pub mod page;
pub mod worlds;
