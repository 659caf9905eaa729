//! Where the cells of a map are.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Why a grid cannot be made.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum GridError {
    /// The cell size is zero, negative or not finite.
    #[error("cell size {0} m is not a positive, finite length")]
    CellSize(f64),
    /// The rectangle is empty or not finite.
    #[error("the rectangle from {min:?} to {max:?} m is empty or not finite: max must exceed min")]
    Extent {
        /// Lower-left corner, m.
        min: [f64; 2],
        /// Upper-right corner, m.
        max: [f64; 2],
    },
    /// More cells than can be addressed.
    #[error(
        "{columns:.0} x {rows:.0} cells are more than the {limit} a map can address: use larger cells or a smaller rectangle"
    )]
    TooManyCells {
        /// Cells along x.
        columns: f64,
        /// Cells along y.
        rows: f64,
        /// The largest number of cells.
        limit: usize,
    },
}

/// The cells of a map: a `width` x `height` rectangle of squares with side `cell_m`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GridSpec {
    /// Side of a cell, m.
    pub cell_m: f64,
    /// Lower-left corner of cell (0, 0), m.
    pub origin_m: [f64; 2],
    /// Cells along x.
    pub width: usize,
    /// Cells along y.
    pub height: usize,
}

impl GridSpec {
    /// Cell indices fit a `u32`, edges (two per cell) too.
    pub const MAX_CELLS: usize = (u32::MAX / 2) as usize;

    /// The grid with cells of side `cell_m` that covers the rectangle from `min` to `max` (m).
    /// Its lower-left corner is `min`; a last row or column may reach past `max`.
    ///
    /// # Errors
    /// A cell size or rectangle that is empty or not finite; more than [`Self::MAX_CELLS`] cells.
    pub fn covering(min: [f64; 2], max: [f64; 2], cell_m: f64) -> Result<Self, GridError> {
        if !(cell_m > 0.0 && cell_m.is_finite()) {
            return Err(GridError::CellSize(cell_m));
        }
        let size = [max[0] - min[0], max[1] - min[1]];
        if !size.iter().all(|s| s.is_finite() && *s > 0.0) {
            return Err(GridError::Extent { min, max });
        }
        // A side that is a whole number of cells up to rounding gets no extra sliver.
        let [columns, rows] = size.map(|s| (s / cell_m - 1e-6).ceil().max(1.0));
        if columns * rows > Self::MAX_CELLS as f64 {
            return Err(GridError::TooManyCells { columns, rows, limit: Self::MAX_CELLS });
        }
        Ok(Self { cell_m, origin_m: min, width: columns as usize, height: rows as usize })
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.width * self.height
    }

    /// Area of one cell, m².
    pub fn cell_area_m2(&self) -> f64 {
        self.cell_m * self.cell_m
    }

    /// Index of the cell at (`column`, `row`), both inside the grid.
    pub fn index(&self, column: usize, row: usize) -> usize {
        debug_assert!(column < self.width && row < self.height);
        row * self.width + column
    }

    /// Column and row of a cell.
    pub fn column_row(&self, index: usize) -> (usize, usize) {
        (index % self.width, index / self.width)
    }

    /// Lower-left corner of a cell, m.
    pub fn corner(&self, index: usize) -> [f64; 2] {
        let (column, row) = self.column_row(index);
        [self.origin_m[0] + column as f64 * self.cell_m, self.origin_m[1] + row as f64 * self.cell_m]
    }

    /// Centre of a cell, m.
    pub fn centre(&self, index: usize) -> [f64; 2] {
        let (column, row) = self.column_row(index);
        self.centre_at(column, row)
    }

    /// Centre of the cell at (`column`, `row`), m.
    #[inline]
    pub fn centre_at(&self, column: usize, row: usize) -> [f64; 2] {
        let corner = [self.origin_m[0] + column as f64 * self.cell_m, self.origin_m[1] + row as f64 * self.cell_m];
        corner.map(|c| c + 0.5 * self.cell_m)
    }

    /// The cell that holds `point` (m), if the grid does. A point on a grid line belongs to the
    /// cell above or to the right of it.
    pub fn locate(&self, point: [f64; 2]) -> Option<usize> {
        let column = ((point[0] - self.origin_m[0]) / self.cell_m).floor();
        let row = ((point[1] - self.origin_m[1]) / self.cell_m).floor();
        let inside = column >= 0.0 && row >= 0.0 && column < self.width as f64 && row < self.height as f64;
        inside.then(|| self.index(column as usize, row as usize))
    }

