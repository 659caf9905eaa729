//! A map as files: as numpy reads it, and as a robot does.

use std::io::Write as _;

use grid::ros_map::{self, Coding, Shades};
use grid::{Raster, npy};

use super::folder::Staging;
use crate::failure::Failure;

/// The files of a map.
pub fn names(stem: &str) -> [String; 3] {
    ["npy", "pgm", "yaml"].map(|extension| format!("{stem}.{extension}"))
}

/// Writes `stem.npy` with the probabilities to six decimals, so that committed maps survive another machine, and
/// `stem.yaml` with `stem.pgm` for map_server and Nav2. A cell that no ray has reached is NaN in the one and unknown
/// in the others: the mapper's prior of it is not knowledge.
///
/// # Errors
/// Whatever the system reports; a map of other things than probabilities.
pub fn write(
    staging: &mut Staging,
    stem: &str,
    occupancy: &Raster<f64>,
    reached: &Raster<bool>,
) -> Result<(), Failure> {
    let spec = *occupancy.spec();
    let known = |cell: usize| reached[cell].then(|| ((occupancy[cell] * 1e6).round() / 1e6) as f32);
    let known = Raster::new(spec, (0..spec.cells()).map(known).collect());
    let [npy, image, yaml] = names(stem);
    staging.write(&npy, |out| npy::write_occupancy(&known, out))?;
    let coding = Coding::default();
    let shades = Shades::of(&known, &coding).map_err(Failure::internal)?;
    staging.write(&image, |out| shades.pgm(out))?;
    let text = ros_map::describe(&spec, 0.0, &coding, &image);
    staging.write(&yaml, |out| out.write_all(text.as_bytes()))
}
