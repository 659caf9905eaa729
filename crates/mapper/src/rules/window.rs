//! The last scans solved together, and a map of pairs of all of them: a mapper with a fixed lag.
//!
//! Eight maps of occupied and free cells are drawn again and again, a chain to a lane, from the posterior of the last scans that
//! [`Gibbs`](crate::Gibbs) has of all: every reading is explained by the first occupied cell of its ray, and the prior knows how blocks of
//! cells look. What leaves the window is condensed twice: into a log odds per cell, as what its flip gained on average while the readings
//! were there (the natural gradient of variational inference: Hoffman et al. 2013), and into the pairs of `visibility-lateral`, which take
//! every scan as it comes. The map is the mean of the two, a linear opinion pool (Stone 1961): where the one has settled on what is wrong,
//! the other does not follow.

mod chains;
mod lag;
mod rays;
mod reader;

use std::cell::OnceCell;

use grid::Raster;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use sensor::lanes::{LANES, Lanes, each};
use sensor::{Scan, exp_minus, in_lanes};

use crate::belief::lateral::Lateral;
use crate::belief::probability::bounded;
use crate::fast::visibility::FastVisibility;
use crate::fit::{Fitted, Setting};
use crate::mapper::{Mapper, Work};
use crate::memory::Held;
use crate::model::{Model, Sensors};
use crate::ray::worth::Reading;
use crate::rules::gibbs::Sampling;
use crate::rules::window::chains::{Chains, Target, maps};
pub use crate::rules::window::lag::FixedLag;
use crate::rules::window::rays::{Crossing, Moment};
use crate::rules::window::reader::Reader;

/// Cells that are occupied with a probability between this and one less it are in doubt, and drawn in every sweep.
const DOUBT: f64 = 0.01;

/// The others that a scan's rays may see are drawn after one scan in so many.
const SETTLED: u32 = 3;

/// Cells behind the second occupied one of a ray, in the map in which it lies farthest, that a scan's rays are taken to see.
const BEHIND: u32 = 3;

/// Gains on rays that are about to leave are looked at after one scan in so many.
const LOOKS: u32 = 3;

/// Cells whose rays are looked up together.
const TOGETHER: usize = 32;

/// Differences in nats beyond this are as good as this: the exponential of the rest is nothing in single precision.
const FAR: f32 = 80.0;

/// The mapper with a fixed lag. Online; O(cells) per ray, and per scan O(rays through them) per cell in doubt and sweep.
///
/// Holds 74 bytes per cell of the map, and in the window 136 per ray and 24 per cell of it.
pub struct VisibilityWindow {
    rule: FixedLag,
    pairs: Box<dyn Mapper>,
    sensors: Sensors,
    reading: Reading,
    /// `u0 = P(E_{j+1} | not E_j)` of an unseen world.
    onset: f64,
    reader: Reader,
    target: Target,
    chains: Chains,
    rng: ChaCha8Rng,
    /// Probability of every cell, of the drawn maps, and number of draws.
    drawn: Vec<f64>,
    draws: Vec<u32>,
    /// Cells in doubt, and whether each cell is one of them.
    doubtful: Vec<u32>,
    is_doubtful: Vec<bool>,
    /// Number of scans, which wraps, and the one by which each cell was seen last.
    taken: u32,
    seen: Vec<u32>,
    occupancy: OnceCell<Raster<f64>>,
}

impl VisibilityWindow {
    /// The unseen map.
    pub fn new(model: &Model, rule: FixedLag) -> Self {
        let FixedLag { weight, leak, strength, shift, .. } = rule;
        let (spec, cells) = (model.grid, model.grid.cells());
        let field = Sampling { strength, shift, ..Sampling::TUNED }.field(model);
        Self {
            rule,
            pairs: Box::new(FastVisibility::lateral(model, Lateral::default())),
            sensors: model.sensors.clone(),
            reading: Reading { weight, leak },
            onset: model.prior.onset(spec.cell_m),
            reader: Reader::default(),
            target: Target::new(spec, &field),
            chains: Chains::free(cells),
            rng: ChaCha8Rng::seed_from_u64(rule.seed),
            drawn: vec![model.prior.marginal(); cells],
            draws: vec![0; cells],
            doubtful: Vec::new(),
            is_doubtful: vec![false; cells],
            taken: 0,
            seen: vec![0; cells],
            occupancy: OnceCell::new(),
        }
    }