    /// Number of the edge between two 4-neighbours: twice the lower cell's index, plus one where
    /// the neighbour is above rather than to the right. Edge numbers are below `2 * cells()`.
    pub fn edge_between(&self, a: usize, b: usize) -> usize {
        let (low, high) = (a.min(b), a.max(b));
        let above = high - low == self.width && (self.width > 1 || high != low);
        debug_assert!(above || (high - low == 1 && high % self.width != 0), "cells {a} and {b} are no neighbours");
        2 * low + usize::from(above)
    }

    /// The neighbours of a cell with the edges to them: right, up, left, down, where they exist.
    pub fn neighbours(&self, index: usize) -> impl Iterator<Item = Neighbour> + use<> {
        let (column, row) = self.column_row(index);
        self.neighbours_at(column, row).into_iter().flatten()
    }

    /// The same of the cell at (`column`, `row`).
    #[inline(always)]
    pub fn neighbours_at(&self, column: usize, row: usize) -> [Option<Neighbour>; 4] {
        let Self { width, height, .. } = *self;
        let index = self.index(column, row);
        [
            (column + 1 < width).then(|| Neighbour { cell: index + 1, edge: 2 * index }),
            (row + 1 < height).then(|| Neighbour { cell: index + width, edge: 2 * index + 1 }),
            (column > 0).then(|| Neighbour { cell: index - 1, edge: 2 * (index - 1) }),
            (row > 0).then(|| Neighbour { cell: index - width, edge: 2 * (index - width) + 1 }),
        ]
    }
}

/// A 4-neighbour of a cell and the edge that leads to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Neighbour {
    /// Index of the neighbouring cell.
    pub cell: usize,
    /// Number of the edge, as [`GridSpec::edge_between`] gives it.
    pub edge: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(width: usize, height: usize) -> GridSpec {
        GridSpec { cell_m: 0.05, origin_m: [-1.0, 2.0], width, height }
    }

    #[test]
    fn covering_has_no_sliver_from_rounding() {
        let spec = GridSpec::covering([0.0, 0.0], [10.0, 8.0], 0.05).expect("valid");
        assert_eq!((spec.width, spec.height), (200, 160));
        let odd = GridSpec::covering([0.0, 0.0], [1.01, 0.01], 0.05).expect("valid");
        assert_eq!((odd.width, odd.height), (21, 1));
    }

    #[test]
    fn covering_refuses_what_is_no_rectangle() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(GridSpec::covering([0.0; 2], [1.0; 2], bad), Err(GridError::CellSize(_))), "{bad}");
        }
        assert!(matches!(GridSpec::covering([1.0; 2], [1.0; 2], 0.1), Err(GridError::Extent { .. })));
        assert!(matches!(GridSpec::covering([0.0; 2], [f64::NAN, 1.0], 0.1), Err(GridError::Extent { .. })));
        assert!(matches!(GridSpec::covering([0.0; 2], [1e9; 2], 0.1), Err(GridError::TooManyCells { .. })));
    }

    #[test]
    fn locate_inverts_centre() {
        let spec = grid(7, 5);
        for index in 0..spec.cells() {
            assert_eq!(spec.locate(spec.centre(index)), Some(index));
        }
        for outside in [[-1.01, 2.1], [-0.9, 1.99], [-0.64, 2.1], [-0.9, 2.26], [f64::NAN, 2.1]] {
            assert_eq!(spec.locate(outside), None, "{outside:?}");
        }
    }

    #[test]
    fn every_edge_has_one_number_seen_from_both_ends() {
        for spec in [grid(1, 1), grid(1, 4), grid(4, 1), grid(3, 4)] {
            let mut ends = std::collections::HashMap::<usize, Vec<usize>>::new();
            for cell in 0..spec.cells() {
                for n in spec.neighbours(cell) {
                    assert_eq!(spec.edge_between(cell, n.cell), n.edge);
                    ends.entry(n.edge).or_default().push(cell);
                }
            }
            assert!(ends.iter().all(|(edge, ends)| ends.len() == 2 && *edge < 2 * spec.cells()));
            let expected = spec.height * (spec.width - 1) + spec.width * (spec.height - 1);
            assert_eq!(ends.len(), expected);
        }
    }
}
