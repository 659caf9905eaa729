//! `scene generate FAMILY`: the scene file of a layout.

use scene::{Family, Variation};

use crate::cli::GenerateOptions;
use crate::failure::Failure;
use crate::table;

/// Prints the scene file, or writes it.
///
/// # Errors
/// The first problem with the family, and a file that cannot be written.
pub fn run(options: &GenerateOptions) -> Result<(), Failure> {
    let variation = Variation { size_factor: options.size_factor };
    let text = Family::load(&options.family)?.generate(options.layout, &variation)?;
    match &options.out {
        Some(path) => std::fs::write(path, text).map_err(|error| Failure::write(path, &error)),
        None => table::print(&text),
    }
}
