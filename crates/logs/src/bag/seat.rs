//! How a sensor that stands in space sees the plane.

use sensor::Pose;

use super::turn::Motion;

/// What is tilted by more sees another plane than the map's: the cosine of 45 degrees.
const LEVEL: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Where a sensor stands in the plane, and how its beams lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Seat {
    pub(super) pose: Pose,
    /// Whether its left is on the right: it hangs upside down.
    pub(super) is_mirrored: bool,
    /// Between its plane and the map's, rad.
    pub(super) tilt_rad: f64,
}

/// What the axes of a sensor's frame mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Axes {
    /// x forward, y to the left, z up: lasers (REP 103).
    Body,
    /// z forward, x to the right, y down: cameras (REP 103).
    Optical,
}

impl Seat {
    /// Of a frame in the map; says so where it is tilted by more than 45 degrees.
    pub(super) fn of(motion: &Motion, axes: Axes) -> Result<Self, String> {
        let ([forward, up], sign) = match axes {
            Axes::Body => ([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], 1.0),
            Axes::Optical => ([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]], -1.0),
        };
        let [x, y, _] = motion.direction(forward);
        let up = sign * motion.direction(up)[2];
        if up.abs() < LEVEL {
            let degrees = libm::acos(up.abs().min(1.0)).to_degrees();
            return Err(format!(
                "its plane is tilted by {degrees:.0} degrees against the map, of which 45 are the most"
            ));
        }
        let pose = Pose { x_m: motion.at_m[0], y_m: motion.at_m[1], theta_rad: libm::atan2(y, x) };
        Ok(Self { pose, is_mirrored: up < 0.0, tilt_rad: libm::acos(up.abs().min(1.0)) })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_1_SQRT_2, PI};

    use super::*;

    #[test]
    fn lasers_look_along_x_and_may_hang_upside_down() {
        let seat = |turn| Seat::of(&Motion { at_m: [1.0, 2.0, 3.0], turn }, Axes::Body);
        let upright = seat([0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2]).expect("level");
        assert!((upright.pose.theta_rad - PI / 2.0).abs() < 1e-12 && !upright.is_mirrored && upright.tilt_rad < 1e-7);
        let rolled = seat([1.0, 0.0, 0.0, 0.0]).expect("level");
        assert!(rolled.pose.theta_rad.abs() < 1e-12 && rolled.is_mirrored);
        let pitched = seat([0.0, FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2]).expect_err("it looks down");
        assert!(pitched.contains("90 degrees"), "{pitched}");
    }

    #[test]
    fn cameras_look_along_z() {
        // The usual rotation from a body to its optical frame, -90 degrees of roll and then of yaw.
        let seat = Seat::of(&Motion { at_m: [0.0; 3], turn: [-0.5, 0.5, -0.5, 0.5] }, Axes::Optical).expect("level");
        assert!(seat.pose.theta_rad.abs() < 1e-12 && !seat.is_mirrored);
        assert!(Seat::of(&Motion::NONE, Axes::Optical).is_err(), "a body's frame is none of a camera");
    }
}
