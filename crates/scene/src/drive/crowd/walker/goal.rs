//! Where a walker goes next.

use rand::RngExt as _;

use super::super::Trail;
use super::super::room::{Among, Room};
use super::Walker;
use crate::geometry::{distance, dot, minus};
use crate::{Behaviour, Repeat};

/// A walker nearer than this to where it goes is there, m.
pub(super) const THERE_M: f64 = 0.05;

/// One that stands is drawn back from farther than this, m.
const AWAY_M: f64 = 0.3;

/// One that is stuck as near as this to a point of its route lets it be, m.
const NEAR_ENOUGH_M: f64 = 1.0;

/// One that is stuck goes back so far, m.
pub(super) const BACK_M: f64 = 0.7;

impl Walker<'_> {
    /// Where it is to be at a time, or none if it stands there already.
    pub(super) fn goal(&mut self, time_s: f64, trail: &Trail, room: &Room) -> Option<[f64; 2]> {
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

    /// Leaves a jam: lets a point be that is near enough, or goes back for a while.
    pub(super) fn unstick(&mut self, time_s: f64) {
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
