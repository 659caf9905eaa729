//! A Markov chain over maps whose stationary distribution is the posterior.

use grid::GridSpec;
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use crate::rules::gibbs::moves::{Direction, MOST, Place, try_flip, try_shift};
use crate::rules::gibbs::tally::Tally;
use crate::rules::gibbs::walk::Walk;

/// Everything is counted anew after so many sweeps, so that rounding does not add up.
const RECOUNTED: usize = 64;

/// One chain: where it is, and what it draws from.
pub(super) struct Chain<'a> {
    spec: GridSpec,
    walk: Walk<'a>,
    rng: ChaCha8Rng,
    swept: usize,
    /// Cells of a move.
    cells: Vec<usize>,
}

impl<'a> Chain<'a> {
    /// Begins at a map.
    pub(super) fn new(spec: GridSpec, walk: Walk<'a>, rng: ChaCha8Rng) -> Self {
        Self { spec, walk, rng, swept: 0, cells: Vec::new() }
    }

    /// The map.
    pub(super) fn occupied(&self) -> &[bool] {
        self.walk.occupied()
    }

    /// What it draws from.
    pub(super) fn rng(self) -> ChaCha8Rng {
        self.rng
    }

    /// So many sweeps that nothing is kept of.
    pub(super) fn warm_up(&mut self, sweeps: usize) {
        (0..sweeps).for_each(|_| self.sweep(|_, _| ()));
    }

    /// A stage of so many sweeps: the conditional probability of every cell at each, and the log posterior as the last series.
    pub(super) fn stage(&mut self, sweeps: usize) -> Tally {
        let cells = self.spec.cells();
        let mut tally = Tally::new(cells + 1, sweeps);
        for sweep in 0..sweeps {
            self.sweep(|cell, p| tally.add(cell, sweep, p));
            tally.add(cells, sweep, self.walk.log_posterior());
        }
        tally
    }

    /// Draws every cell given all others, tries to move every cell that differs from a neighbour, and tries boxes, to flip and to
    /// shift. Each step is in detailed
    /// balance with the posterior.
    fn sweep(&mut self, mut seen: impl FnMut(usize, f64)) {
        for cell in 0..self.spec.cells() {
            let p = occupied(&self.walk, cell);
            seen(cell, p);
            if (self.rng.random::<f64>() < p) != self.walk.occupied()[cell] {
                self.walk.flip(cell);
            }
        }
        for cell in 0..self.spec.cells() {
            let Some(other) = beside(&self.spec, cell, self.rng.random_range(0..8)) else { continue };
            let draw = self.rng.random();
            try_swap(&mut self.walk, cell, other, draw);
        }
        for _ in 0..self.spec.cells() / FLIPS {
            self.flip_box();
        }
        for _ in 0..self.spec.cells() / SHIFTS {
            self.shift_box();
        }
        self.swept += 1;
        if self.swept.is_multiple_of(RECOUNTED) {
            self.walk.recount();
        }
    }
}

impl Chain<'_> {
    /// Tries to flip a box of cells that are all alike, anywhere and of any size.
    fn flip_box(&mut self) {
        if let Some(place) = Place::to_flip(&self.spec, &mut self.rng) {
            place.cells(&self.spec, &mut self.cells);
            try_flip(&mut self.walk, &self.cells, MOST, self.rng.random());
        }
    }

    /// Tries to move all that is in a box, anywhere and of any size, by one cell. The way back is the same box and the opposite direction, as likely
    /// as this one.
    fn shift_box(&mut self) {
        if let Some(place) = Place::to_shift(&self.spec, &mut self.rng) {
            let to = Direction::ALL[self.rng.random_range(0..4)];
            place.shifted(&self.spec, self.walk.occupied(), to, &mut self.cells);
            try_shift(&mut self.walk, &self.cells, MOST, self.rng.random());
        }
    }
}

/// Swaps two cells, if they differ and that is worth it by a uniform draw.
fn try_swap(walk: &mut Walk, cell: usize, other: usize, draw: f64) {
    if walk.occupied()[cell] != walk.occupied()[other] {
        let change = walk.swap_change(cell, other);
        if draw < libm::exp(change.min(0.0)) {
            walk.flip(cell);
            walk.flip(other);
        }
    }
}

/// One box is flipped for so many cells of the map ...
const FLIPS: usize = 16;

/// ... and one is shifted for so many.
const SHIFTS: usize = 32;

/// Log odds beyond which a cell is surely free: no draw is less than their probability, 4e-18.
const SURE: f64 = 40.0;

/// Probability that a cell is occupied given all others.
fn occupied(walk: &Walk, cell: usize) -> f64 {
    let change = walk.change(cell);
    let log_odds = if walk.occupied()[cell] { -change } else { change };
    if log_odds < -SURE { 0.0 } else { 1.0 / (1.0 + libm::exp(-log_odds)) }
}

/// The cell beside another in one of eight directions.
fn beside(spec: &GridSpec, cell: usize, direction: usize) -> Option<usize> {
    let (column, row) = spec.column_row(cell);
    let step = if direction < 4 { direction } else { direction + 1 }; // not the cell itself
    let x = (column + step % 3).checked_sub(1).filter(|x| *x < spec.width)?;
    let y = (row + step / 3).checked_sub(1).filter(|y| *y < spec.height)?;
    Some(spec.index(x, y))
}

#[cfg(test)]
mod tests;
