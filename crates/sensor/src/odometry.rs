//! What odometry measures: the way between two poses as a turn, a straight piece and a second turn.
//!
//! Source: Thrun, Burgard and Fox, Probabilistic Robotics, MIT Press 2005, Section 5.4.

mod noise;
#[cfg(test)]
mod tests;

pub use noise::{OdometryNoise, OdometryNoiseError};

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::Pose;

/// The way from one pose to the next: turn, drive straight on or back, turn again.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Step {
    /// The turn from the old heading into the way, rad, counter-clockwise; from -pi/2 to pi/2 from [`Step::between`].
    pub first_turn_rad: f64,
    /// Length of the way, m; below zero for a robot that drives backwards.
    pub distance_m: f64,
    /// The turn from the way into the new heading, rad, counter-clockwise; within pi of zero from [`Step::between`].
    pub second_turn_rad: f64,
}

impl Step {
    /// The step from pose `from` to pose `to` (Table 5.6, lines 2 to 4).
    ///
    /// Where the new position lies behind the old heading, the robot drove backwards: the distance is below zero, and
    /// neither turn is half a revolution (which line 2 of the table, and the noise that follows from it, would take it
    /// for). Without a way between the poses the whole turn is the second one.
    pub fn between(from: Pose, to: Pose) -> Self {
        let [dx, dy] = [to.x_m - from.x_m, to.y_m - from.y_m];
        let distance_m = libm::hypot(dx, dy);
        let (first_turn_rad, distance_m) = if distance_m > 0.0 {
            let turn = wrapped_rad(libm::atan2(dy, dx) - from.theta_rad);
            if turn.abs() > FRAC_PI_2 { (wrapped_rad(turn - PI), -distance_m) } else { (turn, distance_m) }
        } else {
            (0.0, 0.0)
        };
        let second_turn_rad = wrapped_rad(to.theta_rad - from.theta_rad - first_turn_rad);
        Self { first_turn_rad, distance_m, second_turn_rad }
    }

    /// The change of heading over the step, rad, within pi of zero.
    pub fn turn_rad(&self) -> f64 {
        wrapped_rad(self.first_turn_rad + self.second_turn_rad)
    }

    /// The pose that the step leads to from pose `start` (Table 5.6, lines 8 to 10); the heading is not wrapped.
    pub fn end(&self, start: Pose) -> Pose {
        let along_rad = start.theta_rad + self.first_turn_rad;
        let (sin, cos) = libm::sincos(along_rad);
        Pose {
            x_m: start.x_m + self.distance_m * cos,
            y_m: start.y_m + self.distance_m * sin,
            theta_rad: along_rad + self.second_turn_rad,
        }
    }
}

/// `angle_rad` plus or minus whole revolutions: from -pi (not taken) to pi.
pub fn wrapped_rad(angle_rad: f64) -> f64 {
    if angle_rad > -PI && angle_rad <= PI {
        return angle_rad;
    }
    angle_rad - TAU * ((angle_rad - PI) / TAU).ceil()
}
