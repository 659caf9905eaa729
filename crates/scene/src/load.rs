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
    examine(path, cell_m, layout).map_err(|mut errors| errors.swap_remove(0))
}

/// As [`load`], for those who would rather mend all of a file at once.
///
/// # Errors
/// Every problem, at least one; not what would only follow from another.
pub fn examine(path: &Path, cell_m: Option<f64>, layout: Option<u64>) -> Result<Scene, Vec<SceneError>> {
    let one = |error: SceneError| vec![error];
    let text = strict::read(path).map_err(|error| one(error.into()))?;
    if is_family(&text) {
        let family = Family::examine(&text, path)?;
        return family.scene(layout.unwrap_or(Set::FIRST_TEST), cell_m, &Variation::default()).map_err(one);
    }
    let scene = Scene::examine(&text, path, cell_m)?;
    match layout {
        None => Ok(scene),
        Some(layout) => {
            let place = Place { file: path.display().to_string(), line: 1, column: 1 };
            Err(one(SceneError::at(place, Problem::NoFamily { layout })))
        }
    }
}
