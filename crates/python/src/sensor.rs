//! Sensors by their parameters, and their kernels.

use std::sync::Arc;

use experiments::worlds::seen::Reach;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use sensor::SensorModel;

use crate::errors::bad;

/// What mappers know of a sensor: ``Stereo``, ``Laser``, ``Sonar``, or one of a scene that has no class of its own.
#[pyclass(frozen, subclass, module = "sightgrid")]
#[derive(Clone)]
pub(crate) struct Sensor {
    pub(crate) model: Arc<dyn SensorModel>,
    /// How far a reading is relied on, where it is asked which cells were seen.
    pub(crate) reach: Reach,
}

#[pymethods]
impl Sensor {
    /// The kernel ``P(o | F_k)`` of Eq. (21): how likely a reading is where the first occupied cell of its ray lies between
    /// ``ranges[k]`` and ``ranges[k + 1]``.
    ///
    /// :param reading: in the sensor's unit (px of disparity, m of range); ``inf`` where nothing came back
    /// :param ranges: m along the ray, never decreasing, two or more
    /// :param bearing: angle between ray and optical axis, rad
    /// :returns: an array one shorter than ``ranges``, per unit of the reading
    #[pyo3(signature = (reading, ranges, bearing = 0.0))]
    fn likelihood<'py>(
        &self,
        py: Python<'py>,
        reading: f64,
        ranges: PyReadonlyArray1<'py, f64>,
        bearing: f64,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let ranges: Vec<f64> = ranges.as_array().iter().copied().collect();
        if reading.is_nan() || !bearing.is_finite() {
            return Err(bad(format!(
                "reading {reading} at bearing {bearing}: a reading is a number, a bearing a finite one (rad)"
            )));
        }
        if ranges.len() < 2 || ranges.iter().any(|range| !(0.0..f64::INFINITY).contains(range)) || !ranges.is_sorted() {
            return Err(bad("ranges must be two or more finite numbers of m, 0 or more, that never decrease"));
        }
        let mut likelihood = vec![0.0; ranges.len() - 1];
        py.detach(|| self.model.likelihood(reading, bearing, &ranges, &mut likelihood));
        Ok(PyArray1::from_vec(py, likelihood))
    }

    /// The range, m along the ray, that a reading stands for; ``None`` of one that stands for none.
    #[pyo3(signature = (reading, bearing = 0.0))]
    fn range_of(&self, reading: f64, bearing: f64) -> Option<f64> {
        self.model.range_of(reading, bearing)
    }
}

/// A stereo camera, whose readings are disparities in px (Eq. 21: a Gaussian, and mismatches).
///
/// :param focal_baseline: focal length times baseline, px m
/// :param disparity_sigma: standard deviation of a correct disparity, px
/// :param correct_match: probability of a correct match
/// :param max_disparity: largest disparity searched, px
#[pyclass(frozen, extends = Sensor, module = "sightgrid")]
pub(crate) struct Stereo {
    stereo: sensor::Stereo,
}

fn positive(name: &str, value: f64) -> PyResult<()> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(bad(format!("{name} is {value}; it must be a finite number above 0")))
    }
}

fn share(name: &str, value: f64) -> PyResult<()> {
    if (0.0..=1.0).contains(&value) { Ok(()) } else { Err(bad(format!("{name} is {value}; it must be from 0 to 1"))) }
}

impl Stereo {
    /// The camera as an object of Python.
    pub(crate) fn of(stereo: sensor::Stereo) -> PyClassInitializer<Self> {
        PyClassInitializer::from(Sensor { model: Arc::new(stereo), reach: Reach::Median }).add_subclass(Self { stereo })
    }
}

