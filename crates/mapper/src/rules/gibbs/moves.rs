//! Moves of many cells at once: obstacles come and go, walls and things move by a cell.

use grid::GridSpec;
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use crate::rules::gibbs::walk::Walk;

/// Sides of the boxes that are flipped, all equally often, cells.
const FLIPPED: [usize; 12] = [1, 1, 1, 2, 2, 3, 4, 5, 7, 10, 16, 25];

/// Sides of the boxes whose cells move on by one, all equally often, cells.
const SHIFTED: [usize; 12] = [2, 2, 2, 3, 3, 4, 5, 6, 8, 11, 16, 25];

/// A move is tried where none of the cells that it fills would by itself cost more than this, nats.
pub(super) const MOST: f64 = 30.0;

/// A box of cells inside the map.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// Its first cell: lowest column, lowest row.
    pub(super) at: usize,
    /// Columns.
    pub(super) width: usize,
    /// Rows.
    pub(super) height: usize,
}

/// Where the cells of a box move on to, and what leaves it comes in on the other side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Direction {
    /// To the next column.
    Right,
    /// To the column before.
    Left,
    /// To the next row.
    Up,
    /// To the row before.
    Down,
}

impl Direction {
    /// All four.
    pub(super) const ALL: [Self; 4] = [Self::Right, Self::Left, Self::Up, Self::Down];
}

impl Place {
    /// A box to flip, anywhere and of any size; none where it leaves the map.
    pub(super) fn to_flip(spec: &GridSpec, rng: &mut ChaCha8Rng) -> Option<Self> {
        Self::drawn(spec, &FLIPPED, rng)
    }

    /// The same of a box to shift.
    pub(super) fn to_shift(spec: &GridSpec, rng: &mut ChaCha8Rng) -> Option<Self> {
        Self::drawn(spec, &SHIFTED, rng)
    }

    fn drawn(spec: &GridSpec, sides: &[usize], rng: &mut ChaCha8Rng) -> Option<Self> {
        let [width, height] = [(); 2].map(|()| sides[rng.random_range(0..sides.len())]);
        let at = rng.random_range(0..spec.cells());
        let (column, row) = spec.column_row(at);
        (column + width <= spec.width && row + height <= spec.height).then_some(Self { at, width, height })
    }

    /// Its cells into a buffer.
    pub(super) fn cells(&self, spec: &GridSpec, cells: &mut Vec<usize>) {
        cells.clear();
        for y in 0..self.height {
            let first = self.at + y * spec.width;
            cells.extend(first..first + self.width);
        }
    }

    /// The cells that differ from those whose state they get by a shift, into a buffer.
    pub(super) fn shifted(&self, spec: &GridSpec, occupied: &[bool], to: Direction, cells: &mut Vec<usize>) {
        cells.clear();
        let (width, height) = (self.width, self.height);
        for y in 0..height {
            let row = self.at + y * spec.width;
            let from_row = match to {
                Direction::Up => self.at + (y + height - 1) % height * spec.width,
                Direction::Down => self.at + (y + 1) % height * spec.width,
                Direction::Right | Direction::Left => row,
            };
            for x in 0..width {
                let from = match to {
                    Direction::Right => row + (x + width - 1) % width,
                    Direction::Left => row + (x + 1) % width,
                    Direction::Up | Direction::Down => from_row + x,
                };
                if occupied[row + x] != occupied[from] {
                    cells.push(row + x);
                }
            }
        }
    }
}

/// Flips cells that are all alike, if that is worth it by a uniform draw. Nothing is tried where one of them by itself would cost more than `most` nats of
/// likelihood, before or on the way back.
pub(super) fn try_flip(walk: &mut Walk, cells: &[usize], most: f64, draw: f64) {
    let Some(&one) = cells.first() else { return };
    let state = walk.occupied()[one];
    let is_alike = cells.iter().all(|&cell| walk.occupied()[cell] == state);
    let may_flip = |walk: &Walk| cells.iter().all(|&cell| walk.costs_less(cell, most));
    if is_alike && may_flip(walk) {
        try_all(walk, cells, draw, may_flip);
    }
}

/// Flips cells of both kinds, those of a shift, if that is worth it by a uniform draw. Nothing is tried where filling one of them by itself would cost
/// more than `most` nats of likelihood, before or on the way back.
pub(super) fn try_shift(walk: &mut Walk, cells: &[usize], most: f64, draw: f64) {
    let may_fill = |walk: &Walk| cells.iter().all(|&cell| walk.occupied()[cell] || walk.costs_less(cell, most));
    if !cells.is_empty() && may_fill(walk) {
        try_all(walk, cells, draw, may_fill);
    }
}

fn try_all(walk: &mut Walk, cells: &[usize], draw: f64, may_go_back: impl Fn(&Walk) -> bool) {
    if draw < libm::exp(walk.change_of(cells).min(0.0)) {
        cells.iter().for_each(|&cell| walk.flip(cell));
        if !may_go_back(walk) {
            cells.iter().for_each(|&cell| walk.flip(cell));
        }
    }
}
