//! Maps in files, as robots have them.

use std::fs;
use std::path::{Path, PathBuf};

use ::grid::Raster;
use ::grid::ros_map::{self, Coding, RosMapError, Shades};
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{of_cells, to_cells};
use crate::errors::{bad, system};
use crate::grid::Grid;

/// Reads a map of map_server or Nav2 (YAML with its image).
///
/// What is suspicious about it is warned of. NumPy reads ``.npy``.
///
/// :returns: occupancy, 0 to 1 with NaN for unknown, ``(height, width)`` with the lowest row first; and its ``Grid``
#[pyfunction]
pub(crate) fn load_map(py: Python<'_>, path: PathBuf) -> PyResult<(Bound<'_, PyArray2<f64>>, Grid)> {
    let read = py.detach(|| ros_map::read(&path)).map_err(|error| of_map(&error))?;
    if read.is_turned() {
        let degrees = read.yaw_rad.to_degrees();
        return Err(bad(format!(
            "{}: the map is turned by {degrees:.1} degrees; turn it first (sightgrid convert)",
            path.display()
        )));
    }
    let warnings = py.import("warnings")?;
    for warning in &read.warnings {
        warnings.call_method1("warn", (format!("{}: {warning}", path.display()),))?;
    }
    let values = read.occupancy.values().iter().map(|share| share.map_or(f64::NAN, f64::from)).collect();
    Ok((of_cells(py, &read.spec, values)?, Grid { spec: read.spec }))
}

/// Writes ``NAME.yaml`` and ``NAME.pgm``, which map_server, Nav2 and ``load_map`` read; both whole or not at all.
///
/// :param path: ends in ``.yaml``
/// :param p: probability that each cell is occupied, NaN for unknown, ``(height, width)``
/// :param grid: its cells
#[pyfunction]
pub(crate) fn save_map(path: PathBuf, p: PyReadonlyArray2<'_, f64>, grid: PyRef<'_, Grid>) -> PyResult<()> {
    if path.extension().is_none_or(|extension| extension != "yaml") {
        return Err(bad(format!("{}: the name must end in .yaml; the image beside it ends in .pgm", path.display())));
    }
    let values = to_cells("p", &p, &grid.spec)?;
    if let Some(cell) = values.iter().position(|value| !value.is_nan() && !(0.0..=1.0).contains(value)) {
        let (column, row) = grid.spec.column_row(cell);
        return Err(bad(format!("p[{row}, {column}] is {}; it must be a probability, or NaN", values[cell])));
    }
    let shares = values.iter().map(|value| Some(*value as f32).filter(|share| !share.is_nan())).collect();
    let coding = Coding::default();
    let shades = Shades::of(&Raster::new(grid.spec, shares), &coding).map_err(bad)?;
    let mut image = Vec::new();
    shades.pgm(&mut image).map_err(system)?;
    let picture = path.with_extension("pgm");
    let name = picture.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let text = ros_map::describe(&grid.spec, 0.0, &coding, &name);
    let written = [(&picture, image), (&path, text.into_bytes())];
    let beside = |path: &Path| {
        path.with_extension(format!("{}.partial", path.extension().unwrap_or_default().to_string_lossy()))
    };
    for (path, bytes) in &written {
        fs::write(beside(path), bytes)
            .map_err(|error| system(format!("{}: cannot be written: {error}", path.display())))?;
    }
    for (path, _) in &written {
        fs::rename(beside(path), path)
            .map_err(|error| system(format!("{}: cannot be written: {error}", path.display())))?;
    }
    Ok(())
}

fn of_map(error: &RosMapError) -> PyErr {
    if error.is_io() { system(error) } else { bad(error) }
}
