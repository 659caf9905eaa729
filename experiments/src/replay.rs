//! `replay`: what a robot recorded, mapped by several rules, and how well each map predicts scans that it has not seen.

mod extent;
mod options;
mod outputs;
mod predictions;
mod recording;

pub use options::ReplayOptions;

use std::io::{self, Write as _};
use std::sync::Arc;
use std::time::Instant;

use grid::{DigitalLine, GridSpec, Raster};
use mapper::catalogue::Entry;
use mapper::{Mapper, Model, PairwiseGrid};
use rayon::prelude::*;
use sensor::{Scan, SensorModel};

use self::extent::Survey;
use self::predictions::Predictions;
use self::recording::Recording;
use crate::cli::Format;
use crate::failure::Failure;
use crate::mappers::entries;
use crate::progress::Count;
use crate::staging::Staging;
use crate::{interruption, table, threads};

/// Scans that are read before the mappers take them, each on a thread.
const BATCH: usize = 64;

/// More cells than this are not a building but a mistake in the poses: some 20 GB with all mappers.
const MOST_CELLS: usize = 100_000_000;

/// Maps a log and scores the maps by the scans that were kept back.
///
/// # Errors
/// Bad input before any work, a log that is refused, I/O.
pub fn run(options: &ReplayOptions) -> Result<(), Failure> {
    let start = Instant::now();
    interruption::watch();
    let entries = entries(&options.mappers)?;
    let recording = Recording::of(options)?;
    threads::limit(options.threads)?;
    let sensor = options.sensor(recording.scans()?.sensor())?;
    let survey = Survey::of(&recording, options.reach, &*sensor)?;
    if survey.kept == 0 {
        return Err(Failure::BadInput(format!(
            "{}: none of its {} scans is in use: {} lie outside --window, {} outside --trajectory; give another one",
            recording.place(),
            survey.report.scans,
            survey.report.outside_window,
            survey.report.outside_trajectory
        )));
    }
    if survey.kept <= options.hold_out {
        return Err(Failure::BadInput(format!(
            "--hold-out {}: keeps every so-many-th scan back, and the log has {}; lower it, or give a longer log",
            options.hold_out, survey.kept
        )));
    }
    let grid = survey.grid(options.grid)?;
    let setup = Model {
        prior: options.belief.prior(),
        reconciliation: options.belief.reconciliation(),
        ..Model::new(grid, sensor)
    };
    let mut staging = Staging::open(&options.out())?;

    let mapping = Instant::now();
    let maps = mapped(&recording, &survey, options.hold_out, &entries, &setup)?;
    let seconds = mapping.elapsed().as_secs_f64();
    let predictions = Predictions::of(&recording, options.hold_out, &maps, &setup)?;
    let told = outputs::Told { options, survey: &survey, setup: &setup, maps: &maps, predictions: &predictions };
    outputs::write(&mut staging, &told)?;
    staging.publish()?;

    match options.format {
        Format::Text => {
            table::print(&outputs::text(&told))?;
            let place = options.out().join("report.html");
            let mapped = survey.kept - survey.kept / options.hold_out;
            let _ = writeln!(
                io::stderr(),
                "{} in {:.1} s; {:.0} scans/s by {} mappers at once{}",
                place.display(),
                start.elapsed().as_secs_f64(),
                mapped as f64 / seconds,
                entries.len(),
                pace(&survey, start.elapsed().as_secs_f64())
            );
            Ok(())
        }
        Format::Csv => predictions.table().print(false),
        Format::Json => predictions.table().print(true),
    }
}

/// How much faster than it was recorded.
fn pace(survey: &Survey, seconds: f64) -> String {
    match survey.duration_s() {
        duration if duration > 0.0 => format!("; recorded in {duration:.0} s, {:.0} times as long", duration / seconds),
        _ => String::new(),
    }
}

/// What mappers made of the scans that were not kept back.
pub(crate) struct Maps {
    pub(crate) maps: Vec<Map>,
    /// Cells that a beam crossed or ended in.
    pub(crate) seen: Raster<bool>,
}

/// The map of one mapper.
pub(crate) struct Map {
    pub(crate) mapper: &'static str,
    pub(crate) occupancy: Raster<f64>,
    /// Its joint probabilities, if it holds any.
    pub(crate) pairs: Option<PairwiseGrid>,
}

/// Whether a scan is kept back: the last of every so many.
fn is_kept_back(number: u64, hold_out: u64) -> bool {
    (number + 1).is_multiple_of(hold_out)
}

fn mapped(
    recording: &Recording,
    survey: &Survey,
    hold_out: u64,
    entries: &[&'static Entry],
    setup: &Model,
) -> Result<Maps, Failure> {
    let progress = Count::scans(survey.kept);
    let mut mappers: Vec<Box<dyn Mapper>> = entries.iter().map(|entry| (entry.build)(setup)).collect();
    let mut seen = Seen::new(setup.grid);
    let mut batch = Vec::with_capacity(BATCH);
    let mut take = |batch: &mut Vec<Scan>, mappers: &mut [Box<dyn Mapper>]| {
        rayon::join(
            || mappers.par_iter_mut().for_each(|mapper| batch.iter().for_each(|scan| mapper.integrate(scan))),
            || batch.iter().for_each(|scan| seen.add(scan, &**setup.sensors.of(scan))),
        );
        batch.clear();
    };
    for (number, scan) in (0..).zip(recording.scans()?) {
        let scan = scan.map_err(recording::refused)?;
        progress.step();
        if !is_kept_back(number, hold_out) {
            batch.push(scan);
            if batch.len() == BATCH {
                take(&mut batch, &mut mappers);
            }
        }
    }
    take(&mut batch, &mut mappers);
    mappers.par_iter_mut().for_each(|mapper| mapper.settle());
    progress.finish();
    let maps = entries.iter().zip(&mappers).map(|(entry, mapper)| Map {
        mapper: entry.name,
        occupancy: mapper.occupancy().clone(),
        pairs: mapper.pairwise(),
    });
    Ok(Maps { maps: maps.collect(), seen: seen.cells })
}

/// Which cells beams were in.
struct Seen {
    cells: Raster<bool>,
    line: DigitalLine,
}

impl Seen {
    fn new(grid: GridSpec) -> Self {
        Self { cells: Raster::filled(grid, false), line: DigitalLine::default() }
    }

    fn add(&mut self, scan: &Scan, sensor: &dyn SensorModel) {
        for ray in scan.rays() {
            let Some(range_m) = ray.reading.and_then(|reading| sensor.range_of(reading, ray.bearing_rad)) else {
                continue;
            };
            self.line.trace(self.cells.spec(), ray.origin_m, ray.direction, range_m);
            self.line.cells().iter().for_each(|cell| self.cells[*cell] = true);
        }
    }
}

/// A sensor that mappers share.
type Shared = Arc<dyn SensorModel>;
