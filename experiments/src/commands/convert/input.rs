//! Reading the map to convert.

use grid::GridSpec;

use super::ConvertOptions;
use crate::failure::Failure;
use crate::worlds::map_file::{self, MapFile, Origin, Reading};

/// Reads the map that the options name, and puts it where they say.
pub(super) fn read(options: &ConvertOptions) -> Result<MapFile, Failure> {
    let reading = Reading {
        shading: options.read_as.unwrap_or_default(),
        row_order: options.row_order.unwrap_or_default(),
        placed: options.resolution.is_some() && options.origin.is_some(),
        in_full: false,
    };
    Ok(placed(map_file::read(&options.input, reading)?, options))
}

/// The map where the options say, or else where it was; with both numbers it needs no place of its own.
fn placed(mut map: MapFile, options: &ConvertOptions) -> MapFile {
    let spec = *map.occupancy.spec();
    let cell_m = options.resolution.or(map.place.map(|(grid, _)| grid.cell_m));
    let origin = options.origin.or(map.place.map(|(grid, yaw_rad)| Origin { corner_m: grid.origin_m, yaw_rad }));
    map.place = match (cell_m, origin) {
        (Some(cell_m), Some(origin)) => Some((GridSpec { cell_m, origin_m: origin.corner_m, ..spec }, origin.yaw_rad)),
        _ => None,
    };
    map
}
