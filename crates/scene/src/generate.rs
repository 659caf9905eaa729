//! Layouts: where walls, furniture and the route of a generated scene are.

mod furniture;
pub(crate) mod people;
mod piece;
mod plan;
mod structure;

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;

pub(crate) use piece::Piece;
use plan::rounded;
pub(crate) use plan::{Kind, Plan};
use structure::Structure;

/// Layouts that are tried before a family is held impossible.
pub(crate) const ATTEMPTS: usize = 200;

/// The stream of the seed from which layouts are drawn: far from the streams of the readings, of which
/// there is one per scan.
const STREAM: u64 = u64::MAX;

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
