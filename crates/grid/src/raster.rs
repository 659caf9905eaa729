//! One value per cell.

use crate::GridSpec;

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
    pub fn filled(spec: GridSpec, value: T) -> Self
    where
        T: Clone,
    {
        Self { spec, values: vec![value; spec.cells()] }
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
    pub fn map<U>(&self, f: impl FnMut(&T) -> U) -> Raster<U> {
        Raster { spec: self.spec, values: self.values.iter().map(f).collect() }
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
