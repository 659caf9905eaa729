//! Which scans to give, and from which poses.

use sensor::{Pose, Scan};

use crate::options::Options;
use crate::record::Recorded;
use crate::report::Report;
use crate::trajectory::{Body, Trajectory, mounted};

/// Counts scans in the order of the log, drops those that were not asked for and puts the others on the trajectory.
pub(crate) struct Choice {
    options: Options,
    trajectory: Option<(Trajectory, Body)>,
    /// Time of the first scan by the log's clock, s.
    start_s: f64,
    /// Time by the log's clock (s), and number in a table, of the scan before.
    before: Option<(f64, Option<u64>)>,
    thinning: Thinning,
}

impl Choice {
    pub(crate) fn new(options: &Options, start_s: f64) -> Self {
        Self { options: options.clone(), trajectory: None, start_s, before: None, thinning: Thinning::default() }
    }

    pub(crate) fn along(&mut self, trajectory: Trajectory, body: Body) {
        self.trajectory = Some((trajectory, body));
    }

    /// The scan with its time since the start, if it is to be given.
    pub(crate) fn take(&mut self, recorded: Recorded, report: &mut Report) -> Option<Scan> {
        let Recorded { mut scan, mount, number, .. } = recorded;
        let clock_s = scan.time_s;
        let back = self.before.is_some_and(|(time_s, before)| clock_s < time_s || number < before);
        report.steps_back += u64::from(back);
        self.before = Some((clock_s, number));
        scan.time_s = clock_s - self.start_s;
        report.at(scan.time_s);
        if self.options.window_s.as_ref().is_some_and(|window| !window.contains(&scan.time_s)) {
            report.outside_window += 1;
            return None;
        }
        if let Some((trajectory, body)) = &self.trajectory {
            let Some(pose) = trajectory.pose(clock_s) else {
                report.outside_trajectory += 1;
                return None;
            };
            scan.pose = match body {
                Body::Sensor => pose,
                Body::Robot => mounted(pose, mount),
            };
        }
        if !self.thinning.keeps(scan.pose, &self.options) {
            report.thinned += 1;
            return None;
        }
        report.kept += 1;
        Some(scan)
    }
}

/// Every n-th scan, and of these those that were made far enough from the last.
#[derive(Debug, Default)]
struct Thinning {
    seen: u64,
    last: Option<Pose>,
}

impl Thinning {
    /// Whether to keep a scan that was made here.
    fn keeps(&mut self, pose: Pose, options: &Options) -> bool {
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
    let moved_m = libm::hypot(pose.x_m - last.x_m, pose.y_m - last.y_m);
    let turned_rad = libm::remainder(pose.theta_rad - last.theta_rad, std::f64::consts::TAU).abs();
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
            thinning.keeps(Pose { x_m, y_m: 0.0, theta_rad }, options)
        };
        (0..poses.len()).filter(|k| keeps(k)).collect()
    }

    #[test]
    fn every_nth_from_the_first_on() {
        assert_eq!(kept(&[(0.0, 0.0); 7], &Options { every: 3, ..Options::default() }), [0, 3, 6]);
        assert_eq!(kept(&[(0.0, 0.0); 3], &Options::default()), [0, 1, 2]);
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
