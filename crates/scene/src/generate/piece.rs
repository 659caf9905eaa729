//! What a layout is built from: walls, boxes and discs, as the scene file writes them.

use std::fmt;

use crate::Shape;
use crate::geometry::{distance, minus};

/// A wall, a box or a disc. Lengths are m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Piece {
    Wall { from: [f64; 2], to: [f64; 2], thickness: f64 },
    Box { center: [f64; 2], size: [f64; 2], rotation_deg: f64 },
    Disc { center: [f64; 2], radius: f64 },
}

impl Piece {
    /// What it covers, as the scene file's reader makes it.
    pub(crate) fn shape(&self) -> Shape {
        match *self {
            Self::Wall { from, to, thickness } => {
                let (length, half) = (distance(from, to), 0.5 * thickness);
                let center_m = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
                Shape::Box { center_m, half_m: [0.5 * length + half, half], axis: minus(to, from).map(|v| v / length) }
            }
            Self::Box { center, size, rotation_deg } => {
                let (sin, cos) = libm::sincos(rotation_deg.to_radians());
                Shape::Box { center_m: center, half_m: size.map(|s| 0.5 * s), axis: [cos, sin] }
            }
            Self::Disc { center, radius } => Shape::Disc { center_m: center, radius_m: radius },
        }
    }

    /// Covered area, m².
    pub(crate) fn area_m2(&self) -> f64 {
        match *self {
            Self::Wall { from, to, thickness } => (distance(from, to) + thickness) * thickness,
            Self::Box { size: [w, h], .. } => w * h,
            Self::Disc { radius, .. } => std::f64::consts::PI * radius * radius,
        }
    }

    /// With every point moved by `mirror`; `turned` where that turns left into right.
    pub(crate) fn mirrored(self, mirror: impl Fn([f64; 2]) -> [f64; 2], turned: bool) -> Self {
        match self {
            Self::Wall { from, to, thickness } => Self::Wall { from: mirror(from), to: mirror(to), thickness },
            Self::Box { center, size, rotation_deg } => {
                let rotation_deg = if turned { 0.0 - rotation_deg } else { rotation_deg };
                Self::Box { center: mirror(center), size, rotation_deg }
            }
            Self::Disc { center, radius } => Self::Disc { center: mirror(center), radius },
        }
    }
}

impl fmt::Display for Piece {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Wall { from, to, thickness } => {
                write!(f, "[[wall]]\nfrom = {from:?}\nto = {to:?}\nthickness = {thickness:?}")
            }
            Self::Box { center, size, rotation_deg } => {
                write!(f, "[[box]]\ncenter = {center:?}\nsize = {size:?}\nrotation_deg = {rotation_deg:?}")
            }
            Self::Disc { center, radius } => write!(f, "[[disc]]\ncenter = {center:?}\nradius = {radius:?}"),
        }
    }
}
