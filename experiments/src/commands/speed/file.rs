//! Scans from a log.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use logs::{Log, LogError, Options, Sensor};
use sensor::{Laser, Scan, Stereo};

use super::scans::{Carrier, Kernel, ScanSet};
use crate::failure::Failure;
use crate::worlds::kernels::{self, SonarOptions};
use crate::worlds::usual_range::Ranges;

/// More rays are taken for a mistake: these need 2 GB.
const MOST_RAYS: usize = 50_000_000;

/// Reads a log, or a table of scans, for the given kernel; of a log of several kinds of sensors, or of sonars, each for what it is. 32 bytes are
/// kept of each ray, and as many more while it is read. The map covers what was read up to the reach (m): where none is given every range, or,
/// where there are disparities, which can say any range, that of 99 in 100 readings.
///
/// # Errors
/// A file that cannot be read; the first line of it that is damaged; disparities for a laser.
pub fn load(path: &Path, kernel: Kernel, reach_m: Option<f64>) -> Result<ScanSet, Failure> {
    // A camera sees as far as its disparities reach, and ends of ranges beyond are on the map.
    let max_range_m = (kernel == Kernel::Stereo).then_some(f64::INFINITY);
    let mut read = Read::of(path, max_range_m)?;
    let is_one_kind = read.kinds().len() == 1;
    match read.sensors.values().next() {
        Some(Sensor::Stereo) if is_one_kind && kernel == Kernel::Laser => {
            let what = "holds disparities, which no laser reads; leave out --sensor laser";
            return Err(Failure::BadInput(format!("{}: {what}", path.display())));
        }
        Some(_) if !is_one_kind && max_range_m.is_some() => read = Read::of(path, None)?,
        _ => {}
    }
    let by_ranges = is_one_kind && kernel == Kernel::Stereo;
    let carrier = |(number, sensor): (&usize, &Sensor)| {
        let called = format!("{number} {}", kernels::kind(*sensor));
        match *sensor {
            Sensor::Laser { .. } if by_ranges => Carrier::by_ranges(&called),
            Sensor::Laser { max_range_m, .. } => {
                Carrier::new(&called, Arc::new(Laser { max_range_m, ..Laser::default() }))
            }
            Sensor::Stereo => Carrier::camera(&called, Stereo::default()),
            Sensor::Sonar { max_range_m, width_rad } => {
                let sonar = SonarOptions::default().sonar(max_range_m, width_rad);
                Carrier::new(&called, Arc::new(sonar))
            }
        }
    };
    let carriers: Vec<Carrier> = read.sensors.iter().map(carrier).collect();
    let has_disparities = read.sensors.values().any(|sensor| matches!(sensor, Sensor::Stereo));
    let scans = read.scans();
    let reach_m =
        reach_m.unwrap_or_else(|| if has_disparities { usual_range(scans, &carriers) } else { f64::INFINITY });
    let mut set = ScanSet::of(carriers).within(reach_m);
    scans.iter().for_each(|scan| set.add(scan));
    Ok(set)
}

/// The range within which all but a few readings lie, m.
fn usual_range(scans: &[Scan], carriers: &[Carrier]) -> f64 {
    let mut ranges = Ranges::default();
    for scan in scans {
        for (&bearing_rad, &given) in scan.bearings_rad.iter().zip(&scan.readings) {
            if let (_, Some(range_m)) = carriers[scan.sensor].read(bearing_rad, given) {
                ranges.add(range_m);
            }
        }
    }
    ranges.usual_m()
}

/// What a log holds.
struct Read {
    /// What took the first scan of every sensor, by its number.
    sensors: BTreeMap<usize, Sensor>,
    scans: Vec<Scan>,
}

impl Read {
    fn of(path: &Path, max_range_m: Option<f64>) -> Result<Self, Failure> {
        let refuse = |what: &str| Failure::BadInput(format!("{}{what}", path.display()));
        let refused = |error: LogError| Failure::BadInput(error.to_string());
        let options = Options { max_range_m, problems: 1, ..Options::default() };
        let mut log = Log::open(path, &options).map_err(refused)?;
        let mut read = Self { sensors: BTreeMap::new(), scans: Vec::new() };
        let mut rays = 0;
        while let Some(event) = log.next_event() {
            let event = event.map_err(refused)?;
            read.sensors.entry(event.sensor).or_insert(event.kind);
            rays += event.scan.readings.len();
            read.scans.push(event.scan);
            if rays > MOST_RAYS {
                return Err(refuse(&format!(": must be at most {MOST_RAYS} rays; split the file")));
            }
        }
        let report = log.report();
        match report.problems.first().filter(|_| report.damaged > 0) {
            Some(problem) => Err(refuse(&format!(":{}: {}", problem.line, problem.reason))),
            None => Ok(read),
        }
    }

    fn kinds(&self) -> BTreeSet<&'static str> {
        self.sensors.values().map(|sensor| kernels::kind(*sensor)).collect()
    }

    /// The scans with their sensors counted from 0. Those of one sensor are a second apart in the order of the log, whatever its times; of
    /// several, those of one time stand by rising numbers.
    fn scans(&mut self) -> &[Scan] {
        let is_one = self.sensors.len() == 1;
        let places: BTreeMap<usize, usize> = self.sensors.keys().copied().zip(0..).collect();
        for (number, scan) in self.scans.iter_mut().enumerate() {
            scan.sensor = places[&scan.sensor];
            if is_one {
                scan.time_s = number as f64;
            }
        }
        let at_once = |a: &Scan, b: &Scan| a.time_s.total_cmp(&b.time_s).is_eq();
        self.scans.chunk_by_mut(at_once).for_each(|scans| scans.sort_by_key(|scan| scan.sensor));
        &self.scans
    }
}
