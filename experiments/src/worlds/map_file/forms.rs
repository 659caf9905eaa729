//! What a file of a map may leave open: the meaning of shades, the order of rows, the place.

use clap::ValueEnum;
use grid::ros_map::Mode;

use crate::output::args::positive;

/// Names of [`Mode`] on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Shading {
    /// black, white and grey for occupied, free and unknown
    #[default]
    Trinary,
    /// percent as shades between the thresholds, transparent for unknown
    Scale,
    /// percent as brightness of 255
    Raw,
}

/// The row of the map that an array begins with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum RowOrder {
    /// the top one, as in pictures
    Top,
    /// the lowest one, as y runs: the usual one
    #[default]
    Bottom,
}

impl RowOrder {
    /// The cells of an array in the other order of rows, if need be.
    pub(crate) fn apply<T: Copy>(self, cells: Vec<Option<T>>, width: usize) -> Vec<Option<T>> {
        match self {
            Self::Top => cells.chunks(width).rev().flatten().copied().collect(),
            Self::Bottom => cells,
        }
    }
}

impl From<Shading> for Mode {
    fn from(shading: Shading) -> Self {
        match shading {
            Shading::Trinary => Self::Trinary,
            Shading::Scale => Self::Scale,
            Shading::Raw => Self::Raw,
        }
    }
}

/// Where a map lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Origin {
    /// Lower-left corner, m.
    pub corner_m: [f64; 2],
    /// Angle about it, rad.
    pub yaw_rad: f64,
}

/// The bounds of map files, so that what is written can be read.
pub(crate) fn side(text: &str) -> Result<f64, String> {
    positive(text)
        .ok()
        .filter(|m| (1e-4..=100.0).contains(m))
        .ok_or_else(|| "must be a number from 0.0001 to 100".into())
}

/// A place on the command line.
pub(crate) fn origin(text: &str) -> Result<Origin, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, yaw_rad]) if x.abs() <= 1e8 && y.abs() <= 1e8 && yaw_rad.abs() <= 6.3 => {
            Ok(Origin { corner_m: [x, y], yaw_rad })
        }
        _ => Err("must be three numbers X,Y,YAW: metres up to 1e8 either way and radians up to 6.3".into()),
    }
}
