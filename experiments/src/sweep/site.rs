//! The files that a sweep's worlds come from, and digests of what they say.

use std::fs;
use std::path::{Path, PathBuf};

use scene::{Family, Scene};

use super::digest::{Running, hex, sha256};
use crate::failure::Failure;

/// A scene or family file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Site {
    /// Its path, as the sweep names it.
    pub file: String,
    /// Digest of its text; of a scene also of what stands in it, which may come from a map.
    pub digest: String,
    /// Whether it is a family.
    pub family: bool,
}

impl Site {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// A file that cannot be read, and the first problem with what it says; a scene where families are asked for,
    /// and the other way round.
    pub fn load(path: &PathBuf, family: bool) -> Result<Self, Failure> {
        let text = fs::read(path);
        let mut digest = Running::default();
        if family {
            Family::load(path)?;
            digest.add(&text.unwrap_or_default());
        } else {
            let scene = Scene::load(path, None)?;
            digest.add(&text.unwrap_or_default());
            digest.add(format!("{:?} {:?}", scene.obstacles, scene.known).as_bytes());
        }
        let file = path.to_str().ok_or_else(|| {
            Failure::BadInput(format!(
                "{}: the name must be UTF-8 to stand in a table; rename the file",
                path.display()
            ))
        })?;
        Ok(Self { file: file.to_owned(), digest: digest.hex(), family })
    }

    /// Refuses a file that says something else than when the sweep was planned.
    ///
    /// # Errors
    /// As [`load`](Self::load), and such a file.
    pub fn confirm(&self) -> Result<(), Failure> {
        if Self::load(&PathBuf::from(&self.file), self.family)?.digest == self.digest {
            return Ok(());
        }
        let file = Path::new(&self.file).display();
        Err(Failure::BadInput(format!("{file}: has changed since the sweep was planned; plan it again with --replace")))
    }
}

/// A digest of a text, to compare sweeps by.
pub fn digest_of(text: &str) -> String {
    hex(&sha256(text.as_bytes()))
}
