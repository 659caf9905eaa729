//! `[bounds]`, and what must lie within them.

use strict::Table;

use super::points::{ordered, point};
use crate::{Problem, SceneError};

/// `[bounds]`, which the extent of a map or plan may stand in for.
pub(super) fn read(root: &Table, extent_m: Option<[[f64; 2]; 2]>) -> Result<[[f64; 2]; 2], SceneError> {
    let Some(table) = root.section("bounds")? else {
        return extent_m
            .ok_or_else(|| root.missing("[bounds]", "[bounds] with min = [x, y] and max = [x, y] in m").into());
    };
    table.only(&["min", "max"])?;
    let bounds = [point(&table, "min")?, point(&table, "max")?];
    ordered(&table, "max", bounds)?;
    Ok(bounds)
}

/// Refuses what reaches out of the bounds by more than rounding.
pub(super) fn within(
    extent: [[f64; 2]; 2],
    bounds: [[f64; 2]; 2],
    element: impl Fn() -> String,
) -> Result<(), Problem> {
    const ROUNDING_M: f64 = 1e-9;
    let outside = (0..2).any(|k| extent[0][k] < bounds[0][k] - ROUNDING_M || extent[1][k] > bounds[1][k] + ROUNDING_M);
    if outside { Err(Problem::OutsideBounds { element: element(), extent, bounds }) } else { Ok(()) }
}
