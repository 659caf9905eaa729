//! Images of maps: PGM, the other netpbm forms, and PNG.

use std::path::Path;

use grid::ros_map::{Coding, EncodeError, Mode, RosMap, Shades, Thresholds, read_image_from};

use crate::message;

const PLACE: &str = "m.pgm";

/// Three bytes for mode, negation and thresholds, then an image. What is read is written as PNG and, where it can be, as PGM,
/// and both read back the same.
pub fn image(data: &[u8]) {
    let Some(([mode, a, b], image)) = data.split_first_chunk() else { return };
    let share = |byte: &u8| f64::from(*byte) / 255.0;
    let thresholds = Thresholds { free: share(a.min(b)), occupied: share(a.max(b)) };
    let coding = Coding { mode: Mode::ALL[usize::from(mode % 3)], negate: mode / 3 % 2 == 1, thresholds };
    match read(image, coding) {
        Ok(map) => comes_back(&map, |image| read(image, coding).expect("what was written is an image")),
        Err(error) => message::check(&error, PLACE),
    }
}

fn read(image: &[u8], coding: Coding) -> Result<RosMap, grid::ros_map::RosMapError> {
    read_image_from(image, Path::new(PLACE), coding, 0.05, [-1.0, 2.0])
}

/// Writes the map's image in both forms; `read` reads it with the map's own description.
pub(crate) fn comes_back(map: &RosMap, read: impl Fn(&[u8]) -> RosMap) {
    let shares = map.occupancy.values();
    assert!(shares.len() == map.spec.cells() && !shares.is_empty());
    assert!(shares.iter().flatten().all(|share| (0.0..=1.0).contains(share)));
    let shades = match Shades::of(&map.occupancy, &map.coding) {
        Ok(shades) => shades,
        // Thresholds can lie too near to each other for 256 shades.
        Err(error @ (EncodeError::NoShade { .. } | EncodeError::NoTransparency { .. })) => {
            return message::check(&error, "");
        }
    };
    let (mut png, mut pgm) = (Vec::new(), Vec::new());
    shades.png(&mut png).expect("memory can be written");
    let mut images = vec![png];
    match shades.pgm(&mut pgm) {
        Ok(()) => images.push(pgm),
        Err(error) => {
            message::check(&error, "");
            assert!(map.coding.mode == Mode::Scale && shares.contains(&None), "{error}");
        }
    }
    for image in images {
        let back = read(&image);
        assert_eq!(back.spec, map.spec);
        assert_eq!(back.cells(), map.cells());
        if map.coding.mode != Mode::Trinary {
            assert_eq!(back.occupancy, map.occupancy); // whole percents
        }
    }
}
