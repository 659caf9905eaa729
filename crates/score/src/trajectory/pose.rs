//! Poses, and motions from one to another.

use std::f64::consts::TAU;

use super::error::{TrajectoryError, number};

/// A pose in the plane, or the motion from one to another.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// Position along x, m.
    pub x_m: f64,
    /// Position along y, m.
    pub y_m: f64,
    /// Heading, rad, of any number of turns.
    pub theta_rad: f64,
}

/// A pose with its time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stamped {
    /// Time, s.
    pub time_s: f64,
    /// Where it was then.
    pub pose: Pose,
}

impl Pose {
    /// `self` in the frame of `from`: the inverse compound, `⊖ from ⊕ self`.
    pub fn seen_from(self, from: Self) -> Self {
        let (sin, cos) = libm::sincos(from.theta_rad);
        let [x, y] = [self.x_m - from.x_m, self.y_m - from.y_m];
        Self { x_m: cos * x + sin * y, y_m: cos * y - sin * x, theta_rad: self.theta_rad - from.theta_rad }
    }

    /// `motion` from here: the compound, `self ⊕ motion`.
    pub fn moved(self, motion: Self) -> Self {
        let (sin, cos) = libm::sincos(self.theta_rad);
        Self {
            x_m: self.x_m + cos * motion.x_m - sin * motion.y_m,
            y_m: self.y_m + sin * motion.x_m + cos * motion.y_m,
            theta_rad: self.theta_rad + motion.theta_rad,
        }
    }

    /// How far the motion goes, m.
    pub(super) fn distance_m(self) -> f64 {
        libm::hypot(self.x_m, self.y_m)
    }

    /// By how much it turns, the shorter way, rad, 0 to pi.
    pub(super) fn turn_rad(self) -> f64 {
        libm::remainder(self.theta_rad, TAU).abs()
    }

    /// Refuses what is no number.
    pub(super) fn checked(self, index: usize) -> Result<(), TrajectoryError> {
        number(index, "x, m", self.x_m)?;
        number(index, "y, m", self.y_m)?;
        number(index, "heading, rad", self.theta_rad)
    }
}

/// Refuses poses that are no numbers, and times that do not rise.
pub(super) fn in_order(whose: &'static str, poses: &[Stamped]) -> Result<(), TrajectoryError> {
    for (index, stamped) in poses.iter().enumerate() {
        number(index, "time, s", stamped.time_s)?;
        stamped.pose.checked(index)?;
    }
    match (1..poses.len()).find(|&k| poses[k].time_s <= poses[k - 1].time_s) {
        None => Ok(()),
        Some(index) => {
            let [before_s, time_s] = [poses[index - 1].time_s, poses[index].time_s];
            Err(TrajectoryError::Order { whose, index, time_s, before_s })
        }
    }
}

/// The pose nearest in time, the earlier of two; none where there are no poses. O(log poses).
pub(super) fn nearest(poses: &[Stamped], time_s: f64) -> Option<Stamped> {
    let after = poses.partition_point(|stamped| stamped.time_s < time_s);
    let before = after.checked_sub(1).map(|k| poses[k]);
    match (before, poses.get(after).copied()) {
        (Some(before), Some(after)) if after.time_s - time_s < time_s - before.time_s => Some(after),
        (Some(before), _) => Some(before),
        (None, after) => after,
    }
}
