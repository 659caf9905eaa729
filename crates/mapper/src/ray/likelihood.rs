//! The likelihood of one reading for every cell of its ray.

use grid::{DigitalLine, GridSpec};
use sensor::{Ray, SensorModel};

use crate::memory::Held;
use crate::ray::past_the_map::{self, PastTheMap};

/// A ray over a map, and how its reading comes about. A buffer to fill again and again.
#[derive(Debug, Clone, Default)]
pub(crate) struct RayLikelihood {
    /// The cells, to the border.
    pub(crate) line: DigitalLine,
    /// `P(o | F_k)` of every cell, per unit of the reading.
    pub(crate) likelihood: Vec<f64>,
    /// `P(o | no cell of the ray is occupied)`.
    pub(crate) none: f64,
}

impl RayLikelihood {
    /// Takes up a ray with a reading; `onset` is `u0` of an unseen world. False where there is no reading, or the ray starts
    /// outside the map.
    pub(crate) fn take(&mut self, ray: &Ray, spec: &GridSpec, sensor: &dyn SensorModel, onset: f64) -> bool {
        let Some(reading) = ray.reading else { return false };
        self.line.trace(spec, ray.origin_m, ray.direction, f64::INFINITY);
        if self.line.is_empty() {
            return false;
        }
        self.likelihood.resize(self.line.len(), 0.0);
        sensor.likelihood(reading, ray.bearing_rad, self.line.ranges(), &mut self.likelihood); // Eq. (21)
        let past = PastTheMap::after(&self.line, ray.direction, spec.cell_m, onset);
        self.none = past_the_map::likelihood(sensor, reading, ray.bearing_rad, &past); // k to infinity, Eq. (7)
        true
    }
}

impl Held for RayLikelihood {
    fn held(&self) -> usize {
        self.line.held() + self.likelihood.held()
    }
}
