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
    /// Their beams.
    pub beams: u64,
    /// Scans whose pose is that of the odometry.
    pub odometry_poses: u64,
    /// Scans that are left out since the log has no pose for them.
    pub without_pose: u64,
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

/// The longest range, and how often it comes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Longest {
    /// Echoes.
    pub echoes: u64,
    /// The longest, m; 0 without one.
    pub range_m: f64,
    /// Echoes that have it.
    pub count: u64,
}

impl Longest {
    fn add(&mut self, range_m: f64) {
        self.echoes += 1;
        if range_m > self.range_m {
            (self.range_m, self.count) = (range_m, 1);
        } else {
            self.count += u64::from(range_m.total_cmp(&self.range_m).is_eq());
        }
    }

    /// Whether more than one echo in a hundred has it.
    fn is_suspected(&self) -> bool {
        self.count >= 10 && self.count * 100 > self.echoes
    }
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
    /// Scans without a pose: of raw lasers and sonars, without poses of the robot around them; of a bag, without poses before and after them.
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
    /// The longest range of sonars.
    pub longest_of_sonars: Longest,
    /// Messages of sonars that do not say where these stand, and the line of the first.
    pub without_mounts: (u64, u64),
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

    /// The first sensor of the array that a sensor is of: of a CARMEN log's sonars, that of the first in each line; else the sensor itself.
    pub fn array_of(&self, sensor: usize) -> usize {
        let name = |found: &SensorReport| found.is_sonar().then(|| found.name.clone()).filter(|name| !name.is_empty());
        let Some(own) = self.sensors.get(&sensor).and_then(name) else { return sensor };
        self.sensors.iter().find(|(_, other)| name(other).as_ref() == Some(&own)).map_or(sensor, |(first, _)| *first)
    }

    /// Scans that were not given.
    pub fn left_out(&self) -> u64 {
        self.outside_window + self.outside_trajectory + self.in_gaps + self.unplaced + self.strays + self.thinned
    }

    /// What is to be known of the log, warnings first.
    pub fn findings(&self) -> Vec<Finding> {
        // Of an array, its first sensor stands for all.
        let first = self.sensors.iter().filter(|(number, _)| self.array_of(**number) == **number);
        let mut all: Vec<Finding> = first.flat_map(|(_, sensor)| sensor_findings(sensor)).collect();
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
        // Sonars may have one each.
        let others = self.sensors.values().filter(|sensor| !sensor.is_sonar());
        let (scans, of_them) =
            others.fold((0, 0), |(scans, beams), sensor| (scans + sensor.scans, beams + sensor.beams));
        if scans >= LEAST_FOR_ONE_BEAM && scans == of_them {
            all.push(Finding::OneBeam { scans });
        }
        let longest = self.longest_of_sonars;
        if longest.is_suspected() {
            all.push(Finding::SonarMaximum { range_m: longest.range_m, count: longest.count });
        }
        let (lines, line) = self.without_mounts;
        all.extend(some(lines, Finding::WithoutMounts { lines, line }));
        all.extend(self.noted.iter().cloned());
        all.sort_by_key(|finding| !finding.is_warning());
        all
    }

    pub(crate) fn unmounted(&mut self, line: u64) {
        let (lines, first) = self.without_mounts;
        self.without_mounts = (lines + 1, if lines == 0 { line } else { first });
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

    pub(crate) fn readings(&mut self, readings: &[Option<f64>], kind: Sensor) {
        let laser = matches!(kind, Sensor::Laser { .. });
        self.scans += 1;
        self.beams += readings.len() as u64;
        for reading in readings {
            match *reading {
                None => self.unusable += 1,
                Some(f64::INFINITY) => self.no_returns += 1,
                Some(range) if matches!(kind, Sensor::Sonar { .. }) => self.longest_of_sonars.add(range),
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

impl SensorReport {
    fn is_sonar(&self) -> bool {
        matches!(self.kind, Some(Sensor::Sonar { .. }))
    }
}

/// Fewer scans of one beam each tell nothing.
const LEAST_FOR_ONE_BEAM: u64 = 100;

fn sensor_findings(sensor: &SensorReport) -> Vec<Finding> {
    let SensorReport { name, scans, odometry_poses, without_pose, fans, .. } = sensor;
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
    if *odometry_poses > 1 && odometry_poses + without_pose == *scans {
        all.push(Finding::OdometryPoses { sensor: name.clone(), scans: *odometry_poses });
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
        let laser = Sensor::Laser { max_range_m: 80.0, beams: 1 };
        report.readings(&readings, laser);
        assert_eq!((report.suspected_max_range_m(), report.longest_m), (None, 4.99));
        readings.extend([Some(29.99); 20]);
        report.readings(&readings, laser);
        assert_eq!(report.suspected_max_range_m(), Some(29.99));
        report.readings(&[Some(60.0); 20], Sensor::Stereo);
        assert_eq!(report.suspected_max_range_m(), Some(29.99), "disparities are no ranges");
        assert_eq!(report.findings(), []);
        report.readings(&[Some(3.0), Some(2.0), None, Some(f64::INFINITY)].repeat(9), SONAR);
        assert_eq!(report.findings(), []);
        report.readings(&[Some(3.0)], SONAR);
        assert_eq!(report.findings(), [Finding::SonarMaximum { range_m: 3.0, count: 10 }]);
        assert_eq!(report.suspected_max_range_m(), Some(29.99), "that is of lasers");
    }

    const SONAR: Sensor = Sensor::Sonar { max_range_m: None, width_rad: None };

    #[test]
    fn the_sonars_of_a_message_are_an_array_and_its_first_stands_for_all() {
        let sensor = |name: &str, kind: Sensor| SensorReport {
            name: name.to_owned(),
            kind: Some(kind),
            scans: 200,
            beams: 200,
            odometry_poses: 200,
            without_pose: 0,
            fans: Vec::new(),
        };
        let laser = Sensor::Laser { max_range_m: 80.0, beams: 1 };
        let all = [("FLASER", laser), ("SONAR", SONAR), ("SONAR", SONAR), ("", SONAR), ("", SONAR)];
        let sensors = all.into_iter().enumerate().map(|(number, (name, kind))| (number, sensor(name, kind)));
        let report = Report { sensors: sensors.collect(), ..Report::default() };
        assert_eq!([0, 1, 2, 3, 4, 9].map(|number| report.array_of(number)), [0, 1, 1, 3, 4, 9]);
        let names: Vec<String> = (report.findings().iter())
            .filter_map(|finding| match finding {
                Finding::OdometryPoses { sensor, .. } => Some(sensor.clone()),
                _ => None,
            })
            .collect();
        assert_eq!(names, ["FLASER", "SONAR", "", ""]);
        assert!(report.findings().contains(&Finding::OneBeam { scans: 200 }), "of the laser alone");
    }

    #[test]
    fn a_report_as_text() {
        let mut report = Report { lines: 4, kept: 1, damaged: 1, steps_back: 1, ..Report::default() };
        report.readings(&[Some(1.0), None, Some(f64::INFINITY)], Sensor::Laser { max_range_m: 80.0, beams: 3 });
        report.at(0.0);
        report.at(2.5);
        report.skip("ODOM");
        report.problems.push(Problem { line: 3, reason: "x is missing".to_owned() });
        let expected = "1 scans in 4 lines, 2.5 s; 1 kept, 1 back in time\n3 beams, 1 without echo, 1 unusable\nskipped: ODOM 1\n\
                        1 damaged lines\n  line 3: x is missing";
        assert_eq!(report.to_string(), expected);
    }
}
