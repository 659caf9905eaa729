//! Maps as robots save them: the YAML file and the image of ROS `map_server` and `nav2_map_server`.
//!
//! A pixel is a cell. Its darkness `p = 1 - brightness` (or the brightness itself, where `negate`
//! is 1) says what the robot found: occupied above `occupied_thresh`, free below `free_thresh`,
//! unknown between and at the two.
//!
//! Map files come from other people's machines, so the reader takes what it meets every day:
//! blanks behind the image's name, comments, keys that it does not know, and an image path of
//! another machine, for which it looks beside the YAML file.

mod description;
mod error;
mod picture;

use std::path::Path;

use crate::{GridSpec, Raster};

pub use error::{Place, RosMapError};

use description::Description;

/// A map that a robot built.
#[derive(Debug, Clone, PartialEq)]
pub struct RosMap {
    /// Where the cells are, in the map's own frame.
    pub spec: GridSpec,
    /// `Some(true)` occupied, `Some(false)` free, `None` unknown. Row 0 is the lowest.
    pub cells: Raster<Option<bool>>,
}

/// Reads the map that the YAML file at `yaml_path` describes, and its image (PGM or PNG).
///
/// ```
/// let map = grid::ros_map::read("../../scenes/maps/UMA_236_237.yaml".as_ref())?;
/// let occupied = map.cells.values().iter().filter(|state| **state == Some(true)).count();
/// assert_eq!((occupied, map.spec.cells()), (5044, 331 * 269));
/// # Ok::<(), grid::ros_map::RosMapError>(())
/// ```
///
/// # Errors
/// A file that cannot be read; YAML that is not a map's; a value out of its range; a map that is
/// turned (`origin` with an angle) or not in mode `trinary`; an image that is missing, damaged or
/// too large.
pub fn read(yaml_path: &Path) -> Result<RosMap, RosMapError> {
    let description = Description::read(yaml_path)?;
    let picture = picture::read(&description.image, |pixel| description.state(pixel))?;
    let spec = GridSpec {
        cell_m: description.resolution_m,
        origin_m: description.origin_m,
        width: picture.width,
        height: picture.height,
    };
    // The image's first row is the top one, the grid's first row the lowest.
    let cells = picture.pixels.chunks_exact(spec.width).rev().flatten().copied().collect();
    Ok(RosMap { spec, cells: Raster::new(spec, cells) })
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
        assert_eq!(map.cells.values(), [FREE, FREE, OCCUPIED, OCCUPIED, FREE, None]);
    }

    #[test]
    fn a_value_at_a_threshold_is_unknown() {
        // p = (255 - 51) / 255 = 0.8 and (255 - 204) / 255 = 0.2.
        let at = YAML.replace("0.65", "0.8").replace("0.196", "0.2");
        assert_eq!(map(&at, 4, 1, &[50, 51, 204, 205]).cells.values(), [OCCUPIED, None, None, FREE]);
    }

    #[test]
    fn a_free_threshold_of_a_quarter_reads_unknown_as_free() {
        // What the files mean by the standard; hence 0.196 in the maps that we write.
        let nav2 = YAML.replace("0.196", "0.25");
        assert_eq!(map(&nav2, 1, 1, &[205]).cells.values(), [FREE]);
    }

    proptest! {
        #[test]
        fn negating_image_and_key_gives_the_same_map(
            width in 1usize..6, height in 1usize..6, seed in prop::collection::vec(any::<u8>(), 36),
        ) {
            let pixels = &seed[..width * height];
            let inverted: Vec<u8> = pixels.iter().map(|p| 255 - p).collect();
            let plain = map(YAML, width, height, pixels);
            for yes in ["1", "true"] {
                let negated = YAML.replace("negate: 0", &format!("negate: {yes}"));
                prop_assert_eq!(&map(&negated, width, height, &inverted), &plain);
            }
            // Slow reference, pixel by pixel.
            for (row, column) in (0..height).flat_map(|r| (0..width).map(move |c| (r, c))) {
                let p = f64::from(255 - pixels[row * width + column]) / 255.0;
                let expected = if p > 0.65 { OCCUPIED } else if p < 0.196 { FREE } else { None };
                prop_assert_eq!(plain.cells[plain.spec.index(column, height - 1 - row)], expected);
            }
        }
    }
}
