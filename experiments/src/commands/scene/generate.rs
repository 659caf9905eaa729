//! `scene generate FAMILY`: the scene file of a layout.

use scene::{Family, Variation};

use super::options::GenerateOptions;
use crate::failure::Failure;
use crate::output::folder;
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
            let place = |path| std::fs::canonicalize(path).ok();
            if place(path).is_some() && place(path) == place(&options.family) {
                let message = format!("--out: {}: is the family itself; choose another file", path.display());
                return Err(Failure::BadInput(message));
            }
            folder::replace(path, text.as_bytes())
        }
        None => table::print(&text),
    }
}
