//! One viewing ray in double precision, from the map to the posterior of its pairs.

use grid::{DigitalLine, GridSpec};
use sensor::{Ray, SensorModel};

use crate::beyond::{self, Beyond};
use crate::lateral::Across;
use crate::{Chain, RayPosterior, RayRule};

/// A ray and what its reading says. A buffer to fill again and again.
#[derive(Default)]
pub(crate) struct RayUpdate {
    pub(crate) line: DigitalLine,
    pub(crate) chain: Chain,
    pub(crate) likelihood: Vec<f64>,
    pub(crate) posterior: RayPosterior,
}

impl RayUpdate {
    /// Follows a ray with a reading to the border; `gather` reads the chain along its cells out of the map, `onset`
    /// is `u0` of an unseen world, and `across` what other rays say of the one with a number. False, and nothing is said, where it has no reading or starts outside the map.
    pub(crate) fn update(
        &mut self,
        ray: &Ray,
        spec: &GridSpec,
        (sensor, onset): (&dyn SensorModel, f64),
        across: Option<(&Across, usize)>,
        rule: RayRule,
        gather: impl FnOnce(&mut Chain, &[usize]),
    ) -> bool {
        let Some(reading) = ray.reading else { return false };
        self.line.trace(spec, ray.origin_m, ray.direction, f64::INFINITY);
        if self.line.is_empty() {
            return false;
        }
        gather(&mut self.chain, self.line.cells()); // P(e_j, e_{j+1} | O)
        self.likelihood.resize(self.line.len(), 0.0);
        sensor.likelihood(reading, ray.bearing_rad, self.line.ranges(), &mut self.likelihood); // Eq. (21)
        let beyond = Beyond::after(&self.line, ray.direction, spec.cell_m, onset);
        let none = match across {
            None => beyond::likelihood(sensor, reading, ray.bearing_rad, &beyond), // k to infinity, Eq. (7)
            Some((across, number)) => {
                across.join(number, self.line.ranges(), &mut self.likelihood);
                f64::from(across.beyond(number, beyond.from_m))
            }
        };
        rule(&self.chain, &self.likelihood, none, &mut self.posterior); // Eqs. (1), (4)-(7)
        true
    }
}
