//! Fuzz targets for the parsers of foreign files, as functions of bytes that panic where a promise is broken.
//!
//! `targets/` makes a libFuzzer program of each; README.md says how to run and add them.

#![forbid(unsafe_code)]

mod bag;
mod image;
mod log;
mod message;
mod npy;
mod ros_map;
mod scene;
mod trajectory;

pub use bag::bag;
pub use image::image;
pub use log::{carmen, gzip, table};
pub use npy::npy;
pub use ros_map::ros_map;
pub use scene::{family, plan, scene};
pub use trajectory::trajectory;
