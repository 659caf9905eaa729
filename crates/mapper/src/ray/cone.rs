//! One reading from a cone: the nearest of several rays, exactly.
//!
//! The cells of the cone are dealt to chains that run outwards and share no cell. The reading explains the nearest occupied cell of all
//! chains, `F`. As long as cells of different chains are independent of each other, what lies before a cell is free with the
//! product of the chains' own probabilities, `P(F > k) = prod_l S_l[k]`, and for the states of one chain the reading has a
//! likelihood that depends on its first occupied cell `i` alone:
//!
//! ```text
//! L_l(i) = sum over cells k of other chains that are nearer than i: P(k is the nearest of these) P(o | F_k)
//!        + prod over other chains m of S_m[i] P(o | F_i)
//! ```
//!
//! With that, the chain is updated as a ray by itself is (Eqs. (1)-(7)). It costs as many steps for each chain as the cone has cells.
//! `tests/cone.rs` is the oracle: all states of all chains. What is neglected is what neighbouring chains know of each other.

use std::collections::HashSet;

use grid::{DigitalLine, GridSpec};
use sensor::{Ray, SensorModel};

use crate::memory::Held;
use crate::pairs::posterior::RayPosterior;
use crate::ray::chain::Chain;
use crate::ray::past_the_map::{self, PastTheMap};
use crate::ray::update::RayRule;

/// A cone is halved at most so often: into 64 parts.
const MOST_HALVINGS: u32 = 6;

/// The most chains that a cone has.
pub(crate) const MOST_CHAINS: usize = (1 << MOST_HALVINGS) + 1;

/// A part of the cells of a cone, one behind the other.
#[derive(Debug, Clone, Default)]
pub(crate) struct Strand {
    /// The cells, nearest first.
    pub(crate) cells: Vec<usize>,
    /// Where the chain enters each, and leaves the last, m.
    ranges: Vec<f64>,
    /// `P(o | F_k)` of each.
    likelihood: Vec<f64>,
    chain: Chain,
}

/// A reading from a cone and what it makes of it. A buffer to fill again and again.
#[derive(Debug, Clone, Default)]
pub(crate) struct ConeUpdate {
    strands: Vec<Strand>,
    line: DigitalLine,
    posterior: RayPosterior,
    /// `P(o | O)`, per unit of the reading.
    pub(crate) evidence: f64,
    /// Range up to which it has moved cells, m.
    pub(crate) end_m: f64,
}

/// A cell that may be the first that is occupied.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ahead {
    /// The one before it on its ray or chain.
    pub(crate) before: Option<usize>,
    pub(crate) cell: usize,
    /// `P(o | F_k)`, per unit of the reading.
    pub(crate) likelihood: f64,
}

/// The rays along which the cells of the cone about a ray are dealt, those first that are farthest apart: so many that beside each
/// other they are a cell apart as far as cells are told apart. The ray itself, of a sensor that looks along it.
pub(crate) fn fan(ray: &Ray, sensor: &dyn SensorModel, spec: &GridSpec) -> impl Iterator<Item = Ray> + use<> {
    let (ray, width_rad) = (*ray, sensor.width_rad());
    let is_cone = width_rad > 0.0;
    let reach_m = if is_cone { reach_m(&ray, sensor, spec) } else { 0.0 };
    let parts = (width_rad * reach_m / spec.cell_m).clamp(1.0, f64::from(1u32 << MOST_HALVINGS));
    let halvings = libm::ceil(libm::log2(parts)) as u32;
    // The edges, the axis, and then what is between them.
    let level = |level: u32| (0..1u32 << (level - 1)).map(move |k| f64::from(2 * k + 1) / f64::from(1u32 << level));
    let places = [0.0, 1.0].into_iter().chain((1..=halvings.max(1)).flat_map(level));
    places.take(if is_cone { MOST_CHAINS } else { 1 }).map(move |place| {
        let (sin, cos) = libm::sincos(width_rad * (place - 0.5));
        let [x, y] = ray.direction;
        Ray { direction: [x * cos - y * sin, x * sin + y * cos], ..ray }
    })
}

