//! Raw lasers, whose poses come from the odometry before and after them.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use sensor::Pose;

use crate::frames::{between, mounted};
use crate::record::Recorded;
use crate::report::{Gap, Report};

/// Poses of the odometry that are kept, the last ones.
const MOST_POSES: usize = 256;

/// Scans that wait for odometry, at most.
const MOST_WAITING: usize = 256;

/// So many raw scans of a laser without one that has a pose: then there are none with poses.
const SURE: u64 = 20;

/// Scans of raw lasers until the odometry reaches them.
///
/// CARMEN logs have a scan twice where a program combined it with a pose (`RAWLASER1` and `ROBOTLASER1`): then the raw ones are left out.
#[derive(Default)]
pub(super) struct Waiting {
    poses: VecDeque<(f64, Pose)>,
    scans: VecDeque<(u8, Recorded)>,
    /// Raw scans by laser.
    seen: BTreeMap<u8, u64>,
    /// Lasers of which there are scans with poses.
    placed: BTreeSet<u8>,
}

/// Where the odometry puts a time.
enum Found {
    Pose(Pose),
    Gap(Gap),
    /// Before the first pose that is known.
    Before,
    /// After the last.
    After,
}

impl Waiting {
    pub(super) fn odometry(&mut self, time_s: f64, pose: Pose) {
        if self.poses.back().is_some_and(|(last_s, _)| time_s <= *last_s) {
            return;
        }
        if self.poses.len() == MOST_POSES {
            self.poses.pop_front();
        }
        self.poses.push_back((time_s, pose));
    }

    /// Notes that this laser has scans with poses. Its raw ones that wait are left out.
    pub(super) fn placed(&mut self, laser: u8, report: &mut Report) {
        if self.placed.insert(laser) {
            self.scans.retain(|(raw, _)| {
                if *raw == laser {
                    report.skip(&format!("RAWLASER{raw}"));
                }
                *raw != laser
            });
        }
    }

    /// Whether raw scans of this laser are of use.
    pub(super) fn wants(&self, laser: u8) -> bool {
        !self.placed.contains(&laser)
    }

    pub(super) fn scan(&mut self, laser: u8, recorded: Recorded) {
        *self.seen.entry(laser).or_default() += 1;
        self.scans.push_back((laser, recorded));
    }

    /// Adds the scans whose poses are known; at the end of the log, all.
    pub(super) fn release(&mut self, end: bool, max_gap_s: f64, report: &mut Report, out: &mut VecDeque<Recorded>) {
        while let Some((laser, recorded)) = self.scans.front() {
            let crowded = end || self.scans.len() > MOST_WAITING;
            if !crowded && self.seen.get(laser).is_none_or(|seen| *seen < SURE) {
                return;
            }
            let found = self.find(recorded.scan.time_s, max_gap_s);
            if !crowded && matches!(found, Found::After) {
                return;
            }
            let Some((_, mut recorded)) = self.scans.pop_front() else { return };
            match found {
                Found::Pose(robot) => {
                    recorded.odometry = Some(robot);
                    recorded.scan.pose = mounted(robot, recorded.mount.unwrap_or_default());
                    recorded.placed = true;
                    report.sensors.entry(recorded.sensor).or_default().odometry_poses += 1;
                }
                Found::Gap(gap) => recorded.gap = Some(gap),
                Found::Before | Found::After => {}
            }
            out.push_back(recorded);
        }
    }

    fn find(&self, time_s: f64, max_gap_s: f64) -> Found {
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
        Found::Pose(between(last, next, (time_s - before_s) / long_s))
    }
}
