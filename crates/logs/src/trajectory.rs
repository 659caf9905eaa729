//! Trajectories in the TUM format, which give the poses of a log anew.

use std::f64::consts::TAU;
use std::io::Read;
use std::path::Path;

use sensor::Pose;

use crate::carmen::{FAR_M, LATE_S};
use crate::error::LogError;
use crate::fields::Fields;
use crate::lines::{Line, Lines};
use crate::{LONGEST_LINE, log, source};

/// More poses are taken for a mistake: these need 320 MB.
const MOST_POSES: usize = 10_000_000;

/// The norm of a quaternion may differ from 1 by this; files round to four digits or more.
const NORM_TOLERANCE: f64 = 1e-3;

/// What is tilted by more than 45 degrees has no heading: the z axis of a robot points up, that of a camera forward.
const LEAST_UPRIGHT: f64 = 0.707;

/// Poses with times, in order: `time x y z qx qy qz qw` in s and m, as SLAM programs write them.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    stamps: Vec<(f64, Pose)>,
}

/// Whose poses a trajectory has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Body {
    /// The sensor's.
    #[default]
    Sensor,
    /// The robot's: the sensor stands on it where the log says (`robot_frontlaser_offset`, or the poses of `ROBOTLASER1`;
    /// in a table, at the robot's own pose).
    Robot,
}

impl Trajectory {
    /// Reads a file, plain or gzip.
    ///
    /// # Errors
    /// As [`read`](Self::read); a file that cannot be opened.
    pub fn open(path: &Path) -> Result<Self, LogError> {
        Self::read(log::file(path)?, &path.display().to_string())
    }

    /// Reads a trajectory; `place` names it in messages. Blank lines and `#` comments are skipped. z, roll and pitch are left out.
    ///
    /// # Errors
    /// The first line that is not eight numbers within their bounds, whose quaternion has not the norm 1, that is tilted by more
    /// than 45 degrees, or whose time is not after the one before; no pose at all; more than ten million.
    pub fn read(source: impl Read + Send, place: &str) -> Result<Self, LogError> {
        let interrupted = |line, source| LogError::Interrupted { place: place.to_owned(), line, source };
        let mut lines = Lines::new(source::text(source).map_err(|error| interrupted(0, error))?);
        let mut stamps: Vec<(f64, Pose)> = Vec::new();
        loop {
            let before = lines.number();
            let refuse = |reason| LogError::Trajectory { place: place.to_owned(), line: before + 1, reason };
            match lines.next().map_err(|error| interrupted(before, error))? {
                None if stamps.is_empty() => {
                    return Err(refuse("no pose; give lines of time x y z qx qy qz qw".to_owned()));
                }
                None => return Ok(Self { stamps }),
                Some((_, Line::TooLong)) => return Err(refuse(format!("is longer than {LONGEST_LINE} bytes"))),
                Some((_, Line::Text(text))) if matches!(text.trim_ascii(), [] | [b'#', ..]) => {}
                Some((_, Line::Text(_))) if stamps.len() == MOST_POSES => {
                    return Err(refuse(format!("more than {MOST_POSES} poses; thin them out")));
                }
                Some((_, Line::Text(text))) => stamps.push(stamp(text, stamps.last()).map_err(refuse)?),
            }
        }
    }

    /// First and last time, s.
    pub fn span_s(&self) -> [f64; 2] {
        [self.stamps[0].0, self.stamps[self.stamps.len() - 1].0]
    }

