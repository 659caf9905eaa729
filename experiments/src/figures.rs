//! Pictures, in the paper's layout.
//!
//! A function gives a [`Drawing`], in units that are no pixels; [`Paper`] makes a PNG of it, and an SVG beside that. Charts
//! are drawn by plotters, for which a drawing is a back end; maps are cells and marks in metres. With a bundled font and
//! no mathematics of the system's a picture is the same on every machine: plotters counts in whole numbers, and the axes
//! are ours.

pub mod axis;
mod backend;
pub mod calibration;
pub mod cells;
pub mod chart;
pub mod drawing;
mod elements;
mod encode;
pub mod ink;
pub mod key;
mod legend;
pub mod letters;
pub mod maps;
pub mod mark;
pub mod movement;
pub mod panel;
mod paper;
pub mod profiles;
mod raster;
pub mod regions;
pub mod scene;
pub mod style;
mod svg;
pub mod timeline;
mod window;

pub use drawing::Drawing;
pub use paper::Paper;
