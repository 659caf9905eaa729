//! Trajectories, which give the poses of a log anew.
//!
//! A line is a pose: `time x y z qx qy qz qw` (the TUM format), separated by blanks, commas or semicolons; more fields behind are allowed
//! where the first line names the columns, as in the ground truth of EuRoC. Blank lines and `#` comments are skipped. z, roll and
//! pitch are left out. Read as well, each with a [`Finding`]:
//!
//! | what | how it is told |
//! |---|---|
//! | times in ns, us or ms | named in the first line; else times beyond the year 5138 in s, or whole numbers that are that far apart |
//! | quaternions in the order w x y z | named in the first line; else the body would be tilted, or would roll instead of turning |
//! | quaternions of few digits | norms within 0.05 of 1 are normalised |
//! | poses that are not in order | sorted, unless the path then goes to and fro |
//! | poses that come twice | used once, if they are the same |
//! | poses far from those around them | left out, if they are few |

mod clock;
mod head;
mod orientation;
pub mod relations;
mod rows;

use std::collections::VecDeque;
use std::io::Read;
use std::path::Path;

use sensor::Pose;

use self::head::{Names, is_head};
use self::rows::Row;
use crate::error::LogError;
use crate::finding::Finding;
use crate::frames::{between, distance_m};
use crate::lines::{LONGEST_LINE, Line, Lines};
use crate::report::Gap;
use crate::source;
use crate::strays::near;

/// More poses are taken for a mistake: these need 500 MB.
const MOST_POSES: usize = 5_000_000;

/// So many poses far from those around them are left out; more are another place.
const MOST_STRAYS: usize = 9;

/// At the time of a pose, s, there is no gap.
const AT_STAMP_S: f64 = 1e-3;

/// Poses with times, in order: `time x y z qx qy qz qw` in s and m, as SLAM programs write them.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    stamps: Vec<(f64, Pose)>,
    findings: Vec<Finding>,
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

/// What a trajectory says of a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum At {
    /// The pose.
    Pose(Pose),
    /// The poses before and after are too far apart.
    Gap(Gap),
    /// Before the first pose or after the last.
    Outside,
}

impl Trajectory {
    /// Reads a file, plain, gzip or bzip2.
    ///
    /// # Errors
    /// As [`read`](Self::read); a file that cannot be opened.
    pub fn open(path: &Path) -> Result<Self, LogError> {
        Self::read(source::file(path, false)?, &path.display().to_string())
    }

    /// Reads a trajectory; `place` names it in messages.
    ///
    /// # Errors
    /// The first line that is not eight numbers within their bounds, whose quaternion has not the norm 1, or that is tilted by more
    /// than 45 degrees; a time that comes twice with different poses; two runs in one; no pose at all; more than five million.
    pub fn read(source: impl Read + Send, place: &str) -> Result<Self, LogError> {
        let interrupted = |line, source| LogError::Interrupted { place: place.to_owned(), line, source };
        let refused = |line, reason| LogError::Trajectory { place: place.to_owned(), line, reason };
        let mut lines = Lines::new(source::text(source, place)?);
        let mut rows: Vec<Row> = Vec::new();
        let mut names = Names::default();
        let mut named = false;
        loop {
            let line = lines.number() + 1;
            match lines.next().map_err(|error| interrupted(line - 1, error))? {
                None if rows.is_empty() => {
                    return Err(refused(line, "no pose; give lines of time x y z qx qy qz qw".to_owned()));
                }
                None => break,
                Some((_, Line::TooLong)) => return Err(refused(line, format!("is longer than {LONGEST_LINE} bytes"))),
                Some((_, Line::Text(text))) => match text.trim_ascii() {
                    [] => {}
                    line if line[0] == b'#' || rows.is_empty() && !named && is_head(line) => {
                        if rows.is_empty() && !named {
                            names = head::names(line);
                            named = names != Names::default() || line[0] != b'#';
                        }
                    }
                    _ if rows.len() == MOST_POSES => {
                        return Err(refused(line, format!("more than {MOST_POSES} poses; thin them out")));
                    }
                    text => rows.push(rows::row(text, line, named).map_err(|reason| refused(line, reason))?),
                },
            }
        }
        Self::of(rows, names).map_err(|(line, reason)| refused(line, reason))
    }

