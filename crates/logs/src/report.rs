//! What was found in a log.

use std::collections::BTreeMap;
use std::fmt;

use crate::fan::{Fan, FanSource};
use crate::finding::Finding;
use crate::motion::Motion;
use crate::record::Sensor;

/// Names of messages that the report tells apart; what comes on top is counted together.
const MOST_NAMES: usize = 100;

/// What a log is counted in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Unit {
    /// Lines of a text.
    #[default]
    Line,
    /// Messages of a bag.
    Message,
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Line => "line",
            Self::Message => "message",
        })
    }
}

/// Something wrong in a log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Line, or message of a bag, from 1.
    pub line: u64,
    /// What is wrong.
    pub reason: String,
}

/// What was found of one sensor.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SensorReport {
    /// Name of its messages; empty in a table.
    pub name: String,
    /// What it is, by its first scan.
    pub kind: Option<Sensor>,
    /// Its scans, whether kept or not.
    pub scans: u64,
    /// Scans whose pose is that of the odometry.
    pub odometry_poses: u64,
    /// Fans by their number of beams, in order.
    pub fans: Vec<FanReport>,
}

/// Directions of the beams of a laser in a CARMEN log.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FanReport {
    /// Line of the first scan that has it.
    pub line: u64,
    /// Number of beams.
    pub beams: usize,
    /// Their directions.
    pub fan: Fan,
    /// Where they were taken from.
    pub source: FanSource,
    /// Whether field of view, resolution and number of beams fit each other.
    pub fits: bool,
}

/// A time that goes back, from one scan of a sensor to its next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepBack {
    /// Line of the later scan.
    pub line: u64,
    /// How far, s.
    pub by_s: f64,
}

/// A scan whose pose is far from all others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stray {
    /// Line of the scan.
    pub line: u64,
    /// From the drive, m.
    pub away_m: f64,
}

/// Time without a known pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// Where it begins, s by the log's clock.
    pub from_s: f64,
    /// How long it is, s.
    pub long_s: f64,
}

/// Disparities that cannot be, and were taken for no match.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct NoMatchCodes {
    /// Exactly 0.
    pub zero: u64,
    /// Infinite.
    pub infinite: u64,
    /// Above the largest that is searched.
    pub large: u64,
}

/// Number of beams that a fan is told apart by; scanners have one or two.
const MOST_FANS: usize = 8;

/// What was found in a log so far; complete at its end.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// What the log is counted in.
    pub unit: Unit,
    /// Lines that are not blank, or messages of a bag.
    pub lines: u64,
    /// Scans, whether kept or not.
    pub scans: u64,
    /// Scans that were given.
    pub kept: u64,
    /// Beams of all scans.
    pub beams: u64,
    /// Beams without an echo up to the maximum range.
    pub no_returns: u64,
    /// Beams that gave nothing usable.
    pub unusable: u64,
    /// Messages that hold no scan, by name; comments are `#`.
    pub skipped: BTreeMap<String, u64>,
    /// Messages that say a scan again that stands in one of another name; they are among the skipped ones.
    pub said_again: u64,
    /// Lines that could not be read.
    pub damaged: u64,
    /// The first of them, and other things to know, in order.
    pub problems: Vec<Problem>,
    /// Times that a scan was made before the one that stands before it, of the same sensor, or in a table has a lower number.
    pub steps_back: u64,
    /// The largest step back in time.
    pub largest_step_back: Option<StepBack>,
    /// Scans outside the time window.
    pub outside_window: u64,
    /// Scans outside the time span of the trajectory.
    pub outside_trajectory: u64,
    /// Scans in gaps of the trajectory, or of the odometry, that are too long.
    pub in_gaps: u64,
    /// The longest of these gaps that has a scan in it.
    pub longest_gap: Option<Gap>,
    /// The longest gap that is bridged, s.
    pub max_gap_s: f64,
    /// Scans without a pose: of raw lasers, without odometry around them; of a bag, without poses before and after them.
    pub unplaced: u64,
    /// Where the poses of a bag come from.
    pub poses: Option<String>,
    /// Ranges of a bag beyond the maximum that its messages state.
    pub beyond_maximum: u64,
    /// Scans whose poses are far from all others.
    pub strays: u64,
    /// The first of them.
    pub first_stray: Option<Stray>,
    /// Scans dropped as not the n-th, or too near to the one before.
    pub thinned: u64,
    /// Earliest and latest time of a scan, s since the first; none without a scan.
    pub span_s: Option<[f64; 2]>,
    /// The longest range below the maximum range, m; 0 without one.
    pub longest_m: f64,
    /// Beams that have it.
    pub longest_beams: u64,
    /// Time of the first scan by the log's own clock, s.
    pub start_s: f64,
    /// Every sensor, by its number.
    pub sensors: BTreeMap<usize, SensorReport>,
    /// How scans that are in use, before thinning, lie to each other.
    pub motion: Motion,
    /// Disparities that cannot be.
    pub codes: NoMatchCodes,
    /// The largest disparity that is a reading, px; infinite without a bound.
    pub max_disparity_px: f64,
    /// Whether a trajectory gives the poses.
    pub along_trajectory: bool,
    /// Whether no scan lies in the time of the trajectory.
    pub clocks_differ: bool,
    /// Whether a time window was asked for.
    pub windowed: bool,
    /// What parsers and the trajectory have to say.
    pub noted: Vec<Finding>,
}

