//! What a rule is made from: the cells, the sensors, and what is assumed before the first reading.

use std::sync::Arc;

use grid::GridSpec;
use sensor::{Scan, SensorModel};

use crate::belief::prior::Prior;
use crate::belief::repeats::Repeats;
use crate::pairs::reconcile::Reconciliation;
use crate::tuning::Tuning;

/// What a mapper is made from.
#[derive(Clone)]
pub struct Model {
    /// The cells to map.
    pub grid: GridSpec,
    /// The sensors that the mapper assumes, as scans number them.
    pub sensors: Sensors,
    /// What is assumed before the first reading.
    pub prior: Prior,
    /// What becomes of edges that no ray runs along.
    pub reconciliation: Reconciliation,
    /// Parameters of the rules that are not as published or fitted.
    pub tuning: Tuning,
    /// When `visibility-dynamic` takes a reading for a repetition: `calibrate` fits its lengths.
    pub repeats: Repeats,
    /// Readings beyond this, of a camera its depth, are thrown away before any rule sees them, m; infinite where all are used. What a rule does about far readings
    /// of its own comes after that.
    pub max_range_m: f64,
}

impl Model {
    /// One sensor, the paper's prior, and every rule as it is.
    pub fn new(grid: GridSpec, sensor: Arc<dyn SensorModel>) -> Self {
        Self {
            grid,
            sensors: Sensors::one(sensor),
            prior: Prior::default(),
            reconciliation: Reconciliation::default(),
            tuning: Tuning::default(),
            repeats: Repeats::CHOSEN,
            max_range_m: f64::INFINITY,
        }
    }
}

/// The sensors of a robot by number, at least one.
#[derive(Clone)]
pub struct Sensors(Vec<Arc<dyn SensorModel>>);

impl Sensors {
    /// One sensor, number 0.
    pub fn one(sensor: Arc<dyn SensorModel>) -> Self {
        Self(vec![sensor])
    }

    /// Several sensors, numbered from 0.
    ///
    /// # Panics
    /// If there is none.
    pub fn new(sensors: Vec<Arc<dyn SensorModel>>) -> Self {
        assert!(!sensors.is_empty(), "a model has at least one sensor");
        Self(sensors)
    }

    /// The sensor that took a scan.
    ///
    /// # Panics
    /// If the scan names a sensor that is not there.
    pub fn of(&self, scan: &Scan) -> &Arc<dyn SensorModel> {
        let (number, sensors) = (scan.sensor, self.0.len());
        self.0
            .get(number)
            .unwrap_or_else(|| panic!("a scan of sensor {number}: the model has {sensors}, numbered from 0"))
    }

    /// All sensors in the order of their numbers.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Arc<dyn SensorModel>> {
        self.0.iter()
    }
}
