//! Maps in files of every form: ROS YAML with its image, NPY, and images alone.

mod forms;

use std::path::{Path, PathBuf};

use grid::ros_map::{self, Coding, RosMap, Thresholds, Warning};
use grid::{GridSpec, Raster, npy};

pub use forms::{Origin, RowOrder, Shading};
pub(crate) use forms::{origin, side};

use crate::failure::Failure;
use crate::output::ledger::RECORD;

/// A map as a file holds it.
pub(crate) struct MapFile {
    /// Shares of occupancy, none where nothing is known; the place of these cells is `place`.
    pub(crate) occupancy: Raster<Option<f32>>,
    /// The same in double precision, of an array that single precision does not hold and where it is asked for.
    pub(crate) in_full: Option<Raster<Option<f64>>>,
    /// Where the cells lie, and the angle of their rows, rad; none for a map that has no place.
    pub(crate) place: Option<(GridSpec, f64)>,
    /// What the file says is occupied and free.
    pub(crate) thresholds: Thresholds,
    /// The files that it was read from.
    pub(crate) sources: Vec<PathBuf>,
    /// What is suspicious about it.
    pub(crate) warnings: Vec<Warning>,
}

/// What the command line says of a file that does not say it itself.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Reading {
    /// What the shades of an image without YAML mean.
    pub(crate) shading: Shading,
    /// The first row of an array.
    pub(crate) row_order: RowOrder,
    /// Whether the command line has a place, so that the record beside an array is not asked.
    pub(crate) placed: bool,
    /// Whether arrays are kept in double precision too.
    pub(crate) in_full: bool,
}

/// The extension of a file's name, in small letters.
pub(crate) fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
}

/// Reads a map of any form; an array lies where the record of its run, in the same folder, has the grid.
///
/// # Errors
/// A file that cannot be read or is no map.
pub(crate) fn read(path: &Path, reading: Reading) -> Result<MapFile, Failure> {
    let kind = std::fs::metadata(path).map(|found| found.file_type());
    let refuse = |what: &str| Err(Failure::BadInput(format!("{}: {what}", path.display())));
    match kind {
        Ok(kind) if kind.is_dir() => return refuse("is a folder; name the file of a map in it"),
        // Would be waited for.
        Ok(kind) if !kind.is_file() => return refuse("is a pipe or a device; save the map to a file and name that"),
        _ => {}
    }
    match extension(path).as_str() {
        "yaml" | "yml" => Ok(of_ros(ros_map::read(path).map_err(ros)?, vec![path.to_owned()])),
        "npy" => of_npy(path, reading),
        "pgm" | "png" => {
            let coding = Coding { mode: reading.shading.into(), negate: false, thresholds: Thresholds::default() };
            let map = ros_map::read_image(path, coding, 1.0, [0.0; 2]).map_err(ros)?;
            Ok(MapFile { place: None, ..of_ros(map, Vec::new()) })
        }
        _ => Err(Failure::BadInput(format!(
            "{}: must end in .yaml, .npy, .pgm or .png; name the YAML file of a map, not its folder",
            path.display()
        ))),
    }
}

fn of_ros(map: RosMap, mut sources: Vec<PathBuf>) -> MapFile {
    let place = Some((map.spec, map.yaw_rad));
    sources.push(map.image);
    MapFile {
        occupancy: map.occupancy,
        in_full: None,
        place,
        thresholds: map.coding.thresholds,
        sources,
        warnings: map.warnings,
    }
}

/// An array lies where the record of its run, in the same folder, has the grid.
fn of_npy(path: &Path, reading: Reading) -> Result<MapFile, Failure> {
    let (array, in_full) = arrays(path, reading).map_err(|error| {
        if error.is_io() && path.exists() {
            Failure::Internal(error.to_string())
        } else {
            Failure::BadInput(error.to_string())
        }
    })?;
    let (width, height) = (array.width, array.height);
    let record = path.with_file_name(RECORD);
    let mut sources = vec![path.to_owned()];
    let mut place = None;
    if !reading.placed
        && let Some(grid) = grid_of(&record)?
    {
        if (grid.width, grid.height) != (width, height) {
            return Err(Failure::BadInput(format!(
                "{}: its grid has {} x {} cells: must be {width} x {height}, as {}; give --resolution and --origin",
                record.display(),
                grid.width,
                grid.height,
                path.display()
            )));
        }
        place = Some((grid, 0.0));
        sources.push(record);
    }
    let spec = GridSpec { cell_m: 1.0, origin_m: [0.0; 2], width, height };
    let occupancy = Raster::new(spec, reading.row_order.apply(array.occupancy, width));
    let in_full = in_full.map(|array| Raster::new(spec, reading.row_order.apply(array.occupancy, width)));
    Ok(MapFile { occupancy, in_full, place, thresholds: Thresholds::default(), sources, warnings: Vec::new() })
}

/// An array in single precision, and where that is asked for and says something else, in double.
fn arrays(path: &Path, reading: Reading) -> Result<(npy::Array, Option<npy::Array<f64>>), npy::NpyError> {
    if !reading.in_full {
        return Ok((npy::read(path)?, None));
    }
    let full = npy::read_file_in_full(path)?;
    let halves = full.occupancy.iter().map(|share| share.map(|share| share as f32)).collect();
    let single = npy::Array { width: full.width, height: full.height, occupancy: halves };
    let held = |share: &Option<f64>| share.is_none_or(|share| f64::from(share as f32).to_bits() == share.to_bits());
    let same = full.occupancy.iter().all(held);
    Ok((single, (!same).then_some(full)))
}

/// The grid of a record, if it has one.
fn grid_of(record: &Path) -> Result<Option<GridSpec>, Failure> {
    let Ok(text) = std::fs::read_to_string(record) else { return Ok(None) };
    let wrong = |error: serde_json::Error| {
        Failure::BadInput(format!("{}: is not understood: {error}; give --resolution and --origin", record.display()))
    };
    let mut record: serde_json::Value = serde_json::from_str(&text).map_err(wrong)?;
    match record.get_mut("grid").map(serde_json::Value::take) {
        Some(grid) if grid.is_object() => serde_json::from_value(grid).map(Some).map_err(wrong),
        _ => Ok(None),
    }
}

fn ros(error: ros_map::RosMapError) -> Failure {
    match &error {
        ros_map::RosMapError::Unreadable { path, .. } if path.is_file() => Failure::Internal(error.to_string()),
        _ => Failure::BadInput(error.to_string()),
    }
}
