//! How well a map predicts a reading that it has not seen: `-ln P(reading | map)`, a score that needs no truth.

use grid::{GridSpec, Raster};
use sensor::{Ray, Scan, SensorModel};

use crate::pairs::grid::PairwiseGrid;
use crate::ray::cone::{Ahead, ConeUpdate};
use crate::ray::likelihood::RayLikelihood;

/// A map that predicts readings.
#[derive(Clone, Copy)]
pub enum Belief<'a> {
    /// The first occupied cell, cells being independent of each other: `P(F_k) = p_k (1 - p_0) ... (1 - p_{k-1})`.
    Cells(&'a Raster<f64>),
    /// The same by the chain of neighbours, Eqs. (11)-(13): a cell is occupied given that the one before is free.
    Chain(&'a PairwiseGrid),
}

/// One predictive model for all maps: the likelihood of a reading, Eq. (21), over its first occupied cell, and beyond the
/// border of the map an unseen world. A buffer to use again and again.
pub struct Predictive<'a> {
    spec: GridSpec,
    sensor: &'a dyn SensorModel,
    onset: f64,
    pub(crate) ray: RayLikelihood,
    cone: ConeUpdate,
    /// The cells of the cone, nearest first; of a sensor that looks along rays, nothing.
    cells: Vec<Ahead>,
}

/// What is left ahead of a ray below this does not count.
pub(crate) const NOTHING: f64 = 1e-12;

impl<'a> Predictive<'a> {
    /// For maps of this grid; `onset` is the probability that a cell begins an obstacle in an unseen world,
    /// [`Prior::onset`](crate::Prior::onset).
    pub fn new(spec: GridSpec, sensor: &'a dyn SensorModel, onset: f64) -> Self {
        Self { spec, sensor, onset, ray: RayLikelihood::default(), cone: ConeUpdate::default(), cells: Vec::new() }
    }

    /// Takes up a ray with a reading, or the cone about it; false where there is none, or it does not start in the map.
    ///
    /// Of a cone the reading is that of the nearest occupied cell. Chains of its cells are taken to be independent of each other.
    pub fn take(&mut self, ray: &Ray) -> bool {
        if self.sensor.width_rad() <= 0.0 {
            return self.ray.take(ray, &self.spec, self.sensor, self.onset);
        }
        let Some(none) = self.cone.take(ray, &self.spec, (self.sensor, self.onset)) else { return false };
        self.ray.none = none;
        self.cone.nearest_first(&mut self.cells);
        true
    }

    /// The cells that may be the first occupied one, nearest first, and the likelihood of none.
    pub(crate) fn ahead(&self) -> (impl Iterator<Item = Ahead>, f64) {
        let RayLikelihood { line, likelihood, none } = &self.ray;
        let is_cone = self.sensor.width_rad() > 0.0;
        let (cells, likelihood) = if is_cone { (&[][..], &[][..]) } else { (line.cells(), &likelihood[..]) };
        let along = cells.iter().zip(likelihood).enumerate().map(|(k, (&cell, &likelihood))| Ahead {
            before: k.checked_sub(1).map(|before| cells[before]),
            cell,
            likelihood,
        });
        (along.chain(self.cells.iter().copied()), *none)
    }

    /// `-ln P(reading | map)` of the ray taken up last, in nats; the density of a reading is per its unit.
    pub fn log_loss(&self, map: Belief) -> f64 {
        -libm::log(self.probability(map).max(f64::MIN_POSITIVE))
    }

    /// The same, from the probability that each cell, by its index, is occupied, cells being independent of each other.
    pub(crate) fn log_loss_of_cells(&self, occupied: impl Fn(usize) -> f64) -> f64 {
        -libm::log(self.sum(|_, cell| occupied(cell)).max(f64::MIN_POSITIVE))
    }

