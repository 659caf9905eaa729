//! A scene drawn into a file.

use std::path::Path;

use super::drawing::drawing;
use crate::failure::Failure;
use crate::figures::{self, Paper};
use crate::worlds::ground::Ground;

/// How a scene is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// As `room` draws it.
    Png,
    /// The same for print and for editing.
    Svg,
    /// In characters.
    Text,
}

impl Form {
    /// The form of a file, by the end of its name.
    ///
    /// # Errors
    /// Another end.
    pub(super) fn of(path: &Path) -> Result<Self, Failure> {
        let end = path.extension().map(|end| end.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        match end.as_str() {
            "png" => Ok(Self::Png),
            "svg" => Ok(Self::Svg),
            "txt" => Ok(Self::Text),
            _ => Err(Failure::BadInput(format!(
                "--out {}: must end in .png, .svg, or .txt for characters; such as scene.png",
                path.display()
            ))),
        }
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// More pixels than are taken.
    pub(super) fn picture(self, ground: &Ground, columns: usize) -> Result<Vec<u8>, Failure> {
        let paper = Paper::default();
        match self {
            Self::Png => paper.png(&figures::scene::draw(ground, &paper)),
            Self::Svg => Paper::svg(&figures::scene::draw(ground, &paper)).map(String::into_bytes),
            Self::Text => Ok(drawing(ground, columns).into_bytes()),
        }
    }
}
