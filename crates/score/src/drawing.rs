//! Worlds drawn by hand, for tests.

use grid::{GridSpec, Raster};

/// Side of a drawn cell, m.
pub(crate) const CELL_M: f64 = 0.1;

/// A world drawn from the top row down: `#` occupied, `.` free, `?` not known. The lower-left corner
/// is at (0, 0) m.
pub(crate) fn drawn(rows: &[&str]) -> Raster<Option<bool>> {
    let spec = GridSpec { cell_m: CELL_M, origin_m: [0.0; 2], width: rows[0].len(), height: rows.len() };
    let cell = |drawn| match drawn {
        '#' => Some(true),
        '.' => Some(false),
        '?' => None,
        other => panic!("{other:?} is no cell"),
    };
    Raster::new(spec, rows.iter().rev().flat_map(|row| row.chars().map(cell)).collect())
}

/// The reverse: a character for every cell, from the top row down.
pub(crate) fn picture(spec: &GridSpec, cell: impl Fn(usize) -> char) -> Vec<String> {
    (0..spec.height).rev().map(|row| (0..spec.width).map(|column| cell(spec.index(column, row))).collect()).collect()
}
