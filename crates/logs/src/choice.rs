//! Which scans to give, and from which poses.

use std::collections::BTreeMap;

use crate::frames::{distance_m, turn_rad};
use crate::motion::Place;
use crate::options::Options;
use crate::record::{Event, Recorded};
use crate::report::Report;
use crate::trajectory::{At, Body, Trajectory};

use sensor::{Pose, Scan};

/// Counts scans in the order of the log, drops those that were not asked for and puts the others on the trajectory.
pub(crate) struct Choice {
    options: Options,
    trajectory: Option<(Trajectory, Body)>,
    /// Time of the first scan by the log's clock, s.
    start_s: f64,
    /// Of every sensor, time by the log's clock (s), and number in a table, of the scan before.
    before: BTreeMap<usize, (f64, Option<u64>)>,
    /// Of every sensor, where it took the last scan in use.
    places: BTreeMap<usize, Place>,
    thinning: Thinning,
}

impl Choice {
    pub(crate) fn new(options: &Options, start_s: f64) -> Self {
        Self {
            options: options.clone(),
            trajectory: None,
            start_s,
            before: BTreeMap::new(),
            places: BTreeMap::new(),
            thinning: Thinning::default(),
        }
    }

    pub(crate) fn along(&mut self, trajectory: Trajectory, body: Body) {
        self.trajectory = Some((trajectory, body));
    }

    /// The trajectory that gives the poses, if not the log.
    pub(crate) fn trajectory(&self) -> Option<&Trajectory> {
        self.trajectory.as_ref().map(|(trajectory, _)| trajectory)
    }

    /// Counts a scan of the log, in the order of the log.
    pub(crate) fn see(&mut self, recorded: &Recorded, report: &mut Report) {
        let now = (recorded.scan.time_s, recorded.number);
        let before = self.before.insert(recorded.sensor, now);
        if let Some((time_s, _)) = before.filter(|(time_s, number)| now.0 < *time_s || now.1 < *number) {
            report.step_back(recorded.line, (time_s - now.0).max(0.0));
        }
        report.at(now.0 - self.start_s);
    }

    /// The scan with its time since the start, if it is to be given.
    pub(crate) fn take(&mut self, recorded: Recorded, report: &mut Report) -> Option<Event> {
        let Recorded { mut scan, sensor, kind, mount, from_reference, odometry, placed, gap, line, .. } = recorded;
        let clock_s = scan.time_s;
        scan.time_s = clock_s - self.start_s;
        scan.sensor = sensor;
        if self.options.window_s.as_ref().is_some_and(|window| !window.contains(&scan.time_s)) {
            report.outside_window += 1;
            return None;
        }
        if let Some((trajectory, body)) = &self.trajectory {
            let pose = match trajectory.at(clock_s, self.options.max_gap_s) {
                At::Pose(pose) => pose,
                At::Gap(gap) => {
                    report.in_gap(gap);
                    return None;
                }
                At::Outside => {
                    report.outside_trajectory += 1;
                    return None;
                }
            };
            scan.pose = match body {
                Body::Sensor => pose.compose(from_reference),
                Body::Robot => pose.compose(mount.unwrap_or_default()),
            };
        } else if !placed {
            report.sensors.entry(sensor).or_default().without_pose += 1;
            match gap {
                Some(gap) => report.in_gap(gap),
                None => report.unplaced += 1,
            }
            return None;
        }
        let place = Place { pose: scan.pose, time_s: clock_s, line };
        if let Some(before) = self.places.insert(sensor, place) {
            report.motion.add(before, place);
        }
        if !self.thinning.keeps(&scan, &self.options) {
            report.thinned += 1;
            return None;
        }
        report.kept += 1;
        Some(Event { scan, sensor, kind, mount, odometry, line })
    }
}