/// Range up to which the cells of a cone are told apart, m: what lies behind learns nothing from its reading.
fn reach_m(ray: &Ray, sensor: &dyn SensorModel, spec: &GridSpec) -> f64 {
    let diagonal_m = libm::hypot(spec.width as f64, spec.height as f64) * spec.cell_m;
    ray.reading.map_or(0.0, |reading| sensor.constant_from(reading, ray.bearing_rad)).min(diagonal_m)
}

impl ConeUpdate {
    /// Updates the chains of the cone about a ray with its reading; `gather` reads a chain along cells out of the map, `onset` is `u0`
    /// of an unseen world, and `add` is given every chain's cells and posterior. False, and nothing is added, where there is no reading or
    /// the cone starts outside the map.
    pub(crate) fn update(
        &mut self,
        ray: &Ray,
        spec: &GridSpec,
        (sensor, onset): (&dyn SensorModel, f64),
        rule: RayRule,
        gather: impl Fn(&mut Chain, &[usize]),
        mut add: impl FnMut(&[usize], &RayPosterior),
    ) -> bool {
        let Some(none) = self.take(ray, spec, (sensor, onset)) else { return false };
        self.strands.iter_mut().for_each(|strand| gather(&mut strand.chain, &strand.cells));
        let parts: Vec<Part> = self.strands.iter().map(Strand::part).collect();
        let own = likelihoods(&parts, none);
        for (strand, own) in self.strands.iter().zip(&own) {
            rule(&strand.chain, &own.cells, own.none, &mut self.posterior);
            self.evidence = self.posterior.evidence;
            add(&strand.cells, &self.posterior);
        }
        true
    }

    /// Takes up the cone about a ray with a reading: `P(o | F_k)` of its cells, and `P(o | no cell of the cone is occupied)`, which it gives. None
    /// where there is no reading, or the cone starts outside the map.
    pub(crate) fn take(&mut self, ray: &Ray, spec: &GridSpec, (sensor, onset): (&dyn SensorModel, f64)) -> Option<f64> {
        let reading = ray.reading?;
        self.deal(ray, spec, sensor);
        if self.strands.is_empty() {
            return None;
        }
        for strand in &mut self.strands {
            strand.likelihood.resize(strand.cells.len(), 0.0);
            sensor.likelihood(reading, ray.bearing_rad, &strand.ranges, &mut strand.likelihood);
        }
        self.end_m = self.strands.iter().filter_map(|strand| strand.ranges.last()).fold(0.0, |far, end| far.max(*end));
        // Past the map, each chain goes on.
        let onset = 1.0 - libm::pow(1.0 - onset, self.strands.len() as f64);
        let past = PastTheMap::at(self.end_m, ray.direction, spec.cell_m, onset);
        Some(past_the_map::likelihood(sensor, reading, ray.bearing_rad, &past))
    }

    /// The cells of the cone that was taken up last, nearest first; those at one range in the order of their chains.
    pub(crate) fn nearest_first(&self, into: &mut Vec<Ahead>) {
        into.clear();
        let mut order: Vec<[usize; 2]> =
            (0..self.strands.len()).flat_map(|l| (0..self.strands[l].cells.len()).map(move |k| [l, k])).collect();
        let range = |[l, k]: [usize; 2]| self.strands[l].ranges[k];
        order.sort_by(|a, b| range(*a).total_cmp(&range(*b)).then(a[0].cmp(&b[0])));
        into.extend(order.into_iter().map(|[l, k]| {
            let strand = &self.strands[l];
            let before = k.checked_sub(1).map(|before| strand.cells[before]);
            Ahead { before, cell: strand.cells[k], likelihood: strand.likelihood[k] }
        }));
    }

    /// Deals the cells of the cone to chains: each takes those on its ray that lie behind all that were dealt before.
    fn deal(&mut self, ray: &Ray, spec: &GridSpec, sensor: &dyn SensorModel) {
        let reach_m = reach_m(ray, sensor, spec);
        let mut dealt: HashSet<usize> = HashSet::new();
        let mut strands = std::mem::take(&mut self.strands).into_iter();
        let mut filled = Vec::new();
        for ray in fan(ray, sensor, spec) {
            self.line.trace(spec, ray.origin_m, ray.direction, f64::INFINITY);
            let (cells, ranges) = (self.line.cells(), self.line.ranges());
            let from = cells.iter().rposition(|cell| dealt.contains(cell)).map_or(0, |last| last + 1);
            if from >= cells.len() || ranges[from] > reach_m {
                continue;
            }
            let mut strand = strands.next().unwrap_or_default();
            strand.cells.clear();
            strand.cells.extend_from_slice(&cells[from..]);
            strand.ranges.clear();
            strand.ranges.extend_from_slice(&ranges[from..]);
            dealt.extend(&cells[from..]);
            filled.push(strand);
        }
        self.strands = filled;
    }

