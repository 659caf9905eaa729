//! One viewing ray in double precision, from the map to the posterior of its pairs.

use grid::GridSpec;
use sensor::{Ray, SensorModel};

use crate::memory::Held;
use crate::pairs::posterior::RayPosterior;
use crate::ray::bearing_chain::BearingChain;
use crate::ray::chain::Chain;
use crate::ray::likelihood::RayLikelihood;

/// A rule for one ray: from the chain, `P(o | F_k)` and the likelihood past the last cell to the
/// posterior of every pair.
pub type RayRule = fn(&Chain, &[f64], f64, &mut RayPosterior);

/// A ray and the posterior of its reading. A buffer to fill again and again.
#[derive(Clone, Default)]
pub(crate) struct RayUpdate {
    pub(crate) ray: RayLikelihood,
    chain: Chain,
    pub(crate) posterior: RayPosterior,
}

impl RayUpdate {
    /// Follows a ray with a reading to the border; `gather` reads the chain along its cells out of the map, `onset`
    /// is `u0` of an unseen world, and `others` what other rays make of the end of the one with a number. False, and nothing is
    /// updated, where it has no reading or starts outside the map.
    pub(crate) fn update(
        &mut self,
        ray: &Ray,
        spec: &GridSpec,
        (sensor, onset): (&dyn SensorModel, f64),
        others: Option<(&BearingChain, usize)>,
        rule: RayRule,
        gather: impl FnOnce(&mut Chain, &[usize]),
    ) -> bool {
        if !self.ray.take(ray, spec, sensor, onset) {
            return false;
        }
        let RayLikelihood { line, likelihood, none } = &mut self.ray;
        if let (Some((others, number)), Some(end_m)) = (others, line.ranges().last()) {
            others.join(number, line.ranges(), likelihood);
            *none = f64::from(others.past_the_map(number, *end_m));
        }
        gather(&mut self.chain, line.cells()); // P(e_j, e_{j+1} | O)
        rule(&self.chain, likelihood, *none, &mut self.posterior); // Eqs. (1), (4)-(7)
        true
    }
}

impl Held for RayUpdate {
    fn held(&self) -> usize {
        self.ray.held() + self.chain.held() + self.posterior.held()
    }
}
