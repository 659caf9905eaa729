//! A progress bar on stderr that shows how the maps are doing.

use std::sync::Mutex;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Progress of several mappers over their scans. Silent where stderr is not a terminal.
pub struct Progress {
    bar: ProgressBar,
    losses: Mutex<Vec<(String, Option<f64>)>>,
}

impl Progress {
    /// A bar over `scans` updates in all, of the mappers with the given names.
    pub fn new(scans: usize, mappers: &[&str]) -> Self {
        let bar = bar(scans as u64, "{bar:32} {pos}/{len} scans, {eta} left\n{wide_msg}");
        Self { bar, losses: Mutex::new(mappers.iter().map(|name| ((*name).to_owned(), None)).collect()) }
    }

    /// One more scan is in the map of `mapper`, which now has this log loss (nats per cell).
    pub fn step(&self, mapper: usize, log_loss: Option<f64>) {
        self.bar.inc(1);
        if self.bar.is_hidden() {
            return;
        }
        let Ok(mut losses) = self.losses.lock() else { return };
        losses[mapper].1 = log_loss;
        let shown = losses.iter().map(|(name, loss)| match loss {
            Some(loss) => format!("{name} {loss:.3}"),
            None => format!("{name} -"),
        });
        self.bar.set_message(format!("log loss: {}", shown.collect::<Vec<_>>().join(", ")));
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// Progress over things of one kind. Silent where stderr is not a terminal.
pub struct Count {
    bar: ProgressBar,
}

impl Count {
    /// A bar over so many worlds, with what is left.
    pub fn worlds(worlds: usize) -> Self {
        Self { bar: bar(worlds as u64, "{bar:32} {pos}/{len} worlds, {elapsed}, {eta} left") }
    }

    /// A bar over so many measurements, of which some take long.
    pub fn measurements(measurements: usize) -> Self {
        Self { bar: bar(measurements as u64, "{bar:32} {pos}/{len} measurements, {elapsed}") }
    }

    /// A count of settings, of which nobody knows how many there will be.
    pub fn settings() -> Self {
        Self { bar: bar(0, "{spinner} {pos} settings tried, {elapsed}") }
    }

    /// A bar over the scans of a log, with their rate.
    pub fn scans(scans: u64) -> Self {
        Self { bar: bar(scans, "{bar:32} {pos}/{len} scans, {per_sec:.0}, {eta} left") }
    }

    /// One more is finished.
    pub fn step(&self) {
        self.bar.inc(1);
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
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
        let bar = ProgressBar::new_spinner();
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

/// Progress over the jobs of a sweep, with their rate and what is left. Silent where stderr is not a terminal.
pub struct Jobs {
    bar: ProgressBar,
}

impl Jobs {
    /// A bar over so many jobs.
    pub fn new(jobs: u64) -> Self {
        Self { bar: bar(jobs, "{bar:28} {pos}/{len} jobs, {per_sec:.1}, {eta} left{msg}") }
    }

    /// So many more are finished; of all so far, so many rows have an error.
    pub fn step(&self, jobs: u64, failed: u64) {
        self.bar.inc(jobs);
        if failed > 0 {
            self.bar.set_message(format!(", {failed} failed"));
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

fn bar(length: u64, template: &str) -> ProgressBar {
    let bar = ProgressBar::new(length);
    bar.set_style(ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}
