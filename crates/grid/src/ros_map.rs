//! Maps as robots save them: the YAML file and the image of ROS `map_server` and `nav2_map_server`.
//!
//! A pixel is a cell. Its darkness `p = 1 - brightness` (or the brightness itself, where `negate`
//! is 1) says what the robot found, by the file's [`Mode`]: in `trinary` occupied above
//! `occupied_thresh`, free below `free_thresh`, unknown between and at the two.
//!
//! Map files come from other people's machines, so the reader takes what it meets every day:
//! blanks behind the image's name, comments, keys that it does not know, and an image path of
//! another machine, for which it looks beside the YAML file. [`Shades`] and [`describe`] write maps
//! that this reader and both servers read back cell by cell.

mod coding;
mod description;
mod error;
mod header;
mod netpbm;
mod picture;
mod pixel;
mod png;
mod values;
mod warning;
mod write;
mod yaml;

use std::path::{Path, PathBuf};

use crate::{GridSpec, Raster};

pub use coding::{Coding, Mode, Thresholds};
pub use description::Places;
pub use error::RosMapError;
pub use warning::Warning;
pub use write::{EncodeError, Shades, describe};

use description::Description;
use pixel::{Picture, Pixel};
use warning::Tally;

/// Larger cells were probably not given in metres, m.
const COARSE_M: f64 = 1.0;

/// A map that a robot built.
#[derive(Debug, Clone, PartialEq)]
pub struct RosMap {
    /// Where the cells are, in the map's own frame: the world, turned back about `spec.origin_m`.
    pub spec: GridSpec,
    /// Angle from the world's x axis to the map's rows, counter-clockwise, rad.
    pub yaw_rad: f64,
    /// Share of occupancy from 0 to 1, `None` where nothing is known. Row 0 is the lowest.
    ///
    /// In modes `scale` and `raw` these are the whole percents that nav2 would serve, in `trinary` 0 and 1.
    pub occupancy: Raster<Option<f32>>,
    /// How the shades of the image were read.
    pub coding: Coding,
    /// The image.
    pub image: PathBuf,
    /// Where its values stand in the YAML file; none for an image without one.
    pub places: Option<Places>,
    /// What is suspicious about it, nothing where all is well.
    pub warnings: Vec<Warning>,
}

impl RosMap {
    /// `Some(true)` occupied, `Some(false)` free, `None` unknown, by the thresholds of the file on the occupancy.
    pub fn cells(&self) -> Raster<Option<bool>> {
        self.occupancy.map(|&occupancy| self.coding.thresholds.state(occupancy))
    }

    /// Whether the map's rows leave the world's x axis, by more than a thousandth of a cell at the far corner.
    pub fn is_turned(&self) -> bool {
        self.yaw_rad.abs() * self.spec.width.max(self.spec.height) as f64 > 1e-3
    }

    /// Where a point (m) of the map's own frame, in which `spec` is, lies in the world, m.
    pub fn to_world(&self, point: [f64; 2]) -> [f64; 2] {
        self.turned(point, self.yaw_rad)
    }

    /// Where a point (m) of the world lies in the map's own frame, m; `spec.locate` then gives the cell.
    pub fn to_map(&self, point: [f64; 2]) -> [f64; 2] {
        self.turned(point, -self.yaw_rad)
    }

    fn turned(&self, point: [f64; 2], angle_rad: f64) -> [f64; 2] {
        let origin = self.spec.origin_m;
        let (sin, cos) = libm::sincos(angle_rad);
        let [x, y] = [point[0] - origin[0], point[1] - origin[1]];
        [origin[0] + cos * x - sin * y, origin[1] + sin * x + cos * y]
    }
}

