//! A log as a stream of scans.

use std::collections::VecDeque;
use std::io::{self, BufRead, Read};
use std::path::Path;
use std::sync::Arc;

use memchr::memchr;
use sensor::Scan;

use crate::bag::{BagOptions, Drive, Scans};
use crate::carmen::Carmen;
use crate::choice::Choice;
use crate::error::LogError;
use crate::lines::{LONGEST_LINE, Line, Lines};
use crate::options::Options;
use crate::record::{Event, Fault, Parser, Recorded, Sensor};
use crate::report::{Problem, Report, Unit};
use crate::source;
use crate::strays::Strays;
use crate::table::{Head, Table};
use crate::trajectory::{Body, Trajectory};

/// A log, read scan by scan. It holds one line and at most some hundred scans at a time, of a trajectory all, and of a table whose rows are
/// not in order as much as four million rows.
///
/// Iterating ends after the first error. Times of scans are s since the first scan of the log, kept or not.
pub struct Log<'a> {
    place: String,
    options: Options,
    lines: Lines<Box<dyn BufRead + Send + 'a>>,
    /// The scans of a bag, which has no lines.
    bag: Option<Scans>,
    kind: Option<Kind>,
    /// None before the first line, which says what the log is.
    parser: Option<Box<dyn Parser>>,
    report: Report,
    sensor: Sensor,
    /// Scans that the parser completed.
    ahead: VecDeque<Recorded>,
    strays: Strays,
    /// Scans whose poses are near others'.
    near: VecDeque<Recorded>,
    choice: Choice,
    /// The report may keep no problem at all.
    first_damage: Option<Problem>,
    /// The line that was damaged last: what two of its sensors read can be so.
    last_damaged: Option<u64>,
    /// Whether it was said that scans differ in maximum range.
    maximum_changed: bool,
    /// Why reading came to an end before the log did, to be said after the last scan.
    failure: Option<LogError>,
    ended: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Carmen,
    Table,
}

impl Log<'static> {
    /// Opens a CARMEN log or a table of scans, plain, gzip or bzip2, or a [bag](crate::bag) that leaves no choice, and reads up to its first scan.
    ///
    /// # Errors
    /// A file that cannot be read, or not twice; options that make no sense, the head of a table that is wrong, a log without a scan; of a
    /// bag, as [`Drive::open`].
    pub fn open(path: &Path, options: &Options) -> Result<Self, LogError> {
        if Drive::is_at(path) {
            return Self::of_drive(&Drive::open(path, &BagOptions::default())?, options);
        }
        Self::begin(source::file(path, true)?, &path.display().to_string(), options, None)
    }

    /// The scans of a bag, up to its first scan.
    ///
    /// # Errors
    /// Options that make no sense, a bag without a scan that can be read.
    pub fn of_drive(drive: &Arc<Drive>, options: &Options) -> Result<Self, LogError> {
        options.check()?;
        let mut log = Self::unread(io::empty(), drive.place(), options, None)?;
        let scans = Scans::new(drive, options);
        scans.begin(&mut log.report);
        log.bag = Some(scans);
        log.up_to_the_first(options)
    }
}

impl<'a> Log<'a> {
    /// As [`open`](Log::open), from any source; `place` names it in messages.
    ///
    /// # Errors
    /// As [`open`](Log::open).
    pub fn read(source: impl Read + Send + 'a, place: &str, options: &Options) -> Result<Self, LogError> {
        Self::begin(source, place, options, None)
    }

    /// As [`read`](Self::read), for a source that must be a CARMEN log.
    ///
    /// # Errors
    /// As [`open`](Log::open).
    pub fn carmen(source: impl Read + Send + 'a, place: &str, options: &Options) -> Result<Self, LogError> {
        Self::begin(source, place, options, Some(Kind::Carmen))
    }

    /// As [`read`](Self::read), for a source that must be a table of scans.
    ///
    /// # Errors
    /// As [`open`](Log::open).
    pub fn table(source: impl Read + Send + 'a, place: &str, options: &Options) -> Result<Self, LogError> {
        Self::begin(source, place, options, Some(Kind::Table))
    }

    /// Takes the poses of scans from a trajectory, by the log's own clock (`ipc_time`, `time_s`); scans outside its time span, and
    /// in gaps longer than [`Options::max_gap_s`], are dropped and counted. If all lie outside, the log ends with [`LogError::Clocks`].
    ///
    /// # Errors
    /// [`LogError::Untimed`], for a table without times.
    pub fn along(mut self, trajectory: Trajectory, body: Body) -> Result<Self, LogError> {
        if self.bag.is_none() && !self.parser.as_ref().is_some_and(|parser| parser.timed()) {
            return Err(LogError::Untimed { place: self.place });
        }
        self.report.noted.extend_from_slice(trajectory.findings());
        self.report.along_trajectory = true;
        self.choice.along(trajectory, body);
        Ok(self)
    }

    /// What took the first scan.
    pub fn sensor(&self) -> Sensor {
        self.sensor
    }

