//! The scans of a log, mapped by several rules.

use std::time::{Duration, Instant};

use grid::Raster;
use logs::Sensor;
use mapper::Model;
use mapper::catalogue::Entry;
use mapper::{Mapper, PairwiseGrid, moments};
use rayon::prelude::*;
use sensor::Scan;

use super::extent::Survey;
use super::kept_back::{BATCH, KeptBack};
use super::recording::{self, Recording};

use crate::failure::Failure;
use crate::jobs::progress::Count;
use crate::output::note;
use crate::worlds::faults;
use crate::worlds::seen::{Reach, Seen};

/// What mappers made of the scans that were not kept back.
pub(super) struct Maps {
    pub(super) maps: Vec<Map>,
    /// Mappers that gave no map, and why: programs, and those whose draws do not agree.
    pub(super) faults: Vec<(&'static str, String)>,
    /// Cells that a beam crossed or ended in.
    pub(super) seen: Raster<bool>,
}

/// The map of one mapper.
pub(super) struct Map {
    pub(super) mapper: &'static str,
    pub(super) occupancy: Raster<f64>,
    /// Its joint probabilities, if it holds any.
    pub(super) pairs: Option<PairwiseGrid>,
}

/// Who maps when.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Turns {
    /// All mappers at once, while scans are read.
    Together,
    /// One mapper after the other, each on all threads, and how long each took is told.
    Timed,
}

/// A mapper, and how long it has mapped so far.
struct AtWork {
    mapper: Box<dyn Mapper>,
    took: Duration,
}

impl AtWork {
    fn integrate(&mut self, scans: &[Scan]) {
        self.timed(|mapper| moments(scans).for_each(|scans| mapper.integrate_together(scans)));
    }

    fn settle(&mut self) {
        self.timed(|mapper| mapper.settle());
    }

    fn timed(&mut self, work: impl FnOnce(&mut dyn Mapper)) {
        let start = Instant::now();
        work(&mut *self.mapper);
        self.took += start.elapsed();
    }
}

/// Maps the scans that are not kept back.
pub(super) fn map(
    recording: &Recording,
    survey: &Survey,
    hold_out: u64,
    entries: &[&'static Entry],
    setup: &Model,
    turns: Turns,
) -> Result<Maps, Failure> {
    let progress = Count::scans(survey.kept);
    let mut mappers: Vec<AtWork> =
        entries.iter().map(|entry| AtWork { mapper: entry.mapper(setup), took: Duration::ZERO }).collect();
    let mut mapped = 0;
    let reach = |scan: &Scan| match survey.kind(scan) {
        Sensor::Laser { .. } | Sensor::Sonar { .. } => Reach::Reading,
        Sensor::Stereo => Reach::Median,
    };
    let mut seen = Seen::new(setup.grid);
    let mut batch = Vec::with_capacity(BATCH);
    let mut take = |batch: &mut Vec<Scan>, mappers: &mut [AtWork]| {
        mapped += batch.len();
        let mut see = || batch.iter().for_each(|scan| seen.add(scan, &**setup.sensors.of(scan), reach(scan)));
        match turns {
            Turns::Together => {
                rayon::join(|| mappers.par_iter_mut().for_each(|mapper| mapper.integrate(batch)), see);
            }
            Turns::Timed => {
                mappers.iter_mut().for_each(|mapper| mapper.integrate(batch));
                see();
            }
        }
        batch.clear();
    };
    let mut kept_back = KeptBack::new(hold_out);
    for scan in recording.scans()? {
        let scan = scan.map_err(recording::refused)?;
        progress.step();
        if kept_back.has(&scan) {
            continue;
        }
        // What several sensors read at one time stays together.
        if batch.len() >= BATCH && batch.last().is_some_and(|last: &Scan| !last.is_with(&scan)) {
            take(&mut batch, &mut mappers);
        }
        batch.push(scan);
    }
    take(&mut batch, &mut mappers);
    match turns {
        Turns::Together => mappers.par_iter_mut().for_each(AtWork::settle),
        Turns::Timed => mappers.iter_mut().for_each(AtWork::settle),
    }
    progress.finish();
    let (mut maps, mut faults) = (Vec::new(), Vec::new());
    for (entry, AtWork { mapper, took }) in entries.iter().zip(&mappers) {
        match mapper.fault() {
            Some(fault) => faults.push((entry.name, fault)),
            None => {
                maps.push(Map { mapper: entry.name, occupancy: mapper.occupancy().clone(), pairs: mapper.pairwise() })
            }
        }
        if let Some(mixing) = mapper.mixing() {
            note(format_args!("{}: {mixing}", entry.name));
        }
        if let Some(outside) = mapper.outside() {
            note(format_args!("{}: {:.2} s in its process", entry.name, outside.seconds));
        }
        if turns == Turns::Timed {
            note(pace(entry.name, mapped, *took));
        }
    }
    if maps.is_empty() {
        faults::none(&lines(&faults))?;
    }
    Ok(Maps { maps, faults, seen: seen.cells })
}

/// What is told of the time that a mapper took.
fn pace(mapper: &str, scans: usize, took: Duration) -> String {
    let seconds = took.as_secs_f64();
    format!("{mapper}: {scans} scans mapped in {seconds:.3} s, {:.0} scans/s", scans as f64 / seconds)
}

/// Faults as lines.
pub(super) fn lines(faults: &[(&'static str, String)]) -> Vec<String> {
    faults.iter().map(|(mapper, fault)| format!("{mapper}: {fault}")).collect()
}
