//! The files that a sweep's worlds come from, and digests of what they say.

use std::path::{Path, PathBuf};

use scene::reader::with;
use scene::{Family, Scene, SceneError, Variation};
use serde::{Deserialize, Serialize};
use strict::read;

use super::parameters::{Settings, number_of, overrides};
use crate::failure::Failure;
use crate::output::digest::Running;

/// A scene or family file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SourceFile {
    /// Its path, as the sweep names it.
    pub file: String,
    /// Digest of its text; of a scene also of what stands in it, which may come from a map.
    pub digest: String,
    /// Whether it is a family.
    pub family: bool,
}

/// A file's text, which was read without a problem.
pub struct SourceText {
    text: String,
    path: PathBuf,
    family: bool,
}

impl SourceFile {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// A file that cannot be read, and the first problem with its content; a scene where families are asked for,
    /// and the other way round.
    pub fn load(path: &Path, family: bool) -> Result<Self, Failure> {
        Ok(Self::open(path, family)?.0)
    }

    /// Reads and checks a file, and gives its content.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn open(path: &Path, family: bool) -> Result<(Self, SourceText), Failure> {
        let text = read(path)?;
        let mut digest = Running::default();
        digest.add(text.as_bytes());
        if family {
            Family::parse(&text, path)?;
        } else {
            let scene = Scene::parse(&text, path, None)?;
            digest.add(format!("{:?} {:?}", scene.obstacles, scene.known).as_bytes());
        }
        let file = path.to_str().ok_or_else(|| {
            Failure::BadInput(format!(
                "{}: the name must be UTF-8 to stand in a table; rename the file",
                path.display()
            ))
        })?;
        let site = Self { file: file.to_owned(), digest: digest.hex(), family };
        Ok((site, SourceText { text, path: path.to_owned(), family }))
    }

    /// The content of the file, if it is the same as when the sweep was planned.
    ///
    /// # Errors
    /// As [`load`](Self::load), and a file with another content.
    pub fn source(&self) -> Result<SourceText, Failure> {
        let (now, source) = Self::open(Path::new(&self.file), self.family)?;
        if now.digest == self.digest {
            return Ok(source);
        }
        let file = &self.file;
        Err(Failure::BadInput(format!("{file}: has changed since the sweep was planned; plan it again with --replace")))
    }
}

impl SourceText {
    /// The scene, of a family that of a layout, with the given settings.
    ///
    /// # Errors
    /// As [`Family::scene`] and [`Scene::parse`]; settings that do not go together.
    pub fn scene(&self, layout: u64, settings: &Settings) -> Result<Scene, SceneError> {
        let (text, cell_m) = (self.with(settings)?, number_of(settings, "grid"));
        if !self.family {
            return Scene::parse(&text, &self.path, cell_m);
        }
        let size_factor = number_of(settings, "size_factor");
        let variation = size_factor.map_or_else(Variation::default, |size_factor| Variation { size_factor });
        Family::parse(&text, &self.path)?.scene(layout, cell_m, &variation)
    }

    /// Whether the file can have the given settings; of a family no layout is made.
    ///
    /// # Errors
    /// A value that this file does not know, or that does not go with its others.
    pub fn check(&self, settings: &Settings) -> Result<(), SceneError> {
        let text = self.with(settings)?;
        if self.family {
            Family::parse(&text, &self.path).map(drop)
        } else {
            Scene::parse(&text, &self.path, None).map(drop)
        }
    }

    fn with(&self, settings: &Settings) -> Result<String, SceneError> {
        with(&self.text, &self.path.display().to_string(), &overrides(settings))
    }
}
