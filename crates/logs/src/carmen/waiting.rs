//! Raw lasers and sonars, whose poses come from those of the robot before and after them.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use sensor::Pose;

use super::track::{Found, Track};
use crate::record::Recorded;
use crate::report::Report;

/// Messages that wait for poses, at most.
const MOST_WAITING: usize = 256;

/// So many raw scans of a laser without one that has a pose: then there are none with poses. Likewise so many messages of sonars without
/// a laser that has poses.
const SURE: u64 = 20;

/// Scans of raw lasers and of sonars until the poses of the robot reach them.
///
/// CARMEN logs have a scan twice where a program combined it with a pose (`RAWLASER1` and `ROBOTLASER1`): then the raw ones are left out.
/// Sonars stand on the robot where its lasers with poses put it, so that in a corrected log they are corrected too; where there are none, where the odometry does.
#[derive(Default)]
pub(super) struct Waiting {
    odometry: Track,
    /// Poses of the robot by its lasers.
    lasers: Track,
    /// In the order of the log.
    queue: VecDeque<Held>,
    /// Raw scans by laser.
    seen: BTreeMap<u8, u64>,
    /// Messages of sonars.
    sonars: u64,
    /// Lasers of which there are scans with poses.
    placed: BTreeSet<u8>,
    /// Where the first of them stands on the robot.
    reference: Pose,
}

/// A message that waits.
enum Held {
    Raw(u8, Recorded),
    /// The sonars of one message.
    Sonars(Vec<Recorded>),
    /// A scan that has a pose, behind sonars.
    Placed(Recorded),
}

impl Waiting {
    pub(super) fn odometry(&mut self, time_s: f64, pose: Pose) {
        self.odometry.push(time_s, pose);
    }

    /// Notes that this laser, mounted so, has scans with poses, and where the robot stood. Its raw ones that wait are left out.
    pub(super) fn placed(&mut self, laser: u8, mount: Pose, (time_s, robot): (f64, Pose), report: &mut Report) {
        if self.placed.is_empty() {
            self.reference = mount;
        }
        self.lasers.push(time_s, robot);
        if self.placed.insert(laser) {
            self.queue.retain(|held| match held {
                Held::Raw(raw, _) if *raw == laser => {
                    report.skip(&format!("RAWLASER{raw}"));
                    false
                }
                _ => true,
            });
        }
    }

    /// Whether raw scans of this laser are of use.
    pub(super) fn wants(&self, laser: u8) -> bool {
        !self.placed.contains(&laser)
    }

    pub(super) fn scan(&mut self, laser: u8, recorded: Recorded) {
        *self.seen.entry(laser).or_default() += 1;
        self.queue.push_back(Held::Raw(laser, recorded));
    }

    /// Takes the sonars of one message.
    pub(super) fn sonars(&mut self, recorded: Vec<Recorded>) {
        self.sonars += 1;
        self.queue.push_back(Held::Sonars(recorded));
    }

    /// Takes a scan that has a pose: behind sonars that wait, so that what is of one time stays together.
    pub(super) fn give(&mut self, recorded: Recorded, out: &mut VecDeque<Recorded>) {
        if self.sonars > 0 && !self.queue.is_empty() {
            self.queue.push_back(Held::Placed(recorded));
        } else {
            out.push_back(recorded);
        }
    }

    /// Adds the scans whose poses are known; at the end of the log, all.
    pub(super) fn release(&mut self, end: bool, max_gap_s: f64, report: &mut Report, out: &mut VecDeque<Recorded>) {
        while let Some(held) = self.queue.front() {
            let crowded = end || self.queue.len() > MOST_WAITING;
            let waits = match held {
                Held::Placed(_) => false,
                Held::Raw(laser, recorded) => {
                    let early = self.seen.get(laser).is_none_or(|seen| *seen < SURE);
                    early || matches!(self.odometry.find(recorded.scan.time_s, max_gap_s), Found::After)
                }
                Held::Sonars(sonars) => {
                    let early = self.lasers.is_empty() && self.sonars < SURE;
                    let time_s = sonars.first().map_or(0.0, |first| first.scan.time_s);
                    early || matches!(self.track().find(time_s, max_gap_s), Found::After)
                }
            };
            if waits && !crowded {
                return;
            }
            match self.queue.pop_front() {
                Some(Held::Placed(recorded)) => out.push_back(recorded),
                Some(Held::Raw(_, recorded)) => out.push_back(self.by_odometry(recorded, max_gap_s, report)),
                Some(Held::Sonars(sonars)) => {
                    out.extend(sonars.into_iter().map(|sonar| self.sonar(sonar, max_gap_s, report)));
                }
                None => return,
            }
        }
    }

    /// What puts sonars in their places.
    fn track(&self) -> &Track {
        if self.lasers.is_empty() { &self.odometry } else { &self.lasers }
    }

    fn by_odometry(&self, mut recorded: Recorded, max_gap_s: f64, report: &mut Report) -> Recorded {
        match self.odometry.find(recorded.scan.time_s, max_gap_s) {
            Found::Pose(robot) => {
                recorded.odometry = Some(robot);
                recorded.scan.pose = robot.compose(recorded.mount.unwrap_or_default());
                recorded.placed = true;
                report.sensors.entry(recorded.sensor).or_default().odometry_poses += 1;
            }
            Found::Gap(gap) => recorded.gap = Some(gap),
            Found::Jump | Found::Before | Found::After => {}
        }
        recorded
    }

    fn sonar(&self, mut recorded: Recorded, max_gap_s: f64, report: &mut Report) -> Recorded {
        // A trajectory of "the sensor" is that of the laser.
        recorded.from_reference = recorded.mount.unwrap_or_default().seen_from(self.reference);
        if self.lasers.is_empty() {
            return self.by_odometry(recorded, max_gap_s, report);
        }
        let time_s = recorded.scan.time_s;
        match self.lasers.find(time_s, max_gap_s) {
            Found::Pose(robot) => {
                recorded.scan.pose = robot.compose(recorded.mount.unwrap_or_default());
                recorded.placed = true;
            }
            Found::Gap(gap) => recorded.gap = Some(gap),
            Found::Jump | Found::Before | Found::After => {}
        }
        if let Found::Pose(odometry) = self.odometry.find(time_s, max_gap_s) {
            recorded.odometry = Some(odometry);
        }
        recorded
    }
}