    /// The pose at this time (s), between the two nearest: along a line, and by the shorter turn. None outside
    /// [`span_s`](Self::span_s). O(log poses).
    pub fn pose(&self, time_s: f64) -> Option<Pose> {
        let after = self.stamps.partition_point(|(stamp, _)| *stamp <= time_s);
        let (before_s, before) = *self.stamps.get(after.checked_sub(1)?)?;
        let Some(&(after_s, after)) = self.stamps.get(after) else {
            return (time_s <= before_s).then_some(before);
        };
        let share = (time_s - before_s) / (after_s - before_s);
        let turn_rad = libm::remainder(after.theta_rad - before.theta_rad, TAU);
        Some(Pose {
            x_m: before.x_m + share * (after.x_m - before.x_m),
            y_m: before.y_m + share * (after.y_m - before.y_m),
            theta_rad: libm::remainder(before.theta_rad + share * turn_rad, TAU),
        })
    }
}

/// Where something stands that is mounted so on what stands at `body`.
pub(crate) fn mounted(body: Pose, mount: Pose) -> Pose {
    let (sin, cos) = libm::sincos(body.theta_rad);
    Pose {
        x_m: body.x_m + cos * mount.x_m - sin * mount.y_m,
        y_m: body.y_m + sin * mount.x_m + cos * mount.y_m,
        theta_rad: body.theta_rad + mount.theta_rad,
    }
}

