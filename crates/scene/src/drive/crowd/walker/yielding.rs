//! Getting out of the robot's way.

use rand::RngExt as _;

use super::super::room::{Among, Room};
use super::super::{BEFORE_PEOPLE_M, Passing};
use super::goal::{BACK_M, THERE_M};
use super::{ROBOT_WAITS_S, Walker};
use crate::geometry::{cross, distance, dot, minus};

/// What walkers leave between themselves and the way of the robot, m, and how far ahead of it they leave it, m.
const ASIDE_M: f64 = 0.15;
const BEFORE_ROBOT_M: f64 = 1.5;

/// When the robot waits, people as near to it as this, m, leave one after the other, each within about so long, s: who is in its way
/// may have no other way out.
const CROWD_M: f64 = 1.5;
const CROWD_S: f64 = 3.0;

/// Ways that one looks at who leaves like that, and how far it looks, m.
const WAYS_OUT: u32 = 12;
const OUT_M: f64 = 2.0;

impl Walker<'_> {
    /// Whether it leaves now, within a step of `dt_s`, to make room around a robot that waits.
    pub(super) fn crowds(&mut self, robot: &Passing, dt_s: f64) -> bool {
        let near = distance(self.at_m, robot.at_m) < robot.radius_m + self.reach_m + CROWD_M;
        near && robot.direction.is_some() && robot.waits_s > ROBOT_WAITS_S && self.rng.random::<f64>() < dt_s / CROWD_S
    }

    /// A way out of the robot's, if it stands or walks in that.
    pub(super) fn aside(&self, robot: &Passing, room: &Room) -> Option<[f64; 2]> {
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

    /// A long free way from where it stands, and how long it is, m: drawn, so that who comes into a corner also comes out of it.
    pub(super) fn way_out(&mut self, room: &Room) -> ([f64; 2], f64) {
        let first_rad = std::f64::consts::TAU * self.rng.random::<f64>();
        let mut best = ([1.0, 0.0], 0.0, 0.0);
        for k in 0..WAYS_OUT {
            let (sin, cos) = libm::sincos(first_rad + std::f64::consts::TAU * f64::from(k) / f64::from(WAYS_OUT));
            let (free_m, _) = room.reach(self.piece, [cos, sin], OUT_M, Among::All);
            let liking = free_m * (0.5 + self.rng.random::<f64>());
            if liking > best.2 {
                best = ([cos, sin], free_m, liking);
            }
        }
        (best.0, best.1)
    }
}
