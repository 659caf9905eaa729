//! A rule that turns scans into a map.

use std::sync::{Mutex, MutexGuard, PoisonError};

use experiments::worlds::seen::Seen;
use mapper::catalogue::{self, Kind, MAPPERS};
use mapper::{Model, Sensors};
use numpy::{PyArray1, PyArray2, PyArrayMethods as _, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::arrays::of_cells;
use crate::errors::bad;
use crate::grid::Grid;
use crate::prior::Prior;
use crate::scan::{Scan, checked};
use crate::sensor::Sensor;

/// So many scans wait until somebody asks which cells were seen.
const WAITING: usize = 1000;

/// The mappers there are: name, kind (``online``, ``batch``, ``noise-free``) and a line on each.
#[pyfunction]
pub(crate) fn mappers() -> Vec<(&'static str, &'static str, &'static str)> {
    MAPPERS.iter().map(|entry| (entry.name, kind(entry.kind), entry.summary)).collect()
}

fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Online => "online",
        Kind::Batch => "batch",
        Kind::NoiseFree => "noise-free",
    }
}

/// A rule that turns scans into a map, by its name (see ``mappers``).
///
/// :param name: such as ``"visibility"``, the paper's method
/// :param grid: the cells
/// :param sensors: the sensor that takes the scans, or a list of them by number
/// :param prior: what is assumed of an unseen world
/// :param max_range_m: readings beyond are not used, m
#[pyclass(frozen, module = "sightgrid")]
pub(crate) struct Mapper {
    name: &'static str,
    kind: Kind,
    model: Model,
    sensors: Vec<Sensor>,
    state: Mutex<State>,
}

struct State {
    mapper: Box<dyn mapper::Mapper>,
    /// What the sensors have seen, but for the scans that wait.
    seen: Seen,
    waiting: Vec<sensor::Scan>,
}

