//! Reading maps.

use std::path::Path;

use grid::ros_map::{self, Coding, RosMap, Thresholds};
use grid::{GridSpec, Raster, npy};

use super::{ConvertOptions, Map, Origin, extension};
use crate::failure::Failure;
use crate::output::ledger::RECORD;

/// Reads the map that the options name, and puts it where they say.
pub(super) fn read(options: &ConvertOptions) -> Result<Map, Failure> {
    let path = options.input.as_path();
    let map = match extension(path).as_str() {
        "yaml" | "yml" => of_ros(ros_map::read(path).map_err(ros)?, vec![path.to_owned()]),
        "npy" => of_npy(path, options)?,
        "pgm" | "png" => {
            let mode = options.read_as.unwrap_or_default().into();
            let coding = Coding { mode, negate: false, thresholds: Thresholds::default() };
            let map = ros_map::read_image(path, coding, 1.0, [0.0; 2]).map_err(ros)?;
            Map { place: None, ..of_ros(map, Vec::new()) }
        }
        _ => {
            return Err(Failure::BadInput(format!(
                "{}: must end in .yaml, .npy, .pgm or .png; name the YAML file of a map, not its folder",
                path.display()
            )));
        }
    };
    Ok(placed(map, options))
}

fn of_ros(map: RosMap, mut sources: Vec<std::path::PathBuf>) -> Map {
    let place = Some((map.spec, map.yaw_rad));
    sources.push(map.image);
    Map { occupancy: map.occupancy, place, thresholds: map.coding.thresholds, sources, warnings: map.warnings }
}

/// An array lies where the record of its run, in the same folder, has the grid.
fn of_npy(path: &Path, options: &ConvertOptions) -> Result<Map, Failure> {
    let array = npy::read(path).map_err(|error| {
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
    let told = options.resolution.is_some() && options.origin.is_some();
    if !told && let Some(grid) = grid_of(&record)? {
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
    let cells = options.row_order.unwrap_or_default().apply(array.occupancy, width);
    let occupancy = Raster::new(spec, cells);
    Ok(Map { occupancy, place, thresholds: Thresholds::default(), sources, warnings: Vec::new() })
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

/// The map where the options say, or else where it was; with both numbers it needs no place of its own.
fn placed(mut map: Map, options: &ConvertOptions) -> Map {
    let spec = *map.occupancy.spec();
    let cell_m = options.resolution.or(map.place.map(|(grid, _)| grid.cell_m));
    let origin = options.origin.or(map.place.map(|(grid, yaw_rad)| Origin { corner_m: grid.origin_m, yaw_rad }));
    map.place = match (cell_m, origin) {
        (Some(cell_m), Some(origin)) => Some((GridSpec { cell_m, origin_m: origin.corner_m, ..spec }, origin.yaw_rad)),
        _ => None,
    };
    map
}

fn ros(error: ros_map::RosMapError) -> Failure {
    match &error {
        ros_map::RosMapError::Unreadable { path, .. } if path.is_file() => Failure::Internal(error.to_string()),
        _ => Failure::BadInput(error.to_string()),
    }
}
