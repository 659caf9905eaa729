//! A program that is given all scans at once, in files.

use std::time::{Duration, Instant};

use grid::Raster;
use mapper::{Mapper, Model, Outside};
use sensor::Scan;

use super::exchange::Folder;
use super::fault::Fault;
use super::kept::last_words;
use super::process::Process;
use super::times;

/// Keeps the scans, and starts the program on all of them whenever a map is asked for.
pub(super) struct Batch {
    name: &'static str,
    words: &'static [String],
    longest: Duration,
    model: Model,
    scans: Vec<Scan>,
    occupancy: Raster<f64>,
    outside: Outside,
}

impl Batch {
    pub(super) fn new(name: &'static str, words: &'static [String], longest: Duration, model: &Model) -> Self {
        Self {
            name,
            words,
            longest,
            model: model.clone(),
            scans: Vec::new(),
            occupancy: Raster::filled(model.grid, model.prior.occupancy),
            outside: Outside::default(),
        }
    }

    fn map(&mut self) -> Result<Raster<f64>, Fault> {
        let grid = self.model.grid;
        let folder = Folder::make(&self.model, &self.scans)?;
        let start = Instant::now();
        let process = Process::start(self.words, folder.path())?;
        let ended = process.wait("map", self.longest, || folder.check_size(&grid));
        self.outside.seconds += start.elapsed().as_secs_f64();
        process.end();
        self.outside.stderr = process.stderr();
        ended?;
        folder.map(&grid, self.model.prior.occupancy)
    }
}

impl Mapper for Batch {
    fn integrate(&mut self, scan: &Scan) {
        self.scans.push(scan.clone());
    }

    fn settle(&mut self) {
        let (start, before) = (Instant::now(), self.outside.seconds);
        self.outside = Outside { seconds: before, ..Outside::default() };
        match self.map() {
            Ok(map) => self.occupancy = map,
            Err(fault) => {
                self.occupancy = Raster::filled(self.model.grid, self.model.prior.occupancy);
                self.outside.fault = Some(told(&fault, &self.outside.stderr));
            }
        }
        times::add(self.name, start, self.outside.seconds - before);
    }

    fn occupancy(&self) -> &Raster<f64> {
        &self.occupancy
    }

    fn outside(&self) -> Option<&Outside> {
        Some(&self.outside)
    }
}

/// A fault with the last words of the program.
pub(super) fn told(fault: &Fault, stderr: &str) -> String {
    match last_words(stderr) {
        Some(words) => format!("{fault}; its last words: {words}"),
        None => fault.to_string(),
    }
}
