//! The YAML files of ROS maps, with their images.

use std::ffi::OsStr;
use std::path::Path;

use grid::ros_map::{Coding, Mode, describe, read_from};

use crate::image::comes_back;
use crate::message;

/// Stands between the YAML file and the image.
const BETWEEN: &[u8] = b"\n%image\n";

/// An image for those that bring none.
const IMAGE: &[u8] = b"P2 3 2 255  0 100 205 254 255 20";

/// A YAML file, the line `%image`, an image. A map that was read is described and drawn, and reads back the same.
pub fn ros_map(data: &[u8]) {
    let between = data.windows(BETWEEN.len()).position(|window| window == BETWEEN);
    let (yaml, image) = match between {
        Some(at) => (&data[..at], &data[at + BETWEEN.len()..]),
        None => (data, IMAGE),
    };
    let path = Path::new("maps/m.yaml");
    let map = match read_from(yaml, image, path) {
        Ok(map) => map,
        // What is wrong with the image begins with the image's name, which is the input's.
        Err(error) => return message::check(&error, ""),
    };
    let name = map.image.file_name().and_then(OsStr::to_str).unwrap_or("m.pgm");
    let text = describe(&map.spec, map.yaw_rad, &map.coding, name);
    comes_back(&map, |image| {
        let back = read_from(text.as_bytes(), image, path).expect("what was written is a map");
        assert_eq!(back.image.file_name(), Some(name.as_ref()));
        assert_eq!(back.yaw_rad, map.yaw_rad);
        // In mode raw nothing is negated, and the key is not written.
        let negate = map.coding.negate && map.coding.mode != Mode::Raw;
        assert_eq!(back.coding, Coding { negate, ..map.coding });
        back
    });
}
