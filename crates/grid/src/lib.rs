//! Cell geometry, digital lines and rasters for 2-D occupancy maps.
//!
//! A map is a rectangle of square cells. Cell 0 is the lower-left one, indices run along x first
//! (`index = row * width + column`), lengths are in metres and angles in radians,
//! counter-clockwise from the x axis.
//!
//! - [`GridSpec`] says where the cells are.
//! - [`Frame`] is a grid that may be turned, with the way from its cells to those of another.
//! - [`DigitalLine`] lists the cells that a viewing ray crosses, 4-connected, with the range at
//!   which it enters and leaves each (Figure 2 of the paper).
//! - [`clear`] finds where a disc fits between cells, and [`Lattice`] the shortest ways over them.
//! - [`Raster`] is one value per cell; [`npy`] writes it for numpy and reads it back.
//! - [`ros_map`] reads the maps that robots save, and writes them, as ROS map_server and nav2_map_server do.

mod clearance;
mod frame;
mod lattice;
mod line;
pub mod npy;
mod raster;
pub mod ros_map;
mod spec;

pub use clearance::{ROUNDING, clear, disc_reach};
pub use frame::{CellsToCells, Frame};
pub use lattice::{Lattice, StepCosts, UNREACHED};
pub use line::{Block, DigitalLine, Staircase};
pub use raster::{NoMemory, Raster};
pub use spec::{GridError, GridSpec, Neighbour};
