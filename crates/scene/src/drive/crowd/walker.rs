//! Somebody who walks: a goal, and a way there that gives way.

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;

use super::room::{Among, Piece, Room, Who};
use super::{BEFORE_PEOPLE_M, Passing, Trail};
use crate::geometry::{cross, distance, dot, minus};
use crate::{Behaviour, Mover, Repeat, Shape};

/// Stream of the motion seed of the first walker; the others follow below it.
const WALKERS: u64 = u64::MAX - (2 << 32);

/// A walker nearer than this to where it goes is there, m.
const THERE_M: f64 = 0.05;

/// One that stands is drawn back from farther than this, m.
const AWAY_M: f64 = 0.3;

/// Walkers look so far ahead, s of their walk and at least m.
const AHEAD_S: f64 = 0.8;
const AHEAD_M: f64 = 0.5;

/// Ways round what is in the way, rad off the straight one, to the right first.
const ROUND_RAD: [f64; 6] = [-0.45, 0.45, -0.9, 0.9, -1.35, 1.35];

/// What walkers leave between themselves and the way of the robot, m, and how far ahead of it they leave it, m.
const ASIDE_M: f64 = 0.15;
const BEFORE_ROBOT_M: f64 = 1.5;

/// One that has come no farther for so long does something else, s.
const STUCK_S: f64 = 1.5;

/// One that is stuck as near as this to a point of its route lets it be, m.
const NEAR_ENOUGH_M: f64 = 1.0;

/// One that is stuck goes back so far, m.
const BACK_M: f64 = 0.7;

pub(super) struct Walker<'a> {
    mover: &'a Mover,
    piece: Piece,
    at_m: [f64; 2],
    shape: Shape,
    reach_m: f64,
    rng: ChaCha8Rng,
    /// Where it goes, or stands until `rest_s`.
    goal_m: [f64; 2],
    rest_s: f64,
    /// Number of the goal among the points of a route, and the direction in which it goes through them.
    point: usize,
    forth: bool,
    /// Whether it has come to the goal and rests there.
    paused: bool,
    /// Another goal until a time, s: out of a jam.
    detour: Option<([f64; 2], f64)>,
    stuck_s: f64,
}

impl<'a> Walker<'a> {
    pub(super) fn new(mover: &'a Mover, thing: usize, seed: u64, room: &mut Room) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(WALKERS - thing as u64);
        let piece = room.add(&mover.shape, Who::Thing(thing));
        room.place(piece, mover.start_m, [1.0, 0.0]);
        let pause_s = if let Behaviour::Route { pauses_s, .. } = &mover.behaviour { pauses_s[0] } else { 0.0 };
        Self {
            mover,
            piece,
            at_m: mover.start_m,
            shape: mover.shape_at(mover.start_m),
            reach_m: mover.reach_m(),
            rng,
            goal_m: mover.start_m,
            rest_s: mover.start_s + pause_s,
            point: 0,
            forth: true,
            paused: true,
            detour: None,
            stuck_s: 0.0,
        }
    }

    pub(super) fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Walks for `dt_s` up to `time_s`.
    pub(super) fn walk(&mut self, time_s: f64, dt_s: f64, robot: &Passing, trail: &Trail, room: &mut Room) {
        let most_m = self.mover.speed_m_s * dt_s;
        if let Some(aside) = self.aside(robot, room) {
            self.go(aside, most_m, room);
            return;
        }
        let Some(goal_m) = self.goal(time_s, trail, room) else {
            self.stuck_s = 0.0;
            return;
        };
        let left_m = distance(self.at_m, goal_m);
        let wish_m = most_m.min(left_m);
        let gone_m = match self.direction(goal_m, left_m, room) {
            Some(direction) => self.go(direction, wish_m, room),
            None => 0.0,
        };
        self.stuck_s = if gone_m < 0.2 * wish_m { self.stuck_s + dt_s } else { 0.0 };
        if self.stuck_s > STUCK_S {
            self.stuck_s = 0.0;
            self.unstick(time_s);
        }
    }

