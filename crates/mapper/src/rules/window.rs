//! The last scans solved together, and a map of pairs of all of them: a mapper with a fixed lag.
//!
//! One map of occupied and free cells is drawn again and again, as [`Gibbs`](crate::Gibbs) draws it, from the posterior of the last
//! scans: every reading is explained by the first occupied cell of its ray, and the prior knows how blocks of cells look. What leaves the
//! window is condensed twice: into a log odds per cell, as what its flip gained on average while the readings were there (the natural
//! gradient of variational inference: Hoffman et al. 2013), and into the pairs of `visibility-lateral`, which take every scan as it
//! comes. The map is the mean of the two, a linear opinion pool (Stone 1961): where the one has settled on what is wrong, the other
//! does not follow.

mod chain;
mod lag;
mod rays;
mod worth;

use std::cell::OnceCell;

use grid::Raster;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use sensor::Scan;

use crate::belief::lateral::Lateral;
use crate::belief::probability::{EPSILON, bounded};
use crate::fast::visibility::FastVisibility;
use crate::fit::{Fitted, Setting};
use crate::mapper::{Mapper, Work};
use crate::memory::Held;
use crate::model::{Model, Sensors};
use crate::rules::gibbs::Sampling;
use crate::rules::window::chain::{Chain, Target};
pub use crate::rules::window::lag::FixedLag;
use crate::rules::window::rays::Moment;
use crate::rules::window::worth::{Reader, Reading};

/// Cells that are occupied with a probability between this and one less it are in doubt, and drawn in every sweep.
const DOUBT: f64 = 0.01;

/// The others that a scan's rays may see are drawn after one scan in so many.
const SETTLED: u32 = 3;

/// Cells behind the second occupied one of a ray that a scan's rays are taken to see.
const BEHIND: u32 = 3;

/// Gains on rays that are about to leave are looked at after one scan in so many.
const LOOKS: u32 = 3;

/// Sweeps after a scan that count for nothing, since the map is still that of the scan before.
const WARM_UP: usize = 1;

/// Beyond this, in log odds, a probability is its bound.
const SURE: f64 = 14.0;

/// The mapper with a fixed lag. Online; O(cells) per ray, and per scan O(rays through them) per cell in doubt and sweep.
///
/// Holds 60 bytes per cell of the map, and 24 per cell of every ray of the window.
pub struct VisibilityWindow {
    rule: FixedLag,
    pairs: Box<dyn Mapper>,
    sensors: Sensors,
    reading: Reading,
    reader: Reader,
    target: Target,
    chain: Chain,
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
            reading: Reading { weight, leak, onset: model.prior.onset(spec.cell_m) },
            reader: Reader::default(),
            target: Target::new(spec, &field),
            chain: Chain::free(cells),
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
            self.reader.read(scan, self.target.spec(), sensor, &self.reading, &mut moment);
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
        self.chain.follow(&self.target.rays);
        let seen = self.look(first);
        seen.iter().for_each(|&cell| self.draw(cell as usize, true));
        seen.iter().for_each(|&cell| self.doubt(cell as usize));
        for sweep in 0..self.rule.sweeps {
            self.sweep(sweep >= WARM_UP);
        }
        self.target.rays.look(self.chain.nearest(), self.rule.scans, LOOKS);
        let mut doubtful = std::mem::take(&mut self.doubtful);
        doubtful.retain(|&cell| {
            let cell = cell as usize;
            self.is_doubtful[cell] = is_in_doubt(self.drawn[cell]) && !self.target.rays.through(cell).is_empty();
            self.is_doubtful[cell]
        });
        self.doubtful = doubtful;
    }

    /// Lets the oldest scan go.
    fn condense(&mut self) {
        if let Some(moment) = self.target.rays.leave() {
            self.chain.forget(moment.rays());
            moment.gains().for_each(|(cell, gain)| self.target.condensed[cell] += f64::from(gain));
        }
    }

    /// Cells that the rays from one on may see and that are not in doubt, of which every third is due.
    fn look(&mut self, first: usize) -> Vec<u32> {
        let mut seen = Vec::new();
        for place in first..self.target.rays.count() {
            let cells = self.target.rays.cells(place);
            let until = (self.chain.nearest()[place].second.saturating_add(BEHIND) as usize).min(cells.len());
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

    /// Draws every cell in doubt given all others, and tries to move those that differ from a neighbour.
    fn sweep(&mut self, counts: bool) {
        for number in 0..self.doubtful.len() {
            self.draw(self.doubtful[number] as usize, counts);
        }
        for number in 0..self.doubtful.len() {
            let cell = self.doubtful[number] as usize;
            let (column, row) = self.target.spec().column_row(cell);
            let direction = self.rng.random_range(0..4);
            let Some(beside) = self.target.spec().neighbours_at(column, row)[direction] else { continue };
            let other = beside.cell;
            let pair = [cell, other].map(|cell| self.chain.is_occupied(cell));
            if pair[0] != pair[1] {
                let [on, off] = if pair[0] { [cell, other] } else { [other, cell] };
                let gain = self.chain.swap_gain(&self.target, on, off);
                if self.rng.random::<f64>() < libm::exp(gain.min(0.0)) {
                    self.chain.flip(&self.target, on);
                    self.chain.flip(&self.target, off);
                }
            }
        }
    }

    /// Draws a cell given all others.
    fn draw(&mut self, cell: usize, counts: bool) {
        let p = probability(self.chain.log_odds(&self.target, cell));
        if (self.rng.random::<f64>() < p) != self.chain.is_occupied(cell) {
            self.chain.flip(&self.target, cell);
        }
        if counts {
            self.draws[cell] = self.draws[cell].saturating_add(1);
            let share = 1.0 / f64::from(self.draws[cell]).min(self.rule.draws.max(1.0));
            self.drawn[cell] += share * (p - self.drawn[cell]);
        }
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

/// The probability of the given log odds, as [`crate::belief::probability::from_log_odds`], without the exponential where that makes no difference.
fn probability(log_odds: f64) -> f64 {
    if log_odds < -SURE {
        EPSILON
    } else if log_odds > SURE {
        1.0 - EPSILON
    } else {
        bounded(1.0 / (1.0 + libm::exp(-log_odds)))
    }
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
            chain: self.chain.clone(),
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
        Work { cells, bytes: bytes + self.target.held() + self.chain.held() + cells_of + self.occupancy.held() }
    }

    fn skipped(&self) -> u64 {
        self.pairs.skipped()
    }
}

#[cfg(test)]
mod tests;
