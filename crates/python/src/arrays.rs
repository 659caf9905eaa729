//! Maps as arrays: a row per row of cells, the lowest first.

use grid::{GridSpec, Raster};
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods as _, PyReadonlyArray2, PyUntypedArrayMethods as _};
use pyo3::prelude::*;

use crate::errors::bad;

/// An array with a value for every cell.
pub(crate) fn of_cells<'py, T: Element>(
    py: Python<'py>,
    spec: &GridSpec,
    values: Vec<T>,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    PyArray1::from_vec(py, values).reshape([spec.height, spec.width])
}

/// The values of an array of `spec`'s shape, row by row.
pub(crate) fn to_cells<T: Element + Copy>(
    what: &str,
    array: &PyReadonlyArray2<'_, T>,
    spec: &GridSpec,
) -> PyResult<Vec<T>> {
    let shape = array.shape();
    if shape != [spec.height, spec.width] {
        return Err(bad(format!(
            "{what} has the shape ({}, {}); it must be that of the grid, ({}, {}), a row of cells per row",
            shape[0], shape[1], spec.height, spec.width
        )));
    }
    Ok(array.as_array().iter().copied().collect())
}

/// A truth out of numbers: 1 for occupied, 0 for free, NaN for not known.
pub(crate) fn truth(values: Vec<f64>, spec: GridSpec) -> PyResult<Raster<Option<bool>>> {
    let state = |(cell, value): (usize, &f64)| match *value {
        value if value.is_nan() => Ok(None),
        value if value.total_cmp(&1.0).is_eq() => Ok(Some(true)),
        value if value.abs().total_cmp(&0.0).is_eq() => Ok(Some(false)),
        value => {
            let (column, row) = spec.column_row(cell);
            Err(bad(format!(
                "truth[{row}, {column}] is {value}; it must be 1 (or True) for occupied, 0 (or False) for free, NaN for not known"
            )))
        }
    };
    let cells: PyResult<Vec<Option<bool>>> = values.iter().enumerate().map(state).collect();
    Ok(Raster::new(spec, cells?))
}

/// 1 for occupied, 0 for free, NaN for not known.
pub(crate) fn of_truth(truth: &Raster<Option<bool>>) -> Vec<f64> {
    truth.values().iter().map(|cell| cell.map_or(f64::NAN, |occupied| f64::from(u8::from(occupied)))).collect()
}
