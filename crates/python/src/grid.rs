//! The cells of a map.

use grid::GridSpec;
use pyo3::prelude::*;

use crate::errors::bad;

/// Square cells in rows and columns.
///
/// Arrays of a map have the shape ``(height, width)``, the lowest row first.
///
/// :param width: cells along x
/// :param height: cells along y
/// :param cell_m: side of a cell, m
/// :param origin_m: lower left corner of the cell in row 0 and column 0, m
#[pyclass(frozen, eq, module = "sightgrid")]
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Grid {
    pub(crate) spec: GridSpec,
}

#[pymethods]
impl Grid {
    #[new]
    #[pyo3(signature = (width, height, cell_m, origin_m = [0.0, 0.0]))]
    fn new(width: usize, height: usize, cell_m: f64, origin_m: [f64; 2]) -> PyResult<Self> {
        if !(cell_m.is_finite() && cell_m > 0.0) {
            return Err(bad(format!("cell_m is {cell_m}; it must be a finite number of m above 0")));
        }
        if !origin_m.iter().all(|value| value.is_finite()) {
            return Err(bad(format!("origin_m is {origin_m:?}; it must be two finite numbers of m")));
        }
        let cells = width.checked_mul(height).filter(|cells| (1..=GridSpec::MAX_CELLS).contains(cells));
        if cells.is_none() {
            return Err(bad(format!("{width} x {height} cells; a map has 1 to {}", GridSpec::MAX_CELLS)));
        }
        Ok(Self { spec: GridSpec { cell_m, origin_m, width, height } })
    }

    /// Cells along x.
    #[getter]
    fn width(&self) -> usize {
        self.spec.width
    }

    /// Cells along y.
    #[getter]
    fn height(&self) -> usize {
        self.spec.height
    }

    /// Side of a cell, m.
    #[getter]
    fn cell_m(&self) -> f64 {
        self.spec.cell_m
    }

    /// Lower left corner, m.
    #[getter]
    fn origin_m(&self) -> (f64, f64) {
        (self.spec.origin_m[0], self.spec.origin_m[1])
    }

    /// ``(height, width)``: the shape of an array of this map.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.spec.height, self.spec.width)
    }

    /// ``(left, right, bottom, top)``, m: what ``matplotlib.pyplot.imshow`` takes as ``extent``, with ``origin="lower"``.
    #[getter]
    fn extent(&self) -> (f64, f64, f64, f64) {
        let GridSpec { cell_m, origin_m: [x, y], width, height } = self.spec;
        (x, x + width as f64 * cell_m, y, y + height as f64 * cell_m)
    }

    /// Row and column of the cell at a place, m; ``None`` outside the map.
    fn cell_at(&self, x_m: f64, y_m: f64) -> Option<(usize, usize)> {
        let (column, row) = self.spec.column_row(self.spec.locate([x_m, y_m])?);
        Some((row, column))
    }

    /// The centre of a cell, m.
    fn centre(&self, row: usize, column: usize) -> PyResult<(f64, f64)> {
        if row >= self.spec.height || column >= self.spec.width {
            let (height, width) = self.shape();
            return Err(pyo3::exceptions::PyIndexError::new_err(format!(
                "({row}, {column}) is outside of a map of {height} x {width} cells"
            )));
        }
        let [x, y] = self.spec.centre(row * self.spec.width + column);
        Ok((x, y))
    }

    fn __repr__(&self) -> String {
        let GridSpec { cell_m, origin_m: [x, y], width, height } = self.spec;
        format!("Grid(width={width}, height={height}, cell_m={cell_m}, origin_m=({x}, {y}))")
    }
}
