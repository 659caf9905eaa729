//! Continuity without occlusion: the ablation that completes the paper's method, `independent` and
//! `conventional` to a square.
//!
//! Every cell has likelihoods of its own, as in the conventional rule, so the ray is a hidden Markov
//! chain: prior pairs from the map, one unary per cell. Its posterior is the forward-backward recursion
//! of Rabiner, "A tutorial on hidden Markov models", Proceedings of the IEEE 77, 1989.

mod bundle;

use grid::{DigitalLine, Raster};
use sensor::Scan;
use sensor::lanes::LANES;

use self::bundle::Bundle;
use crate::mapper::{Mapper, Work};
use crate::memory::Held;
use crate::model::{Model, Sensors};
use crate::pairs::grid::PairwiseGrid;
use crate::pairs::joint::Joint;
use crate::pairs::moments::Moments;
use crate::pairs::posterior::RayPosterior;
use crate::pairs::reconcile::Reconciliation;
use crate::ray::chain::Chain;
use crate::rules::conventional::{Along, ConventionalRule};

/// Updates the pairs along one ray with likelihoods of every cell by itself.
///
/// `unaries[k]` holds the likelihoods of what was seen at cell `k` if it is occupied and if it is free;
/// only their ratio matters, and two zeros count as equal. `posterior.evidence` becomes the probability of
/// all unaries together, which may underflow to 0. States that the unaries rule out altogether leave
/// the pairs as they were. O(cells).
///
/// # Panics
/// If the chain is empty, or there is not one pair of likelihoods per cell.
pub fn posterior(chain: &Chain, unaries: &[[f64; 2]], posterior: &mut RayPosterior) {
    assert!(!chain.is_empty(), "a ray has at least one cell");
    assert_eq!(chain.len(), unaries.len(), "one pair of likelihoods per cell");
    let mut behind = std::mem::take(&mut posterior.scratch);
    backward(chain, unaries, &mut behind);
    posterior.pairs.clear();
    let p = chain.occupied(0);
    let [occupied, free] = relative(unaries[0]);
    let (mut front, mut evidence) = normalised([p * occupied, (1.0 - p) * free]);
    let (first, last) = normalised([front[0] * behind[0], front[1] * behind[1]]);
    posterior.first = first[0];
    let mut possible = last > 0.0;
    for j in 0..chain.len() - 1 {
        let (t, u) = (chain.stays_occupied(j), chain.becomes_occupied(j));
        let [occupied, free] = relative(unaries[j + 1]);
        let ahead = Joint {
            ee: front[0] * t * occupied,
            ef: front[0] * (1.0 - t) * free,
            fe: front[1] * u * occupied,
            ff: front[1] * (1.0 - u) * free,
        };
        let [yes, no] = [behind[2 * j + 2], behind[2 * j + 3]];
        let pair = Joint { ee: ahead.ee * yes, ef: ahead.ef * no, fe: ahead.fe * yes, ff: ahead.ff * no };
        possible &= pair.total() > 0.0;
        posterior.pairs.push(pair.scaled(1.0 / pair.total()));
        let (next, weight) = normalised([ahead.second(), ahead.ef + ahead.ff]);
        front = next;
        evidence *= weight;
    }
    posterior.evidence = evidence;
    if !possible {
        posterior.evidence = 0.0;
        chain.keep(posterior);
    }
    posterior.scratch = behind;
}

/// Likelihood of the unaries behind each cell if it is occupied and if it is free, up to a factor.
fn backward(chain: &Chain, unaries: &[[f64; 2]], behind: &mut Vec<f64>) {
    behind.clear();
    behind.resize(2 * chain.len(), 1.0);
    for j in (0..chain.len() - 1).rev() {
        let (t, u) = (chain.stays_occupied(j), chain.becomes_occupied(j));
        let [occupied, free] = relative(unaries[j + 1]);
        let (yes, no) = (occupied * behind[2 * j + 2], free * behind[2 * j + 3]);
        let (scaled, _) = normalised([t * yes + (1.0 - t) * no, u * yes + (1.0 - u) * no]);
        behind[2 * j..2 * j + 2].copy_from_slice(&scaled);
    }
}

