//! Points of a scene file.

use strict::{Error, Limit, Table};

/// Coordinates and lengths stay below this, m: doubles then resolve a tenth of a nanometre.
pub(super) const METRES: f64 = 1e6;

pub(super) const POINT: Limit = Limit {
    min: -METRES,
    max: METRES,
    bound: "a point [x, y] in m, two numbers of at most 1000000 in size",
    remedy: "write it like [1.0, 2.5]",
};

/// A positive length.
pub(super) const LENGTH: Limit = Limit {
    min: 1e-6,
    max: METRES,
    bound: "a positive length in m, 0.000001 to 1000000",
    remedy: "give a length such as 0.4",
};

/// A point that must be there.
pub(super) fn point(table: &Table, key: &str) -> Result<[f64; 2], Error> {
    table.required_pair(key, &POINT)
}

/// Refuses a rectangle whose `max` does not exceed its `min`, at the key of `max`.
pub(super) fn ordered(table: &Table, key: &str, [min, max]: [[f64; 2]; 2]) -> Result<(), Error> {
    const SMALLEST_M: f64 = 1e-6;
    if (0..2).all(|k| max[k] - min[k] >= SMALLEST_M) {
        return Ok(());
    }
    let value = table.get(key).ok_or_else(|| table.missing(key, "the upper-right corner"))?;
    let bound = format!("to the right of and above min = [{}, {}]", min[0], min[1]);
    Err(table.refuse(key, value, &bound, "min is the lower-left, max the upper-right corner, in m"))
}