fn stamp(text: &[u8], before: Option<&(f64, Pose)>) -> Result<(f64, Pose), String> {
    let mut fields = Fields::by_blanks(text);
    if fields.left() != 8 {
        return Err(format!("{} fields; must be 8: time x y z qx qy qz qw", fields.left()));
    }
    let time_s = fields.number("time", LATE_S)?;
    if let Some((last_s, _)) = before.filter(|(last_s, _)| time_s <= *last_s) {
        return Err(format!("time {time_s} s: must be after {last_s} s, the time before; sort the poses"));
    }
    let [x_m, y_m] = [fields.number("x", FAR_M)?, fields.number("y", FAR_M)?];
    fields.number("z", FAR_M)?;
    let [x, y, z, w] =
        [fields.number("qx", 2.0)?, fields.number("qy", 2.0)?, fields.number("qz", 2.0)?, fields.number("qw", 2.0)?];
    let norm = libm::sqrt(x * x + y * y + z * z + w * w);
    if (norm - 1.0).abs() > NORM_TOLERANCE {
        let bound = format!("1 to within {NORM_TOLERANCE}; is the order qx qy qz qw?");
        return Err(format!("quaternion of norm {norm:.4}: must be {bound}"));
    }
    let upright = 1.0 - 2.0 * (x * x + y * y);
    if upright < LEAST_UPRIGHT {
        let tilt = libm::acos(upright.clamp(-1.0, 1.0)).to_degrees();
        return Err(format!(
            "tilted by {tilt:.0} degrees: must be at most 45; give poses whose z axis points up, not a camera's"
        ));
    }
    let theta_rad = libm::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
    Ok((time_s, Pose { x_m, y_m, theta_rad }))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use proptest::prelude::*;

    fn read(text: &str) -> Result<Trajectory, LogError> {
        Trajectory::read(text.as_bytes(), "a.tum")
    }

    /// A line for a planar pose.
    fn tum(time_s: f64, pose: Pose) -> String {
        let (sin, cos) = libm::sincos(0.5 * pose.theta_rad);
        format!("{time_s} {} {} 0.3 0 0 {sin} {cos}\n", pose.x_m, pose.y_m)
    }

    #[test]
    fn between_stamps_a_pose_moves_along_a_line_and_turns_the_shorter_way() {
        let at = |x_m, theta_rad| Pose { x_m, y_m: 2.0 * x_m, theta_rad };
        let text = format!("# time x y\n\n{}{}", tum(10.0, at(1.0, 3.0)), tum(12.0, at(3.0, -3.0)));
        let trajectory = read(&text).expect("fine");
        assert_eq!(trajectory.span_s().map(f64::to_bits), [10.0f64, 12.0].map(f64::to_bits));
        for (time, x, theta) in [(10.0, 1.0, 3.0), (11.0, 2.0, PI), (11.5, 2.5, -3.0708), (12.0, 3.0, -3.0)] {
            let pose = trajectory.pose(time).expect("within");
            let turn = libm::remainder(pose.theta_rad - theta, TAU);
            assert!((pose.x_m - x).abs() < 1e-9 && (pose.y_m - 2.0 * x).abs() < 1e-9 && turn.abs() < 1e-4, "{pose:?}");
        }
        for outside in [9.999, 12.001, f64::NAN, f64::INFINITY] {
            assert_eq!(trajectory.pose(outside), None, "{outside}");
        }
    }

    #[test]
    fn roll_and_pitch_leave_the_heading() {
        // Yaw 90 degrees, then pitch 20: q = qz(90) * qy(20).
        let (s, c) = libm::sincos(10f64.to_radians());
        let h = 0.5f64.sqrt();
        let trajectory = read(&format!("0 0 0 0 {} {} {} {}", -h * s, h * s, h * c, h * c)).expect("fine");
        let theta = trajectory.pose(0.0).expect("within").theta_rad;
        assert!((theta - PI / 2.0).abs() < 1e-12, "{theta}");
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        let fine = "1 0 0 0 0 0 0 1\n";
        for (text, message) in [
            (String::new(), "a.tum:1: no pose"),
            ("# only this\n".to_owned(), "a.tum:2: no pose"),
            (format!("{fine}2 0 0 0 0 0 1"), "a.tum:2: 7 fields; must be 8"),
            (format!("{fine}2 0 0 0 0 0 0 x"), "a.tum:2: field 8, qw: \"x\" is no number"),
            (format!("{fine}2 nan 0 0 0 0 0 1"), "a.tum:2: field 2, x: \"nan\" must be"),
            (format!("{fine}1 0 0 0 0 0 0 1"), "a.tum:2: time 1 s: must be after 1 s"),
            (format!("{fine}\n0.5 0 0 0 0 0 0 1"), "a.tum:3: time 0.5 s: must be after 1 s"),
            ("1 0 0 0 0 0 0 0.99".to_owned(), "quaternion of norm 0.9900: must be 1 to within 0.001"),
            ("1 0 0 0 0 0 0 0".to_owned(), "quaternion of norm 0.0000"),
            ("1 0 0 0 -0.5 0.5 -0.5 0.5".to_owned(), "tilted by 90 degrees"),
        ] {
            let found = read(&text).expect_err(&text).to_string();
            assert!(found.contains(message), "{text}: {found}");
        }
        assert!(read("1 0 0 0 0 0 0 1.0009").is_ok(), "rounded");
    }

    proptest! {
        #[test]
        fn a_planar_pose_comes_back(x_m in -1e3..1e3, y_m in -1e3..1e3, theta_rad in -3.1..3.1) {
            let pose = Pose { x_m, y_m, theta_rad };
            let found = read(&tum(5.0, pose)).expect("fine").pose(5.0).expect("within");
            prop_assert_eq!(Pose { theta_rad, ..found }, pose);
            prop_assert!((found.theta_rad - theta_rad).abs() < 1e-12);
        }

        #[test]
        fn a_mount_is_undone_by_its_inverse(x in -9.0..9.0, y in -9.0..9.0, theta in -3.0..3.0, dx in -1.0..1.0, turn in -3.0..3.0) {
            let body = Pose { x_m: x, y_m: y, theta_rad: theta };
            let mount = Pose { x_m: dx, y_m: 0.2, theta_rad: turn };
            let sensor = mounted(body, mount);
            // By complex numbers, the slow way.
            let (sin, cos) = libm::sincos(-theta);
            let [px, py] = [sensor.x_m - x, sensor.y_m - y];
            prop_assert!((px * cos - py * sin - dx).abs() < 1e-9 && (px * sin + py * cos - 0.2).abs() < 1e-9);
        }

        #[test]
        fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = Trajectory::read(bytes.as_slice(), "noise");
        }
    }
}