    /// What was found so far.
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// The next scan, with its sensor, odometry and line; none at the end, an error at most once.
    pub fn next_event(&mut self) -> Option<Result<Event, LogError>> {
        loop {
            let Some(recorded) = self.near.pop_front() else {
                match self.record() {
                    // The trajectory gives all poses: those of the log do not matter.
                    Some(recorded) if self.choice.trajectory().is_some() => self.near.push_back(recorded),
                    Some(recorded) => self.strays.take(recorded, &mut self.report, &mut self.near),
                    None => {
                        self.strays.end(&mut self.report, &mut self.near);
                        if self.near.is_empty() {
                            return self.close().map(Err);
                        }
                    }
                }
                continue;
            };
            if let Some(event) = self.choice.take(recorded, &mut self.report) {
                return Some(Ok(event));
            }
        }
    }

    fn begin(
        source: impl Read + Send + 'a,
        place: &str,
        options: &Options,
        kind: Option<Kind>,
    ) -> Result<Self, LogError> {
        options.check()?;
        Self::unread(source, place, options, kind)?.up_to_the_first(options)
    }

    fn unread(
        source: impl Read + Send + 'a,
        place: &str,
        options: &Options,
        kind: Option<Kind>,
    ) -> Result<Self, LogError> {
        Ok(Self {
            place: place.to_owned(),
            options: options.clone(),
            lines: Lines::new(source::text(source, place)?),
            bag: None,
            kind,
            parser: None,
            report: Report {
                max_gap_s: options.max_gap_s,
                max_disparity_px: options.max_disparity_px.unwrap_or(f64::INFINITY),
                windowed: options.window_s.is_some(),
                ..Report::default()
            },
            sensor: Sensor::Stereo,
            ahead: VecDeque::new(),
            strays: Strays::default(),
            near: VecDeque::new(),
            choice: Choice::new(options, 0.0),
            first_damage: None,
            last_damaged: None,
            maximum_changed: false,
            failure: None,
            ended: false,
        })
    }

    fn up_to_the_first(mut self, options: &Options) -> Result<Self, LogError> {
        while self.ahead.is_empty() && !self.ended {
            self.read_more();
        }
        match self.ahead.front() {
            Some(first) => {
                (self.sensor, self.choice) = (first.kind, Choice::new(options, first.scan.time_s));
                self.report.start_s = first.scan.time_s;
            }
            None => return Err(self.failure.take().unwrap_or_else(|| self.no_scan())),
        }
        Ok(self)
    }

    /// The next scan of the log whose readings are plausible, counted.
    fn record(&mut self) -> Option<Recorded> {
        while self.ahead.is_empty() && !self.ended {
            self.read_more();
        }
        let recorded = self.ahead.pop_front()?;
        self.count(&recorded);
        self.choice.see(&recorded, &mut self.report);
        Some(recorded)
    }

    fn read_more(&mut self) {
        match &mut self.bag {
            Some(_) => self.read_message(),
            None => self.read_line(),
        }
    }

    /// Reads up to the next scan of a bag, or comes to the end.
    fn read_message(&mut self) {
        match self.bag.as_mut().and_then(|scans| scans.next(&mut self.report)) {
            Some((_, Ok(recorded))) => self.keep(VecDeque::from([recorded])),
            Some((number, Err(reason))) => self.damage(number, reason),
            None => self.ended = true,
        }
    }

    /// Reads a line, or comes to the end, and keeps the scans that this completes.
    fn read_line(&mut self) {
        let mut complete = VecDeque::new();
        let (number, outcome) = match self.lines.next() {
            Ok(Some((_, Line::Text(text)))) if text.trim_ascii().is_empty() => return,
            Ok(Some((number, Line::Text(text)))) if memchr(0, text).is_some() => {
                (number, Err(Fault::Damage("holds a byte of value 0, so that it is no text".to_owned())))
            }
            Ok(Some((number, Line::Text(text)))) => match &mut self.parser {
                Some(parser) => (number, parser.line(text, number, &mut self.report, &mut complete)),
                None => match begun(self.kind, text, &self.options) {
                    Ok(Begun::Comment) => {
                        self.report.skip("#");
                        (number, Ok(()))
                    }
                    Ok(Begun::Table(table)) => {
                        self.parser = Some(table);
                        (number, Ok(()))
                    }
                    Ok(Begun::Carmen(mut parser)) => {
                        let outcome = parser.line(text, number, &mut self.report, &mut complete);
                        self.parser = Some(parser);
                        (number, outcome)
                    }
                    Err(reason) => {
                        return self.end(Some(LogError::Head { place: self.place.clone(), line: number, reason }));
                    }
                },
            },
            Ok(Some((number, Line::TooLong))) => {
                let reason = format!("is longer than {LONGEST_LINE} bytes, of which no line of a log is");
                (number, Err(Fault::Damage(reason)))
            }
            Ok(None) => return self.end(None),
            Err(source) => {
                let (place, line) = (self.place.clone(), self.lines.number());
                return self.end(Some(LogError::Interrupted { place, line, source }));
            }
        };
        self.report.lines += 1;
        self.keep(complete);
        match outcome {
            Ok(()) => {}
            Err(Fault::Damage(reason)) => self.damage(number, reason),
            Err(Fault::Refusal(reason)) => {
                (self.ended, self.failure) =
                    (true, Some(LogError::Table { place: self.place.clone(), line: number, reason }));
            }
        }
    }