    /// What was read at one time.
    fn take(&mut self, scans: &[Scan]) {
        let mut moment = Moment::default();
        for scan in scans {
            let sensor = &**self.sensors.of(scan);
            self.reader.read(scan, self.target.spec(), sensor, (&self.reading, self.onset), &mut moment);
        }
        if moment.rays() == 0 {
            return;
        }
        if self.target.rays.moments() == self.rule.scans.max(1) {
            self.condense();
        }
        self.taken = self.taken.wrapping_add(1);
        let first = self.target.rays.count();
        self.target.rays.add(moment);
        self.chains.follow(&self.target.rays);
        let seen = self.look(first);
        draw_all(self, &seen);
        seen.iter().for_each(|&cell| self.doubt(cell as usize));
        let mut doubtful = std::mem::take(&mut self.doubtful);
        for _ in 0..self.rule.sweeps {
            draw_all(self, &doubtful);
        }
        self.target.rays.look(self.chains.nearest(), self.rule.scans, LOOKS);
        doubtful.retain(|&cell| {
            let cell = cell as usize;
            self.is_doubtful[cell] = is_in_doubt(self.drawn[cell]) && self.target.rays.crossings(cell) > 0;
            self.is_doubtful[cell]
        });
        // Neighbours are drawn after each other, whose rays are at hand.
        doubtful.sort_unstable();
        self.doubtful = doubtful;
    }

    /// Lets the oldest scan go.
    fn condense(&mut self) {
        if let Some(moment) = self.target.rays.leave() {
            self.chains.forget(moment.rays());
            moment.gains().for_each(|(cell, gain)| self.target.condensed[cell] += f64::from(gain));
        }
    }

    /// Cells that the rays from one on may see and that are not in doubt, of which every third is due.
    fn look(&mut self, first: usize) -> Vec<u32> {
        let mut seen = Vec::new();
        for place in first..self.target.rays.count() {
            let cells = self.target.rays.cells(place);
            let second = self.chains.nearest()[place].second.into_iter().max().unwrap_or_default();
            let until = (second.saturating_add(BEHIND) as usize).min(cells.len());
            for &cell in &cells[..until] {
                let is_due = cell.wrapping_add(self.taken).is_multiple_of(SETTLED) || self.draws[cell as usize] == 0;
                if is_due && !self.is_doubtful[cell as usize] && self.seen[cell as usize] != self.taken {
                    self.seen[cell as usize] = self.taken;
                    seen.push(cell);
                }
            }
        }
        seen
    }

    /// Draws cells one after the other.
    #[inline(always)]
    fn draw_each(&mut self, cells: &[u32]) {
        // The rays of several cells are looked up together, so that memory is waited for once.
        let (mut crossings, mut ends) = (Vec::new(), [0; TOGETHER]);
        for cells in cells.chunks(TOGETHER) {
            crossings.clear();
            for (cell, end) in cells.iter().zip(&mut ends) {
                self.target.rays.gather(*cell as usize, &mut crossings);
                *end = crossings.len();
            }
            let mut start = 0;
            for (cell, end) in cells.iter().zip(ends) {
                self.draw(*cell as usize, &crossings[start..end]);
                start = end;
            }
        }
    }