/// Reads the map that the YAML file at `yaml_path` describes, and its image (PGM or PNG).
///
/// ```
/// let map = grid::ros_map::read("../../scenes/maps/UMA_236_237.yaml".as_ref())?;
/// let occupied = map.cells().values().iter().filter(|state| **state == Some(true)).count();
/// assert_eq!((occupied, map.spec.cells()), (5044, 331 * 269));
/// # Ok::<(), grid::ros_map::RosMapError>(())
/// ```
///
/// # Errors
/// A file that cannot be read; YAML that is not a map's; a value out of its range; an image that is
/// missing, damaged or too large.
pub fn read(yaml_path: &Path) -> Result<RosMap, RosMapError> {
    let found = Description::read(yaml_path)?;
    let mut shades = Tally::default();
    let picture = picture::read(&found.image, counted(&mut shades, found.coding))?;
    Ok(described(found, &picture, &shades))
}

/// Reads a map whose two files are in memory. `yaml_path` is named in messages, and no file is looked for.
///
/// # Errors
/// As [`read`], but for files that cannot be read.
pub fn read_from(yaml: &[u8], image: &[u8], yaml_path: &Path) -> Result<RosMap, RosMapError> {
    let found = Description::parse(yaml, yaml_path, |_| true)?;
    let mut shades = Tally::default();
    let picture = picture::read_from(image, &found.image, counted(&mut shades, found.coding))?;
    Ok(described(found, &picture, &shades))
}

/// Reads an image without its YAML file: `coding` says what the shades mean, `cell_m` is the side of a
/// pixel and `origin_m` the lower-left corner of the lower-left one, m.
///
/// # Errors
/// An image that cannot be read, is damaged or too large.
pub fn read_image(image: &Path, coding: Coding, cell_m: f64, origin_m: [f64; 2]) -> Result<RosMap, RosMapError> {
    let mut shades = Tally::default();
    let picture = picture::read(image, counted(&mut shades, coding))?;
    Ok(of_picture(&picture, &shades, image, coding, (cell_m, origin_m), None))
}

/// As [`read_image`], of an image in memory; `path` is named in messages.
///
/// # Errors
/// An image that is damaged or too large.
pub fn read_image_from(
    image: &[u8],
    path: &Path,
    coding: Coding,
    cell_m: f64,
    origin_m: [f64; 2],
) -> Result<RosMap, RosMapError> {
    let mut shades = Tally::default();
    let picture = picture::read_from(image, path, counted(&mut shades, coding))?;
    Ok(of_picture(&picture, &shades, path, coding, (cell_m, origin_m), None))
}

/// The occupancy of every pixel, which is counted on the way.
fn counted(shades: &mut Tally, coding: Coding) -> impl FnMut(Pixel) -> Option<f32> {
    move |pixel| {
        shades.add(pixel, &coding);
        coding.occupancy(pixel)
    }
}

fn described(found: Description, picture: &Picture<Option<f32>>, shades: &Tally) -> RosMap {
    let Description { image, resolution_m, origin_m, yaw_rad, coding, places } = found;
    let map = of_picture(picture, shades, &image, coding, (resolution_m, origin_m), Some(places));
    RosMap { yaw_rad, ..map }
}

