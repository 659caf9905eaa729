//! Somebody who walks: a goal, and a way there that gives way.

mod goal;
mod yielding;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;

use super::room::{Among, Piece, Room, Who};
use super::{Passing, Trail};
use crate::geometry::{distance, minus};
use crate::{Behaviour, Mover, Shape};

/// Stream of the motion seed of the first walker; the others follow below it.
const WALKERS: u64 = u64::MAX - (2 << 32);

/// Walkers look so far ahead, s of their walk and at least m.
const AHEAD_S: f64 = 0.8;
const AHEAD_M: f64 = 0.5;

/// Ways round what is in the way, rad off the straight one, to the right first.
const ROUND_RAD: [f64; 6] = [-0.45, 0.45, -0.9, 0.9, -1.35, 1.35];

/// When the robot has waited for so long, s, who is in its way leaves by any way that is free.
const ROBOT_WAITS_S: f64 = 2.0;

/// One that has come no farther for so long does something else, s.
const STUCK_S: f64 = 1.5;

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
    /// The way on which it leaves the robot's, until a time, s.
    flight: Option<([f64; 2], f64)>,
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
            flight: None,
        }
    }

    pub(super) fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Walks for `dt_s` up to `time_s`.
    pub(super) fn walk(&mut self, time_s: f64, dt_s: f64, robot: &Passing, trail: &Trail, room: &mut Room) {
        let most_m = self.mover.speed_m_s * dt_s;
        if let Some((way, until_s)) = self.flight {
            if time_s < until_s && self.go(way, most_m, room) > 0.0 {
                return;
            }
            self.flight = None;
        }
        if let Some(aside) = self.aside(robot, room) {
            if robot.waits_s > ROBOT_WAITS_S {
                let (way, free_m) = self.way_out(room);
                self.flight = Some((way, time_s + free_m / self.mover.speed_m_s));
            }
            self.go(self.flight.map_or(aside, |(way, _)| way), most_m, room);
            return;
        }
        if self.crowds(robot, dt_s) {
            let (way, free_m) = self.way_out(room);
            self.flight = Some((way, time_s + free_m / self.mover.speed_m_s));
            self.go(way, most_m, room);
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
}
