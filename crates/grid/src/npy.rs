//! Rasters as NPY files, for numpy: rows are y, row 0 is the lowest.

mod header;
mod read;

use std::io::{self, Write};

use npyz::WriterBuilder as _;

use crate::Raster;

pub use read::{Array, NpyError, read, read_from};

/// Writes a raster as a 2-D float32 array: rows are y, row 0 is the lowest.
///
/// # Errors
/// Whatever the writer reports.
pub fn write(raster: &Raster<f32>, out: impl Write) -> io::Result<()> {
    let spec = raster.spec();
    let mut npy = npyz::WriteOptions::new()
        .default_dtype()
        .shape(&[spec.height as u64, spec.width as u64])
        .writer(out)
        .begin_nd()?;
    npy.extend(raster.values().iter().copied())?;
    npy.finish()
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
    fn numpy_reads_rows_from_the_lowest_up() {
        let spec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: 3, height: 2 };
        let mut bytes = Vec::new();
        write(&Raster::new(spec, vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0]), &mut bytes).expect("memory");
        let npy = npyz::NpyFile::new(&bytes[..]).expect("valid");
        assert_eq!(npy.shape(), &[2, 3]);
        assert_eq!(npy.order(), npyz::Order::C);
        assert_eq!(npy.into_vec::<f32>().expect("float32"), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    }
}
