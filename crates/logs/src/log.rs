//! A log as a stream of scans.

use std::fs::File;
use std::io::{BufRead, Read};
use std::path::Path;

use memchr::memchr;
use sensor::Scan;

use crate::carmen::Carmen;
use crate::choice::Choice;
use crate::error::LogError;
use crate::lines::{Line, Lines};
use crate::options::Options;
use crate::record::{Parser, Recorded, Sensor};
use crate::report::{Problem, Report};
use crate::table::{self, Table};
use crate::trajectory::{Body, Trajectory};
use crate::{LONGEST_LINE, source};

/// A log, read scan by scan. It holds one line and two scans at a time, and of a trajectory all.
///
/// Iterating ends after the first error. Times of scans are s since the first scan of the log, kept or not.
pub struct Log<'a> {
    place: String,
    options: Options,
    lines: Lines<Box<dyn BufRead + Send + 'a>>,
    kind: Option<Kind>,
    /// None before the first line, which says what the log is.
    parser: Option<Box<dyn Parser>>,
    report: Report,
    sensor: Sensor,
    /// The scan to give next, if it is known already.
    ahead: Option<Recorded>,
    choice: Choice,
    /// The report may keep no problem at all.
    first_damage: Option<Problem>,
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
    /// Opens a CARMEN log or a table of scans, plain or gzip, and reads up to its first scan.
    ///
    /// # Errors
    /// A file that cannot be read, options that make no sense, the head of a table that is wrong, a log without a scan.
    pub fn open(path: &Path, options: &Options) -> Result<Self, LogError> {
        Self::begin(file(path)?, &path.display().to_string(), options, None)
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

    /// Takes the poses of scans from a trajectory, by the log's own clock (`ipc_time`, `time_s`); scans outside its time span are
    /// dropped and counted.
    ///
    /// # Errors
    /// [`LogError::Untimed`], for a table without times.
    pub fn along(mut self, trajectory: Trajectory, body: Body) -> Result<Self, LogError> {
        if !self.parser.as_ref().is_some_and(|parser| parser.timed()) {
            return Err(LogError::Untimed { place: self.place });
        }
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

    fn begin(
        source: impl Read + Send + 'a,
        place: &str,
        options: &Options,
        kind: Option<Kind>,
    ) -> Result<Self, LogError> {
        options.check()?;
        let text = source::text(source);
        let text = text.map_err(|source| LogError::Interrupted { place: place.to_owned(), line: 0, source })?;
        let mut log = Self {
            place: place.to_owned(),
            options: options.clone(),
            lines: Lines::new(text),
            kind,
            parser: None,
            report: Report::default(),
            sensor: Sensor::Stereo,
            ahead: None,
            choice: Choice::new(options, 0.0),
            first_damage: None,
            maximum_changed: false,
            failure: None,
            ended: false,
        };
        log.ahead = log.record();
        match &log.ahead {
            Some(first) => (log.sensor, log.choice) = (first.sensor, Choice::new(options, first.scan.time_s)),
            None => return Err(log.failure.take().unwrap_or_else(|| log.no_scan())),
        }
        Ok(log)
    }

    /// The next scan of the log whose ranges are believable.
    fn record(&mut self) -> Option<Recorded> {
        while !self.ended {
            let (number, outcome) = match self.lines.next() {
                Ok(Some((_, Line::Text(text)))) if text.trim_ascii().is_empty() => continue,
                Ok(Some((number, Line::Text(text)))) if memchr(0, text).is_some() => {
                    (number, Err("holds a byte of value 0, so that it is no text".to_owned()))
                }
                Ok(Some((number, Line::Text(text)))) => match &mut self.parser {
                    Some(parser) => (number, parser.line(text, number, &mut self.report)),
                    None => match parser(self.kind, text, &self.options) {
                        Ok((mut parser, head)) => {
                            let outcome = if head { Ok(None) } else { parser.line(text, number, &mut self.report) };
                            self.parser = Some(parser);
                            (number, outcome)
                        }
                        Err(reason) => {
                            return self.end(Some(LogError::Head { place: self.place.clone(), line: number, reason }));
                        }
                    },
                },
                Ok(Some((number, Line::TooLong))) => {
                    (number, Err(format!("is longer than {LONGEST_LINE} bytes, of which no line of a log is")))
                }
                Ok(None) => return self.end(None),
                Err(source) => {
                    let (place, line) = (self.place.clone(), self.lines.number());
                    return self.end(Some(LogError::Interrupted { place, line, source }));
                }
            };
            self.report.lines += 1;
            match outcome {
                Ok(None) => {}
                Ok(Some(recorded)) => {
                    if let Some(recorded) = self.believe(recorded) {
                        return Some(recorded);
                    }
                }
                Err(reason) => self.damage(number, reason),
            }
        }
        None
    }

    /// The scan that the end completes; the failure, if it is one, is said after it.
    fn end(&mut self, failure: Option<LogError>) -> Option<Recorded> {
        (self.ended, self.failure) = (true, failure);
        let last = self.parser.as_mut().and_then(|parser| parser.end());
        last.and_then(|last| self.believe(last))
    }

    fn believe(&mut self, recorded: Recorded) -> Option<Recorded> {
        match recorded.unit {
            Ok(()) => Some(recorded),
            Err(reason) => {
                self.damage(recorded.line, reason);
                None
            }
        }
    }

    fn damage(&mut self, line: u64, reason: String) {
        self.report.damaged += 1;
        self.first_damage.get_or_insert_with(|| Problem { line, reason: reason.clone() });
        self.report.note(line, reason, self.options.problems);
    }

    fn count(&mut self, recorded: &Recorded) {
        self.report.readings(&recorded.scan.readings, recorded.sensor != Sensor::Stereo);
        let maxima = [recorded.sensor, self.sensor].map(|sensor| match sensor {
            Sensor::Laser { max_range_m, .. } => max_range_m,
            Sensor::Stereo => f64::INFINITY,
        });
        if maxima[0].total_cmp(&maxima[1]).is_ne() && !std::mem::replace(&mut self.maximum_changed, true) {
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
        let Report { damaged, lines, .. } = self.report;
        let share = self.options.damaged_share;
        if damaged <= 1 || damaged as f64 <= share * lines as f64 {
            return None;
        }
        let Problem { line, reason } = self.first_damage.take()?;
        Some(LogError::Damaged { place: self.place.clone(), line, reason, damaged, lines, share })
    }

    fn no_scan(&self) -> LogError {
        let reason = match &self.first_damage {
            Some(problem) => format!("; line {}: {}", problem.line, problem.reason),
            None if self.report.lines == 0 => ": it is empty".to_owned(),
            None => {
                let names: Vec<_> = self.report.skipped.keys().take(5).cloned().collect();
                if names.is_empty() { String::new() } else { format!(", only {}", names.join(", ")) }
            }
        };
        LogError::NoScan { place: self.place.clone(), lines: self.report.lines, reason }
    }
}

impl Iterator for Log<'_> {
    type Item = Result<Scan, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let Some(recorded) = self.ahead.take().or_else(|| self.record()) else {
                return self.close().map(Err);
            };
            self.count(&recorded);
            if let Some(scan) = self.choice.take(recorded, &mut self.report) {
                return Some(Ok(scan));
            }
        }
    }
}

/// The parser for a text with this first line, and whether it needs that line no more.
fn parser(kind: Option<Kind>, line: &[u8], options: &Options) -> Result<(Box<dyn Parser>, bool), String> {
    match kind.unwrap_or(if table::is_head(line) { Kind::Table } else { Kind::Carmen }) {
        Kind::Table => Ok((Box::new(Table::new(line, options)?), true)),
        Kind::Carmen => Ok((Box::new(Carmen::new(options)), false)),
    }
}

pub(crate) fn file(path: &Path) -> Result<File, LogError> {
    let place = || path.display().to_string();
    let file = File::open(path).map_err(|source| LogError::Unreadable { place: place(), source })?;
    if file.metadata().is_ok_and(|metadata| metadata.is_dir()) {
        return Err(LogError::Folder { place: place() });
    }
    Ok(file)
}
