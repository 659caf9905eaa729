//! Scans whose poses lie far from all others: a few bad poses would make a map of kilometres.

use std::collections::VecDeque;

use sensor::Pose;

use crate::frames::distance_m;
use crate::record::Recorded;
use crate::report::{Report, Stray};

/// From one scan to the next a robot stays within this, m: beyond what a laser sees.
const NEAR_M: f64 = 50.0;

/// ... and this for every second between them, m/s, up to a minute.
const FASTEST_M_S: f64 = 10.0;
const LONGEST_S: f64 = 60.0;

/// So many scans near each other are where the robot is.
const SURE: usize = 10;

/// With more scans than this near to nothing, poses are not those of a drive, and all are kept.
const MOST: usize = 3 * SURE;

/// Whether two places can be of one drive.
pub(crate) fn near(a: (Pose, f64), b: (Pose, f64)) -> bool {
    distance_m(a.0, b.0) <= NEAR_M + FASTEST_M_S * (a.1 - b.1).abs().min(LONGEST_S)
}

/// Leaves out groups of fewer than ten scans that lie far from the drive. Holds at most 30 scans.
#[derive(Default)]
pub(crate) struct Strays {
    /// The last place of the drive, once ten scans tell where it is.
    drive: Option<(Pose, f64)>,
    /// Scans apart from the drive, in groups near each other; each with its number in the log.
    groups: Vec<Vec<(u64, Recorded)>>,
    seen: u64,
    /// There is no drive.
    given_up: bool,
}

impl Strays {
    /// Takes a scan; adds those that are known to belong to the drive.
    pub(crate) fn take(&mut self, recorded: Recorded, report: &mut Report, out: &mut VecDeque<Recorded>) {
        let place = place(&recorded);
        self.seen += 1;
        if self.given_up || !recorded.placed {
            out.push_back(recorded);
            return;
        }
        if self.drive.is_some_and(|drive| near(drive, place)) {
            self.leave_out(place, report);
            self.release(out);
            self.drive = Some(place);
            out.push_back(recorded);
            return;
        }
        let last = |group: &[(u64, Recorded)]| group.last().map(|(_, last)| self::place(last));
        let away_m = |k: &usize| last(&self.groups[*k]).map_or(f64::INFINITY, |last| distance_m(last.0, place.0));
        let group = (0..self.groups.len()).filter(|k| last(&self.groups[*k]).is_some_and(|last| near(last, place)));
        let group = group.min_by(|a, b| away_m(a).total_cmp(&away_m(b))).unwrap_or_else(|| {
            self.groups.push(Vec::new());
            self.groups.len() - 1
        });
        self.groups[group].push((self.seen, recorded));
        if self.groups[group].len() == SURE {
            let sure = self.groups.swap_remove(group);
            self.leave_out(sure.first().map_or(place, |(_, first)| self::place(first)), report);
            self.groups.push(sure);
            self.release(out);
            self.drive = Some(place);
        } else if self.groups.iter().map(Vec::len).sum::<usize>() > MOST {
            self.given_up = true;
            self.release(out);
        }
    }

    /// The log ends.
    pub(crate) fn end(&mut self, report: &mut Report, out: &mut VecDeque<Recorded>) {
        if let Some(drive) = self.drive {
            self.leave_out(drive, report);
        }
        self.release(out);
    }

    /// Adds all scans that wait.
    fn release(&mut self, out: &mut VecDeque<Recorded>) {
        let mut all: Vec<_> = self.groups.drain(..).flatten().collect();
        all.sort_by_key(|(number, _)| *number);
        out.extend(all.into_iter().map(|(_, recorded)| recorded));
    }

    /// Leaves out what is not near this place of the drive: a bad pose may have parted scans of the drive from it.
    fn leave_out(&mut self, drive: (Pose, f64), report: &mut Report) {
        for group in &mut self.groups {
            group.retain(|(_, recorded)| {
                let kept = near(drive, place(recorded));
                if !kept {
                    let away_m = distance_m(drive.0, recorded.scan.pose);
                    report.stray(Stray { line: recorded.line, away_m });
                }
                kept
            });
        }
    }
}

fn place(recorded: &Recorded) -> (Pose, f64) {
    (recorded.scan.pose, recorded.scan.time_s)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use sensor::Scan;

    use super::*;
    use crate::record::Sensor;

    /// Places (m) along a line, one a second; gives the numbers of those that are kept, and of those left out.
    fn kept(places: &[f64]) -> (Vec<u64>, u64) {
        let (mut strays, mut report, mut out) = (Strays::default(), Report::default(), VecDeque::new());
        for (line, x_m) in (0..).zip(places) {
            let scan = Scan { time_s: line as f64, pose: Pose { x_m: *x_m, ..Pose::default() }, ..Scan::default() };
            let (sensor, kind, mount) = (0, Sensor::Stereo, None);
            let (odometry, placed, gap, unit, number) = (None, true, None, Ok(()), None);
            let recorded = Recorded { scan, sensor, kind, mount, odometry, placed, gap, line, unit, number };
            strays.take(recorded, &mut report, &mut out);
        }
        strays.end(&mut report, &mut out);
        (out.iter().map(|recorded| recorded.line).collect(), report.strays)
    }

    #[test]
    fn a_few_poses_far_away_are_left_out_wherever_they_stand() {
        for at in [vec![0], vec![2], vec![9], vec![10], vec![20], vec![39], vec![20, 21], vec![0, 1, 15, 38, 39]] {
            let mut places: Vec<f64> = (0..40).map(f64::from).collect();
            at.iter().for_each(|k| places[*k as usize] += 588e3);
            let expected: Vec<u64> = (0..40).filter(|k| !at.contains(k)).collect();
            assert_eq!(kept(&places), (expected, at.len() as u64), "{at:?}");
        }
    }

    #[test]
    fn a_bad_pose_that_can_just_be_reached_costs_no_other_scan() {
        for at in [0, 3, 9, 10, 25] {
            let mut places: Vec<f64> = (0..40).map(f64::from).collect();
            places[at] += 55.0; // 60 m are near after a second
            let (kept, strays) = kept(&places);
            assert!(kept.len() >= 39 && kept.len() as u64 + strays == 40, "{at}: {kept:?}");
        }
    }

    #[test]
    fn a_drive_that_goes_on_elsewhere_and_scattered_places_are_kept() {
        let moved: Vec<f64> = (0..40).map(|k| f64::from(k) + if k < 20 { 0.0 } else { 1e4 }).collect();
        assert_eq!(kept(&moved), ((0..40).collect(), 0));
        let scattered: Vec<f64> = (0..100).map(|k| f64::from(k * k) * 1e3).collect();
        assert_eq!(kept(&scattered), ((0..100).collect(), 0));
        assert_eq!(kept(&[0.0, 1e6, 0.0]).0, [0, 1, 2], "three scans tell nothing");
    }

    proptest! {
        #[test]
        fn nothing_is_lost_or_reordered(places in prop::collection::vec(prop_oneof![4 => 0.0..9.0, 1 => 1e4..1e6], 0..120)) {
            let (kept, strays) = kept(&places);
            prop_assert!(kept.is_sorted() && kept.len() as u64 + strays == places.len() as u64);
        }
    }
}
