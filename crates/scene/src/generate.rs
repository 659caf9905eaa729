//! Layouts: where walls, furniture and the route of a generated scene are.

mod furniture;
mod gap;
mod piece;
mod structure;

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;

pub(crate) use piece::Piece;
use structure::Structure;

/// Layouts that are tried before a family is held impossible.
pub(crate) const ATTEMPTS: usize = 200;

/// The stream of the seed from which layouts are drawn: far from the streams of the readings, of which
/// there is one per scan.
const STREAM: u64 = u64::MAX;

/// Places are rounded to this, m, before anything is checked: the text of the scene then says exactly what was checked.
const ROUND_M: f64 = 1e-3;

/// Sides of rooms are multiples of this, m.
const SIDE_M: f64 = 0.05;

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
}

/// One place of a family.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layout {
    /// Outer width and height, m.
    pub(crate) size_m: [f64; 2],
    /// Walls first, then furniture.
    pub(crate) pieces: Vec<Piece>,
    /// Named points, m.
    pub(crate) waypoints: Vec<(&'static str, [f64; 2])>,
    /// The route.
    pub(crate) stops: Vec<&'static str>,
    /// Stages with the number of stops after which they end.
    pub(crate) stages: [(&'static str, usize); 3],
}

/// The layout of a seed, or none if obstacles and a route with `clear_m` (m) on either side find no
/// room in [`ATTEMPTS`] attempts.
///
/// Walls and route are drawn first, and drawn again where the route would touch a wall; then
/// furniture, piece by piece, where it keeps off the route, the walls and other furniture. A piece
/// keeps its size while a place is looked for, since to draw it anew would favour small ones.
pub(crate) fn layout(plan: &Plan, clear_m: f64, seed: u64) -> Option<Layout> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(STREAM);
    (0..ATTEMPTS).find_map(|_| {
        let structure = Structure::draw(plan, clear_m, &mut rng)?;
        let furniture = furniture::place(plan, &structure, clear_m, &mut rng)?;
        let flipped = [rng.random::<bool>(), rng.random::<bool>()];
        Some(finished(structure, furniture, flipped))
    })
}

/// The layout, mirrored or not, so that no side of the room is the one where the robot starts.
fn finished(structure: Structure, furniture: Vec<Piece>, flipped: [bool; 2]) -> Layout {
    let Structure { size_m, walls, waypoints, stops, stages, .. } = structure;
    let mirror = |at: [f64; 2]| [0, 1].map(|k| if flipped[k] { rounded(size_m[k] - at[k]) } else { at[k] });
    let pieces = walls.into_iter().chain(furniture).map(|piece| piece.mirrored(mirror, flipped[0] != flipped[1]));
    let waypoints = waypoints.into_iter().map(|(name, at)| (name, mirror(at))).collect();
    Layout { size_m, pieces: pieces.collect(), waypoints, stops, stages }
}

/// To the millimetre.
fn rounded(value: f64) -> f64 {
    // Divided, not multiplied: 1.234 is then the double that the text 1.234 stands for.
    libm::rint(value / ROUND_M) / 1e3
}

/// A uniform number between two bounds.
fn between([low, high]: [f64; 2], rng: &mut ChaCha8Rng) -> f64 {
    low + (high - low) * rng.random::<f64>()
}