    fn probability(&self, map: Belief) -> f64 {
        match map {
            Belief::Cells(occupancy) => self.sum(|_, cell| occupancy[cell]),
            Belief::Chain(pairs) => self.sum(|before, cell| {
                let Some(before) = before else { return pairs.marginals()[cell] };
                let edge = self.spec.edge_between(before, cell);
                let free = 1.0 - pairs.marginals()[before];
                ((pairs.marginals()[cell] - pairs.both[edge]) / free).clamp(0.0, 1.0)
            }),
        }
    }

    /// The likelihood over the first occupied cell; `begins` is the probability of a cell, given that all before it, the last of which
    /// it is given too, are free.
    fn sum(&self, begins: impl Fn(Option<usize>, usize) -> f64) -> f64 {
        let (ahead, none) = self.ahead();
        let (mut sum, mut clear) = (0.0, 1.0);
        for Ahead { before, cell, likelihood } in ahead {
            let begins = begins(before, cell);
            sum += clear * begins * likelihood;
            clear *= 1.0 - begins;
            if clear < NOTHING {
                return sum;
            }
        }
        sum + clear * none
    }
}

/// `ln P(readings of the scan | map)` of cells that are independent of each other, nats, as [`Mapper::evidence`](crate::Mapper::evidence);
/// none of a scan that starts outside the map.
pub(crate) fn evidence_of_cells(
    scan: &Scan,
    spec: GridSpec,
    (sensor, onset): (&dyn SensorModel, f64),
    occupied: impl Fn(usize) -> f64,
) -> Option<f64> {
    spec.locate(scan.pose.position_m())?;
    let mut predictive = Predictive::new(spec, sensor, onset);
    let taken = |ray: Ray| predictive.take(&ray).then(|| -predictive.log_loss_of_cells(&occupied));
    Some(scan.rays().filter_map(taken).sum())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::ray::chain::Chain;
    use crate::{Mapper as _, Model, Visibility};
    use proptest::prelude::*;
    use sensor::{Kernel as _, Laser, Pose, Sonar};

    fn row(width: usize) -> GridSpec {
        GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width, height: 1 }
    }

    fn beam(reading: f64) -> Scan {
        let pose = Pose { x_m: 0.03, y_m: 0.05, theta_rad: 0.0 };
        Scan { sensor: 0, time_s: 0.0, pose, bearings_rad: vec![0.0], readings: vec![Some(reading)] }
    }

    proptest! {
        /// All states of the row, and what lies beyond.
        #[test]
        fn it_is_the_sum_over_all_states(p in prop::collection::vec(0.0f64..1.0, 1..10), reading in 0.0f64..1.5, none: bool) {
            let (spec, laser) = (row(p.len()), Laser::default());
            let ray = beam(if none { f64::INFINITY } else { reading }).rays().next().expect("one");
            let mut predictive = Predictive::new(spec, &laser, 0.02);
            prop_assert!(predictive.take(&ray));
            let expected: f64 = (0..1u32 << p.len())
                .map(|states| {
                    let occupied = |k: usize| states >> k & 1 == 1;
                    let weight: f64 = (0..p.len()).map(|k| if occupied(k) { p[k] } else { 1.0 - p[k] }).product();
                    let first = (0..p.len()).find(|k| occupied(*k));
                    weight * first.map_or(predictive.ray.none, |k| predictive.ray.likelihood[k])
                })
                .sum();
            let map = Raster::new(spec, p);
            prop_assert!((predictive.probability(Belief::Cells(&map)) / expected - 1.0).abs() < 1e-9);
        }

        /// The evidence of the mapper that would take the reading next.
        #[test]
        fn by_the_chain_it_is_the_evidence(width in 1usize..40, first in 0.0f64..4.0, second in 0.0f64..4.0) {
            let laser = Laser::default();
            let setup = Model::new(row(width), Arc::new(laser));
            let mut mapper = Visibility::exact(&setup);
            mapper.integrate(&beam(first));
            let ray = beam(second).rays().next().expect("one");
            let onset = setup.prior.onset(0.1);
            let mut predictive = Predictive::new(setup.grid, &laser, onset);
            prop_assert!(predictive.take(&ray));
            let mut posterior = crate::pairs::posterior::RayPosterior::default();
            let pairs = mapper.pairs();
            let (cells, mut likelihood) = (predictive.ray.line.cells(), vec![0.0; width]);
            laser.likelihood(second, 0.0, predictive.ray.line.ranges(), &mut likelihood);
            let both = cells.windows(2).map(|pair| pairs.both[setup.grid.edge_between(pair[0], pair[1])]).collect();
            let chain = crate::ray::chain::Chain::new(cells.iter().map(|cell| pairs.marginals()[*cell]).collect(), both);
            crate::ray::exact::posterior(&chain, &likelihood, predictive.ray.none, &mut posterior);
            let found = predictive.log_loss(Belief::Chain(pairs));
            prop_assert!((found + posterior.evidence.ln()).abs() < 1e-8, "{found} {}", posterior.evidence);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        /// A cone by its chains: the evidence by which the mapper of chains is updated, and with cells that are independent of each other the
        /// sum over the nearest occupied cell.
        #[test]
        fn of_a_cone_it_is_the_evidence_of_its_chains(
            p in prop::collection::vec(0.01f64..0.6, 100), share in 0.0f64..1.0, reading in 0.1f64..1.2, none: bool, turn in 0.0f64..6.2,
        ) {
            let spec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: 10, height: 10 };
            let sonar = Sonar { width_rad: 0.8, range_sigma_m: 0.08, max_range_m: 1.5, ..Sonar::default() };
            let reading = if none { f64::INFINITY } else { reading };
            let ray = Ray { origin_m: [0.52, 0.47], direction: [turn.cos(), turn.sin()], bearing_rad: 0.0, reading: Some(reading) };
            let mut predictive = Predictive::new(spec, &sonar, 0.02);
            prop_assert!(predictive.take(&ray));
            // Joints between the least and the most that the marginals allow.
            let mut pairs = PairwiseGrid::prior(spec, &crate::Prior::default());
            for (cell, p) in p.iter().enumerate() {
                pairs.marginal[cell] = *p;
            }
            for cell in 0..spec.cells() {
                for n in spec.neighbours(cell).filter(|n| n.cell > cell) {
                    let [a, b] = [p[cell], p[n.cell]];
                    let [low, high] = [(a + b - 1.0f64).max(0.0), a.min(b)];
                    pairs.both[spec.edge_between(cell, n.cell)] = low + share * (high - low);
                }
            }
            let mut cone = ConeUpdate::default();
            let gather = |chain: &mut Chain, cells: &[usize]| chain.gather(&pairs, cells);
            let is_taken = cone.update(&ray, &spec, (&sonar, 0.02), crate::ray::exact::posterior, gather, |_, _| {});
            prop_assert!(is_taken);
            let found = predictive.log_loss(Belief::Chain(&pairs));
            prop_assert!((found + cone.evidence.ln()).abs() < 1e-8, "{} {}", found, cone.evidence);
            let map = Raster::new(spec, p.clone());
            let (ahead, none) = predictive.ahead();
            let all: Vec<Ahead> = ahead.collect();
            let first = |k: usize| p[all[k].cell] * all[..k].iter().map(|before| 1.0 - p[before.cell]).product::<f64>();
            let clear: f64 = all.iter().map(|ahead| 1.0 - p[ahead.cell]).product();
            let expected = (0..all.len()).map(|k| first(k) * all[k].likelihood).sum::<f64>() + clear * none;
            prop_assert!((predictive.log_loss(Belief::Cells(&map)) + expected.ln()).abs() < 1e-9);
        }
    }

    #[test]
    fn rays_that_say_nothing_are_not_taken() {
        let laser = Laser::default();
        let mut predictive = Predictive::new(row(3), &laser, 0.02);
        let ray = beam(0.2).rays().next().expect("one");
        assert!(
            !predictive.take(&Ray { reading: None, ..ray }) && !predictive.take(&Ray { origin_m: [5.0, 0.0], ..ray })
        );
    }
}
