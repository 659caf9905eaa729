//! The first reading of a log: what is in it, and where.

use std::collections::BTreeMap;

use grid::GridSpec;
use logs::{Event, Report, Sensor};
use mapper::Sensors;
use sensor::{Scan, SensorModel};

use super::recording::{self, Recording};
use crate::failure::Failure;
use crate::worlds::kernels::{self, Shared};
use crate::worlds::usual_range::Ranges;

/// More cells than this are not a building but a mistake in the poses: some 20 GB with all mappers.
const MOST_CELLS: usize = 100_000_000;

/// Places on the path that are kept for the picture, at most.
const MOST_PLACES: usize = 4096;

/// What lies around the outermost readings, m.
const MARGIN_M: f64 = 0.5;

/// What a log holds.
pub(super) struct Survey {
    /// Where it is.
    place: String,
    /// What took it.
    pub(super) sensor: Sensor,
    /// Every sensor by its number, and how mappers know it.
    pub(super) sensors: BTreeMap<usize, Known>,
    /// The sensors that are judged as one, by the number of the first: sonars of one kind of message; every other by itself.
    pub(super) arrays: BTreeMap<usize, Vec<usize>>,
    /// Scans in use.
    pub(super) kept: u64,
    /// Counts of everything.
    pub(super) report: Report,
    /// Where the sensor went, thinned.
    pub(super) path: Vec<[f64; 2]>,
    /// How far, m.
    pub(super) length_m: f64,
    /// Range up to which readings count for the extent, m.
    pub(super) reach_m: f64,
    low: [f64; 2],
    high: [f64; 2],
}

/// A sensor of a log.
#[derive(Clone)]
pub(super) struct Known {
    pub(super) kind: Sensor,
    pub(super) model: Shared,
}

impl Known {
    /// Makes the model of every sensor once, by its first scan.
    fn by_number(model: &dyn Fn(&Event) -> Result<Shared, Failure>) -> impl FnMut(&Event) -> Result<Self, Failure> {
        let mut known: BTreeMap<usize, Self> = BTreeMap::new();
        move |event| {
            if let Some(known) = known.get(&event.sensor) {
                return Ok(known.clone());
            }
            let new = Self { kind: event.kind, model: model(event)? };
            Ok(known.entry(event.sensor).or_insert(new).clone())
        }
    }
}

impl Survey {
    /// The sensors as mappers take them.
    pub(super) fn models(&self) -> Sensors {
        kernels::sensors(&self.sensors.iter().map(|(number, known)| (*number, known.model.clone())).collect())
    }

    /// What took a scan.
    pub(super) fn kind(&self, scan: &Scan) -> Sensor {
        self.sensors.get(&scan.sensor).map_or(self.sensor, |known| known.kind)
    }

    /// Reads the log twice: ranges first, unless the reach (m) is given, then places.
    pub(super) fn of(
        recording: &Recording,
        reach: Option<f64>,
        model: &dyn Fn(&Event) -> Result<Shared, Failure>,
    ) -> Result<Self, Failure> {
        let mut sensors = Known::by_number(model);
        let reach_m = match reach {
            Some(reach) => reach,
            None => usual_range(recording, &mut sensors)?,
        };
        let mut log = recording.scans()?;
        let mut survey = Self {
            place: recording.place(),
            sensor: log.sensor(),
            sensors: BTreeMap::new(),
            arrays: BTreeMap::new(),
            kept: 0,
            report: Report::default(),
            path: Vec::new(),
            length_m: 0.0,
            reach_m,
            low: [f64::INFINITY; 2],
            high: [f64::NEG_INFINITY; 2],
        };
        let (mut every, mut before) = (1, None::<[f64; 2]>);
        while let Some(event) = log.next_event() {
            let event = event.map_err(recording::refused)?;
            let (scan, sensor) = (&event.scan, sensors(&event)?);
            let at = scan.pose.position_m();
            survey.length_m += before.map_or(0.0, |before| libm::hypot(at[0] - before[0], at[1] - before[1]));
            before = Some(at);
            survey.include(at);
            survey.ends(scan, &*sensor.model);
            survey.sensors.entry(event.sensor).or_insert(sensor);
            if survey.kept.is_multiple_of(every) {
                survey.path.push(at);
            }
            if survey.path.len() > MOST_PLACES {
                every *= 2;
                let mut odd = false;
                survey.path.retain(|_| {
                    odd = !odd;
                    odd
                });
            }
            survey.kept += 1;
        }
        survey.report = log.report().clone();
        for number in survey.sensors.keys() {
            survey.arrays.entry(survey.report.array_of(*number)).or_default().push(*number);
        }
        // The first of an array may have no scan in use.
        survey.arrays = survey.arrays.into_values().map(|numbers| (numbers[0], numbers)).collect();
        Ok(survey)
    }

