//! Rasters as NPY files, for numpy: rows are y, row 0 is the lowest.

mod header;
mod meaning;
mod number;
mod read;

use std::io::{self, Write};

use crate::Raster;

pub use read::{Array, NpyError, read, read_file_in_full, read_from, read_in_full};

/// Writes a raster as a 2-D float32 array: rows are y, row 0 is the lowest.
///
/// # Errors
/// Whatever the writer reports.
pub fn write(raster: &Raster<f32>, mut out: impl Write) -> io::Result<()> {
    let spec = raster.spec();
    out.write_all(&header::of_f4(spec.height, spec.width))?;
    let mut row = Vec::with_capacity(4 * spec.width);
    for values in raster.values().chunks(spec.width.max(1)) {
        row.clear();
        row.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        out.write_all(&row)?;
    }
    out.flush()
}

/// Writes shares of occupancy as [`write()`] does: NaN where nothing is known.
///
/// # Errors
/// Whatever the writer reports.
pub fn write_occupancy(occupancy: &Raster<Option<f32>>, out: impl Write) -> io::Result<()> {
    write(&occupancy.map(|share| share.unwrap_or(f32::NAN)), out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::GridSpec;

    #[test]
    fn the_bytes_that_numpy_reads_as_rows_from_the_lowest_up() {
        let spec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: 3, height: 2 };
        let mut bytes = Vec::new();
        write(&Raster::new(spec, vec![0.0, 1.0, -2.5, f32::NAN, 4.0, 0.1]), &mut bytes).expect("memory");
        // By NEP 1: [[0, 1, -2.5], [nan, 4, 0.1]], float32, C order.
        let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, ), }";
        let mut expected = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
        expected.extend(format!("{header:<117}\n").bytes());
        expected.extend([0, 0, 0, 0, 0, 0, 0x80, 0x3f, 0, 0, 0x20, 0xc0, 0, 0, 0xc0, 0x7f, 0, 0, 0x80, 0x40]);
        expected.extend([0xcd, 0xcc, 0xcc, 0x3d]);
        assert_eq!(bytes, expected);
    }
}