/// Two zeros count as equal.
fn relative(unary: [f64; 2]) -> [f64; 2] {
    if unary[0] + unary[1] > 0.0 { unary } else { [1.0; 2] }
}

/// Scaled to add up to one, and the sum.
fn normalised([a, b]: [f64; 2]) -> ([f64; 2], f64) {
    let sum = a + b;
    if sum > 0.0 { ([a / sum, b / sum], sum) } else { ([0.0; 2], 0.0) }
}

/// The paper's grid and reconciliation with the conventional likelihoods of each cell, Eqs. (23)-(26);
/// cells behind the reading have none. O(cells on the ray) per ray.
#[derive(Clone)]
pub struct NoOcclusion {
    pairs: PairwiseGrid,
    sensors: Sensors,
    /// The rule of every sensor.
    rules: Vec<ConventionalRule>,
    reconciliation: Reconciliation,
    lines: [DigitalLine; LANES],
    along: Along,
    bundle: Bundle,
    chain: Chain,
    posterior: RayPosterior,
    moments: Moments,
    cells: u64,
}

impl NoOcclusion {
    /// The unseen map, and every sensor's bin: the paper's of 1 px for its camera.
    pub fn new(model: &Model) -> Self {
        Self {
            pairs: PairwiseGrid::prior(model.grid, &model.prior),
            sensors: model.sensors.clone(),
            rules: ConventionalRule::default().for_sensors(model),
            reconciliation: model.reconciliation,
            lines: Default::default(),
            along: Along::default(),
            bundle: Bundle::default(),
            chain: Chain::default(),
            posterior: RayPosterior::default(),
            moments: Moments::new(model.grid),
            cells: 0,
        }
    }

    /// Updates so many rays, and adds what came out in their order.
    fn update(&mut self, bundled: usize) {
        self.bundle.update();
        for (lane, line) in self.lines[..bundled].iter().enumerate() {
            if let Some(posterior) = self.bundle.moments(lane) {
                self.moments.add_moments(line.cells(), &posterior); // Eq. (20)
            } else {
                self.chain.gather(&self.pairs, line.cells());
                self.chain.keep(&mut self.posterior);
                self.moments.add(line.cells(), &self.posterior);
            }
        }
        self.bundle.clear();
    }

    /// The map with its joint probabilities.
    pub fn pairs(&self) -> &PairwiseGrid {
        &self.pairs
    }
}

impl Mapper for NoOcclusion {
    fn integrate(&mut self, scan: &Scan) {
        let sensor = std::sync::Arc::clone(self.sensors.of(scan));
        let rule = self.rules[scan.sensor];
        let mut bundled = 0;
        for ray in scan.rays() {
            let Some(reading) = ray.reading else { continue };
            let line = &mut self.lines[bundled];
            line.trace(self.pairs.spec(), ray.origin_m, ray.direction, f64::INFINITY);
            if line.is_empty() {
                continue;
            }
            rule.along(&*sensor, reading, ray.bearing_rad, line.ranges(), &mut self.along); // Eqs. (23)-(26)
            self.along.likelihoods.resize(line.len(), [1.0; 2]);
            self.bundle.gather(bundled, &self.pairs, line, &self.along.likelihoods);
            self.cells += line.len() as u64;
            bundled += 1;
            if bundled == LANES {
                self.update(std::mem::take(&mut bundled));
            }
        }
        self.update(bundled);
        self.pairs.reconcile(&mut self.moments, self.reconciliation); // Eqs. (18)-(20)
        debug_assert_eq!(self.pairs.check(), Ok(()));
    }