    /// From the first to the last scan in use, s.
    pub(super) fn duration_s(&self) -> f64 {
        self.report.span_s.map_or(0.0, |[first, last]| last - first)
    }

    /// The cells of a map of it.
    ///
    /// # Errors
    /// No place at all, or far too many cells.
    pub(super) fn grid(&self, cell_m: f64) -> Result<GridSpec, Failure> {
        let refuse = |what: String| Failure::BadInput(format!("{}: {what}", self.place));
        let corner = |at: f64, by: f64| ((at + by) / cell_m).floor() * cell_m;
        let low = self.low.map(|at| corner(at, -MARGIN_M));
        let high = self.high.map(|at| corner(at, MARGIN_M + cell_m));
        let size = |high: f64, low: f64| format!("{:.0} m", high - low);
        let extent = || format!("{} x {}", size(high[0], low[0]), size(high[1], low[1]));
        let grid = GridSpec::covering(low, high, cell_m)
            .map_err(|error| refuse(format!("{}: {error}{}", extent(), self.longest())))?;
        if grid.cells() > MOST_CELLS {
            return Err(refuse(format!(
                "the map of {} has {} cells of {cell_m} m, more than {MOST_CELLS}; use larger cells (--grid), a shorter --reach, or \
                 a part of the log (--window); or the poses are not in m{}",
                extent(),
                grid.cells(),
                self.longest(),
            )));
        }
        Ok(grid)
    }

    /// The longest move, which may be what makes the map large.
    fn longest(&self) -> String {
        self.report.motion.longest.map_or_else(String::new, |step| {
            format!("; the longest move between two scans is {:.1} m, to line {}", step.move_m, step.line)
        })
    }

    fn include(&mut self, at: [f64; 2]) {
        self.low = [0, 1].map(|k| self.low[k].min(at[k]));
        self.high = [0, 1].map(|k| self.high[k].max(at[k]));
    }

    fn ends(&mut self, scan: &Scan, sensor: &dyn SensorModel) {
        for ray in scan.rays() {
            let range = ray.reading.and_then(|reading| sensor.range_of(reading, ray.bearing_rad));
            if let Some(range_m) = range.filter(|range| *range <= self.reach_m) {
                self.include([0, 1].map(|k| ray.origin_m[k] + range_m * ray.direction[k]));
            }
        }
    }
}

/// The range within which all but a few readings lie, m.
fn usual_range(
    recording: &Recording,
    sensors: &mut impl FnMut(&Event) -> Result<Known, Failure>,
) -> Result<f64, Failure> {
    let mut ranges = Ranges::default();
    let mut log = recording.scans()?;
    while let Some(event) = log.next_event() {
        let event = event.map_err(recording::refused)?;
        let sensor = sensors(&event)?;
        for ray in event.scan.rays() {
            if let Some(range_m) = ray.reading.and_then(|reading| sensor.model.range_of(reading, ray.bearing_rad)) {
                ranges.add(range_m);
            }
        }
    }
    Ok(ranges.usual_m())
}