    /// Draws a cell in every map given all others.
    #[inline(always)]
    fn draw(&mut self, cell: usize, crossings: &[Crossing]) {
        let p = probabilities(&self.chains.log_odds(&self.target, cell, crossings));
        let drawn: Lanes<f32> = self.rng.random();
        let turned = maps(|l| drawn[l] < p[l]) ^ self.chains.occupied(cell);
        if turned != 0 {
            self.chains.flip(&self.target, cell, crossings, turned);
        }
        let p = f64::from(p.iter().sum::<f32>()) / LANES as f64;
        self.draws[cell] = self.draws[cell].saturating_add(1);
        let share = 1.0 / f64::from(self.draws[cell]).min(self.rule.draws.max(1.0));
        self.drawn[cell] = bounded(self.drawn[cell] + share * (p - self.drawn[cell]));
    }

    fn doubt(&mut self, cell: usize) {
        if !self.is_doubtful[cell] && is_in_doubt(self.drawn[cell]) {
            self.is_doubtful[cell] = true;
            self.doubtful.push(cell as u32);
        }
    }

    /// The mean of the two; of a cell that was never drawn, that of the pairs.
    fn mean(&self, cell: usize, of_pairs: f64) -> f64 {
        if self.draws[cell] == 0 {
            of_pairs
        } else {
            bounded(of_pairs + self.rule.share * (self.drawn[cell] - of_pairs))
        }
    }
}

fn is_in_doubt(p: f64) -> bool {
    p > DOUBT && p < 1.0 - DOUBT
}

in_lanes! {
    /// Draws cells one after the other.
    fn draw_all<'a>(window: &'a mut VisibilityWindow, cells: &'a [u32]) {
        window.draw_each(cells);
    }
}

/// The probabilities of the given log odds.
#[inline(always)]
fn probabilities(log_odds: &Lanes<f32>) -> Lanes<f32> {
    let less = each(|l| exp_minus(log_odds[l].abs().min(FAR)));
    each(|l| if log_odds[l] < 0.0 { less[l] } else { 1.0 } / (1.0 + less[l]))
}

impl Fitted for FixedLag {
    fn parameters(&self) -> Vec<(&'static str, Setting)> {
        self.named()
    }

    fn label(&self) -> String {
        self.words()
    }

    fn mapper(&self, model: &Model) -> Box<dyn Mapper> {
        Box::new(VisibilityWindow::new(model, *self))
    }
}

impl Mapper for VisibilityWindow {
    fn integrate(&mut self, scan: &Scan) {
        self.integrate_together(std::slice::from_ref(scan));
    }

    fn integrate_together(&mut self, scans: &[Scan]) {
        self.pairs.integrate_together(scans);
        self.take(scans);
        self.occupancy.take();
    }

    fn occupancy(&self) -> &Raster<f64> {
        self.occupancy.get_or_init(|| {
            let mut map = self.pairs.occupancy().clone();
            map.values_mut().iter_mut().enumerate().for_each(|(cell, p)| *p = self.mean(cell, *p));
            map
        })
    }

    fn occupied(&self, cell: usize) -> f64 {
        self.mean(cell, self.pairs.occupied(cell))
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(Self {
            pairs: self.pairs.fork()?,
            sensors: self.sensors.clone(),
            reader: self.reader.clone(),
            target: self.target.clone(),
            chains: self.chains.clone(),
            rng: self.rng.clone(),
            drawn: self.drawn.clone(),
            draws: self.draws.clone(),
            doubtful: self.doubtful.clone(),
            is_doubtful: self.is_doubtful.clone(),
            seen: self.seen.clone(),
            occupancy: OnceCell::new(),
            ..*self
        }))
    }

    /// Counts what its pairs count: draws are none of a ray.
    fn work(&self) -> Work {
        let Work { cells, bytes } = self.pairs.work();
        let cells_of =
            self.drawn.held() + self.draws.held() + self.doubtful.held() + self.is_doubtful.held() + self.seen.held();
        Work { cells, bytes: bytes + self.target.held() + self.chains.held() + cells_of + self.occupancy.held() }
    }

    fn skipped(&self) -> u64 {
        self.pairs.skipped()
    }
}

#[cfg(test)]
mod tests;
