//! Writing maps: all files of one, or none.

use std::path::Path;

use grid::ros_map::{self, Coding, Mode, Shades};
use grid::{Raster, npy};

use super::{ConvertOptions, graded};
use crate::failure::Failure;
use crate::output::single::Whole;
use crate::worlds::map_file::{MapFile, extension};

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// YAML and image.
    Map,
    /// An array.
    Npy,
    /// An image alone.
    Png,
}

impl Kind {
    pub(super) fn of(path: &Path) -> Result<Self, Failure> {
        match extension(path).as_str() {
            "yaml" | "yml" | "pgm" => Ok(Self::Map),
            "npy" => Ok(Self::Npy),
            "png" => Ok(Self::Png),
            _ => Err(Failure::BadInput(format!(
                "{}: must end in .yaml, .pgm, .npy or .png, which says what is written; choose one",
                path.display()
            ))),
        }
    }
}

/// The files of a map, an image before the YAML file that names it.
pub(super) fn files(
    map: &MapFile,
    kind: Kind,
    options: &ConvertOptions,
    coding: &Coding,
) -> Result<Vec<Whole>, Failure> {
    let out = options.output.as_path();
    let mut bytes = Vec::new();
    match kind {
        Kind::Npy => {
            // The order of an array that is read was applied there.
            let order = options.row_order.filter(|_| extension(&options.input) != "npy").unwrap_or_default();
            let spec = *map.occupancy.spec();
            let rows = Raster::new(spec, order.apply(map.occupancy.values().to_vec(), spec.width));
            npy::write_occupancy(&rows, &mut bytes).map_err(Failure::internal)?
        }
        Kind::Png => shades(map, coding, out)?.png(&mut bytes).map_err(Failure::internal)?,
        Kind::Map => {
            let mut files = pair(map, coding, out)?;
            // States alone would lose the shares.
            if options.mode.is_none() && graded(map) > 0 {
                let stem = out.file_stem().unwrap_or_default().to_string_lossy();
                let raw = out.with_file_name(format!("{stem}-raw.yaml"));
                files.extend(pair(map, &Coding { mode: Mode::Raw, ..*coding }, &raw)?);
            }
            return Ok(files);
        }
    }
    Ok(vec![Whole { path: out.to_owned(), bytes }])
}

/// Image and YAML file.
fn pair(map: &MapFile, coding: &Coding, out: &Path) -> Result<Vec<Whole>, Failure> {
    let Some((spec, yaw_rad)) = map.place else {
        return Err(Failure::BadInput(format!(
            "{}: has no resolution and origin, which the YAML file must say; give --resolution M and --origin X,Y,YAW",
            map.sources[0].display()
        )));
    };
    // Only a PNG can be transparent.
    let form = if coding.mode == Mode::Scale { "png" } else { "pgm" };
    let image = out.with_extension(form);
    let yaml = if extension(out) == "pgm" { out.with_extension("yaml") } else { out.to_owned() };
    let Some(name) = image.file_name().and_then(|name| name.to_str()) else {
        return Err(Failure::BadInput(format!(
            "{}: must be UTF-8 to stand in a YAML file; choose another name",
            out.display()
        )));
    };
    let text = ros_map::describe(&spec, yaw_rad, coding, name);
    let shades = shades(map, coding, out)?;
    let mut bytes = Vec::new();
    if form == "png" { shades.png(&mut bytes) } else { shades.pgm(&mut bytes) }.map_err(Failure::internal)?;
    Ok(vec![Whole { path: image, bytes }, Whole { path: yaml, bytes: text.into_bytes() }])
}

fn shades(map: &MapFile, coding: &Coding, out: &Path) -> Result<Shades, Failure> {
    Shades::of(&map.occupancy, coding).map_err(|error| Failure::BadInput(format!("{}: {error}", out.display())))
}
