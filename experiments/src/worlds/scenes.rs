//! Scene and family files by the names that a user gives.

use std::path::{Path, PathBuf};

use scene::Family;

use crate::failure::Failure;

/// The families of generated scenes that come with the program.
pub const FAMILIES: &str = "scenes/clutter.toml,scenes/corridors.toml,scenes/halls.toml,scenes/two-rooms.toml";

/// The file of a family or scene by what a user calls it: a bare name is `scenes/NAME.toml`.
pub fn path_of(name: &str) -> PathBuf {
    let bare = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    if bare { Path::new("scenes").join(format!("{name}.toml")) } else { PathBuf::from(name) }
}

/// The families of the given files.
///
/// # Errors
/// A family that cannot be read, or two of a name.
pub fn families(paths: &[PathBuf]) -> Result<Vec<Family>, Failure> {
    let mut families: Vec<Family> = Vec::new();
    for path in paths {
        let family = Family::load(path)?;
        if families.iter().any(|other| other.name == family.name) {
            let name = &family.name;
            let message =
                format!("--families: {}: a family named {name:?} is among them; name each once", path.display());
            return Err(Failure::BadInput(message));
        }
        families.push(family);
    }
    Ok(families)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bare_name_is_one_of_the_scenes() {
        assert_eq!(path_of("two-rooms"), Path::new("scenes/two-rooms.toml"));
        assert_eq!(path_of("my/halls.toml"), Path::new("my/halls.toml"));
        assert_eq!(path_of("halls.toml"), Path::new("halls.toml"));
    }
}