#[pymethods]
impl Stereo {
    #[new]
    #[pyo3(signature = (
        focal_baseline = sensor::Stereo::default().focal_baseline, disparity_sigma = sensor::Stereo::default().disparity_sigma,
        correct_match = sensor::Stereo::default().correct_match, max_disparity = sensor::Stereo::default().max_disparity,
    ))]
    fn new(
        focal_baseline: f64,
        disparity_sigma: f64,
        correct_match: f64,
        max_disparity: f64,
    ) -> PyResult<PyClassInitializer<Self>> {
        positive("focal_baseline", focal_baseline)?;
        positive("disparity_sigma", disparity_sigma)?;
        share("correct_match", correct_match)?;
        positive("max_disparity", max_disparity)?;
        Ok(Self::of(sensor::Stereo { focal_baseline, disparity_sigma, correct_match, max_disparity }))
    }

    /// Focal length times baseline, px m.
    #[getter]
    fn focal_baseline(&self) -> f64 {
        self.stereo.focal_baseline
    }

    /// Standard deviation of a correct disparity, px.
    #[getter]
    fn disparity_sigma(&self) -> f64 {
        self.stereo.disparity_sigma
    }

    /// Probability of a correct match.
    #[getter]
    fn correct_match(&self) -> f64 {
        self.stereo.correct_match
    }

    /// Largest disparity searched, px.
    #[getter]
    fn max_disparity(&self) -> f64 {
        self.stereo.max_disparity
    }

    fn __repr__(&self) -> String {
        let sensor::Stereo { focal_baseline, disparity_sigma, correct_match, max_disparity } = self.stereo;
        format!(
            "Stereo(focal_baseline={focal_baseline}, disparity_sigma={disparity_sigma}, correct_match={correct_match}, max_disparity={max_disparity})"
        )
    }
}

/// A laser, whose readings are ranges in m, and ``inf`` where nothing came back (the beam model of Thrun, Burgard and Fox 2005).
///
/// :param range_sigma_m: standard deviation of an echo, m
/// :param max_range_m: readings from here on are no echo, m
/// :param hit: probability that a pulse is reflected by the first obstacle
/// :param no_echo: probability that a pulse is lost
/// :param early_per_m: things on no map that stand in a metre of beam, 1/m
#[pyclass(frozen, extends = Sensor, module = "sightgrid")]
pub(crate) struct Laser {
    laser: sensor::Laser,
}

impl Laser {
    /// The laser as an object of Python.
    pub(crate) fn of(laser: sensor::Laser) -> PyClassInitializer<Self> {
        PyClassInitializer::from(Sensor { model: Arc::new(laser), reach: Reach::Reading }).add_subclass(Self { laser })
    }
}

#[pymethods]
impl Laser {
    #[new]
    #[pyo3(signature = (
        range_sigma_m = sensor::Laser::default().range_sigma_m, max_range_m = sensor::Laser::default().max_range_m,
        hit = sensor::Laser::default().hit, no_echo = sensor::Laser::default().no_echo,
        early_per_m = sensor::Laser::default().early_per_m,
    ))]
    fn new(
        range_sigma_m: f64,
        max_range_m: f64,
        hit: f64,
        no_echo: f64,
        early_per_m: f64,
    ) -> PyResult<PyClassInitializer<Self>> {
        let laser = sensor::Laser { range_sigma_m, max_range_m, hit, no_echo, early_per_m };
        laser.validate().map_err(bad)?;
        Ok(Self::of(laser))
    }

    /// Standard deviation of an echo, m.
    #[getter]
    fn range_sigma_m(&self) -> f64 {
        self.laser.range_sigma_m
    }

    /// Readings from here on are no echo, m.
    #[getter]
    fn max_range_m(&self) -> f64 {
        self.laser.max_range_m
    }

    /// Probability that a pulse is reflected by the first obstacle.
    #[getter]
    fn hit(&self) -> f64 {
        self.laser.hit
    }

    /// Probability that a pulse is lost.
    #[getter]
    fn no_echo(&self) -> f64 {
        self.laser.no_echo
    }

    /// Things on no map that stand in a metre of beam, 1/m.
    #[getter]
    fn early_per_m(&self) -> f64 {
        self.laser.early_per_m
    }

    fn __repr__(&self) -> String {
        let sensor::Laser { range_sigma_m, max_range_m, hit, no_echo, early_per_m } = self.laser;
        format!(
            "Laser(range_sigma_m={range_sigma_m}, max_range_m={max_range_m}, hit={hit}, no_echo={no_echo}, early_per_m={early_per_m})"
        )
    }
}

