//! Progress on stderr: a bar in a terminal; elsewhere a line, where the work will take longer than a minute.

use std::fmt::Write;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::output::loudness::{self, Loudness};
use crate::output::{note, screen};

/// So long the pace is watched before it is told what is left.
const WATCHED: Duration = Duration::from_secs(5);

/// So long after its beginning a bar says what is left.
const PACED: Duration = Duration::from_secs(2);

/// No line below a bar is wider, in columns.
const WIDEST: usize = 80;

/// What takes no longer is not told.
const SHORT: Duration = Duration::from_secs(60);

/// Progress of several mappers over their scans.
pub struct Progress {
    bar: Bar,
    losses: Mutex<Vec<(String, Option<f64>)>>,
}

impl Progress {
    /// A bar over `scans` updates in all, of the mappers with the given names.
    pub fn new(scans: usize, mappers: &[&str]) -> Self {
        let bar = Bar::new(scans as u64, "{bar:32} {pos}/{len} scans mapped{left}\n{msg}");
        Self { bar, losses: Mutex::new(mappers.iter().map(|name| ((*name).to_owned(), None)).collect()) }
    }

    /// One more scan is in the map of `mapper`, which now has this log loss (nats per cell).
    pub fn step(&self, mapper: usize, log_loss: Option<f64>) {
        self.bar.inc(1);
        if self.bar.shown.is_hidden() {
            return;
        }
        let Ok(mut losses) = self.losses.lock() else { return };
        losses[mapper].1 = log_loss;
        let shown = losses.iter().map(|(name, loss)| match loss {
            Some(loss) => format!("{name} {loss:.3}"),
            None => format!("{name} -"),
        });
        self.bar.say(&format!("log loss: {}", shown.collect::<Vec<_>>().join(", ")));
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.shown.finish_and_clear();
    }
}

/// Progress over things of one kind.
pub struct Count {
    bar: Bar,
}

impl Count {
    /// A bar over so many worlds, with what is left.
    pub fn worlds(worlds: usize) -> Self {
        Self { bar: Bar::new(worlds as u64, "{bar:32} {pos}/{len} worlds mapped and scored, {elapsed}{left}\n{msg}") }
    }

    /// A bar over so many measurements, of which some take long.
    pub fn measurements(measurements: usize) -> Self {
        Self { bar: Bar::new(measurements as u64, "{bar:32} {pos}/{len} measurements taken, {elapsed}") }
    }

    /// A count of settings, of which nobody knows how many there will be.
    pub fn settings() -> Self {
        Self { bar: Bar::new(0, "{spinner} {pos} settings tried, {elapsed}") }
    }

    /// A bar over the scans of a log, with their rate.
    pub fn scans(scans: u64) -> Self {
        Self { bar: Bar::new(scans, "{bar:32} {pos}/{len} scans mapped, {per_sec:.0}{left}") }
    }

    /// One more is finished.
    pub fn step(&self) {
        self.bar.inc(1);
    }

    /// Whether anybody sees it.
    pub fn is_seen(&self) -> bool {
        !self.bar.shown.is_hidden()
    }

    /// What is known so far, below the bar.
    pub fn say(&self, text: &str) {
        self.bar.say(text);
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.shown.finish_and_clear();
    }
}

/// Progress through steps of which each counts its own parts. Silent where stderr is not a terminal.
pub struct Steps {
    bar: ProgressBar,
}

impl Steps {
    /// A bar before its first step.
    pub fn new() -> Self {
        Self { bar: bar(1, "{bar:32} {msg}, {elapsed}") }
    }

