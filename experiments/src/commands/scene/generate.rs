//! `scene generate FAMILY`: the scene file of a layout.

use scene::{Family, Variation};

use super::options::GenerateOptions;
use crate::failure::Failure;
use crate::output::single::{self, Existing, Whole};
use crate::output::table;

/// Prints the scene file, or writes it.
///
/// # Errors
/// The first problem with the family; a file that cannot be written, or that is the family itself.
pub(super) fn run(options: &GenerateOptions) -> Result<(), Failure> {
    let variation = Variation { size_factor: options.size_factor };
    let text = Family::load(&options.family)?.generate(options.layout, &variation)?;
    match &options.out {
        Some(path) => {
            let whole = Whole { path: path.clone(), bytes: text.into_bytes() };
            single::put(&[whole], &[&options.family], Existing::forced(options.force))
        }
        None => table::print(&text),
    }
}
