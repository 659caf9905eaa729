//! Poses of the robot in the order of their times, and where it was between them.

use std::collections::VecDeque;

use sensor::Pose;

use crate::frames::between;
use crate::report::Gap;
use crate::strays::near;

/// Poses that are kept, the last ones: half a minute at 100 a second.
const MOST_POSES: usize = 4096;

/// Poses whose times rise.
#[derive(Default)]
pub(super) struct Track {
    poses: VecDeque<(f64, Pose)>,
}

/// Where a track puts a time.
pub(super) enum Found {
    Pose(Pose),
    Gap(Gap),
    /// Between two poses of which one cannot be of the same drive.
    Jump,
    /// Before the first pose that is known.
    Before,
    /// After the last.
    After,
}

impl Track {
    pub(super) fn is_empty(&self) -> bool {
        self.poses.is_empty()
    }

    /// Takes a pose (time in s); one that is not later than the last is left out.
    pub(super) fn push(&mut self, time_s: f64, pose: Pose) {
        if self.poses.back().is_some_and(|(last_s, _)| time_s <= *last_s) {
            return;
        }
        if self.poses.len() == MOST_POSES {
            self.poses.pop_front();
        }
        self.poses.push_back((time_s, pose));
    }

    /// The pose at a time, between the one before and the one after, which are at most `max_gap_s` apart.
    pub(super) fn find(&self, time_s: f64, max_gap_s: f64) -> Found {
        let after = self.poses.partition_point(|(stamp, _)| *stamp < time_s);
        let Some(&(after_s, next)) = self.poses.get(after) else { return Found::After };
        let Some(&(before_s, last)) = after.checked_sub(1).and_then(|before| self.poses.get(before)) else {
            // At the very time of the first pose there is none before, and none is needed.
            return if after_s <= time_s { Found::Pose(next) } else { Found::Before };
        };
        let long_s = after_s - before_s;
        if long_s > max_gap_s && after_s > time_s {
            return Found::Gap(Gap { from_s: before_s, long_s });
        }
        if after_s > time_s && !near((last, before_s), (next, after_s)) {
            return Found::Jump;
        }
        Found::Pose(between(last, next, (time_s - before_s) / long_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(poses: &[(f64, f64)]) -> Track {
        let mut track = Track::default();
        poses.iter().for_each(|(time_s, x_m)| track.push(*time_s, Pose { x_m: *x_m, ..Pose::default() }));
        track
    }

    /// What is found, as a number: x of a pose.
    fn at(track: &Track, time_s: f64) -> Result<f64, &'static str> {
        match track.find(time_s, 1.0) {
            Found::Pose(pose) => Ok(pose.x_m),
            Found::Gap(_) => Err("gap"),
            Found::Jump => Err("jump"),
            Found::Before => Err("before"),
            Found::After => Err("after"),
        }
    }

    #[test]
    fn poses_are_interpolated_and_gaps_and_jumps_are_not() {
        let track = track(&[(1.0, 0.0), (2.0, 10.0), (1.5, 99.0), (2.5, 1e6), (3.0, 20.0), (9.0, 30.0)]);
        let expected = [
            (0.5, Err("before")),
            (1.0, Ok(0.0)),
            (1.25, Ok(2.5)),
            (2.0, Ok(10.0)),
            (2.25, Err("jump")),
            (2.5, Ok(1e6)),
            (2.75, Err("jump")),
            (3.0, Ok(20.0)),
            (5.0, Err("gap")),
            (9.0, Ok(30.0)),
            (9.5, Err("after")),
        ];
        for (time_s, expected) in expected {
            assert_eq!(at(&track, time_s), expected, "{time_s}");
        }
    }

    #[test]
    fn what_is_long_ago_is_forgotten() {
        let mut track = Track::default();
        (0..2 * MOST_POSES).for_each(|k| track.push(k as f64, Pose::default()));
        assert_eq!(track.poses.len(), MOST_POSES);
        assert!(matches!(track.find(1.0, 1.0), Found::Before));
    }
}