    /// Goes along a unit vector, up to the first touch; how far it came, m.
    fn go(&mut self, direction: [f64; 2], most_m: f64, room: &mut Room) -> f64 {
        let (free_m, _) = room.reach(self.piece, direction, most_m, Among::All);
        if free_m > 0.0 {
            self.at_m = [0, 1].map(|k| self.at_m[k] + free_m * direction[k]);
            self.shape = self.mover.shape_at(self.at_m);
            room.place(self.piece, self.at_m, [1.0, 0.0]);
        }
        free_m
    }

    /// Where it is to be at a time, or none if it stands there already.
    fn goal(&mut self, time_s: f64, trail: &Trail, room: &Room) -> Option<[f64; 2]> {
        if let Some((detour_m, until_s)) = self.detour {
            if time_s < until_s && distance(self.at_m, detour_m) > THERE_M {
                return Some(detour_m);
            }
            self.detour = None;
        }
        if time_s < self.rest_s {
            return Some(self.goal_m).filter(|goal_m| distance(self.at_m, *goal_m) > AWAY_M);
        }
        let there = distance(self.at_m, self.goal_m) <= THERE_M;
        match &self.mover.behaviour {
            Behaviour::Follower { distance_m } => {
                self.goal_m = trail.behind(*distance_m)?;
                Some(self.goal_m).filter(|goal_m| distance(self.at_m, *goal_m) > THERE_M + 0.05)
            }
            Behaviour::Loiterer { .. } if !there => Some(self.goal_m),
            Behaviour::Loiterer { within_m, pause_s } => {
                self.rest_s = time_s + pause_s * self.rng.random::<f64>();
                self.stray(*within_m, room);
                None
            }
            Behaviour::Route { pauses_s, .. } => {
                if !self.paused && there {
                    (self.paused, self.rest_s) = (true, time_s + pauses_s[self.point]);
                }
                if self.paused && time_s >= self.rest_s {
                    self.turn_to_next();
                }
                Some(self.goal_m).filter(|goal_m| distance(self.at_m, *goal_m) > THERE_M)
            }
        }
    }

    /// Leaves a point of the route for the next.
    fn turn_to_next(&mut self) {
        let Behaviour::Route { points_m, repeat, .. } = &self.mover.behaviour else { return };
        let last = points_m.len() - 1;
        if *repeat == Repeat::BackAndForth {
            self.forth = if self.forth { self.point < last } else { self.point == 0 };
        }
        self.point = match repeat {
            Repeat::Loop => (self.point + 1) % points_m.len(),
            Repeat::BackAndForth if !self.forth => self.point.saturating_sub(1),
            Repeat::Once | Repeat::BackAndForth => (self.point + 1).min(last),
        };
        (self.goal_m, self.paused) = (points_m[self.point], false);
    }

    /// Draws another place to loiter at, one that a straight way leads to.
    fn stray(&mut self, within_m: f64, room: &Room) {
        for _ in 0..10 {
            let (angle, part) = (std::f64::consts::TAU * self.rng.random::<f64>(), self.rng.random::<f64>());
            let (sin, cos) = libm::sincos(angle);
            let radius_m = within_m * part.sqrt();
            let to = [self.mover.start_m[0] + radius_m * cos, self.mover.start_m[1] + radius_m * sin];
            let left_m = distance(self.at_m, to);
            if left_m > THERE_M {
                let direction = minus(to, self.at_m).map(|v| v / left_m);
                if room.reach(self.piece, direction, left_m, Among::Obstacles).1.is_none() {
                    self.goal_m = to;
                    return;
                }
            }
        }
    }

    /// A way towards the goal: straight, or round what is in the way, or straight up to it.
    fn direction(&self, goal_m: [f64; 2], left_m: f64, room: &Room) -> Option<[f64; 2]> {
        let straight = minus(goal_m, self.at_m).map(|v| v / left_m);
        let ahead_m = (AHEAD_S * self.mover.speed_m_s).max(AHEAD_M);
        let (free_m, first) = room.reach(self.piece, straight, ahead_m.min(left_m), Among::All);
        let Some(_) = first else { return Some(straight) };
        for look_m in [ahead_m, 0.5 * ahead_m, 0.25 * ahead_m] {
            for turn in ROUND_RAD {
                let (sin, cos) = libm::sincos(turn);
                let way = [straight[0] * cos - straight[1] * sin, straight[0] * sin + straight[1] * cos];
                if look_m > free_m && room.reach(self.piece, way, look_m, Among::All).1.is_none() {
                    return Some(way);
                }
            }
        }
        Some(straight)
    }

