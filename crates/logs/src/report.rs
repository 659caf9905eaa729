//! What was found in a log.

use std::collections::BTreeMap;
use std::fmt;

/// Names of messages that the report tells apart; what comes on top is counted together.
const MOST_NAMES: usize = 100;

/// Something wrong in a log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Line, from 1.
    pub line: u64,
    /// What is wrong.
    pub reason: String,
}

/// What was found in a log so far; complete at its end.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// Lines that are not blank.
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
    /// Lines that could not be read.
    pub damaged: u64,
    /// The first of them, and other things to know, in order.
    pub problems: Vec<Problem>,
    /// Times that a scan was made before the one that stands before it, or in a table has a lower number.
    pub steps_back: u64,
    /// Scans outside the time window.
    pub outside_window: u64,
    /// Scans outside the time span of the trajectory.
    pub outside_trajectory: u64,
    /// Scans dropped as not the n-th, or too near to the one before.
    pub thinned: u64,
    /// Earliest and latest time of a scan, s since the first; none without a scan.
    pub span_s: Option<[f64; 2]>,
    /// The longest range below the maximum range, m; 0 without one.
    pub longest_m: f64,
    /// Beams that have it.
    pub longest_beams: u64,
}

impl Report {
    /// The longest range, m, where more than one beam in a hundred has exactly it: then it is rather the scanner's code for no
    /// echo than a wall, and the true maximum range of the log.
    pub fn suspected_max_range_m(&self) -> Option<f64> {
        let echoes = self.beams - self.no_returns - self.unusable;
        (self.longest_beams >= 10 && self.longest_beams * 100 > echoes).then_some(self.longest_m)
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

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, last] = self.span_s.unwrap_or_default();
        write!(f, "{} scans in {} lines, {:.1} s; {} kept", self.scans, self.lines, last - first, self.kept)?;
        for (count, what) in [
            (self.outside_window, "outside the time window"),
            (self.outside_trajectory, "outside the trajectory"),
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
        write!(f, "\n{} damaged lines", self.damaged)?;
        self.problems.iter().try_for_each(|problem| write!(f, "\n  line {}: {}", problem.line, problem.reason))
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