impl Report {
    /// The longest range, m, where more than one beam in a hundred has exactly it: then it is rather the scanner's code for no
    /// echo than a wall, and the true maximum range of the log.
    pub fn suspected_max_range_m(&self) -> Option<f64> {
        let echoes = self.beams - self.no_returns - self.unusable;
        (self.longest_beams >= 10 && self.longest_beams * 100 > echoes).then_some(self.longest_m)
    }

    /// Scans that were not given.
    pub fn left_out(&self) -> u64 {
        self.outside_window + self.outside_trajectory + self.in_gaps + self.unplaced + self.strays + self.thinned
    }

    /// What is to be known of the log, warnings first.
    pub fn findings(&self) -> Vec<Finding> {
        let mut all: Vec<Finding> = self.sensors.values().flat_map(sensor_findings).collect();
        if self.along_trajectory {
            all.retain(|finding| !matches!(finding, Finding::OdometryPoses { .. }));
        }
        let Motion { jump, jumps, twist, twists, .. } = self.motion;
        all.extend(jump.map(|step| Finding::Jump { step, count: jumps }));
        all.extend(twist.map(|step| Finding::Twist { step, count: twists }));
        if let Some(StepBack { line, by_s }) = self.largest_step_back {
            all.push(Finding::StepsBack { count: self.steps_back, largest_s: by_s, line, window: self.windowed });
        }
        if let Some(Stray { line, away_m }) = self.first_stray {
            all.push(Finding::Strays { count: self.strays, line, away_m });
        }
        if let Some(Gap { from_s, long_s }) = self.longest_gap {
            all.push(Finding::Gaps { scans: self.in_gaps, longest_s: long_s, from_s, most_s: self.max_gap_s });
        }
        let beams = self.beams;
        let NoMatchCodes { zero, infinite, large } = self.codes;
        let some = |count: u64, finding: Finding| (count > 0).then_some(finding);
        all.extend(some(self.said_again, Finding::SaidAgain { scans: self.said_again }));
        all.extend(some(self.unplaced, Finding::Unplaced { scans: self.unplaced, poses: self.poses.clone() }));
        all.extend(some(self.beyond_maximum, Finding::BeyondMaximum { count: self.beyond_maximum, beams }));
        all.extend(some(zero, Finding::ZeroDisparities { count: zero, beams }));
        all.extend(some(infinite, Finding::InfiniteDisparities { count: infinite }));
        all.extend(some(large, Finding::LargeDisparities { count: large, beams, most_px: self.max_disparity_px }));
        if self.scans >= LEAST_FOR_ONE_BEAM && self.scans == beams {
            all.push(Finding::OneBeam { scans: self.scans });
        }
        all.extend(self.noted.iter().cloned());
        all.sort_by_key(|finding| !finding.is_warning());
        all
    }

    pub(crate) fn stray(&mut self, stray: Stray) {
        self.strays += 1;
        self.first_stray.get_or_insert(stray);
    }

    pub(crate) fn step_back(&mut self, line: u64, by_s: f64) {
        self.steps_back += 1;
        if self.largest_step_back.is_none_or(|largest| by_s > largest.by_s) {
            self.largest_step_back = Some(StepBack { line, by_s });
        }
    }

    pub(crate) fn in_gap(&mut self, gap: Gap) {
        self.in_gaps += 1;
        if self.longest_gap.is_none_or(|longest| gap.long_s > longest.long_s) {
            self.longest_gap = Some(gap);
        }
    }

    pub(crate) fn fan(&mut self, sensor: usize, name: &str, found: FanReport) {
        let of_sensor = self.sensors.entry(sensor).or_default();
        if of_sensor.name.is_empty() {
            name.clone_into(&mut of_sensor.name);
        }
        let fans = &mut of_sensor.fans;
        if fans.len() < MOST_FANS && fans.iter().all(|fan| (fan.beams, fan.fan) != (found.beams, found.fan)) {
            fans.push(found);
        }
    }

    pub(crate) fn skip(&mut self, name: &str) {
        let name = if self.skipped.contains_key(name) || self.skipped.len() < MOST_NAMES { name } else { "others" };
        match self.skipped.get_mut(name) {
            Some(count) => *count += 1,
            None => {
                self.skipped.insert(name.to_owned(), 1);
            }
        }
    }

    pub(crate) fn note(&mut self, line: u64, reason: String, most: usize) {
        if self.problems.len() < most {
            self.problems.push(Problem { line, reason });
        }
    }

