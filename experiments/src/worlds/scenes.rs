//! Scene and family files by the names that a user gives.

use std::path::{Path, PathBuf};

/// The file of a family or scene by what a user calls it: a bare name is `scenes/NAME.toml`.
pub fn path_of(name: &str) -> PathBuf {
    let bare = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    if bare { Path::new("scenes").join(format!("{name}.toml")) } else { PathBuf::from(name) }
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
