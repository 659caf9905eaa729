//! Everything that moves beside the robot, moved by rapier in short steps.

mod leaf;
mod room;
mod seat;
mod walker;

use leaf::Leaf;
use room::{Among, Piece, Room};
use seat::Seat;
use walker::Walker;

pub(super) use room::Who;

use super::course::MOMENT_S;
use crate::geometry::distance;
use crate::{Motion, Scene, Shape};

/// Everything moves at least this often, s.
pub(super) const STEP_S: f64 = 0.05;

/// The robot's way is kept in steps of this, m.
const CRUMB_M: f64 = 0.05;

/// What the robot leaves between itself and who walks, m: it stops for people before it touches them.
const BEFORE_PEOPLE_M: f64 = 0.2;

/// The robot, as others see it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Passing {
    pub(super) at_m: [f64; 2],
    pub(super) radius_m: f64,
    /// Where it drives, if it does, and how far, m.
    pub(super) direction: Option<[f64; 2]>,
    pub(super) left_m: f64,
    /// How long it has stood before something, s.
    pub(super) waits_s: f64,
}

/// The way that the robot has come.
#[derive(Debug)]
pub(super) struct Trail(Vec<[f64; 2]>);

impl Trail {
    fn add(&mut self, at_m: [f64; 2]) {
        if self.0.last().is_none_or(|last| distance(*last, at_m) >= CRUMB_M) {
            self.0.push(at_m);
        }
    }

    /// Where the robot was this far (m) back along its way; none before it has come so far.
    fn behind(&self, distance_m: f64) -> Option<[f64; 2]> {
        let mut left_m = distance_m;
        for leg in self.0.windows(2).rev() {
            left_m -= distance(leg[0], leg[1]);
            if left_m <= 0.0 {
                return Some(leg[0]);
            }
        }
        None
    }
}

/// Everything that moves.
pub(super) struct Crowd<'a> {
    scene: &'a Scene,
    room: Room,
    robot: Piece,
    passing: Passing,
    trail: Trail,
    walkers: Vec<Walker<'a>>,
    leaves: Vec<Leaf<'a>>,
    seats: Vec<Seat<'a>>,
    time_s: f64,
    ended_stages: usize,
    motion: Motion,
}

impl<'a> Crowd<'a> {
    pub(super) fn of(scene: &'a Scene) -> Self {
        let (mut room, seed) = (Room::of(scene), scene.motion_seed);
        let (at_m, radius_m) = (scene.waypoint_of(0).at_m, scene.robot.radius_m);
        let robot = room.add(&Shape::Disc { center_m: at_m, radius_m }, Who::Robot);
        let [doors, chairs] = [scene.movers.len(), scene.movers.len() + scene.doors.len()];
        let walkers = scene.movers.iter().enumerate().map(|(k, m)| Walker::new(m, k, seed, &mut room)).collect();
        let leaves = scene.doors.iter().enumerate().map(|(k, d)| Leaf::new(d, doors + k, seed, &mut room)).collect();
        let seats = scene.chairs.iter().enumerate().map(|(k, c)| Seat::new(c, chairs + k, &mut room)).collect();
        room.settle();
        Self {
            scene,
            room,
            robot,
            passing: Passing { at_m, radius_m, direction: None, left_m: 0.0, waits_s: 0.0 },
            trail: Trail(vec![at_m]),
            walkers,
            leaves,
            seats,
            time_s: 0.0,
            ended_stages: 0,
            motion: Motion::of(scene),
        }
    }

    /// Tells everybody where the robot is about to drive, if it does: a unit vector, how far, m, and how long it has waited
    /// for that, s.
    pub(super) fn expect(&mut self, direction: Option<[f64; 2]>, left_m: f64, waits_s: f64) {
        self.passing = Passing { direction, left_m, waits_s, ..self.passing };
    }

    /// Moves the robot along a unit vector by up to `wish_m`: how far it came, m, and what stopped it.
    pub(super) fn drive(&mut self, direction: [f64; 2], wish_m: f64) -> (f64, Option<Who>) {
        let (mut free_m, mut first) = self.room.reach(self.robot, direction, wish_m + BEFORE_PEOPLE_M, Among::All);
        match first {
            Some(Who::Thing(thing)) if thing < self.walkers.len() => free_m = (free_m - BEFORE_PEOPLE_M).max(0.0),
            _ => {}
        }
        if free_m >= wish_m {
            (free_m, first) = (wish_m, None);
        }
        let at_m = [0, 1].map(|k| self.passing.at_m[k] + free_m * direction[k]);
        self.put(at_m);
        (free_m, first)
    }

    /// Puts the robot where it is, m.
    pub(super) fn put(&mut self, at_m: [f64; 2]) {
        self.passing.at_m = at_m;
        self.room.place(self.robot, at_m, [1.0, 0.0]);
        self.trail.add(at_m);
    }

    /// A stage has ended.
    pub(super) fn stage_ended(&mut self) {
        self.ended_stages += 1;
    }

    pub(super) fn into_motion(self) -> Motion {
        self.motion
    }

    /// One step up to a time, s: doors, chairs, then people, one after the other.
    fn step(&mut self, time_s: f64) {
        let dt_s = time_s - self.time_s;
        self.time_s = time_s;
        // What is due now is due, whatever rounding says.
        let due_s = time_s + MOMENT_S;
        let stage = self.ended_stages.min(self.scene.stages.len() - 1);
        for (k, leaf) in self.leaves.iter_mut().enumerate() {
            let open = self.scene.doors[k].opening.wants_open(due_s, stage, self.scene.motion_seed, k as u64);
            leaf.swing(open, dt_s, &mut self.room);
        }
        for seat in &mut self.seats {
            seat.rearrange(due_s, self.ended_stages, &mut self.room);
        }
        for walker in &mut self.walkers {
            walker.walk(time_s, dt_s, &self.passing, &self.trail, &mut self.room);
        }
        self.room.settle();
    }
}

impl super::course::Others for Crowd<'_> {
    fn until(&mut self, time_s: f64) {
        let (from_s, steps) = (self.time_s, ((time_s - self.time_s) / STEP_S - 1e-9).ceil().max(0.0));
        for k in 1..=steps as usize {
            self.step(if k as f64 >= steps { time_s } else { from_s + k as f64 * STEP_S });
        }
    }

    fn scanned(&mut self) {
        let leaves: Vec<Shape> = self.leaves.iter().map(Leaf::shape).collect();
        let walkers = self.walkers.iter().map(Walker::shape);
        self.motion.add(walkers.chain(&leaves).chain(self.seats.iter().map(Seat::shape)));
    }
}

#[cfg(test)]
mod tests;