    pub(crate) fn readings(&mut self, readings: &[Option<f64>], laser: bool) {
        self.scans += 1;
        self.beams += readings.len() as u64;
        for reading in readings {
            match *reading {
                None => self.unusable += 1,
                Some(f64::INFINITY) => self.no_returns += 1,
                Some(range) if laser && range > self.longest_m => (self.longest_m, self.longest_beams) = (range, 1),
                Some(range) => self.longest_beams += u64::from(laser && range.total_cmp(&self.longest_m).is_eq()),
            }
        }
    }

    pub(crate) fn at(&mut self, time_s: f64) {
        let [first, last] = self.span_s.unwrap_or([time_s; 2]);
        self.span_s = Some([first.min(time_s), last.max(time_s)]);
    }
}

/// Fewer scans of one beam each tell nothing.
const LEAST_FOR_ONE_BEAM: u64 = 100;

fn sensor_findings(sensor: &SensorReport) -> Vec<Finding> {
    let SensorReport { name, scans, odometry_poses, fans, .. } = sensor;
    let mut all = Vec::new();
    for FanReport { line, beams, fan, source, fits } in fans.iter().copied() {
        let sensor = name.clone();
        match source {
            FanSource::UsualNumber | FanSource::Number => {
                all.push(Finding::GuessedFan { sensor, line, beams, fan, usual: source == FanSource::UsualNumber });
            }
            FanSource::Log if !fits => all.push(Finding::UnevenFan { sensor, line, beams, fan }),
            FanSource::Log | FanSource::Options => {}
        }
    }
    if *scans > 1 && odometry_poses == scans {
        all.push(Finding::OdometryPoses { sensor: name.clone(), scans: *scans });
    }
    all
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, last] = self.span_s.unwrap_or_default();
        write!(f, "{} scans in {} {}s, {:.1} s; {} kept", self.scans, self.lines, self.unit, last - first, self.kept)?;
        for (count, what) in [
            (self.outside_window, "outside the time window"),
            (self.outside_trajectory, "outside the trajectory"),
            (self.in_gaps, "in gaps of the trajectory"),
            (self.unplaced, "without odometry"),
            (self.strays, "far from all others"),
            (self.thinned, "thinned out"),
            (self.steps_back, "back in time"),
        ] {
            if count > 0 {
                write!(f, ", {count} {what}")?;
            }
        }
        write!(f, "\n{} beams, {} without echo, {} unusable", self.beams, self.no_returns, self.unusable)?;
        if let Some(range) = self.suspected_max_range_m() {
            write!(
                f,
                "\n{} beams read {range} m, and none more: rather the maximum range than a wall",
                self.longest_beams
            )?;
        }
        if !self.skipped.is_empty() {
            let names: Vec<_> = self.skipped.iter().map(|(name, count)| format!("{name} {count}")).collect();
            write!(f, "\nskipped: {}", names.join(", "))?;
        }
        for finding in self.findings() {
            write!(f, "\n{}{}", if finding.is_warning() { "warning: " } else { "" }, finding.text(self.unit))?;
        }
        write!(f, "\n{} damaged {}s", self.damaged, self.unit)?;
        self.problems.iter().try_for_each(|problem| write!(f, "\n  {} {}: {}", self.unit, problem.line, problem.reason))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endless_names_are_counted_together() {
        let mut report = Report::default();
        for k in 0..1000 {
            report.skip(&format!("NAME{k}"));
        }
        report.skip("NAME3");
        assert_eq!((report.skipped.len(), report.skipped["NAME3"], report.skipped["others"]), (MOST_NAMES + 1, 2, 900));
    }

    #[test]
    fn a_longest_range_that_comes_again_and_again_is_suspected() {
        let mut report = Report::default();
        let mut readings: Vec<_> = (0..500).map(|k| Some(f64::from(k) * 0.01)).collect();
        report.readings(&readings, true);
        assert_eq!((report.suspected_max_range_m(), report.longest_m), (None, 4.99));
        readings.extend([Some(29.99); 20]);
        report.readings(&readings, true);
        assert_eq!(report.suspected_max_range_m(), Some(29.99));
        report.readings(&[Some(60.0); 20], false);
        assert_eq!(report.suspected_max_range_m(), Some(29.99), "disparities are no ranges");
    }

    #[test]
    fn a_report_as_text() {
        let mut report = Report { lines: 4, kept: 1, damaged: 1, steps_back: 1, ..Report::default() };
        report.readings(&[Some(1.0), None, Some(f64::INFINITY)], true);
        report.at(0.0);
        report.at(2.5);
        report.skip("ODOM");
        report.problems.push(Problem { line: 3, reason: "x is missing".to_owned() });
        let expected = "1 scans in 4 lines, 2.5 s; 1 kept, 1 back in time\n3 beams, 1 without echo, 1 unusable\nskipped: ODOM 1\n\
                        1 damaged lines\n  line 3: x is missing";
        assert_eq!(report.to_string(), expected);
    }
}