    /// So much of a step is done.
    pub fn show(&self, step: &'static str, done: usize, of: usize) {
        self.bar.set_length(of as u64);
        self.bar.set_position(done as u64);
        self.bar.set_message(step);
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Default for Steps {
    fn default() -> Self {
        Self::new()
    }
}

/// What is being done, where it has no parts to count. Silent where stderr is not a terminal; taken away at its end.
pub struct Doing {
    bar: ProgressBar,
}

impl Doing {
    /// The first thing to do.
    pub fn new(what: &'static str) -> Self {
        let bar = ProgressBar::with_draw_target(None, target());
        let style = ProgressStyle::with_template("{spinner} {msg}, {elapsed}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        bar.enable_steady_tick(Duration::from_millis(200));
        bar.set_message(what);
        Self { bar }
    }

    /// The next thing to do.
    pub fn next(&self, what: &'static str) {
        self.bar.set_message(what);
    }
}

impl Drop for Doing {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Progress over the jobs of a sweep, with their rate and what is left.
pub struct Jobs {
    bar: Bar,
}

impl Jobs {
    /// A bar over so many jobs.
    pub fn new(jobs: u64) -> Self {
        Self { bar: Bar::new(jobs, "{bar:28} {pos}/{len} jobs, {per_sec:.1}{left}\n{msg}") }
    }

    /// So many more are finished; of all so far, so many rows have an error; `last` is a number of the last job.
    pub fn step(&self, jobs: u64, failed: u64, last: Option<&str>) {
        self.bar.inc(jobs);
        let failed = (failed > 0).then(|| format!("{failed} failed"));
        let told: Vec<&str> = failed.as_deref().into_iter().chain(last).collect();
        if !told.is_empty() {
            self.bar.say(&told.join("; "));
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.shown.finish_and_clear();
    }
}

/// A bar of known length; where nobody sees it, what is left is told once, as soon as the pace is known.
struct Bar {
    shown: ProgressBar,
    start: Instant,
    told: AtomicBool,
}

impl Bar {
    fn new(length: u64, template: &str) -> Self {
        Self { shown: bar(length, template), start: Instant::now(), told: AtomicBool::new(false) }
    }

    /// Says something below the bar, in lines that end between words.
    fn say(&self, text: &str) {
        let width = screen::width_of_notes().map_or(WIDEST, |width| width.min(WIDEST));
        self.shown.set_message(screen::wrapped(text, width - 1).join("\n"));
    }

    fn inc(&self, by: u64) {
        self.shown.inc(by);
        let elapsed = self.start.elapsed();
        if !self.shown.is_hidden() || elapsed < WATCHED || self.told.swap(true, Ordering::Relaxed) {
            return;
        }
        let (done, of) = (self.shown.position(), self.shown.length().unwrap_or(0));
        if let Some(line) = left(elapsed, done, of) {
            note(line);
        }
    }
}

/// What is left after `done` of so many took `elapsed`, where that is more than a minute.
fn left(elapsed: Duration, done: u64, of: u64) -> Option<String> {
    let left = elapsed.checked_mul(u32::try_from(of.saturating_sub(done)).ok()?)? / u32::try_from(done.max(1)).ok()?;
    let minutes = left.as_secs_f64() / 60.0;
    let long = if minutes < 90.0 { format!("{minutes:.0} minutes") } else { format!("{:.0} hours", minutes / 60.0) };
    (left > SHORT).then(|| format!("about {long} are left: {done} of {of} are done"))
}

/// Where bars are drawn: nowhere with `--quiet`.
fn target() -> ProgressDrawTarget {
    if loudness::says(Loudness::Usual) { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() }
}

fn bar(length: u64, template: &str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(length), target());
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    // Before the pace is known, nobody knows what is left.
    let left = |state: &ProgressState, out: &mut dyn Write| {
        if state.pos() > 0 && state.elapsed() > PACED {
            let _ = write!(out, ", {} left", HumanDuration(state.eta()));
        }
    };
    bar.set_style(style.with_key("left", left));
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_is_told_above_a_minute() {
        let elapsed = Duration::from_secs(6);
        assert_eq!(left(elapsed, 10, 100), None);
        assert_eq!(left(elapsed, 10, 1210).as_deref(), Some("about 12 minutes are left: 10 of 1210 are done"));
        assert_eq!(left(elapsed, 1, 1201).as_deref(), Some("about 2 hours are left: 1 of 1201 are done"));
        assert_eq!((left(elapsed, 0, 5), left(elapsed, 5, 0)), (None, None));
    }
}
