//! `[bounds]`, and what must lie within them.

use strict::Table;

use super::findings::Findings;
use super::points::{ordered, point};
use crate::Problem;

/// `[bounds]`, which the extent of a map or plan may stand in for.
pub(super) fn read(root: &Table, extent: Extent, found: &mut Findings) -> Option<[[f64; 2]; 2]> {
    let Some(table) = found.take(root.section("bounds"))? else {
        let example = "[bounds] with min = [x, y] and max = [x, y] in m";
        return match extent {
            Extent::Known(extent_m) => Some(extent_m),
            Extent::Refused => None,
            Extent::None => found.take(Err(root.missing("[bounds]", example))),
        };
    };
    found.only(&table, &["min", "max"]);
    let (min, max) = (found.take(point(&table, "min")), found.take(point(&table, "max")));
    let bounds = [min?, max?];
    found.take(ordered(&table, "max", bounds)).map(|()| bounds)
}

/// How far the map or plan of a scene reaches.
pub(super) enum Extent {
    /// So far, m.
    Known([[f64; 2]; 2]),
    /// There is one, and it cannot be used.
    Refused,
    /// There is neither.
    None,
}

/// What lies within nothing reaches out of it: where the bounds themselves are wrong.
pub(super) const ENDLESS: [[f64; 2]; 2] = [[f64::NEG_INFINITY; 2], [f64::INFINITY; 2]];

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
