//! People of a generated scene, with routes between free places.

use std::fmt;

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;

use super::Layout;
use super::plan::{between, rounded};
use crate::drive::CLEARANCE_M;
use crate::gap;
use crate::geometry::distance;

/// The stream of the seed from which people are drawn: layouts with and without them are the same.
const STREAM: u64 = u64::MAX - 1;

/// Places that are tried for a start, and for the next point of a route.
const TRIES: usize = 400;

/// Shares of followers and of loiterers.
const FOLLOWERS: f64 = 0.2;
const LOITERERS: f64 = 0.2;

const RADIUS_M: [f64; 2] = [0.18, 0.28];

/// How fast people walk where the family does not say, m/s.
pub(crate) const PEOPLE_M_S: [f64; 2] = [0.6, 1.4];

/// What people keep from walls and furniture on their routes, m, and from each other and the robot at the start.
const SPARE_M: f64 = 0.03;
const APART_M: f64 = 0.3;

/// A leg of a route is at least this long, m.
const SHORTEST_LEG_M: f64 = 1.2;

/// Somebody who walks, as the scene file writes it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Person {
    radius: f64,
    speed: f64,
    route: Vec<[f64; 2]>,
    goes: Goes,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Goes {
    BackAndForth { pause_s: f64, start_s: f64 },
    Behind { distance_m: f64 },
    About { within_m: f64, pause_s: f64 },
}

/// So many people per 100 m², between two numbers, who walk so fast (m/s), for a layout and a robot of a radius; none where they find no room.
pub(crate) fn draw(
    layout: &Layout,
    per_100_m2: [f64; 2],
    speed_m_s: [f64; 2],
    robot_m: f64,
    seed: u64,
) -> Option<Vec<Person>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(STREAM);
    let [width, height] = layout.size_m;
    let count = libm::rint(between(per_100_m2, &mut rng) * width * height / 100.0) as usize;
    let mut people: Vec<Person> = Vec::with_capacity(count);
    for _ in 0..count {
        let (radius, speed) = (rounded(between(RADIUS_M, &mut rng)), rounded(between(speed_m_s, &mut rng)));
        let start = (0..TRIES).map(|_| place(layout, &mut rng)).find(|at| {
            let robot =
                layout.waypoints.first().is_none_or(|(_, start)| distance(*start, *at) >= robot_m + radius + APART_M);
            let apart = |other: &Person| distance(other.route[0], *at) >= other.radius + radius + APART_M;
            robot && people.iter().all(apart) && is_free(layout, *at, *at, radius)
        })?;
        let kind = rng.random::<f64>();
        let mut some = |range: [f64; 2]| rounded(between(range, &mut rng));
        let goes = if kind < FOLLOWERS {
            Goes::Behind { distance_m: some([0.8, 1.6]) }
        } else if kind < FOLLOWERS + LOITERERS {
            Goes::About { within_m: some([0.5, 1.5]), pause_s: some([2.0, 8.0]) }
        } else {
            Goes::BackAndForth { pause_s: some([0.0, 3.0]), start_s: some([0.0, 10.0]) }
        };
        let mut route = vec![start];
        if matches!(goes, Goes::BackAndForth { .. }) {
            extend(&mut route, layout, radius, &mut rng);
        }
        // Who finds no way from where it stands stays about.
        let goes = if route.len() == 1 && matches!(goes, Goes::BackAndForth { .. }) {
            Goes::About { within_m: 0.5, pause_s: 3.0 }
        } else {
            goes
        };
        people.push(Person { radius, speed, route, goes });
    }
    Some(people)
}

fn place(layout: &Layout, rng: &mut ChaCha8Rng) -> [f64; 2] {
    layout.size_m.map(|side| rounded(between([0.0, side], rng)))
}

/// Whether a disc can go straight from one place to another.
fn is_free(layout: &Layout, from: [f64; 2], to: [f64; 2], radius: f64) -> bool {
    let needed_m = radius + CLEARANCE_M + SPARE_M;
    layout.pieces.iter().all(|piece| gap::to_way(&piece.shape(), from, to) >= needed_m)
}

/// Adds one to three points, as far as straight ways lead to some.
fn extend(route: &mut Vec<[f64; 2]>, layout: &Layout, radius: f64, rng: &mut ChaCha8Rng) {
    for _ in 0..rng.random_range(1..=3) {
        let from = route[route.len() - 1];
        let mut tries = (0..TRIES).map(|_| place(layout, rng));
        let next = tries.find(|to| distance(from, *to) >= SHORTEST_LEG_M && is_free(layout, from, *to, radius));
        route.extend(next);
    }
}

impl fmt::Display for Person {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { radius, speed, route, goes } = self;
        write!(f, "[[mover]]\nradius = {radius:?}\nspeed_m_s = {speed:?}\nroute = {route:?}\n")?;
        match goes {
            Goes::BackAndForth { pause_s, start_s } => {
                write!(f, "repeat = \"back_and_forth\"\npause_s = {pause_s:?}\nstart_s = {start_s:?}")
            }
            Goes::Behind { distance_m } => write!(f, "behaviour = \"follower\"\ndistance_m = {distance_m:?}"),
            Goes::About { within_m, pause_s } => {
                write!(f, "behaviour = \"loiterer\"\nwithin_m = {within_m:?}\npause_s = {pause_s:?}")
            }
        }
    }
}