    fn of(mut rows: Vec<Row>, names: Names) -> Result<Self, (u64, String)> {
        let mut findings = Vec::new();
        let order = orientation::order(&rows, names.order, &mut findings);
        clock::ordered(&mut rows, names.unit, &mut findings)?;
        let mut stamps = Vec::with_capacity(rows.len());
        for row in &rows {
            let theta_rad = orientation::upright(row, order).map_err(|reason| (row.line, reason))?;
            stamps.push((row.time, Pose { x_m: row.at_m[0], y_m: row.at_m[1], theta_rad }));
        }
        leave_out_strays(&mut stamps, &rows, &mut findings);
        Ok(Self { stamps, findings })
    }

    /// First and last time, s.
    pub fn span_s(&self) -> [f64; 2] {
        [self.stamps[0].0, self.stamps[self.stamps.len() - 1].0]
    }

    /// Times in s and poses, in order.
    pub fn poses(&self) -> &[(f64, Pose)] {
        &self.stamps
    }

    /// What is to be known of it.
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// The pose at this time (s), between the two nearest: along a line, and by the shorter turn. None outside
    /// [`span_s`](Self::span_s). Bridges gaps of any length. O(log poses).
    pub fn pose(&self, time_s: f64) -> Option<Pose> {
        match self.at(time_s, f64::INFINITY) {
            At::Pose(pose) => Some(pose),
            At::Gap(_) | At::Outside => None,
        }
    }

    /// As [`pose`](Self::pose), unless the two nearest poses are more than `max_gap_s` (s) apart; at the times of the poses themselves
    /// there is no gap.
    pub fn at(&self, time_s: f64, max_gap_s: f64) -> At {
        let after = self.stamps.partition_point(|(stamp, _)| *stamp <= time_s);
        let Some(&(before_s, before)) = after.checked_sub(1).and_then(|k| self.stamps.get(k)) else {
            return At::Outside;
        };
        let Some(&(after_s, after)) = self.stamps.get(after) else {
            return if time_s <= before_s { At::Pose(before) } else { At::Outside };
        };
        let long_s = after_s - before_s;
        if long_s > max_gap_s + AT_STAMP_S {
            return match (time_s - before_s, after_s - time_s) {
                (since, _) if since <= AT_STAMP_S => At::Pose(before),
                (_, until) if until <= AT_STAMP_S => At::Pose(after),
                _ => At::Gap(Gap { from_s: before_s, long_s }),
            };
        }
        At::Pose(between(before, after, (time_s - before_s) / long_s))
    }
}

/// Leaves out groups of few poses far from those before and behind them.
fn leave_out_strays(stamps: &mut Vec<(f64, Pose)>, rows: &[Row], findings: &mut Vec<Finding>) {
    // Groups of neighbours that are near each other: first and last.
    let place = |k: usize| (stamps[k].1, stamps[k].0);
    let mut groups: Vec<[usize; 2]> = vec![[0, 0]];
    for k in 1..stamps.len() {
        match groups.last_mut() {
            Some([_, last]) if near(place(*last), place(k)) => *last = k,
            _ => groups.push([k, k]),
        }
    }
    let size = |[first, last]: &[usize; 2]| last - first + 1;
    let few: usize = groups.iter().filter(|group| size(group) <= MOST_STRAYS).map(size).sum();
    if groups.len() == 1 || few == stamps.len() || 10 * few > stamps.len() {
        return;
    }
    let strays: VecDeque<[usize; 2]> = groups.into_iter().filter(|group| size(group) <= MOST_STRAYS).collect();
    let Some(&[first, _]) = strays.front() else { return };
    let beside = if first > 0 { first - 1 } else { strays[0][1] + 1 };
    let away_m = distance_m(stamps[first].1, stamps[beside].1);
    findings.push(Finding::TrajectoryStrays { count: few as u64, line: rows[first].line, away_m });
    let mut k = 0;
    stamps.retain(|_| {
        k += 1;
        !strays.iter().any(|[first, last]| (*first..=*last).contains(&(k - 1)))
    });
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

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
            (
                format!("{fine}1 0.5 0 0 0 0 0 1"),
                "a.tum:2: time 1 s: is there twice with different poses, first in line 1",
            ),
            ("1 0 0 0 0 0 0 0.94".to_owned(), "quaternion of norm 0.9400: must be 1 to within 0.05"),
            ("1 0 0 8 0 1 0 8 0 0 1 0".to_owned(), "a matrix, as in the format of KITTI"),
            (
                "1 0 0 0.5".to_owned(),
                "4 fields; must be 8: time x y z qx qy qz qw: heights and quaternions are missing",
            ),
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
        fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = Trajectory::read(bytes.as_slice(), "noise");
        }
    }
}