/// A sonar, whose readings are ranges in m of the nearest surface in a cone, and ``inf`` where nothing came back (Elfes 1987).
///
/// :param range_sigma_m: standard deviation of an echo, m
/// :param max_range_m: nothing is heard beyond, m
/// :param hit: probability of an echo from the nearest surface in the cone
/// :param no_echo: probability of no echo although there is a surface
/// :param early_per_m: things on no map, 1/m
/// :param width_rad: angle between the edges of the cone, rad
#[pyclass(frozen, extends = Sensor, module = "sightgrid")]
pub(crate) struct Sonar {
    sonar: sensor::Sonar,
}

impl Sonar {
    /// The sonar as an object of Python.
    pub(crate) fn of(sonar: sensor::Sonar) -> PyClassInitializer<Self> {
        PyClassInitializer::from(Sensor { model: Arc::new(sonar), reach: Reach::Reading }).add_subclass(Self { sonar })
    }
}

#[pymethods]
impl Sonar {
    #[new]
    #[pyo3(signature = (
        range_sigma_m = sensor::Sonar::default().range_sigma_m, max_range_m = sensor::Sonar::default().max_range_m,
        hit = sensor::Sonar::default().hit, no_echo = sensor::Sonar::default().no_echo,
        early_per_m = sensor::Sonar::default().early_per_m, width_rad = sensor::Sonar::default().width_rad,
    ))]
    fn new(
        range_sigma_m: f64,
        max_range_m: f64,
        hit: f64,
        no_echo: f64,
        early_per_m: f64,
        width_rad: f64,
    ) -> PyResult<PyClassInitializer<Self>> {
        let laser = sensor::Laser { range_sigma_m, max_range_m, hit, no_echo, early_per_m };
        laser.validate().map_err(bad)?;
        if !(width_rad > 0.0 && width_rad < std::f64::consts::PI) {
            return Err(bad(format!("width_rad is {width_rad}; it must be an angle above 0 and below pi")));
        }
        Ok(Self::of(sensor::Sonar { range_sigma_m, max_range_m, hit, no_echo, early_per_m, width_rad }))
    }

    /// Standard deviation of an echo, m.
    #[getter]
    fn range_sigma_m(&self) -> f64 {
        self.sonar.range_sigma_m
    }

    /// Nothing is heard beyond, m.
    #[getter]
    fn max_range_m(&self) -> f64 {
        self.sonar.max_range_m
    }

    /// Probability of an echo from the nearest surface in the cone.
    #[getter]
    fn hit(&self) -> f64 {
        self.sonar.hit
    }

    /// Probability of no echo although there is a surface.
    #[getter]
    fn no_echo(&self) -> f64 {
        self.sonar.no_echo
    }

    /// Things on no map, 1/m.
    #[getter]
    fn early_per_m(&self) -> f64 {
        self.sonar.early_per_m
    }

    /// Angle between the edges of the cone, rad.
    #[getter]
    fn width_rad(&self) -> f64 {
        self.sonar.width_rad
    }

    fn __repr__(&self) -> String {
        let sensor::Sonar { range_sigma_m, max_range_m, hit, no_echo, early_per_m, width_rad } = self.sonar;
        format!(
            "Sonar(range_sigma_m={range_sigma_m}, max_range_m={max_range_m}, hit={hit}, no_echo={no_echo}, early_per_m={early_per_m}, width_rad={width_rad})"
        )
    }
}

/// A simulated device as mappers know it: a class of its own where there is one, else a plain ``Sensor``.
pub(crate) fn of_device(py: Python<'_>, device: &sensor::Device) -> PyResult<Py<PyAny>> {
    Ok(match *device {
        sensor::Device::Laser(laser) => Py::new(py, Laser::of(laser))?.into_any(),
        sensor::Device::Sonar(sonar) => Py::new(py, Sonar::of(sonar))?.into_any(),
        sensor::Device::Stereo(matcher) => Py::new(py, Stereo::of(matcher.stereo))?.into_any(),
        sensor::Device::Omnidirectional(_) => {
            Py::new(py, Sensor { model: device.model(), reach: Reach::Median })?.into_any()
        }
        sensor::Device::Depth(..) => Py::new(py, Sensor { model: device.model(), reach: Reach::Reading })?.into_any(),
    })
}