    /// Cells of all chains.
    pub(crate) fn cells(&self) -> u64 {
        self.strands.iter().map(|strand| strand.cells.len() as u64).sum()
    }
}

/// A chain of a cone.
#[derive(Debug, Clone, Copy)]
pub struct Part<'a> {
    /// What is known of its cells, nearest first.
    pub chain: &'a Chain,
    /// Range at which each begins, m, which never falls; one longer than the chain, or as long.
    pub ranges: &'a [f64],
    /// `P(o | F_k)` of each, per unit of the reading.
    pub likelihood: &'a [f64],
}

impl Strand {
    fn part(&self) -> Part<'_> {
        Part { chain: &self.chain, ranges: &self.ranges, likelihood: &self.likelihood }
    }
}

/// The likelihood of a cone's reading for one of its chains.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnLikelihood {
    /// Where the chain's first occupied cell is each of its cells, whatever is in the others.
    pub cells: Vec<f64>,
    /// Where it has none.
    pub none: f64,
}

/// `L_l` of every chain, with `none` for a reading of a cone without any occupied cell; all per unit of the reading. Cells at the same
/// range count in the order of their chains.
pub fn likelihoods(parts: &[Part], none: f64) -> Vec<OwnLikelihood> {
    // S_l before each cell of a chain, and behind its last.
    let clear: Vec<Vec<f64>> = parts.iter().map(|part| survival(part.chain)).collect();
    let mut order: Vec<[usize; 2]> =
        (0..parts.len()).flat_map(|l| (0..parts[l].chain.len()).map(move |k| [l, k])).collect();
    order.sort_by(|[l, j], [m, k]| parts[*l].ranges[*j].total_cmp(&parts[*m].ranges[*k]).then(l.cmp(m)));
    // Before each cell in this order, the product of S of the chains up to one, and of those from one on.
    let mut now = vec![1.0; parts.len()];
    let mut before = vec![vec![1.0; order.len() + 1]; parts.len() + 1];
    let mut behind = before.clone();
    for t in 0..=order.len() {
        for l in 0..parts.len() {
            before[l + 1][t] = before[l][t] * now[l];
            let back = parts.len() - 1 - l;
            behind[back][t] = behind[back + 1][t] * now[back];
        }
        if let Some(&[l, k]) = order.get(t) {
            now[l] = clear[l][k + 1];
        }
    }
    let of = |l: usize| {
        let others = |t: usize| before[l][t] * behind[l + 1][t];
        let mut own = OwnLikelihood { cells: Vec::with_capacity(parts[l].chain.len()), none: 0.0 };
        let mut nearer = 0.0;
        for (t, &[m, k]) in order.iter().enumerate() {
            match m == l {
                true => own.cells.push(nearer + others(t) * parts[l].likelihood[k]),
                // What the others lose of being clear, they have hit here.
                false => nearer += (others(t) - others(t + 1)).max(0.0) * parts[m].likelihood[k],
            }
        }
        own.none = nearer + others(order.len()) * none;
        own
    };
    (0..parts.len()).map(of).collect()
}

/// Probability that all cells before each are free, and that all are.
fn survival(chain: &Chain) -> Vec<f64> {
    let mut clear = vec![1.0];
    if !chain.is_empty() {
        clear.push(1.0 - chain.occupied(0));
    }
    for j in 1..chain.len() {
        clear.push(clear[j] * (1.0 - chain.becomes_occupied(j - 1)));
    }
    clear
}