    /// A way out of the robot's, if it stands or walks in that.
    fn aside(&self, robot: &Passing, room: &Room) -> Option<[f64; 2]> {
        let heading = robot.direction?;
        let from_robot = minus(self.at_m, robot.at_m);
        let (along_m, off_m) = (dot(from_robot, heading), cross(heading, from_robot));
        let both_m = robot.radius_m + self.reach_m;
        let needed_m = both_m + ASIDE_M;
        if along_m < 0.0
            || along_m > robot.left_m.min(BEFORE_ROBOT_M) + both_m + BEFORE_PEOPLE_M + THERE_M
            || off_m.abs() >= needed_m
        {
            return None;
        }
        let left = [-heading[1], heading[0]];
        let near = if off_m >= 0.0 { left } else { left.map(|v| -v) };
        let slanted = |side: [f64; 2]| [0, 1].map(|k| (side[k] + heading[k]) * std::f64::consts::FRAC_1_SQRT_2);
        let far = near.map(|v| -v);
        // To the near side if there is room, else across or on ahead of the robot.
        let ways = [
            (near, needed_m - off_m.abs()),
            (slanted(near), (needed_m - off_m.abs()) * std::f64::consts::SQRT_2),
            (far, needed_m + off_m.abs()),
            (slanted(far), (needed_m + off_m.abs()) * std::f64::consts::SQRT_2),
            (heading, BACK_M),
        ];
        let free = |way, look_m| room.reach(self.piece, way, look_m, Among::All).0;
        let clear = ways.iter().find(|(way, look_m)| free(*way, *look_m) >= *look_m - 1e-9);
        let (way, _) = clear.copied().unwrap_or_else(|| {
            let longest = |a: &&([f64; 2], f64), b: &&([f64; 2], f64)| free(a.0, BACK_M).total_cmp(&free(b.0, BACK_M));
            *ways.iter().max_by(longest).unwrap_or(&ways[0])
        });
        Some(way)
    }

    /// Leaves a jam: lets a point be that is near enough, or goes back for a while.
    fn unstick(&mut self, time_s: f64) {
        let wait_s = 1.0 + 2.0 * self.rng.random::<f64>();
        if self.detour.take().is_some() {
            return;
        }
        match &self.mover.behaviour {
            Behaviour::Route { .. } if distance(self.at_m, self.goal_m) < NEAR_ENOUGH_M => self.turn_to_next(),
            Behaviour::Route { points_m, .. } => {
                let from = points_m[self.before()];
                self.detour = Some((back_along(from, self.goal_m, self.at_m), time_s + wait_s));
            }
            Behaviour::Loiterer { .. } => {
                self.goal_m = self.at_m;
                self.rest_s = time_s + wait_s;
            }
            Behaviour::Follower { .. } => {}
        }
    }

    /// The point of the route that it comes from.
    fn before(&self) -> usize {
        let Behaviour::Route { points_m, repeat, .. } = &self.mover.behaviour else { return 0 };
        match repeat {
            Repeat::BackAndForth if !self.forth => (self.point + 1).min(points_m.len() - 1),
            Repeat::Loop if self.point == 0 => points_m.len() - 1,
            _ => self.point.saturating_sub(1),
        }
    }
}

/// A point of the leg from `from` to `to`, a little behind the one that is nearest to `at`.
fn back_along(from: [f64; 2], to: [f64; 2], at: [f64; 2]) -> [f64; 2] {
    let length_m = distance(from, to);
    if length_m <= 0.0 {
        return from;
    }
    let direction = minus(to, from).map(|v| v / length_m);
    let along_m = (dot(minus(at, from), direction) - BACK_M).clamp(0.0, length_m);
    [0, 1].map(|k| from[k] + along_m * direction[k])
}
