//! The readings of all scans, kept for mappers that solve for all of them at once.

use std::sync::Arc;

use grid::{DigitalLine, GridSpec};
use sensor::{Ray, Scan, SensorModel};

use crate::beyond::{self, Beyond};
use crate::catalogue::Setup;
use crate::work::Held;

/// Every ray with a reading: its cells and what each of them would explain. 12 bytes per cell of a ray.
pub(crate) struct Readings {
    spec: GridSpec,
    sensor: Arc<dyn SensorModel>,
    onset: f64,
    line: DigitalLine,
    /// Cells of all rays, one ray after the other, nearest first.
    cells: Vec<u32>,
    /// `P(o | F_k)`, one per entry of `cells`, per unit of the reading.
    likelihood: Vec<f64>,
    /// The reading, one per ray.
    reading: Vec<f64>,
    /// `P(o | no cell of the ray is occupied)`, one per ray.
    none: Vec<f64>,
    /// End of every ray in `cells`.
    ends: Vec<usize>,
}

impl Readings {
    /// No reading yet.
    pub(crate) fn new(setup: &Setup) -> Self {
        Self {
            spec: setup.grid,
            sensor: Arc::clone(&setup.sensor),
            onset: setup.prior.onset(setup.grid.cell_m),
            line: DigitalLine::default(),
            cells: Vec::new(),
            likelihood: Vec::new(),
            reading: Vec::new(),
            none: Vec::new(),
            ends: Vec::new(),
        }
    }

    /// Keeps the rays of a scan that have a reading and cross the map. O(cells on the ray) per ray.
    pub(crate) fn add(&mut self, scan: &Scan) {
        for ray in scan.rays() {
            if let Some(reading) = ray.reading {
                self.add_ray(&ray, reading);
            }
        }
    }

    fn add_ray(&mut self, ray: &Ray, reading: f64) {
        self.line.trace(&self.spec, ray.origin_m, ray.direction, f64::INFINITY);
        if self.line.is_empty() {
            return;
        }
        let start = self.cells.len();
        // GridSpec::MAX_CELLS fits a u32.
        self.cells.extend(self.line.cells().iter().map(|&cell| cell as u32));
        self.likelihood.resize(self.cells.len(), 0.0);
        let likelihood = &mut self.likelihood[start..];
        self.sensor.likelihood(reading, ray.bearing_rad, self.line.ranges(), likelihood); // Eq. (21)
        let beyond = Beyond::after(&self.line, ray.direction, self.spec.cell_m, self.onset);
        self.none.push(beyond::likelihood(&*self.sensor, reading, ray.bearing_rad, &beyond));
        self.reading.push(reading);
        self.ends.push(self.cells.len());
    }

    /// Number of rays.
    pub(crate) fn rays(&self) -> usize {
        self.ends.len()
    }

    /// Entries of a ray in [`cells`](Self::cells) and [`likelihood`](Self::likelihood).
    pub(crate) fn span(&self, ray: usize) -> std::ops::Range<usize> {
        let start = if ray == 0 { 0 } else { self.ends[ray - 1] };
        start..self.ends[ray]
    }

    /// Cells of all rays.
    pub(crate) fn cells(&self) -> &[u32] {
        &self.cells
    }

    /// `P(o | F_k)` of all entries.
    pub(crate) fn likelihood(&self) -> &[f64] {
        &self.likelihood
    }

    /// The reading of a ray, in the sensor's unit.
    pub(crate) fn reading(&self, ray: usize) -> f64 {
        self.reading[ray]
    }

    /// `P(o | no cell of the ray is occupied)`.
    pub(crate) fn none(&self, ray: usize) -> f64 {
        self.none[ray]
    }
}

impl Held for Readings {
    fn held(&self) -> usize {
        let rays = self.reading.held() + self.none.held() + self.ends.held();
        self.line.held() + self.cells.held() + self.likelihood.held() + rays
    }
}
