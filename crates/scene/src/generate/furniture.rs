//! Furniture: boxes and discs that keep off the route.

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use super::piece::Piece;
use super::plan::{Kind, Plan, ROUND_M, between, rounded};
use super::structure::Structure;
use crate::Shape;
use crate::gap;
use crate::geometry::distance;

/// Places that are tried for a piece.
const TRIES: usize = 300;

/// What pieces keep from each other, m: otherwise they cover less than they say.
const APART_M: f64 = 0.02;

/// Distance of a hall's pillars, m.
const BETWEEN_PILLARS_M: f64 = 2.8;

/// Everything that stands so far, ready to keep off it.
struct Room<'a> {
    structure: &'a Structure,
    clear_m: f64,
    shapes: Vec<Shape>,
    furniture: Vec<Piece>,
    covered_m2: f64,
}

/// Furniture that covers the planned share of the outer area to within half a piece; none where a piece
/// finds no place, and where every piece is too large for that share.
pub(super) fn place(plan: &Plan, structure: &Structure, clear_m: f64, rng: &mut ChaCha8Rng) -> Option<Vec<Piece>> {
    let shapes = structure.walls.iter().map(Piece::shape).collect();
    let mut room = Room { structure, clear_m, shapes, furniture: Vec::new(), covered_m2: 0.0 };
    let target_m2 = plan.covered * structure.size_m[0] * structure.size_m[1];
    if plan.kind == Kind::Hall {
        pillars(&mut room, plan, target_m2, rng);
    }
    loop {
        let piece = piece(plan, rng);
        if room.covered_m2 + 0.5 * piece.area_m2() >= target_m2 {
            return Some(room.furniture).filter(|furniture| !furniture.is_empty() || plan.covered <= 0.0);
        }
        let against_wall = rng.random::<f64>() < plan.along_walls;
        let found = (0..TRIES).any(|_| {
            let placed =
                if against_wall { beside_wall(piece, structure, rng) } else { anywhere(piece, structure, rng) };
            room.add(placed)
        });
        if !found {
            return None;
        }
    }
}

impl Room<'_> {
    /// Puts a piece where it stands, if it may.
    fn add(&mut self, piece: Piece) -> bool {
        let shape = piece.shape();
        let [min, max] = shape.extent_m();
        let inside = (0..2).all(|k| min[k] >= 0.0 && max[k] <= self.structure.size_m[k]);
        let off_route = || self.structure.legs().all(|(from, to)| gap::to_way(&shape, from, to) >= self.clear_m);
        let free = inside && off_route() && self.shapes.iter().all(|other| gap::between(&shape, other) >= APART_M);
        if free {
            self.covered_m2 += piece.area_m2();
            self.furniture.push(piece);
            self.shapes.push(shape);
        }
        free
    }
}

/// A piece of furniture that stands nowhere yet.
fn piece(plan: &Plan, rng: &mut ChaCha8Rng) -> Piece {
    let mut side = || rounded(plan.obstacle_m * (1.0 + plan.spread * between([-1.0, 1.0], rng))).max(1e-3);
    let size = [side(), side()];
    if rng.random::<f64>() < plan.discs {
        Piece::Disc { center: [0.0; 2], radius: 0.5 * size[0] }
    } else {
        Piece::Box { center: [0.0; 2], size, rotation_deg: 0.0 }
    }
}

fn moved(piece: Piece, to: [f64; 2], turned_deg: f64) -> Piece {
    let center = to.map(rounded);
    match piece {
        Piece::Box { size, .. } => Piece::Box { center, size, rotation_deg: libm::rint(turned_deg) },
        Piece::Disc { radius, .. } => Piece::Disc { center, radius },
        wall @ Piece::Wall { .. } => wall,
    }
}

fn anywhere(piece: Piece, structure: &Structure, rng: &mut ChaCha8Rng) -> Piece {
    let to = structure.size_m.map(|side| between([0.0, side], rng));
    moved(piece, to, between([0.0, 180.0], rng))
}

/// Flat against a wall, at either side of it. Longer walls get more.
fn beside_wall(piece: Piece, structure: &Structure, rng: &mut ChaCha8Rng) -> Piece {
    let length = |wall: &Piece| if let Piece::Wall { from, to, .. } = wall { distance(*from, *to) } else { 0.0 };
    let mut along = between([0.0, structure.walls.iter().map(length).sum()], rng);
    let side = if rng.random::<bool>() { 1.0 } else { -1.0 };
    for wall in &structure.walls {
        let Piece::Wall { from, to, thickness } = *wall else { continue };
        if along > length(wall) {
            along -= length(wall);
            continue;
        }
        let axis = [0, 1].map(|k| (to[k] - from[k]) / length(wall));
        let depth = match piece {
            Piece::Box { size, .. } => size[1],
            Piece::Disc { radius, .. } => 2.0 * radius,
            Piece::Wall { .. } => 0.0,
        };
        let off = side * (0.5 * (thickness + depth) + APART_M + ROUND_M);
        let at = [from[0] + along * axis[0] - off * axis[1], from[1] + along * axis[1] + off * axis[0]];
        return moved(piece, at, if axis[0].abs() > axis[1].abs() { 0.0 } else { 90.0 });
    }
    piece
}

/// A hall's pillars: a grid, upright, without those that stand in the way.
fn pillars(room: &mut Room, plan: &Plan, target_m2: f64, rng: &mut ChaCha8Rng) {
    let [columns, rows] = room.structure.size_m.map(|side| (side / BETWEEN_PILLARS_M).floor() as usize);
    for row in 1..=rows {
        for column in 1..=columns {
            let pillar = piece(plan, rng);
            let part = [column as f64 / (columns + 1) as f64, row as f64 / (rows + 1) as f64];
            let jitter = [(); 2].map(|()| between([-0.3, 0.3], rng));
            let at = [0, 1].map(|k| room.structure.size_m[k] * part[k] + jitter[k]);
            if room.covered_m2 + 0.5 * pillar.area_m2() < target_m2 {
                room.add(moved(pillar, at, 0.0));
            }
        }
    }
}