/// A sensor, or several.
#[derive(FromPyObject)]
pub(crate) enum SensorOrSensors<'py> {
    One(PyRef<'py, Sensor>),
    Several(Vec<PyRef<'py, Sensor>>),
}

#[pymethods]
impl Mapper {
    #[new]
    #[pyo3(signature = (name, grid, sensors, prior = None, *, max_range_m = None))]
    fn new(
        name: &str,
        grid: PyRef<'_, Grid>,
        sensors: SensorOrSensors<'_>,
        prior: Option<PyRef<'_, Prior>>,
        max_range_m: Option<f64>,
    ) -> PyResult<Self> {
        let entry = catalogue::find(name).ok_or_else(|| {
            let names = || MAPPERS.iter().map(|entry| entry.name);
            let all: Vec<&str> = names().collect();
            bad(format!(
                "there is no mapper {name:?}; the nearest is {:?}, all are: {}",
                strict::nearest(name, names()),
                all.join(", ")
            ))
        })?;
        let sensors: Vec<Sensor> = match sensors {
            SensorOrSensors::One(one) => vec![one.clone()],
            SensorOrSensors::Several(several) => several.iter().map(|sensor| (*sensor).clone()).collect(),
        };
        let Some(first) = sensors.first() else {
            return Err(bad("sensors is empty; a mapper knows one sensor at least"));
        };
        let max_range_m = max_range_m.unwrap_or(f64::INFINITY);
        if max_range_m.is_nan() || max_range_m <= 0.0 {
            return Err(bad(format!("max_range_m is {max_range_m}; it must be a number of m above 0")));
        }
        let model = Model {
            sensors: Sensors::new(sensors.iter().map(|sensor| sensor.model.clone()).collect()),
            prior: prior.map_or_else(mapper::Prior::default, |prior| prior.prior),
            max_range_m,
            ..Model::new(grid.spec, first.model.clone())
        };
        let seen = Seen::new(grid.spec);
        let state = Mutex::new(State { mapper: entry.mapper(&model), seen, waiting: Vec::new() });
        Ok(Self { name: entry.name, kind: entry.kind, model, sensors, state })
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &'static str {
        self.name
    }

    /// ``online``, ``batch``, or ``noise-free`` of one that is to be given readings without noise.
    #[getter]
    fn kind(&self) -> &'static str {
        kind(self.kind)
    }

    /// The cells.
    #[getter]
    fn grid(&self) -> Grid {
        Grid { spec: self.model.grid }
    }

    /// Updates the map with a scan, or with what a scan is made of. Other threads of Python run meanwhile.
    ///
    /// :param scan: a ``Scan``; without it, ``pose``, ``bearings`` and ``readings`` are needed (see ``Scan``)
    #[pyo3(signature = (scan = None, *, pose = None, bearings = None, readings = None, time_s = 0.0, sensor = 0))]
    #[expect(clippy::too_many_arguments, reason = "they are keywords")]
    fn integrate(
        &self,
        py: Python<'_>,
        scan: Option<PyRef<'_, Scan>>,
        pose: Option<[f64; 3]>,
        bearings: Option<PyReadonlyArray1<'_, f64>>,
        readings: Option<PyReadonlyArray1<'_, f64>>,
        time_s: f64,
        sensor: usize,
    ) -> PyResult<()> {
        let parts = (&pose, &bearings, &readings);
        let scan = match (scan, parts) {
            (Some(scan), (None, None, None)) => scan.scan.clone(),
            (None, (Some(pose), Some(bearings), Some(readings))) => checked(*pose, bearings, readings, time_s, sensor)?,
            _ => return Err(bad("give a scan, or pose, bearings and readings")),
        };
        self.take(py, vec![scan])
    }

    /// Updates the map with what several sensors read at one time, as one scan: rays that cross are averaged, whichever sensor they are of.
    ///
    /// :param scans: of different sensors, in the order of their numbers
    fn integrate_together(&self, py: Python<'_>, scans: Vec<PyRef<'_, Scan>>) -> PyResult<()> {
        let scans: Vec<sensor::Scan> = scans.iter().map(|scan| scan.scan.clone()).collect();
        if scans.windows(2).any(|pair| !pair[0].is_with(&pair[1])) {
            return Err(bad("scans that are taken together have one time, and sensors whose numbers rise"));
        }
        self.take(py, scans)
    }

    /// Probability that each cell is occupied, an array of its own; of a batch mapper, solved now.
    ///
    /// :param unseen: what stands for cells that no reading has crossed; ``None`` for what the mapper has there
    #[pyo3(signature = (unseen = Some(f64::NAN)))]
    fn occupancy<'py>(&self, py: Python<'py>, unseen: Option<f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let values = py.detach(|| {
            let mut state = self.state();
            state.mapper.settle();
            let mut values = state.mapper.occupancy().values().to_vec();
            if let Some(unseen) = unseen {
                self.look(&mut state);
                for (cell, value) in values.iter_mut().enumerate() {
                    if !state.seen.cells[cell] {
                        *value = unseen;
                    }
                }
            }
            values
        });
        of_cells(py, &self.model.grid, values)
    }

    /// Joint probabilities of neighbours (Eqs. 16 to 19), of a mapper that holds them: that both are occupied, of cells beside each other,
    /// ``(height, width - 1)``, and of cells one above the other, ``(height - 1, width)``; else ``None``.
    #[expect(clippy::type_complexity, reason = "two arrays")]
    fn pairwise<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)>> {
        let found = py.detach(|| {
            let mut state = self.state();
            state.mapper.settle();
            let pairs = state.mapper.pairwise()?;
            let (width, height) = (self.model.grid.width, self.model.grid.height);
            let both = |a: usize, b: usize| pairs.joint(a, b).ee;
            let beside = (0..height).flat_map(|row| (0..width - 1).map(move |column| row * width + column));
            let above = 0..(height - 1) * width;
            Some((
                beside.map(|cell| both(cell, cell + 1)).collect::<Vec<f64>>(),
                above.map(|cell| both(cell, cell + width)).collect::<Vec<f64>>(),
            ))
        });
        let Some((beside, above)) = found else { return Ok(None) };
        let (width, height) = (self.model.grid.width, self.model.grid.height);
        let beside = PyArray1::from_vec(py, beside).reshape([height, width - 1])?;
        let above = PyArray1::from_vec(py, above).reshape([height - 1, width])?;
        Ok(Some((beside, above)))
    }

    /// ``ln P(readings of the scan | map)``, nats, of a scan that is not integrated, its rays taken for independent; ``None`` of a mapper
    /// that does not predict readings, and of a scan that starts outside the map.
    fn evidence(&self, py: Python<'_>, scan: PyRef<'_, Scan>) -> PyResult<Option<f64>> {
        let scan = scan.scan.clone();
        self.known(&scan)?;
        Ok(py.detach(|| {
            let mut state = self.state();
            state.mapper.settle();
            state.mapper.evidence(&scan)
        }))
    }

    /// A copy that goes on by itself; of a mapper that cannot be copied, a ``ValueError``.
    fn copy(&self) -> PyResult<Self> {
        let mut state = self.state();
        self.look(&mut state);
        let forked = state.mapper.fork().ok_or_else(|| bad(format!("{} cannot be copied", self.name)))?;
        let mut seen = Seen::new(self.model.grid);
        seen.cells = state.seen.cells.clone();
        let copy = Mutex::new(State { mapper: forked, seen, waiting: Vec::new() });
        Ok(Self {
            name: self.name,
            kind: self.kind,
            model: self.model.clone(),
            sensors: self.sensors.clone(),
            state: copy,
        })
    }

    /// Cells that rays were updated over so far, a cell once for every ray; 0 of a mapper that does not count.
    #[getter]
    fn cells_updated(&self) -> u64 {
        self.state().mapper.work().cells
    }

    /// Memory that the mapper holds, bytes.
    #[getter]
    fn nbytes(&self) -> usize {
        self.state().mapper.work().bytes
    }

    fn __repr__(&self) -> String {
        format!(
            "Mapper({:?}, {} x {} cells of {} m)",
            self.name, self.model.grid.height, self.model.grid.width, self.model.grid.cell_m
        )
    }
}

impl Mapper {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn known(&self, scan: &sensor::Scan) -> PyResult<()> {
        let (number, sensors) = (scan.sensor, self.sensors.len());
        if number < sensors {
            return Ok(());
        }
        Err(bad(format!("the scan is of sensor {number}; the mapper knows {sensors}, numbered from 0")))
    }

    fn take(&self, py: Python<'_>, scans: Vec<sensor::Scan>) -> PyResult<()> {
        scans.iter().try_for_each(|scan| self.known(scan))?;
        py.detach(|| {
            let mut state = self.state();
            match scans.as_slice() {
                [scan] => state.mapper.integrate(scan),
                scans => state.mapper.integrate_together(scans),
            }
            state.waiting.extend(scans);
            if state.waiting.len() > WAITING {
                self.look(&mut state);
            }
        });
        Ok(())
    }

    /// Marks the cells of the scans that wait.
    fn look(&self, state: &mut State) {
        for scan in std::mem::take(&mut state.waiting) {
            let sensor = &self.sensors[scan.sensor];
            state.seen.add(&scan, &*sensor.model, sensor.reach);
        }
    }
}
