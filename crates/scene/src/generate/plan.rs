//! What the layouts of a family have in common, and how their numbers are drawn.

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

/// Places are rounded to this, m, before anything is checked: the text of the scene then says exactly what was checked.
pub(super) const ROUND_M: f64 = 1e-3;

/// What kind of place a family is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    /// One room full of furniture.
    Clutter,
    /// A corridor between rows of small rooms.
    Corridor {
        /// Least and largest width of the corridor, m.
        passage_m: [f64; 2],
        /// Least and largest width of the rooms' doors, m.
        door_m: [f64; 2],
    },
    /// An open hall with pillars.
    Hall,
    /// Two rooms with a door between them.
    TwoRooms {
        /// Least and largest width of the door, m.
        door_m: [f64; 2],
    },
}

/// What the layouts of a family have in common. Lengths are m.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Plan {
    pub(crate) kind: Kind,
    /// Least and largest outer width and height.
    pub(crate) size_m: [[f64; 2]; 2],
    /// Mean side of a box and mean diameter of a disc.
    pub(crate) obstacle_m: f64,
    /// Sides are uniform within this share of the mean.
    pub(crate) spread: f64,
    /// Share of the outer area that furniture covers.
    pub(crate) covered: f64,
    /// Share of discs among the furniture.
    pub(crate) discs: f64,
    /// Share of the furniture that stands against a wall.
    pub(crate) along_walls: f64,
    /// What obstacles keep from the robot on its route.
    pub(crate) clearance_m: f64,
    /// Thickness of walls.
    pub(crate) wall_m: f64,
    /// Least and most people per 100 m² of the outer area; a family without the key has none.
    pub(crate) people_per_100_m2: Option<[f64; 2]>,
    /// Least and largest speed of people, m/s.
    pub(crate) people_m_s: [f64; 2],
}

/// To the millimetre.
pub(super) fn rounded(value: f64) -> f64 {
    // Divided, not multiplied: 1.234 is then the double that the text 1.234 stands for.
    libm::rint(value / ROUND_M) / 1e3
}

/// A uniform number between two bounds.
pub(super) fn between([low, high]: [f64; 2], rng: &mut ChaCha8Rng) -> f64 {
    low + (high - low) * rng.random::<f64>()
}
