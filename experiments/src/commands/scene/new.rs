//! `scene new`: a commented scene to begin with.

use std::path::{Path, PathBuf};

use super::options::NewOptions;
use crate::failure::Failure;
use crate::output::single::{self, Existing, Whole};
use crate::output::table;

/// The scene, called `NAME`.
const TEMPLATE: &str = include_str!("new.toml");

/// Longest name of a scene.
const LONGEST: usize = 32;

/// Writes the scene, and prints what to do with it.
///
/// # Errors
/// A name that no scene can have; a file that cannot be written, or that is there already.
pub(super) fn run(options: &NewOptions) -> Result<(), Failure> {
    let path = path(&options.file);
    let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    if !fits(&name) || path.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("toml")) {
        return Err(Failure::BadInput(format!(
            "scene new {}: must be a name of 1 to {LONGEST} letters, digits, - or _, with or without .toml; such as scene new office",
            options.file.display()
        )));
    }
    let whole = Whole { path: path.clone(), bytes: TEMPLATE.replace("NAME", &name).into_bytes() };
    single::put(&[whole], &[], Existing::forced(options.force))?;
    let shown = path.display();
    table::print(&format!("{shown}: a scene to change; next: check {shown} --show, room --scene {shown}\n"))
}

/// A name alone is a file of the working folder.
fn path(file: &Path) -> PathBuf {
    if file.extension().is_none() { file.with_extension("toml") } else { file.to_owned() }
}

fn fits(name: &str) -> bool {
    let plain = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    plain && (1..=LONGEST).contains(&name.len())
}
