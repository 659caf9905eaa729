//! Scans from a log.

use std::path::Path;

use logs::{Log, LogError, Options, Sensor};

use super::scans::{Kernel, ScanSet};
use crate::failure::Failure;
use crate::worlds::kernels;

/// More rays are taken for a mistake: these need 2 GB.
const MOST_RAYS: usize = 50_000_000;

/// Reads a log, or a table of scans, for the given kernel. 32 bytes are kept of each ray.
///
/// # Errors
/// A file that cannot be read; the first line of it that is damaged; disparities for a laser.
pub fn load(path: &Path, kernel: Kernel) -> Result<ScanSet, Failure> {
    let refuse = |what: &str| Failure::BadInput(format!("{}{what}", path.display()));
    // A camera sees as far as its disparities reach, and ends of ranges beyond are on the map.
    let max_range_m = (kernel == Kernel::Stereo).then_some(f64::INFINITY);
    let options = Options { max_range_m, sonars: false, problems: 1, ..Options::default() };
    let mut log = Log::open(path, &options).map_err(refused)?;
    let mut set = match (kernel, log.sensor()) {
        (Kernel::Laser, Sensor::Stereo | Sensor::Sonar { .. }) => {
            return Err(refuse(": holds disparities, which no laser reads; leave out --sensor laser"));
        }
        (Kernel::Laser, Sensor::Laser { max_range_m, .. }) => ScanSet::of_laser(max_range_m),
        (Kernel::Stereo, _) => ScanSet::default(),
    };
    let disparities = log.sensor() == Sensor::Stereo;
    for scan in &mut log {
        let scan = scan.map_err(refused)?;
        set.begin(scan.pose);
        for (&bearing, &reading) in scan.bearings_rad.iter().zip(&scan.readings) {
            if disparities { set.disparity(bearing, reading) } else { set.ray(bearing, reading) }
        }
        if set.rays() > MOST_RAYS {
            return Err(refuse(&format!(": must be at most {MOST_RAYS} rays; split the file")));
        }
    }
    let report = log.report();
    kernels::one_kind(&path.display().to_string(), report, "`speed`")?;
    match report.problems.first().filter(|_| report.damaged > 0) {
        Some(problem) => Err(refuse(&format!(":{}: {}", problem.line, problem.reason))),
        None => Ok(set),
    }
}

/// A log is input: what is wrong with it, the user can correct.
fn refused(error: LogError) -> Failure {
    Failure::BadInput(error.to_string())
}