/// Every n-th scan, and of these those that were made far enough from the last. What several sensors read at one time is one scan.
#[derive(Debug, Default)]
struct Thinning {
    seen: u64,
    last: Option<Pose>,
    /// Time (s) and sensor of the last scan, and whether it was kept.
    before: Option<(f64, usize, bool)>,
}

impl Thinning {
    /// Whether to keep a scan.
    fn keeps(&mut self, scan: &Scan, options: &Options) -> bool {
        let keeps = match self.before {
            Some((time_s, sensor, kept)) if time_s.to_bits() == scan.time_s.to_bits() && sensor < scan.sensor => kept,
            _ => self.keeps_moment(scan.pose, options),
        };
        self.before = Some((scan.time_s, scan.sensor, keeps));
        keeps
    }

    fn keeps_moment(&mut self, pose: Pose, options: &Options) -> bool {
        let nth = self.seen.is_multiple_of(options.every);
        self.seen += 1;
        if !nth || !self.last.is_none_or(|last| far_enough(last, pose, options)) {
            return false;
        }
        self.last = Some(pose);
        true
    }
}

fn far_enough(last: Pose, pose: Pose, options: &Options) -> bool {
    let (moved_m, turned_rad) = (distance_m(pose, last), turn_rad(pose, last));
    match (options.least_move_m, options.least_turn_rad) {
        (None, None) => true,
        (move_m, turn_rad) => {
            move_m.is_some_and(|least| moved_m >= least) || turn_rad.is_some_and(|least| turned_rad >= least)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(poses: &[(f64, f64)], options: &Options) -> Vec<usize> {
        let mut thinning = Thinning::default();
        let mut keeps = |k: &usize| {
            let (x_m, theta_rad) = poses[*k];
            let pose = Pose { x_m, y_m: 0.0, theta_rad };
            thinning.keeps(&Scan { time_s: *k as f64, pose, ..Scan::default() }, options)
        };
        (0..poses.len()).filter(|k| keeps(k)).collect()
    }

    #[test]
    fn every_nth_from_the_first_on() {
        assert_eq!(kept(&[(0.0, 0.0); 7], &Options { every: 3, ..Options::default() }), [0, 3, 6]);
        assert_eq!(kept(&[(0.0, 0.0); 3], &Options::default()), [0, 1, 2]);
    }

    #[test]
    fn what_several_sensors_read_at_one_time_is_kept_or_dropped_together() {
        let kept = |options: &Options| {
            let mut thinning = Thinning::default();
            let scans = [(0.0, 0), (0.0, 1), (0.0, 3), (1.0, 0), (1.0, 1), (2.0, 1), (2.0, 0), (2.0, 1)];
            let mut keeps = |(time_s, sensor): (f64, usize)| {
                let pose = Pose { x_m: time_s, ..Pose::default() };
                thinning.keeps(&Scan { sensor, time_s, pose, ..Scan::default() }, options)
            };
            scans.map(&mut keeps)
        };
        let second = Options { every: 2, ..Options::default() };
        assert_eq!(kept(&second), [true, true, true, false, false, true, false, false]);
        let far = Options { least_move_m: Some(1.5), ..Options::default() };
        assert_eq!(kept(&far), [true, true, true, false, false, true, false, false]);
    }

    #[test]
    fn by_move_or_turn_since_the_last_that_was_kept() {
        let drive = [(0.0, 3.1), (0.4, 3.1), (0.8, 3.1), (0.8, -3.1), (0.8, -2.6), (1.6, -2.6)];
        let least = |least_move_m, least_turn_rad| Options { least_move_m, least_turn_rad, ..Options::default() };
        assert_eq!(kept(&drive, &least(Some(0.5), None)), [0, 2, 5]);
        assert_eq!(kept(&drive, &least(None, Some(0.5))), [0, 4], "3.1 and -3.1 rad are near");
        assert_eq!(kept(&drive, &least(Some(0.5), Some(0.5))), [0, 2, 4, 5]);
        assert_eq!(kept(&drive, &least(Some(0.0), None)).len(), drive.len());
    }
}