impl Held for ConeUpdate {
    fn held(&self) -> usize {
        let strand = |strand: &Strand| {
            strand.cells.held() + strand.ranges.held() + strand.likelihood.held() + strand.chain.held()
        };
        self.strands.iter().map(strand).sum::<usize>() + self.line.held() + self.posterior.held()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::prior::Prior;
    use crate::pairs::grid::PairwiseGrid;
    use crate::ray::exact;
    use proptest::prelude::*;
    use sensor::{Kernel as _, Sonar};

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]
        #[test]
        fn chains_share_no_cell_and_leave_few_out(
            x in 0.5f64..3.5, y in 0.5f64..3.5, turn in 0.0f64..6.3, width_rad in 0.05f64..1.5, reading in 0.3f64..5.0,
        ) {
            let spec = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 80, height: 80 };
            let sonar = Sonar { width_rad, ..Sonar::default() };
            let direction = [turn.cos(), turn.sin()];
            let ray = Ray { origin_m: [x, y], direction, bearing_rad: 0.0, reading: Some(reading) };
            let mut cone = ConeUpdate::default();
            cone.deal(&ray, &spec, &sonar);
            prop_assert!(cone.strands.len() <= MOST_CHAINS);
            let mut all = HashSet::new();
            for strand in &cone.strands {
                prop_assert_eq!(strand.ranges.len(), strand.cells.len() + 1);
                prop_assert!(strand.ranges.is_sorted());
                prop_assert!(strand.cells.iter().all(|cell| all.insert(*cell)), "no cell twice");
                let next_to = |pair: &[usize]| spec.neighbours(pair[0]).any(|n| n.cell == pair[1]);
                prop_assert!(strand.cells.windows(2).all(next_to), "one behind the other");
            }
            // Cells whose centre lies in the cone, not too near and not behind the reading.
            let inside = |cell: &usize| {
                let centre = spec.centre(*cell);
                let to = [centre[0] - x, centre[1] - y];
                let range = libm::hypot(to[0], to[1]);
                let along = (to[0] * direction[0] + to[1] * direction[1]) / range;
                range > 0.2 && range < reading && along > (0.5 * width_rad).cos()
            };
            let cells: Vec<usize> = (0..spec.cells()).filter(inside).collect();
            let told = cells.iter().filter(|cell| all.contains(cell)).count();
            prop_assert!(told as f64 >= 0.7 * cells.len() as f64 - 2.0, "{told} of {}", cells.len());
        }
    }

    /// One reading of a wide cone does not mark its whole arc, and clears what is before it.
    #[test]
    fn an_arc_is_somewhere_occupied_and_nowhere_surely() {
        let spec = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 80, height: 80 };
        let prior = Prior { occupancy: 0.05, ..Prior::default() };
        let (map, sonar) = (PairwiseGrid::prior(spec, &prior), Sonar::default());
        let ray = Ray { origin_m: [0.5, 2.0], direction: [1.0, 0.0], bearing_rad: 0.0, reading: Some(2.0) };
        let mut after = vec![None; spec.cells()];
        let mut cone = ConeUpdate::default();
        let gather = |chain: &mut Chain, cells: &[usize]| chain.gather(&map, cells);
        let onset = prior.onset(spec.cell_m);
        let add = |cells: &[usize], posterior: &RayPosterior| {
            cells.iter().zip(posterior.marginals()).for_each(|(cell, p)| after[*cell] = Some(p));
        };
        assert!(cone.update(&ray, &spec, (&sonar, onset), exact::posterior, gather, add));
        let range = |cell: usize| {
            let [x, y] = spec.centre(cell);
            libm::hypot(x - 0.5, y - 2.0)
        };
        let at = |from: f64, to: f64| (0..spec.cells()).filter(move |cell| range(*cell) > from && range(*cell) < to);
        let p = |from: f64, to: f64| at(from, to).filter_map(|cell| after[cell]).collect::<Vec<f64>>();
        let arc = p(1.9, 2.1);
        assert!(arc.len() > 40 && arc.iter().all(|p| *p < 0.35), "{arc:?}");
        assert!(arc.iter().sum::<f64>() > 0.8, "{}", arc.iter().sum::<f64>());
        assert!(p(0.3, 1.7).iter().all(|p| *p < 0.02));
        assert!(sonar.width_rad() > 0.5);
    }
}
