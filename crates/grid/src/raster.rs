//! One value per cell.

use std::panic::panic_any;

use thiserror::Error;

use crate::GridSpec;

/// Memory for the cells of a grid that the system does not give.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("{width} x {height} cells need {:.1} MB more memory than the system gives; use larger cells or a smaller rectangle", *.bytes as f64 / 1e6)]
pub struct NoMemory {
    /// Cells along x.
    pub width: usize,
    /// Cells along y.
    pub height: usize,
    /// What was asked for, bytes.
    pub bytes: usize,
}

/// Room for one value per cell: the one door through which grids take memory.
fn room<T>(spec: &GridSpec) -> Result<Vec<T>, NoMemory> {
    let mut values = Vec::new();
    let bytes = spec.cells().saturating_mul(size_of::<T>());
    values.try_reserve_exact(spec.cells()).map_err(|_| NoMemory { width: spec.width, height: spec.height, bytes })?;
    Ok(values)
}

/// A value for every cell of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster<T> {
    spec: GridSpec,
    values: Vec<T>,
}

impl<T> Raster<T> {
    /// Takes one value per cell, in index order.
    ///
    /// # Panics
    /// If there is not exactly one value per cell.
    pub fn new(spec: GridSpec, values: Vec<T>) -> Self {
        assert_eq!(values.len(), spec.cells(), "a raster has one value per cell");
        Self { spec, values }
    }

    /// The same value everywhere.
    ///
    /// # Errors
    /// Memory that the system does not give.
    pub fn try_filled(spec: GridSpec, value: T) -> Result<Self, NoMemory>
    where
        T: Clone,
    {
        // Only asked for and given back: the system gives zeros, as `vec!` asks for them, without touching the memory.
        drop(room::<T>(&spec)?);
        Ok(Self { spec, values: vec![value; spec.cells()] })
    }

    /// The same value everywhere.
    ///
    /// # Panics
    /// With [`NoMemory`] as its payload, where the system does not give the memory.
    pub fn filled(spec: GridSpec, value: T) -> Self
    where
        T: Clone,
    {
        Self::try_filled(spec, value).unwrap_or_else(|error| panic_any(error))
    }

    /// The cells' geometry.
    pub fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// The values in index order.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// The values in index order, to change.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// A raster of the same geometry with `f` of every value.
    ///
    /// # Panics
    /// As [`filled`](Self::filled).
    pub fn map<U>(&self, f: impl FnMut(&T) -> U) -> Raster<U> {
        let mut values = room(&self.spec).unwrap_or_else(|error| panic_any(error));
        values.extend(self.values.iter().map(f));
        Raster { spec: self.spec, values }
    }
}

impl<T> std::ops::Index<usize> for Raster<T> {
    type Output = T;
    fn index(&self, cell: usize) -> &T {
        &self.values[cell]
    }
}

impl<T> std::ops::IndexMut<usize> for Raster<T> {
    fn index_mut(&mut self, cell: usize) -> &mut T {
        &mut self.values[cell]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_that_no_system_has_is_an_error_with_its_size() {
        let spec = GridSpec { cell_m: 1.0, origin_m: [0.0; 2], width: 1 << 31, height: 1 << 31 };
        let error = Raster::try_filled(spec, 0.0f64).expect_err("2^65 bytes");
        assert_eq!((error.width, error.height), (1 << 31, 1 << 31));
        let told = std::panic::catch_unwind(|| Raster::filled(spec, 0.0f64)).expect_err("2^65 bytes");
        assert_eq!(told.downcast_ref::<NoMemory>(), Some(&error));
    }
}
