//! Walls and the route: what makes a room a room.

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use super::piece::Piece;
use super::plan::{Kind, Plan, between, rounded};
use crate::gap;
use crate::geometry::distance;

/// Sides of rooms are multiples of this, m.
const SIDE_M: f64 = 0.05;

/// A leg is at least this long, m.
const SHORTEST_LEG_M: f64 = 0.8;

/// A route is at most this many times as long as the place is wide, so that all drives of a family take about as long ...
const LONGEST: f64 = 1.9;

/// ... and that through a door, which goes there twice.
const LONGEST_THROUGH_DOOR: f64 = 2.2;

/// Rooms beside a corridor are this wide, m.
const ROOM_M: [f64; 2] = [2.4, 3.6];

/// Walls and route, before there is furniture. The robot starts on the left.
#[derive(Debug, Clone)]
pub(super) struct Structure {
    pub(super) size_m: [f64; 2],
    pub(super) walls: Vec<Piece>,
    pub(super) waypoints: Vec<(&'static str, [f64; 2])>,
    pub(super) stops: Vec<&'static str>,
    pub(super) stages: [(&'static str, usize); 3],
}

impl Structure {
    /// Draws walls and a route; none where the route comes nearer than `clear_m` to a wall, or a wall reaches out of
    /// the place.
    pub(super) fn draw(plan: &Plan, clear_m: f64, rng: &mut ChaCha8Rng) -> Option<Self> {
        let size_m = plan.size_m.map(|range| libm::rint(between(range, rng) / SIDE_M) / (1.0 / SIDE_M));
        let mut walls = outer(size_m, plan.wall_m);
        let margin = plan.wall_m + clear_m;
        let inside = [[margin, size_m[0] - margin], [margin, size_m[1] - margin]];
        let there_and_back = |across: [f64; 2], rng: &mut ChaCha8Rng| there_and_back([inside[0], across], rng);
        let (waypoints, stops, stages) = match plan.kind {
            Kind::Clutter | Kind::Hall => there_and_back(inside[1], rng),
            Kind::Corridor { passage_m, door_m } => {
                let passage = between(passage_m, rng);
                let middle = 0.5 * size_m[1] + 0.1 * (size_m[1] - passage) * (rng.random::<f64>() - 0.5);
                let sides = [middle - 0.5 * passage, middle + 0.5 * passage].map(rounded);
                for (y, far) in [(sides[0], 0.0), (sides[1], size_m[1])] {
                    rooms(&mut walls, plan.wall_m, [size_m[0], y, far], door_m, rng);
                }
                let margin = 0.5 * plan.wall_m + clear_m;
                there_and_back([sides[0] + margin, sides[1] - margin], rng)
            }
            Kind::TwoRooms { door_m } => {
                let x = rounded(size_m[0] * between([0.42, 0.58], rng));
                let door = between(door_m, rng);
                let y = size_m[1] * between([0.25, 0.75], rng);
                let thickness = plan.wall_m;
                let [low, high] = [y - 0.5 * (door + thickness), y + 0.5 * (door + thickness)].map(rounded);
                walls.push(Piece::Wall { from: [x, 0.5 * thickness], to: [x, low], thickness });
                walls.push(Piece::Wall { from: [x, high], to: [x, rounded(size_m[1] - 0.5 * thickness)], thickness });
                through_the_door(inside, [x, y], rng)
            }
        };
        let waypoints = waypoints.map(|(name, at)| (name, at.map(rounded))).to_vec();
        let structure = Self { size_m, walls, waypoints, stops, stages };
        let length: f64 = structure.legs().map(|(from, to)| distance(from, to)).sum();
        let longest = if matches!(plan.kind, Kind::TwoRooms { .. }) { LONGEST_THROUGH_DOOR } else { LONGEST };
        let short = length <= longest * size_m[0];
        let fits = short
            && structure.walls.iter().all(|wall| structure.holds(wall))
            && structure.legs().all(|(from, to)| {
                let clear = structure.walls.iter().all(|wall| gap::to_way(&wall.shape(), from, to) >= clear_m);
                clear && distance(from, to) >= SHORTEST_LEG_M
            });
        fits.then_some(structure)
    }

    /// Whether a wall lies in the place and has a length.
    fn holds(&self, wall: &Piece) -> bool {
        let [min, max] = wall.shape().extent_m();
        // Half of what a scene's file may reach out of its bounds by rounding.
        (0..2).all(|k| min[k] >= -5e-10 && max[k] <= self.size_m[k] + 5e-10)
    }

    /// The legs of the route, from stop to stop.
    pub(super) fn legs(&self) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
        let at = |name: &str| self.waypoints.iter().find(|(n, _)| *n == name).map_or([0.0; 2], |(_, at)| *at);
        self.stops.windows(2).map(move |leg| (at(leg[0]), at(leg[1])))
    }
}

type Route = ([(&'static str, [f64; 2]); 5], Vec<&'static str>, [(&'static str, usize); 3]);

/// Through the room from left to right, past what stands there, and half way back: what was near on the way
/// out is looked at again from afar.
fn there_and_back([along, across]: [[f64; 2]; 2], rng: &mut ChaCha8Rng) -> Route {
    let mut at = |low: f64, high: f64| {
        let part = between([low, high], rng);
        [along[0] + part * (along[1] - along[0]), between(across, rng)]
    };
    let waypoints =
        [("A", at(0.05, 0.2)), ("B", at(0.4, 0.6)), ("C", at(0.85, 1.0)), ("D", at(0.65, 0.8)), ("E", at(0.45, 0.6))];
    (waypoints, vec!["A", "B", "C", "D", "E"], [("a", 3), ("b", 4), ("c", 5)])
}

/// From one room through the door into the other, round there, and back through the door.
fn through_the_door([along, across]: [[f64; 2]; 2], door: [f64; 2], rng: &mut ChaCha8Rng) -> Route {
    let mut at = |low: f64, high: f64| {
        let part = between([low, high], rng);
        [along[0] + part * (along[1] - along[0]), between(across, rng)]
    };
    let (start, far, farther) = (at(0.0, 0.15), at(0.88, 1.0), at(0.75, 0.9));
    let mut off = || between([0.6, 0.9], rng);
    let (before, behind) = ([door[0] - off(), door[1]], [door[0] + off(), door[1]]);
    let waypoints = [("A", start), ("B", before), ("C", behind), ("D", far), ("E", farther)];
    (waypoints, vec!["A", "B", "C", "D", "E", "C", "B"], [("a", 3), ("b", 5), ("c", 7)])
}

/// The closed outer wall.
fn outer([width, height]: [f64; 2], thickness: f64) -> Vec<Piece> {
    let half = 0.5 * thickness;
    let [right, top] = [width - half, height - half].map(rounded);
    let corners = [[half, half], [right, half], [right, top], [half, top]];
    (0..4).map(|k| Piece::Wall { from: corners[k], to: corners[(k + 1) % 4], thickness }).collect()
}

/// A row of rooms between the corridor's side at `y` and the outer wall at `far`, each with a door.
fn rooms(walls: &mut Vec<Piece>, thickness: f64, [width, y, far]: [f64; 3], door_m: [f64; 2], rng: &mut ChaCha8Rng) {
    let half = 0.5 * thickness;
    let outer = if far > 0.0 { rounded(far - half) } else { half };
    // Rounded as the last room's right side will be, which can be less by a hair than what it is rounded from.
    let end = rounded(width - half);
    let mut left = half;
    while left < end {
        let mut right = rounded(left + between(ROOM_M, rng));
        if width - right < ROOM_M[0] {
            right = end;
        } else {
            walls.push(Piece::Wall { from: [right, y], to: [right, outer], thickness });
        }
        // The door leaves a jamb on either side.
        let opening = between(door_m, rng) + thickness;
        let free = [left + 2.0 * thickness, right - 2.0 * thickness - opening];
        if free[1] > free[0] {
            let from = rounded(between(free, rng));
            walls.push(Piece::Wall { from: [left, y], to: [from, y], thickness });
            walls.push(Piece::Wall { from: [rounded(from + opening), y], to: [right, y], thickness });
        } else {
            walls.push(Piece::Wall { from: [left, y], to: [right, y], thickness });
        }
        left = right;
    }
}
