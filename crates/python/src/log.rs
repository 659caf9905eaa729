//! Logs of robots.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use logs::bag::{BagOptions, Drive, PoseSource};
use logs::{Options, Sensor};
use pyo3::prelude::*;

use crate::errors::bad;
use crate::scan::Scan;
use crate::sensor::{Laser, Sonar, Stereo};

/// A log, scan by scan: iterate over it.
#[pyclass(frozen, module = "sightgrid")]
pub(crate) struct Log {
    path: PathBuf,
    log: Mutex<logs::Log<'static>>,
}

/// A scan of a log, with what else the log tells of it.
#[pyclass(frozen, module = "sightgrid")]
pub(crate) struct Event {
    scan: Py<Scan>,
    odometry: Option<(f64, f64, f64)>,
    line: u64,
}

#[pymethods]
impl Event {
    /// The scan; its time is s since the first of the log.
    #[getter]
    fn scan(&self, py: Python<'_>) -> Py<Scan> {
        self.scan.clone_ref(py)
    }

    /// ``(x_m, y_m, theta_rad)`` of the robot by its odometry; ``None`` where the log has none.
    #[getter]
    fn odometry(&self) -> Option<(f64, f64, f64)> {
        self.odometry
    }

    /// The line that it begins on, or the message of a bag, from 1.
    #[getter]
    fn line(&self) -> u64 {
        self.line
    }
}

/// Opens a log: CARMEN, or a table of scans (CSV), plain or compressed; or a bag of ROS (.bag, .mcap, .db3, or the folder of rosbag2).
///
/// :param every: every n-th scan alone
/// :param window: ``(from, to)``, s since the first scan
/// :param min_range_m: readings below are not used, m
/// :param max_range_m: readings from here on are no echo, m; default what the log says, else 80
/// :param scan: of a bag, topics of scans, a sensor each; default the only one
/// :param pose: of a bag, where poses come from: ``"odom"``, a topic, or ``"tf:FRAME"``; default the only source
#[pyfunction]
#[pyo3(signature = (path, *, every = 1, window = None, min_range_m = 0.0, max_range_m = None, scan = Vec::new(), pose = None))]
pub(crate) fn read_log(
    path: PathBuf,
    every: u64,
    window: Option<(f64, f64)>,
    min_range_m: f64,
    max_range_m: Option<f64>,
    scan: Vec<String>,
    pose: Option<&str>,
) -> PyResult<Log> {
    let options =
        Options { every, window_s: window.map(|(from, to)| from..to), min_range_m, max_range_m, ..Options::default() };
    options.check().map_err(bad)?;
    let pose = pose.map_or(PoseSource::Only, PoseSource::named);
    let bag = BagOptions { scans: scan, pose, ..BagOptions::default() };
    let log = match Drive::is_at(&path) {
        true => Drive::open(&path, &bag).and_then(|drive| logs::Log::of_drive(&drive, &options)).map_err(bad)?,
        false => logs::Log::open(&path, &options).map_err(bad)?,
    };
    Ok(Log { path, log: Mutex::new(log) })
}

#[pymethods]
impl Log {
    /// What took the first scan, with the usual noise (``sightgrid calibrate`` fits it).
    #[getter]
    fn sensor(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let kind = self.log.lock().unwrap_or_else(PoisonError::into_inner).sensor();
        of_kind(py, kind)
    }

    /// The sensors by number, as far as the log was read: ``Mapper(name, grid, list(log.sensors.values()))`` once it was read to its end.
    #[getter]
    fn sensors(&self, py: Python<'_>) -> PyResult<BTreeMap<usize, Py<PyAny>>> {
        let log = self.log.lock().unwrap_or_else(PoisonError::into_inner);
        let known = log.report().sensors.iter().filter_map(|(number, found)| Some((*number, found.kind?)));
        known.map(|(number, kind)| Ok((number, of_kind(py, kind)?))).collect()
    }

    /// What is to be known of what was read so far: a line each.
    #[getter]
    fn findings(&self) -> Vec<String> {
        let log = self.log.lock().unwrap_or_else(PoisonError::into_inner);
        let unit = log.report().unit;
        log.report().findings().iter().map(|finding| finding.text(unit)).collect()
    }

    fn __iter__(this: PyRef<'_, Self>) -> PyRef<'_, Self> {
        this
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Event>> {
        let next = py.detach(|| self.log.lock().unwrap_or_else(PoisonError::into_inner).next_event());
        let Some(event) = next.transpose().map_err(bad)? else { return self.end(py).map(|()| None) };
        let odometry = event.odometry.map(|pose| (pose.x_m, pose.y_m, pose.theta_rad));
        Ok(Some(Event { scan: Py::new(py, Scan { scan: event.scan })?, odometry, line: event.line }))
    }
}

/// A sensor with the usual noise.
fn of_kind(py: Python<'_>, kind: Sensor) -> PyResult<Py<PyAny>> {
    Ok(match kind {
        Sensor::Laser { max_range_m, .. } => {
            Py::new(py, Laser::of(sensor::Laser { max_range_m, ..sensor::Laser::default() }))?.into_any()
        }
        Sensor::Stereo => Py::new(py, Stereo::of(sensor::Stereo::default()))?.into_any(),
        Sensor::Sonar { max_range_m, width_rad } => {
            let usual = sensor::Sonar::default();
            let max_range_m = max_range_m.unwrap_or(usual.max_range_m);
            let width_rad = width_rad.unwrap_or(usual.width_rad);
            Py::new(py, Sonar::of(sensor::Sonar { max_range_m, width_rad, ..usual }))?.into_any()
        }
    })
}

impl Log {
    /// Warns of what is suspicious about the log.
    fn end(&self, py: Python<'_>) -> PyResult<()> {
        let (findings, unit) = {
            let log = self.log.lock().unwrap_or_else(PoisonError::into_inner);
            (log.report().findings(), log.report().unit)
        };
        let warnings = py.import("warnings")?;
        for finding in findings.iter().filter(|finding| finding.is_warning()) {
            warnings.call_method1("warn", (format!("{}: {}", self.path.display(), finding.text(unit)),))?;
        }
        Ok(())
    }
}