    /// Keeps the scans that the end completes; the failure, if it is one, is said after them.
    fn end(&mut self, failure: Option<LogError>) {
        (self.ended, self.failure) = (true, failure);
        let mut last = VecDeque::new();
        if let Some(parser) = &mut self.parser {
            parser.end(&mut self.report, &mut last);
        }
        self.keep(last);
    }

    /// Scans of implausible readings are damage.
    fn keep(&mut self, complete: VecDeque<Recorded>) {
        for recorded in complete {
            match recorded.unit {
                Ok(()) => self.ahead.push_back(recorded),
                Err(reason) => self.damage(recorded.line, reason),
            }
        }
    }

    fn damage(&mut self, line: u64, reason: String) {
        self.report.damaged += u64::from(self.last_damaged.replace(line) != Some(line));
        self.first_damage.get_or_insert_with(|| Problem { line, reason: reason.clone() });
        self.report.note(line, reason, self.options.problems);
    }

    fn count(&mut self, recorded: &Recorded) {
        self.report.readings(&recorded.scan.readings, recorded.kind);
        let sensor = self.report.sensors.entry(recorded.sensor).or_default();
        sensor.scans += 1;
        sensor.beams += recorded.scan.readings.len() as u64;
        sensor.kind.get_or_insert(recorded.kind);
        let maxima = [recorded.kind, self.sensor].map(|sensor| match sensor {
            Sensor::Laser { max_range_m, .. } => max_range_m,
            Sensor::Stereo | Sensor::Sonar { .. } => f64::INFINITY,
        });
        let are_lasers = maxima.iter().all(|max_range_m| max_range_m.is_finite());
        if are_lasers && maxima[0].total_cmp(&maxima[1]).is_ne() && !std::mem::replace(&mut self.maximum_changed, true)
        {
            let [now, first] = maxima;
            let reason = format!("the maximum range is {now} m here and {first} m in the first scan; set it by option");
            self.report.note(recorded.line, reason, self.options.problems);
        }
    }

    /// What the end of the log brings: an error once, then nothing.
    fn close(&mut self) -> Option<LogError> {
        if let Some(failure) = self.failure.take() {
            return Some(failure);
        }
        let Report { damaged, lines, scans, outside_trajectory, .. } = self.report;
        let share = self.options.damaged_share;
        if damaged > 1 && damaged as f64 > share * lines as f64 {
            let Problem { line, reason } = self.first_damage.take()?;
            let unit = self.report.unit;
            return Some(LogError::Damaged { place: self.place.clone(), line, unit, reason, damaged, lines, share });
        }
        let trajectory_s = self.choice.trajectory().filter(|_| outside_trajectory == scans)?.span_s();
        if std::mem::replace(&mut self.report.clocks_differ, true) {
            return None;
        }
        let log_s = self.report.span_s.unwrap_or_default().map(|at| at + self.report.start_s);
        Some(LogError::Clocks { place: self.place.clone(), scans, log_s, trajectory_s })
    }

    fn no_scan(&self) -> LogError {
        let unit = self.report.unit;
        let reason = match &self.first_damage {
            Some(problem) => format!("; {unit} {}: {}", problem.line, problem.reason),
            None if unit == Unit::Message => "; the topics that were named have no message".to_owned(),
            None if self.report.lines == 0 => {
                ": it is empty; give a CARMEN log with FLASER, RLASER, ROBOTLASER1 or SONAR, or a table of scans"
                    .to_owned()
            }
            None => {
                let names: Vec<_> = self.report.skipped.keys().take(5).cloned().collect();
                let only = if names.is_empty() { String::new() } else { format!(", only {}", names.join(", ")) };
                only + "; give a CARMEN log with FLASER, RLASER, ROBOTLASER1, or RAWLASER1 or SONAR and ODOM, or a table of scans"
            }
        };
        LogError::NoScan { place: self.place.clone(), lines: self.report.lines, unit, reason }
    }
}

impl Iterator for Log<'_> {
    type Item = Result<Scan, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_event().map(|event| event.map(|event| event.scan))
    }
}

/// What the first line of a text begins.
enum Begun {
    /// Nothing yet.
    Comment,
    /// A table whose head it is.
    Table(Box<dyn Parser>),
    /// A log whose first message it is.
    Carmen(Box<dyn Parser>),
}

fn begun(kind: Option<Kind>, line: &[u8], options: &Options) -> Result<Begun, String> {
    let found = if kind == Some(Kind::Carmen) { Head::None } else { Head::of(line) };
    match found {
        Head::Comment => Ok(Begun::Comment),
        Head::None if kind != Some(Kind::Table) => Ok(Begun::Carmen(Box::new(Carmen::new(options)))),
        Head::None | Head::Names => Ok(Begun::Table(Box::new(Table::new(line, options)?))),
    }
}
