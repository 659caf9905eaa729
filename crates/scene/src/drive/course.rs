//! Time and pose along a route of turns and straight lines, with scans at even intervals.

use std::convert::Infallible;
use std::f64::consts::{PI, TAU};

use sensor::Pose;

use super::TimedPose;
use crate::Robot;
use crate::geometry::{distance, minus};

/// Times nearer than this are the same moment, s.
pub(super) const MOMENT_S: f64 = 1e-9;

/// Who else is there while the robot drives.
pub(super) trait Others {
    /// Everything moves on to a time (s), while the robot stands where it is.
    fn until(&mut self, time_s: f64);
    /// A scan is made now.
    fn scanned(&mut self);
}

/// An empty world.
pub(super) struct Nobody;

impl Others for Nobody {
    fn until(&mut self, _: f64) {}
    fn scanned(&mut self) {}
}

/// A robot under way.
pub(super) struct Course {
    time_s: f64,
    pose: Pose,
    interval_s: f64,
    /// The scans come at `since_s + k * interval_s`, so that errors do not add up.
    since_s: f64,
    k: f64,
    poses: Vec<TimedPose>,
}

impl Course {
    /// Stands at `at` (m), looks along `theta_rad` and makes the first scan.
    pub(super) fn start([x_m, y_m]: [f64; 2], theta_rad: f64, interval_s: f64) -> Self {
        let pose = Pose { x_m, y_m, theta_rad };
        Self { time_s: 0.0, pose, interval_s, since_s: 0.0, k: 1.0, poses: vec![TimedPose { time_s: 0.0, pose }] }
    }

    pub(super) fn poses(&self) -> &[TimedPose] {
        &self.poses
    }

    pub(super) fn into_poses(self) -> Vec<TimedPose> {
        self.poses
    }

    /// Time since the start, s.
    pub(super) fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Where it is, m.
    pub(super) fn at_m(&self) -> [f64; 2] {
        self.pose.position_m()
    }

    /// Moves on to a time (s) and a place (m), and scans there if a scan is due; no scan may have been due before.
    pub(super) fn move_on(&mut self, time_s: f64, [x_m, y_m]: [f64; 2], others: &mut impl Others) {
        (self.time_s, self.pose) = (time_s, Pose { x_m, y_m, ..self.pose });
        if self.due_s() <= time_s + MOMENT_S {
            self.scan(time_s);
            others.scanned();
        }
    }

    /// Stands for `duration_s`.
    pub(super) fn stand(&mut self, duration_s: f64, others: &mut impl Others) {
        let end_s = self.time_s + duration_s;
        while let Some(due_s) = self.due_before(end_s) {
            others.until(due_s);
            self.scan(due_s);
            others.scanned();
        }
        others.until(end_s);
        self.time_s = end_s;
    }

    /// Turns on the spot to `theta_rad`, the short way, at `rate` rad/s.
    pub(super) fn turn(&mut self, theta_rad: f64, rate: f64, others: &mut impl Others) {
        let from = self.pose.theta_rad;
        let turn = turn_between(from, theta_rad);
        let duration_s = turn.abs() / rate;
        let began_s = self.time_s;
        while let Some(due_s) = self.due_before(began_s + duration_s) {
            let part = ((due_s - began_s) / duration_s).clamp(0.0, 1.0);
            self.pose.theta_rad = wrapped(from + part * turn);
            others.until(due_s);
            self.scan(due_s);
            others.scanned();
        }
        self.time_s = began_s + duration_s;
        others.until(self.time_s);
        self.pose.theta_rad = theta_rad;
    }

    /// Drives straight to `to` (m) at `speed` m/s. `step` moves the robot from a place by a wish and
    /// says where it came to.
    pub(super) fn straight<E>(
        &mut self,
        to: [f64; 2],
        speed: f64,
        step: impl Fn([f64; 2], [f64; 2]) -> Result<[f64; 2], E>,
    ) -> Result<(), E> {
        let from = self.pose.position_m();
        let duration_s = distance(from, to) / speed;
        let began_s = self.time_s;
        let go = |course: &mut Self, part: f64| {
            let here = course.pose.position_m();
            let plan = [0, 1].map(|k| from[k] + part * (to[k] - from[k]));
            let [x_m, y_m] = step(here, minus(plan, here))?;
            course.pose = Pose { x_m, y_m, ..course.pose };
            Ok(())
        };
        while let Some(due_s) = self.due_before(began_s + duration_s) {
            go(self, ((due_s - began_s) / duration_s).clamp(0.0, 1.0))?;
            self.scan(due_s);
        }
        go(self, 1.0)?;
        self.time_s = began_s + duration_s;
        Ok(())
    }

    /// Scans now, unless the last scan was just made here, and counts the interval from now.
    pub(super) fn scan_on_arrival(&mut self, others: &mut impl Others) {
        let just_made = self.poses.last().is_some_and(|last| self.time_s - last.time_s < MOMENT_S);
        if !just_made {
            self.poses.push(TimedPose { time_s: self.time_s, pose: self.pose });
            others.scanned();
        }
        (self.since_s, self.k) = (self.time_s, 1.0);
    }

    /// The time of the next scan, if it comes before `end_s`.
    fn due_before(&self, end_s: f64) -> Option<f64> {
        Some(self.due_s()).filter(|due_s| *due_s < end_s - MOMENT_S)
    }

    /// The time of the next scan, s.
    pub(super) fn due_s(&self) -> f64 {
        self.since_s + self.k * self.interval_s
    }

    fn scan(&mut self, time_s: f64) {
        self.poses.push(TimedPose { time_s, pose: self.pose });
        self.k += 1.0;
    }
}

/// The poses of a drive along `stops_m` on which nothing is in the way, with a scan on arrival at the last.
pub(crate) fn undisturbed(stops_m: &[[f64; 2]], robot: &Robot) -> Vec<TimedPose> {
    let heading = |leg: &[[f64; 2]]| {
        let [x, y] = minus(leg[1], leg[0]);
        libm::atan2(y, x)
    };
    let mut legs = stops_m.windows(2).peekable();
    let (Some(first), Some(&start)) = (legs.peek(), stops_m.first()) else { return Vec::new() };
    let mut course = Course::start(start, heading(first), robot.scan_interval_s);
    for leg in legs {
        course.turn(heading(leg), robot.turn_rate_rad_s, &mut Nobody);
        let Ok(()) = course.straight(leg[1], robot.speed_m_s, |from, wish| {
            Ok::<_, Infallible>([from[0] + wish[0], from[1] + wish[1]])
        });
    }
    course.scan_on_arrival(&mut Nobody);
    course.into_poses()
}

/// The short way round from one heading to another, rad, in -pi ..= pi.
pub(super) fn turn_between(from: f64, to: f64) -> f64 {
    wrapped(to - from)
}

fn wrapped(angle: f64) -> f64 {
    let angle = libm::fmod(angle, TAU);
    if angle > PI {
        angle - TAU
    } else if angle < -PI {
        angle + TAU
    } else {
        angle
    }
}
