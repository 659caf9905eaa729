//! A map between its forms.

use std::path::{Path, PathBuf};

use grid::ros_map::{Thresholds, Warning};
use grid::{GridSpec, Raster};

/// A map on its way.
pub(super) struct Map {
    pub(super) occupancy: Raster<Option<f32>>,
    /// None for a map that has no place.
    pub(super) place: Option<(GridSpec, f64)>,
    pub(super) thresholds: Thresholds,
    /// The files that it was read from.
    pub(super) sources: Vec<PathBuf>,
    /// What is suspicious about it.
    pub(super) warnings: Vec<Warning>,
}

/// Cells of which a state does not say all.
pub(super) fn graded(map: &Map) -> usize {
    map.occupancy.values().iter().flatten().filter(|share| **share > 0.0 && **share < 1.0).count()
}

/// The extension of a file's name, in small letters.
pub(super) fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
}
