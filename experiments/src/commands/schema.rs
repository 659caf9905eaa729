//! `schema KIND`: JSON schemas for editors.

use clap::{Args, ValueEnum};
use serde_json::Value;

use crate::failure::Failure;
use crate::output::table::print;
use crate::worlds::schema;

/// Options of `schema`.
#[derive(Debug, Args)]
pub struct SchemaOptions {
    /// Kind of file
    #[arg(value_name = "KIND", value_enum)]
    pub kind: Kind,
}

/// Kinds of files that have a schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// Scenes
    Scene,
    /// Families of scenes
    Family,
    /// Sweeps
    Sweep,
    /// Gates
    Gate,
}

/// The schemas of files that single commands read.
pub struct Schemas {
    /// Of sweeps.
    pub sweep: fn() -> Value,
    /// Of gates.
    pub gate: fn() -> Value,
}

/// Prints the schema.
///
/// # Errors
/// A stdout that cannot be written.
pub fn run(options: &SchemaOptions, of: &Schemas) -> Result<(), Failure> {
    let schema = match options.kind {
        Kind::Scene => schema::scene(),
        Kind::Family => schema::family(),
        Kind::Sweep => (of.sweep)(),
        Kind::Gate => (of.gate)(),
    };
    print(&format!("{schema:#}\n"))
}
