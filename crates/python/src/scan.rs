//! One scan.

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use sensor::Pose;

use crate::errors::bad;

/// What a sensor read from one place.
///
/// :param pose: ``(x_m, y_m, theta_rad)`` of the sensor
/// :param bearings: angle of every ray to the optical axis, rad, counter-clockwise
/// :param readings: one for every ray, px of disparity or m of range; NaN where there is none, ``inf`` where nothing came back and that
///     is what was measured
/// :param time_s: s since the first scan
/// :param sensor: number of the sensor, from 0
#[pyclass(frozen, module = "sightgrid")]
#[derive(Clone)]
pub(crate) struct Scan {
    pub(crate) scan: sensor::Scan,
}

/// A scan out of arrays, checked.
pub(crate) fn checked(
    pose: [f64; 3],
    bearings: &PyReadonlyArray1<'_, f64>,
    readings: &PyReadonlyArray1<'_, f64>,
    time_s: f64,
    sensor: usize,
) -> PyResult<sensor::Scan> {
    let bearings_rad: Vec<f64> = bearings.as_array().iter().copied().collect();
    let readings: Vec<f64> = readings.as_array().iter().copied().collect();
    if bearings_rad.len() != readings.len() {
        return Err(bad(format!(
            "{} bearings and {} readings; there must be one reading for every bearing",
            bearings_rad.len(),
            readings.len()
        )));
    }
    if !pose.iter().chain([&time_s]).all(|value| value.is_finite()) {
        return Err(bad(format!(
            "pose {pose:?} at {time_s} s: x (m), y (m), theta (rad) and the time must be finite numbers"
        )));
    }
    if let Some(k) = bearings_rad.iter().position(|bearing| !bearing.is_finite()) {
        return Err(bad(format!("bearings[{k}] is {}; it must be a finite number of rad", bearings_rad[k])));
    }
    if let Some(k) = readings.iter().position(|reading| *reading <= 0.0) {
        return Err(bad(format!(
            "readings[{k}] is {}; it must be above 0, NaN for none, or inf for nothing that came back",
            readings[k]
        )));
    }
    let [x_m, y_m, theta_rad] = pose;
    let readings = readings.into_iter().map(|reading| Some(reading).filter(|reading| !reading.is_nan())).collect();
    Ok(sensor::Scan { sensor, time_s, pose: Pose { x_m, y_m, theta_rad }, bearings_rad, readings })
}

#[pymethods]
impl Scan {
    #[new]
    #[pyo3(signature = (pose, bearings, readings, time_s = 0.0, sensor = 0))]
    fn new(
        pose: [f64; 3],
        bearings: PyReadonlyArray1<'_, f64>,
        readings: PyReadonlyArray1<'_, f64>,
        time_s: f64,
        sensor: usize,
    ) -> PyResult<Self> {
        Ok(Self { scan: checked(pose, &bearings, &readings, time_s, sensor)? })
    }

    /// ``(x_m, y_m, theta_rad)`` of the sensor.
    #[getter]
    fn pose(&self) -> (f64, f64, f64) {
        let Pose { x_m, y_m, theta_rad } = self.scan.pose;
        (x_m, y_m, theta_rad)
    }

    /// Angle of every ray to the optical axis, rad; an array of its own.
    #[getter]
    fn bearings<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.scan.bearings_rad)
    }

    /// One for every ray, NaN where there is none; an array of its own.
    #[getter]
    fn readings<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.scan.readings.iter().map(|reading| reading.unwrap_or(f64::NAN)))
    }

    /// s since the first scan.
    #[getter]
    fn time_s(&self) -> f64 {
        self.scan.time_s
    }

    /// Number of the sensor, from 0.
    #[getter]
    fn sensor(&self) -> usize {
        self.scan.sensor
    }

    fn __len__(&self) -> usize {
        self.scan.readings.len()
    }

    fn __repr__(&self) -> String {
        let (x, y, theta) = self.pose();
        format!(
            "Scan({} rays from ({x:.3}, {y:.3}, {theta:.3}) at {:.3} s)",
            self.scan.readings.len(),
            self.scan.time_s
        )
    }
}
