//! Scenes out of files of either form.

use std::path::Path;

use strict::Place;

use crate::family::{Family, Set, Variation};
use crate::file::is_family;
use crate::{Problem, Scene, SceneError};

/// The scene at `path`: a scene file's, or with `layout` that of a family file. `cell_m` replaces the file's
/// cell size (m).
///
/// # Errors
/// As [`Scene::load`] and [`Family::scene`]; a layout of what is no family.
pub fn load(path: &Path, cell_m: Option<f64>, layout: Option<u64>) -> Result<Scene, SceneError> {
    let text = strict::read(path)?;
    if is_family(&text) {
        return Family::parse(&text, path)?.scene(layout.unwrap_or(Set::FIRST_TEST), cell_m, &Variation::default());
    }
    let scene = Scene::parse(&text, path, cell_m)?;
    match layout {
        None => Ok(scene),
        Some(layout) => {
            let place = Place { file: path.display().to_string(), line: 1, column: 1 };
            Err(SceneError::at(place, Problem::NoFamily { layout }))
        }
    }
}
