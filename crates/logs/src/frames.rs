//! Poses between two times, and how far they are from each other.

use std::f64::consts::TAU;

use sensor::Pose;

/// The pose at a share (0 to 1) of the way: along a line, and by the shorter turn.
pub(crate) fn between(before: Pose, after: Pose, share: f64) -> Pose {
    let turn_rad = libm::remainder(after.theta_rad - before.theta_rad, TAU);
    Pose {
        x_m: before.x_m + share * (after.x_m - before.x_m),
        y_m: before.y_m + share * (after.y_m - before.y_m),
        theta_rad: libm::remainder(before.theta_rad + share * turn_rad, TAU),
    }
}

/// From one position to the other, m.
pub(crate) fn distance_m(a: Pose, b: Pose) -> f64 {
    libm::hypot(a.x_m - b.x_m, a.y_m - b.y_m)
}

/// The shorter turn from one heading to the other, rad, 0 to pi.
pub(crate) fn turn_rad(a: Pose, b: Pose) -> f64 {
    libm::remainder(a.theta_rad - b.theta_rad, TAU).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_mount_is_undone_by_its_inverse(x in -9.0..9.0, y in -9.0..9.0, theta in -3.0..3.0, dx in -1.0..1.0, turn in -3.0..3.0) {
            let body = Pose { x_m: x, y_m: y, theta_rad: theta };
            let mount = Pose { x_m: dx, y_m: 0.2, theta_rad: turn };
            let sensor = body.compose(mount);
            // By complex numbers, the slow way.
            let (sin, cos) = libm::sincos(-theta);
            let [px, py] = [sensor.x_m - x, sensor.y_m - y];
            prop_assert!((px * cos - py * sin - dx).abs() < 1e-9 && (px * sin + py * cos - 0.2).abs() < 1e-9);
            let back = sensor.seen_from(body);
            prop_assert!(distance_m(back, mount) < 1e-9 && (back.theta_rad - turn).abs() < 1e-9);
        }
    }
}
