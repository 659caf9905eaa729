//! How far and how much a sensor moves from scan to scan: what is implausible is a bad pose, a gap or a wrong unit.

use sensor::Pose;

use crate::frames::{distance_m, turn_rad};

/// A robot moves this fast, m/s, and poses jump by so much, m, at most: in real logs of indoor robots, corrected or not, the largest
/// are 0.4 m within 0.2 s and 1.2 m within 2.7 s.
const FASTEST_M_S: f64 = 4.0;
const JUMP_M: f64 = 1.0;

/// A robot turns this fast, rad/s, and headings jump by so much, rad: the largest turn within 0.2 s in those logs is 1.06 rad.
const FASTEST_RAD_S: f64 = 3.0;
const TURN_RAD: f64 = 1.2;

/// Longer pauses allow no more motion, s.
const LONGEST_S: f64 = 10.0;

/// The motion of a sensor from one scan to its next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Line of the later scan.
    pub line: u64,
    /// Line of the earlier scan.
    pub before: u64,
    /// How far, m.
    pub move_m: f64,
    /// By what turn, rad, 0 to pi.
    pub turn_rad: f64,
    /// From the earlier to the later, s; negative where the time goes back. 1 in a table without times.
    pub time_s: f64,
}

impl Step {
    /// The farthest plausible move in that time, m: 1 m and 4 m/s, for at most 10 s.
    pub fn move_bound_m(&self) -> f64 {
        JUMP_M + FASTEST_M_S * self.time_s.abs().min(LONGEST_S)
    }

    /// The largest plausible turn in that time, rad: 1.2 rad and 3 rad/s.
    pub fn turn_bound_rad(&self) -> f64 {
        TURN_RAD + FASTEST_RAD_S * self.time_s.abs()
    }
}

/// The largest steps of a log.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// The longest move between neighbouring scans of one sensor.
    pub longest: Option<Step>,
    /// The largest turn between them.
    pub sharpest: Option<Step>,
    /// The move that is farthest beyond its bound, of those that are.
    pub jump: Option<Step>,
    /// Moves beyond their bound.
    pub jumps: u64,
    /// The turn that is farthest beyond its bound, of those that are.
    pub twist: Option<Step>,
    /// Turns beyond their bound.
    pub twists: u64,
}

/// A scan's place for the next to compare with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) pose: Pose,
    pub(crate) time_s: f64,
    pub(crate) line: u64,
}

impl Motion {
    pub(crate) fn add(&mut self, before: Place, now: Place) {
        let step = Step {
            line: now.line,
            before: before.line,
            move_m: distance_m(now.pose, before.pose),
            turn_rad: turn_rad(now.pose, before.pose),
            time_s: now.time_s - before.time_s,
        };
        let more = |kept: &mut Option<Step>, measure: fn(&Step) -> f64| {
            if kept.as_ref().is_none_or(|kept| measure(&step) > measure(kept)) {
                *kept = Some(step);
            }
        };
        more(&mut self.longest, |step| step.move_m);
        more(&mut self.sharpest, |step| step.turn_rad);
        if step.move_m > step.move_bound_m() {
            self.jumps += 1;
            more(&mut self.jump, |step| step.move_m - step.move_bound_m());
        }
        if step.turn_rad > step.turn_bound_rad() {
            self.twists += 1;
            more(&mut self.twist, |step| step.turn_rad - step.turn_bound_rad());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_and_the_implausible_are_kept_with_their_lines() {
        let mut motion = Motion::default();
        let place = |line, time_s, x_m, theta_rad| Place { pose: Pose { x_m, y_m: 0.0, theta_rad }, time_s, line };
        motion.add(place(1, 0.0, 0.0, 3.0), place(2, 0.2, 0.4, -3.0));
        motion.add(place(2, 0.2, 0.4, 0.0), place(5, 5.2, 6.4, 3.1));
        assert_eq!(motion.longest.map(|step| (step.before, step.line)), Some((2, 5)));
        assert_eq!((motion.jump, motion.twist, motion.jumps, motion.twists), (None, None, 0, 0));
        motion.add(place(5, 5.2, 6.4, 0.0), place(6, 5.3, 9.4, 2.0));
        motion.add(place(6, 5.3, 9.4, 2.0), place(7, 5.0, 5.4, 2.0)); // back in time is as far as forth
        let lines = |step: Option<Step>| step.map(|step| step.line);
        assert_eq!((lines(motion.longest), lines(motion.sharpest)), (Some(5), Some(5)));
        assert_eq!((lines(motion.jump), motion.jumps, lines(motion.twist), motion.twists), (Some(7), 2, Some(6), 1));
    }
}
