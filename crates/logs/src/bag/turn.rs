//! Rigid motions in space: how frames stand in each other.

use bags::messages::Rigid;

/// Quaternions of a norm that is farther from 1 are no rotations; those that are not have few digits.
const NORM: f64 = 0.05;

/// A frame in another: where its origin is, m, and how it is turned, a quaternion x, y, z, w of norm 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Motion {
    pub(super) at_m: [f64; 3],
    pub(super) turn: [f64; 4],
}

impl Motion {
    pub(super) const NONE: Self = Self { at_m: [0.0; 3], turn: [0.0, 0.0, 0.0, 1.0] };

    /// Of a message; says what makes it none.
    pub(super) fn of(rigid: &Rigid) -> Result<Self, String> {
        let Rigid { at_m, turn } = *rigid;
        let norm = turn.iter().map(|part| part * part).sum::<f64>().sqrt();
        if at_m.iter().any(|at| !at.is_finite() || at.abs() > crate::bounds::FAR_M) {
            return Err(format!("its position is {at_m:?}, which must be within {:e} m", crate::bounds::FAR_M));
        }
        if norm.is_nan() || (norm - 1.0).abs() > NORM {
            return Err(format!("its quaternion {turn:?} has the norm {norm}, which must be 1"));
        }
        Ok(Self { at_m, turn: turn.map(|part| part / norm) })
    }

    /// About the vertical axis, at height 0.
    pub(super) fn flat(pose: sensor::Pose) -> Self {
        let (sin, cos) = libm::sincos(0.5 * pose.theta_rad);
        Self { at_m: [pose.x_m, pose.y_m, 0.0], turn: [0.0, 0.0, sin, cos] }
    }

    /// A direction of the frame, seen from outside.
    pub(super) fn direction(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [qx, qy, qz, qw] = self.turn;
        // v + 2 w (q x v) + 2 q x (q x v).
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let once = cross([qx, qy, qz], [x, y, z]);
        let twice = cross([qx, qy, qz], once);
        let v = [x, y, z];
        [0, 1, 2].map(|k| v[k] + 2.0 * (qw * once[k] + twice[k]))
    }

    /// The frame that stands so in this one.
    pub(super) fn then(&self, inner: &Self) -> Self {
        let moved = self.direction(inner.at_m);
        let [ax, ay, az, aw] = self.turn;
        let [bx, by, bz, bw] = inner.turn;
        Self {
            at_m: [0, 1, 2].map(|k| self.at_m[k] + moved[k]),
            turn: [
                aw * bx + ax * bw + ay * bz - az * by,
                aw * by - ax * bz + ay * bw + az * bx,
                aw * bz + ax * by - ay * bx + az * bw,
                aw * bw - ax * bx - ay * by - az * bz,
            ],
        }
    }

    /// The outer frame, seen from the inner.
    pub(super) fn inverse(&self) -> Self {
        let [x, y, z, w] = self.turn;
        let back = Self { at_m: [0.0; 3], turn: [-x, -y, -z, w] };
        Self { at_m: back.direction(self.at_m).map(|at| -at), turn: back.turn }
    }

    /// At a share (0 to 1) of the way to another: along a line, and by the shorter turn at a steady rate.
    pub(super) fn towards(&self, other: &Self, share: f64) -> Self {
        let dot: f64 = (0..4).map(|k| self.turn[k] * other.turn[k]).sum();
        let (sign, cos) = if dot < 0.0 { (-1.0, -dot) } else { (1.0, dot) };
        let angle = libm::acos(cos.min(1.0));
        let [own, others] = if angle < 1e-6 {
            [1.0 - share, share]
        } else {
            [libm::sin((1.0 - share) * angle), libm::sin(share * angle)].map(|part| part / libm::sin(angle))
        };
        let turn = [0, 1, 2, 3].map(|k| own * self.turn[k] + sign * others * other.turn[k]);
        let norm = turn.iter().map(|part| part * part).sum::<f64>().sqrt();
        Self {
            at_m: [0, 1, 2].map(|k| self.at_m[k] + share * (other.at_m[k] - self.at_m[k])),
            turn: turn.map(|part| part / norm),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn motion() -> impl Strategy<Value = Motion> {
        let part = || -1.0..1.0f64;
        ([part(), part(), part()], [part(), part(), part(), part()]).prop_filter_map("a rotation", |(at_m, turn)| {
            let norm = turn.iter().map(|part| part * part).sum::<f64>().sqrt();
            (norm > 0.1).then(|| Motion { at_m, turn: turn.map(|part| part / norm) })
        })
    }

    fn near(a: [f64; 3], b: [f64; 3]) -> bool {
        (0..3).all(|k| (a[k] - b[k]).abs() < 1e-9)
    }

    proptest! {
        #[test]
        fn one_after_the_other_is_both(a in motion(), b in motion(), v in [-2.0..2.0f64, -2.0..2.0, -2.0..2.0]) {
            let point = |motion: &Motion, v: [f64; 3]| {
                let turned = motion.direction(v);
                [0, 1, 2].map(|k| motion.at_m[k] + turned[k])
            };
            prop_assert!(near(point(&a.then(&b), v), point(&a, point(&b, v))));
            prop_assert!(near(point(&a.inverse(), point(&a, v)), v));
        }

        #[test]
        fn flat_motions_are_those_of_the_plane(theta in -3.0..3.0f64, turn in -3.0..3.0f64, share in 0.0..1.0f64) {
            let pose = |theta_rad| sensor::Pose { x_m: 1.0, y_m: -2.0, theta_rad };
            let [a, b] = [theta, theta + turn].map(|theta| Motion::flat(pose(theta)));
            let [x, y, z] = a.towards(&b, share).direction([1.0, 0.0, 0.0]);
            let off = libm::remainder(libm::atan2(y, x) - theta - share * turn, std::f64::consts::TAU);
            prop_assert!(off.abs() < 1e-9 && z.abs() < 1e-12, "{}", off);
        }
    }

    #[test]
    fn what_is_no_rotation_is_refused() {
        let rigid = |turn| Rigid { at_m: [0.0; 3], turn };
        assert!(Motion::of(&rigid([0.0; 4])).is_err_and(|reason| reason.contains("norm 0")));
        assert!(Motion::of(&rigid([f64::NAN, 0.0, 0.0, 1.0])).is_err());
        assert_eq!(Motion::of(&rigid([0.0, 0.0, 0.0, 1.001])), Ok(Motion::NONE));
    }
}