fn of_picture(
    picture: &Picture<Option<f32>>,
    shades: &Tally,
    image: &Path,
    coding: Coding,
    (cell_m, origin_m): (f64, [f64; 2]),
    places: Option<Places>,
) -> RosMap {
    let spec = GridSpec { cell_m, origin_m, width: picture.width, height: picture.height };
    // The image's first row is the top one, the grid's first row the lowest.
    let occupancy = picture.pixels.chunks_exact(spec.width).rev().flatten().copied().collect();
    let mut warnings = shades.warnings(&coding, image, places.as_ref());
    if picture.left_over > 0 {
        warnings.push(Warning::LeftOver { image: image.into(), bytes: picture.left_over });
    }
    if let Some(places) = places.as_ref().filter(|_| cell_m > COARSE_M) {
        warnings.push(Warning::Coarse { place: places.resolution.clone(), resolution_m: cell_m });
    }
    let occupancy = Raster::new(spec, occupancy);
    RosMap { spec, yaw_rad: 0.0, occupancy, coding, image: image.into(), places, warnings }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use proptest::prelude::*;

    const YAML: &str =
        "image: m.pgm\nresolution: 0.05\norigin: [-4.0, 2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

    /// Writes a description and a binary PGM and reads them as a map.
    fn map(yaml: &str, width: usize, height: usize, pixels: &[u8]) -> RosMap {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut pgm = format!("P5\n# made by a test\n{width} {height}\n255\n").into_bytes();
        pgm.extend_from_slice(pixels);
        fs::write(folder.path().join("m.pgm"), pgm).expect("written");
        fs::write(folder.path().join("m.yaml"), yaml).expect("written");
        read(&folder.path().join("m.yaml")).expect("a valid map")
    }

    const OCCUPIED: Option<bool> = Some(true);
    const FREE: Option<bool> = Some(false);

    #[test]
    fn the_images_last_row_is_the_maps_lowest() {
        let map = map(YAML, 3, 2, &[0, 254, 205, 254, 254, 0]);
        assert_eq!(map.spec, GridSpec { cell_m: 0.05, origin_m: [-4.0, 2.0], width: 3, height: 2 });
        assert_eq!(map.cells().values(), [FREE, FREE, OCCUPIED, OCCUPIED, FREE, None]);
    }

    #[test]
    fn a_value_at_a_threshold_is_unknown() {
        // p = (255 - 51) / 255 = 0.8 and (255 - 204) / 255 = 0.2.
        let at = YAML.replace("0.65", "0.8").replace("0.196", "0.2");
        assert_eq!(map(&at, 4, 1, &[50, 51, 204, 205]).cells().values(), [OCCUPIED, None, None, FREE]);
    }

    #[test]
    fn a_free_threshold_of_a_quarter_reads_unknown_as_free() {
        // What the files mean by the standard; hence 0.196 in the maps that we write.
        let nav2 = YAML.replace("0.196", "0.25");
        assert_eq!(map(&nav2, 1, 1, &[205]).cells().values(), [FREE]);
    }

    #[test]
    fn a_turned_map_keeps_its_cells_and_knows_where_they_are() {
        let turned = map(&YAML.replace("2, 0]", "2, 1.5707963267948966]"), 3, 1, &[254, 254, 0]);
        assert!(turned.is_turned());
        // A quarter turn to the left: the rows run up the world's y axis, the columns down its x axis.
        let world = turned.to_world(turned.spec.centre(2));
        assert!((world[0] + 4.025).abs() < 1e-12 && (world[1] - 2.125).abs() < 1e-12, "{world:?}");
        assert_eq!(turned.spec.locate(turned.to_map(world)), Some(2));
        assert_eq!(turned.cells().values(), [FREE, FREE, OCCUPIED]);
        assert!(!map(YAML, 3, 1, &[254, 254, 0]).is_turned());
    }

    proptest! {
        #[test]
        fn to_map_undoes_to_world(yaw in -6.3f64..6.3, x in -50f64..50.0, y in -50f64..50.0) {
            let turned = map(&YAML.replace("2, 0]", &format!("2, {yaw}]")), 1, 1, &[0]);
            let back = turned.to_map(turned.to_world([x, y]));
            prop_assert!((back[0] - x).abs() < 1e-10 && (back[1] - y).abs() < 1e-10);
        }

        #[test]
        fn negating_image_and_key_gives_the_same_map(
            width in 1usize..6, height in 1usize..6, seed in prop::collection::vec(any::<u8>(), 36),
        ) {
            let pixels = &seed[..width * height];
            let inverted: Vec<u8> = pixels.iter().map(|p| 255 - p).collect();
            let plain = map(YAML, width, height, pixels);
            for yes in ["1", "true"] {
                let negated = YAML.replace("negate: 0", &format!("negate: {yes}"));
                prop_assert_eq!(map(&negated, width, height, &inverted).occupancy, plain.occupancy.clone());
            }
            // Slow reference, pixel by pixel.
            let cells = plain.cells();
            for (row, column) in (0..height).flat_map(|r| (0..width).map(move |c| (r, c))) {
                let p = f64::from(255 - pixels[row * width + column]) / 255.0;
                let expected = if p > 0.65 { OCCUPIED } else if p < 0.196 { FREE } else { None };
                prop_assert_eq!(cells[plain.spec.index(column, height - 1 - row)], expected);
            }
        }
    }
}
