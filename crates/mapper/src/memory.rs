//! The memory behind values, for those who measure it.

use std::cell::OnceCell;

use grid::{DigitalLine, Raster};

/// Memory behind a value.
pub(crate) trait Held {
    /// Bytes on the heap.
    fn held(&self) -> usize;
}

impl<T> Held for Vec<T> {
    fn held(&self) -> usize {
        self.capacity() * size_of::<T>()
    }
}

impl<T> Held for Raster<T> {
    fn held(&self) -> usize {
        size_of_val(self.values())
    }
}

/// A value that is made when it is asked for.
impl<T: Held> Held for OnceCell<T> {
    fn held(&self) -> usize {
        self.get().map_or(0, Held::held)
    }
}

impl Held for DigitalLine {
    fn held(&self) -> usize {
        size_of_val(self.cells()) + size_of_val(self.ranges())
    }
}
