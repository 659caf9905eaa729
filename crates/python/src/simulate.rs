//! Simulated drives with their truth.

use std::path::PathBuf;

use ::grid::Raster;
use ::score::Region;
use ::sensor::Device;
use experiments::worlds::condition::AS_BELIEVED;
use experiments::worlds::scenes;
use experiments::worlds::site::{Assumptions, Site};
use experiments::worlds::witness::Witness;
use numpy::{PyArray1, PyArray2, PyArrayMethods as _};
use pyo3::prelude::*;

use crate::arrays::{of_cells, of_truth};
use crate::errors::{bad, of_failure};
use crate::grid::Grid;
use crate::scan::Scan;
use crate::sensor::{Stereo, of_device};

/// A drive through a scene: what its camera read, and what is true.
#[pyclass(frozen, module = "sightgrid")]
pub(crate) struct Simulation {
    name: String,
    seed: u64,
    pub(crate) truth: Raster<Option<bool>>,
    pub(crate) surface: Raster<bool>,
    regions: Vec<(String, Raster<bool>)>,
    /// Occupancy of an unseen cell, as mappers assume it.
    pub(crate) prior: f64,
    camera: ::sensor::Stereo,
    beside: Vec<Device>,
    /// What was read at one time.
    moments: Vec<Vec<Py<Scan>>>,
    poses: Vec<f64>,
    odometry: Option<Vec<f64>>,
}

/// Simulates the drive of a scene, as ``room`` does: the same seed gives the same readings.
///
/// :param scene: a name of ``sightgrid list``, such as ``"room"`` or ``"halls"``, or a TOML file
/// :param seed: of the readings
/// :param layout: which scene of a family; ``None`` for the first
/// :param cell_m: side of a cell, m; ``None`` for the scene's own
#[pyfunction]
#[pyo3(signature = (scene, seed = 1, *, layout = None, cell_m = None))]
pub(crate) fn simulate(
    py: Python<'_>,
    scene: PathBuf,
    seed: u64,
    layout: Option<u64>,
    cell_m: Option<f64>,
) -> PyResult<Simulation> {
    let path = scene.to_str().map_or_else(|| scene.clone(), scenes::path_of);
    let found = py.detach(|| -> Result<_, experiments::failure::Failure> {
        let loaded = ::scene::load(&path, cell_m, layout)?;
        let Site { ground, setup } = Site::of(loaded, &AS_BELIEVED, &Assumptions::default())?;
        let simulated = ::scene::simulate(&ground.scene, &ground.world, &ground.drive, seed).scans;
        let mut witness = Witness::new(&ground);
        for (number, scan) in simulated.iter().enumerate() {
            witness.look(&ground, number, scan)?;
        }
        Ok((ground, setup, simulated, witness.seen))
    });
    let (ground, setup, simulated, seen) = found.map_err(of_failure)?;
    let by_rays = Region::ALL.iter().map(|region| (region.name().to_owned(), seen.mask(*region)));
    let by_name = ground.scene.regions.iter().map(|region| (region.name.clone(), region.mask(ground.truth.spec())));
    let of_poses = |poses: &mut dyn Iterator<Item = ::sensor::Pose>| -> Vec<f64> {
        poses.flat_map(|pose| [pose.x_m, pose.y_m, pose.theta_rad]).collect()
    };
    let odometry: Option<Vec<::sensor::Pose>> = simulated.iter().map(|scan| scan.odometry).collect();
    Ok(Simulation {
        name: ground.scene.name.clone(),
        seed,
        regions: by_rays.chain(by_name).collect(),
        surface: seen.surface().clone(),
        prior: setup.prior.marginal(),
        camera: ground.scene.matcher.stereo,
        poses: of_poses(&mut ground.drive.poses.iter().map(|timed| timed.pose)),
        odometry: odometry.map(|poses| of_poses(&mut poses.into_iter())),
        beside: ground.scene.sensors.iter().map(|mounted| mounted.device).collect(),
        moments: simulated
            .iter()
            .map(|simulated| simulated.together().into_iter().map(|scan| Py::new(py, Scan { scan })).collect())
            .collect::<PyResult<_>>()?,
        truth: ground.truth,
    })
}

#[pymethods]
impl Simulation {
    /// Name of the scene.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// The seed of the readings.
    #[getter]
    fn seed(&self) -> u64 {
        self.seed
    }

    /// The cells of the scene.
    #[getter]
    fn grid(&self) -> Grid {
        Grid { spec: *self.truth.spec() }
    }

    /// The camera, as mappers know it.
    #[getter]
    fn sensor(&self, py: Python<'_>) -> PyResult<Py<Stereo>> {
        Py::new(py, Stereo::of(self.camera))
    }

    /// The sensors by number: the camera, and those that the scene has beside it.
    #[getter]
    fn sensors(&self, py: Python<'_>) -> PyResult<Vec<Py<PyAny>>> {
        let camera = Py::new(py, Stereo::of(self.camera))?.into_any();
        [Ok(camera)].into_iter().chain(self.beside.iter().map(|device| of_device(py, device))).collect()
    }

    /// The scans in order, those of one time by the numbers of their sensors.
    #[getter]
    fn scans(&self, py: Python<'_>) -> Vec<Py<Scan>> {
        self.moments.iter().flatten().map(|scan| scan.clone_ref(py)).collect()
    }

    /// The same as a list for every time: what several sensors read then is for ``Mapper.integrate_together``.
    #[getter]
    fn moments(&self, py: Python<'_>) -> Vec<Vec<Py<Scan>>> {
        self.moments.iter().map(|scans| scans.iter().map(|scan| scan.clone_ref(py)).collect()).collect()
    }

    /// 1 for occupied, 0 for free, NaN for not known, at the end of the drive; ``(height, width)``.
    #[getter]
    fn truth<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        of_cells(py, self.truth.spec(), of_truth(&self.truth))
    }

    /// True poses of the robot, a row ``x_m, y_m, theta_rad`` for every time.
    #[getter]
    fn poses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        PyArray1::from_slice(py, &self.poses).reshape([self.moments.len(), 3])
    }

    /// Poses by odometry, as ``poses``; ``None`` of a scene without.
    #[getter]
    fn odometry<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.odometry.as_ref().map(|poses| PyArray1::from_slice(py, poses).reshape([self.moments.len(), 3])).transpose()
    }

    /// Names of the regions that maps are scored in.
    #[getter]
    fn regions(&self) -> Vec<&str> {
        self.regions.iter().map(|(name, _)| name.as_str()).collect()
    }

    /// The cells of a region, ``(height, width)`` of bool.
    fn region<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray2<bool>>> {
        let mask = self.mask(name)?;
        of_cells(py, mask.spec(), mask.values().to_vec())
    }

    fn __repr__(&self) -> String {
        format!("Simulation({:?}, seed {}, {} times)", self.name, self.seed, self.moments.len())
    }
}

impl Simulation {
    /// The cells of a region.
    pub(crate) fn mask(&self, name: &str) -> PyResult<&Raster<bool>> {
        let found = self.regions.iter().find(|(region, _)| region == name);
        found
            .map(|(_, mask)| mask)
            .ok_or_else(|| bad(format!("there is no region {name:?}; there are: {}", self.regions().join(", "))))
    }
}
