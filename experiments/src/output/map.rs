//! A map as files: as numpy reads it, and as a robot does.

use std::io::Write as _;

use grid::ros_map::{self, Coding, Mode, Shades};
use grid::{Raster, npy};
use mapper::{Belief, footprint};

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

/// The files of a costmap, see [`write_footprint`].
pub fn footprint_names(stem: &str) -> [String; 2] {
    ["pgm", "yaml"].map(|extension| format!("{stem}-footprint.{extension}"))
}

/// Writes `stem-footprint.yaml` with `.pgm`: in percent, the probability that an obstacle stands under a robot of `radius_m` (m) about the centre
/// of each cell ([`footprint`]), in mode `raw`, which nav2_map_server hands on as it is; cells that no ray has reached are unknown.
///
/// # Errors
/// Whatever the system reports; a map of other things than probabilities.
pub fn write_footprint(
    staging: &mut Staging,
    stem: &str,
    map: Belief,
    radius_m: f64,
    reached: &Raster<bool>,
) -> Result<(), Failure> {
    let footprint = footprint::occupied(map, radius_m);
    let spec = *footprint.spec();
    let known = |cell: usize| reached[cell].then(|| footprint[cell] as f32);
    let known = Raster::new(spec, (0..spec.cells()).map(known).collect());
    let [image, yaml] = footprint_names(stem);
    let coding = Coding { mode: Mode::Raw, ..Coding::default() };
    let shades = Shades::of(&known, &coding).map_err(Failure::internal)?;
    staging.write(&image, |out| shades.pgm(out))?;
    let text = ros_map::describe(&spec, 0.0, &coding, &image);
    staging.write(&yaml, |out| out.write_all(text.as_bytes()))
}
