//! The files that a sweep's worlds come from, and digests of what they say.

use std::path::{Path, PathBuf};

use scene::reader::read;
use scene::{Family, Scene, SceneError, Variation};
use serde::{Deserialize, Serialize};

use crate::digest::Running;
use crate::failure::Failure;

/// A scene or family file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Site {
    /// Its path, as the sweep names it.
    pub file: String,
    /// Digest of its text; of a scene also of what stands in it, which may come from a map.
    pub digest: String,
    /// Whether it is a family.
    pub family: bool,
}

/// What a file says.
pub enum Source {
    /// A family.
    Family(Box<Family>),
    /// A scene, its text and where it is from.
    Scene(Box<Scene>, String, PathBuf),
}

impl Site {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// A file that cannot be read, and the first problem with what it says; a scene where families are asked for,
    /// and the other way round.
    pub fn load(path: &Path, family: bool) -> Result<Self, Failure> {
        Ok(Self::open(path, family)?.0)
    }

    fn open(path: &Path, family: bool) -> Result<(Self, Source), Failure> {
        let text = read(path)?;
        let mut digest = Running::default();
        digest.add(text.as_bytes());
        let source = if family {
            Source::Family(Box::new(Family::parse(&text, path)?))
        } else {
            let scene = Scene::parse(&text, path, None)?;
            digest.add(format!("{:?} {:?}", scene.obstacles, scene.known).as_bytes());
            Source::Scene(Box::new(scene), text, path.to_owned())
        };
        let file = path.to_str().ok_or_else(|| {
            Failure::BadInput(format!(
                "{}: the name must be UTF-8 to stand in a table; rename the file",
                path.display()
            ))
        })?;
        Ok((Self { file: file.to_owned(), digest: digest.hex(), family }, source))
    }

    /// What the file says, if it still says what it did when the sweep was planned.
    ///
    /// # Errors
    /// As [`load`](Self::load), and a file that says something else.
    pub fn source(&self) -> Result<Source, Failure> {
        let (now, source) = Self::open(Path::new(&self.file), self.family)?;
        if now.digest == self.digest {
            return Ok(source);
        }
        let file = &self.file;
        Err(Failure::BadInput(format!("{file}: has changed since the sweep was planned; plan it again with --replace")))
    }
}

impl Source {
    /// The scene, of a family that of a layout. `cell_m` replaces the file's cell size (m); obstacles of a family
    /// have `size_factor` times their size.
    ///
    /// # Errors
    /// As [`Family::scene`] and [`Scene::parse`].
    pub fn scene(&self, layout: u64, cell_m: Option<f64>, size_factor: Option<f64>) -> Result<Scene, SceneError> {
        match self {
            Self::Family(family) => {
                let variation = size_factor.map_or_else(Variation::default, |size_factor| Variation { size_factor });
                family.scene(layout, cell_m, &variation)
            }
            Self::Scene(scene, ..) if cell_m.is_none() => Ok((**scene).clone()),
            Self::Scene(_, text, path) => Scene::parse(text, path, cell_m),
        }
    }
}
