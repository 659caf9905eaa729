//! Where the odometry's frame lies in the map.

use sensor::{Pose, wrapped_rad};

/// A rigid motion that takes poses of the odometry to poses in the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    turn_rad: f64,
    shift_m: [f64; 2],
}

impl Frame {
    /// The map's frame is the odometry's. A pose goes through it to the bit.
    pub const SAME: Self = Self { turn_rad: 0.0, shift_m: [0.0; 2] };

    /// The frame in which the odometry's pose is the given one in the map.
    pub fn taking(odometry: Pose, to: Pose) -> Self {
        let turn_rad = wrapped_rad(to.theta_rad - odometry.theta_rad);
        let [x, y] = turned(odometry.position_m(), turn_rad);
        Self { turn_rad, shift_m: [to.x_m - x, to.y_m - y] }
    }

    /// The pose in the map of a pose of the odometry.
    pub fn pose(&self, odometry: Pose) -> Pose {
        let [x, y] = turned(odometry.position_m(), self.turn_rad);
        Pose { x_m: x + self.shift_m[0], y_m: y + self.shift_m[1], theta_rad: odometry.theta_rad + self.turn_rad }
    }
}

/// A vector, m, turned by an angle, rad.
pub(crate) fn turned([x, y]: [f64; 2], by_rad: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(by_rad);
    [cos * x - sin * y, sin * x + cos * y]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn poses() -> impl Strategy<Value = Pose> {
        (-50.0f64..50.0, -50.0f64..50.0, -3.0f64..3.0).prop_map(|(x_m, y_m, theta_rad)| Pose { x_m, y_m, theta_rad })
    }

    proptest! {
        #[test]
        fn a_frame_takes_the_pose_and_keeps_what_lies_between(from in poses(), to in poses(), other in poses()) {
            let frame = Frame::taking(from, to);
            let (here, there) = (frame.pose(from), frame.pose(other));
            prop_assert!((here.x_m - to.x_m).hypot(here.y_m - to.y_m) < 1e-9);
            prop_assert!(wrapped_rad(here.theta_rad - to.theta_rad).abs() < 1e-12);
            let seen = |a: Pose, b: Pose| turned([b.x_m - a.x_m, b.y_m - a.y_m], -a.theta_rad);
            let ([x, y], [u, v]) = (seen(from, other), seen(here, there));
            prop_assert!((x - u).hypot(y - v) < 1e-9, "{x} {y} {u} {v}");
            prop_assert_eq!(Frame::SAME.pose(from), from);
        }
    }
}