    fn occupancy(&self) -> &Raster<f64> {
        self.pairs.marginals()
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(self.clone()))
    }

    fn work(&self) -> Work {
        let lines: usize = self.lines.iter().map(Held::held).sum();
        let rays = lines + self.along.held() + self.bundle.held() + self.chain.held() + self.posterior.held();
        Work { cells: self.cells, bytes: self.pairs.held() + self.moments.held() + rays }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::GridSpec;
    use proptest::prelude::*;
    use sensor::{Laser, Pose, SensorModel, Stereo};
    use std::sync::Arc;

    /// The rule ray by ray.
    fn ray_by_ray(model: &Model, scans: &[Scan]) -> PairwiseGrid {
        let mut pairs = PairwiseGrid::prior(model.grid, &model.prior);
        let mut moments = Moments::new(model.grid);
        let rules = ConventionalRule::default().for_sensors(model);
        for scan in scans {
            let (sensor, rule) = (&**model.sensors.of(scan), rules[scan.sensor]);
            for ray in scan.rays() {
                let mut line = DigitalLine::default();
                line.trace(&model.grid, ray.origin_m, ray.direction, f64::INFINITY);
                let Some(reading) = ray.reading.filter(|_| !line.is_empty()) else { continue };
                let mut chain = Chain::default();
                chain.gather(&pairs, line.cells());
                let seen = line.ranges().windows(2).map(|chord| {
                    rule.likelihoods(sensor, reading, ray.bearing_rad, chord[0], chord[1]).unwrap_or([1.0; 2])
                });
                let mut after = RayPosterior::default();
                posterior(&chain, &seen.collect::<Vec<_>>(), &mut after);
                moments.add(line.cells(), &after);
            }
            pairs.reconcile(&mut moments, model.reconciliation);
        }
        pairs
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

        /// To the bit, marginals and joints: any number of rays, readings at the sensor, beyond the map and without range, none, bearings behind
        /// the camera, sensors that rule states out.
        #[test]
        fn rays_in_lockstep_are_rays_one_by_one(
            (width, height) in (1usize..50, 1usize..40), at in prop::array::uniform2(-0.1f64..1.1), theta_rad in -4.0f64..4.0,
            rays in prop::collection::vec((-2.0f64..2.0, prop_oneof![
                5 => (0.0f64..5.0).prop_map(Some), 2 => (0.0f64..70.0).prop_map(Some), 1 => Just(Some(0.0)), 1 => Just(Some(f64::INFINITY)), 1 => Just(None),
            ]), 1..25),
            correct_match in prop_oneof![3 => 0.5f64..0.99, 1 => Just(1.0), 1 => Just(0.0)], touched: bool, correlation in 0.0f64..1.0, laser: bool,
        ) {
            let grid = GridSpec { cell_m: 0.05, origin_m: [1.0, -0.3], width, height };
            let sensor: Arc<dyn SensorModel> = match laser {
                true => Arc::new(Laser { hit: correct_match, no_echo: 0.0, max_range_m: 1.5, ..Laser::default() }),
                false => Arc::new(Stereo { correct_match, ..Stereo::default() }),
            };
            let prior = crate::Prior { correlation, ..crate::Prior::default() };
            let reconciliation = if touched { Reconciliation::Touched } else { Reconciliation::AllEdges };
            let model = Model { prior, reconciliation, ..Model::new(grid, sensor) };
            let [x_m, y_m] = [0, 1].map(|k| grid.origin_m[k] + 0.05 * at[k] * [width, height][k] as f64);
            let (bearings_rad, readings): (Vec<f64>, Vec<Option<f64>>) = rays.into_iter().unzip();
            let scan = Scan { sensor: 0, time_s: 0.0, pose: Pose { x_m, y_m, theta_rad }, bearings_rad, readings };
            let turned = Scan { pose: Pose { theta_rad: theta_rad + 1.0, ..scan.pose }, ..scan.clone() };
            let scans = [scan, turned];
            let mut mapper = NoOcclusion::new(&model);
            scans.iter().for_each(|scan| mapper.integrate(scan));
            let expected = ray_by_ray(&model, &scans);
            let bits = |values: &[f64]| values.iter().map(|p| p.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(mapper.pairs().marginal.values()), bits(expected.marginal.values()));
            prop_assert_eq!(bits(&mapper.pairs().both), bits(&expected.both));
        }
    }
}
