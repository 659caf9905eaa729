//! Scene files, made from families, maps and floor plans.

pub mod from_map;
pub mod generate;
