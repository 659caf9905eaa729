//! Simulate, map, score and show.
//!
//! The command line is a thin layer over this library: an experiment turns a merged configuration
//! into values ([`trial::Trial`], [`claims::Claim`]), and tables, pictures and the report are views
//! of them. Results go to stdout, progress and warnings to stderr.

pub mod calibrate;
pub mod check;
pub mod claims;
pub mod cli;
pub mod compare;
pub mod convert;
pub mod digest;
pub mod engine;
pub mod estimate;
pub mod failure;
pub mod figures;
pub mod from_map;
pub mod gate;
pub mod generate;
pub mod interruption;
pub mod list;
pub mod mappers;
pub mod progress;
pub mod ray;
mod reading;
pub mod rebuild;
pub mod record;
pub mod replay;
pub mod report;
pub mod room;
pub mod scenes;
pub mod sensor_model;
pub mod speed;
pub mod staging;
pub mod summary;
pub mod sweep;
pub mod table;
pub mod threads;
pub mod trial;
pub mod tune;
