//! NPY files.

use std::path::Path;

use grid::npy::{read_from, write_occupancy};
use grid::{GridSpec, Raster};

use crate::message;

/// An NPY file. What is read is written, and reads back the same.
pub fn npy(data: &[u8]) {
    let read = |bytes: &[u8]| read_from(bytes, bytes.len() as u64, Path::new("m.npy"));
    let array = match read(data) {
        Ok(array) => array,
        Err(error) => return message::check(&error, "m.npy: "),
    };
    assert!(array.occupancy.iter().flatten().all(|share| (0.0..=1.0).contains(share)));
    let spec = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: array.width, height: array.height };
    let mut bytes = Vec::new();
    write_occupancy(&Raster::new(spec, array.occupancy.clone()), &mut bytes).expect("memory can be written");
    assert_eq!(read(&bytes).expect("what was written is a map"), array);
}
