//! One map, and what every change of it would make of its posterior.

use grid::GridSpec;

use crate::rules::gibbs::field::{self, BlockField};
use crate::rules::gibbs::rays::Rays;

/// A map of occupied and free cells with its posterior, up to a constant, kept exact change by change.
///
/// A ray depends on its first occupied cell alone: a flip of a cell concerns the rays on which it is, or becomes, the first, and what
/// the flips of other cells would gain changes on no others.
pub(super) struct Walk<'a> {
    spec: GridSpec,
    rays: &'a Rays<'a>,
    field: &'a BlockField,
    occupied: Vec<bool>,
    /// Pattern of the block about each cell.
    patterns: Vec<u16>,
    /// Entries of the first and the second occupied cell of each ray; the end of its span if there is none.
    nearest: Vec<[u32; 2]>,
    /// What flipping each cell would add to the log likelihood, nats.
    gain: Vec<f64>,
    /// Log posterior up to a constant, nats.
    log_posterior: f64,
    /// Number of the last [`change_of`](Self::change_of), the rays that it changes and the blocks.
    touches: u64,
    touched: Vec<u32>,
    blocks: Vec<u32>,
    /// The last of them to touch each ray, to count each block, and to clear the first occupied cell of each ray; the nearest entry that it fills.
    is_touched: Vec<u64>,
    is_counted: Vec<u64>,
    cleared: Vec<u64>,
    filled: Vec<u32>,
}

impl<'a> Walk<'a> {
    /// Begins at a map.
    pub(super) fn new(spec: GridSpec, rays: &'a Rays<'a>, field: &'a BlockField, occupied: Vec<bool>) -> Self {
        let patterns = field::patterns(&spec, &occupied);
        let nearest = vec![[0; 2]; rays.count()];
        let gain = vec![0.0; occupied.len()];
        let mut walk = Self {
            spec,
            rays,
            field,
            occupied,
            patterns,
            nearest,
            gain,
            log_posterior: 0.0,
            touches: 0,
            touched: Vec::new(),
            blocks: Vec::new(),
            is_touched: vec![0; rays.count()],
            is_counted: vec![0; spec.cells()],
            cleared: vec![0; rays.count()],
            filled: vec![0; rays.count()],
        };
        walk.recount();
        walk
    }

    /// Counts everything anew from the map, so that rounding does not add up. O(entries).
    pub(super) fn recount(&mut self) {
        self.gain.fill(0.0);
        let mut sum: f64 = self.patterns.iter().map(|&pattern| self.field.weight(pattern.into())).sum();
        for ray in 0..self.rays.count() {
            let span = self.rays.span(ray);
            let first = self.next(ray, span.start);
            let second = if first < span.end { self.next(ray, first + 1) } else { first };
            self.nearest[ray] = [first as u32, second as u32];
            let now = self.rays.value(ray, first);
            sum += now;
            self.shift(span.start..first, -now);
            if first < span.end {
                self.gain[self.rays.cell(first)] += self.rays.value(ray, second) - now;
            }
        }
        self.log_posterior = sum;
    }

    /// The map.
    pub(super) fn occupied(&self) -> &[bool] {
        &self.occupied
    }

    /// Log of prior times likelihood, up to a constant, nats.
    pub(super) fn log_posterior(&self) -> f64 {
        self.log_posterior
    }

    /// What flipping a cell would add to the log posterior, nats.
    pub(super) fn change(&self, cell: usize) -> f64 {
        self.gain[cell] + self.prior_change(cell)
    }

    /// Flips a cell: what [`change`](Self::change) says is added.
    pub(super) fn flip(&mut self, cell: usize) {
        self.log_posterior += self.change(cell);
        let own = -self.gain[cell];
        let rays = self.rays;
        for &(ray, entry) in rays.through(cell) {
            let (ray, entry) = (ray as usize, entry as usize);
            if entry <= self.nearest[ray][1] as usize {
                if self.occupied[cell] { self.clear(ray, entry) } else { self.fill(ray, entry) }
            }
        }
        self.gain[cell] = own;
        self.occupied[cell] ^= true;
        let Self { spec, patterns, .. } = self;
        field::blocks(spec, cell, |centre, bits| patterns[centre] ^= bits as u16);
    }

    /// What swapping two cells, of which one is occupied, would add to the log posterior, nats.
    pub(super) fn swap_change(&mut self, one: usize, other: usize) -> f64 {
        let (on, off) = if self.occupied[one] { (one, other) } else { (other, one) };
        debug_assert!(self.occupied[on] && !self.occupied[off], "one of the two is occupied");
        let mut change = self.gain[on] + self.gain[off] + self.prior_change(on);
        let Self { spec, patterns, .. } = self;
        field::blocks(spec, on, |centre, bits| patterns[centre] ^= bits as u16);
        change += self.prior_change(off);
        let Self { spec, patterns, .. } = self;
        field::blocks(spec, on, |centre, bits| patterns[centre] ^= bits as u16);
        // On rays that cross both, the two flips are not independent of each other.
        let (mut a, mut b) = (self.rays.through(on), self.rays.through(off));
        while let (Some((ray, filled)), Some((beside, empty))) = (a.first(), b.first()) {
            match ray.cmp(beside) {
                std::cmp::Ordering::Less => a = &a[1..],
                std::cmp::Ordering::Greater => b = &b[1..],
                std::cmp::Ordering::Equal => {
                    change += self.together(*ray as usize, *filled, *empty);
                    (a, b) = (&a[1..], &b[1..]);
                }
            }
        }
        change
    }

    /// What clearing one entry and filling another adds on a ray beyond what each adds by itself, nats.
    fn together(&self, ray: usize, filled: u32, empty: u32) -> f64 {
        let [first, second] = self.nearest[ray];
        let value = |entry: u32| self.rays.value(ray, entry as usize);
        let now = value(first);
        let others = if first == filled { second } else { first };
        let clearing = if first == filled { value(second) - now } else { 0.0 };
        let filling = if empty < first { value(empty) - now } else { 0.0 };
        value(others.min(empty)) - now - clearing - filling
    }

    /// Whether a cell's flip would by itself cost less than this many nats of likelihood.
    pub(super) fn costs_less(&self, cell: usize, nats: f64) -> bool {
        self.gain[cell] > -nats
    }

    /// What flipping these cells together, all of which differ, would add to the log posterior, nats.
    pub(super) fn change_of(&mut self, cells: &[usize]) -> f64 {
        self.touch(cells);
        let before = self.prior_of_blocks();
        cells.iter().for_each(|&cell| self.turn(cell));
        let mut change = self.prior_of_blocks() - before;
        for &ray in &self.touched {
            let ray = ray as usize;
            let (first, filled) = (self.nearest[ray][0] as usize, self.filled[ray] as usize);
            let is_cleared = self.cleared[ray] == self.touches;
            let after = if is_cleared { self.next(ray, first + 1).min(filled) } else { filled };
            change += self.rays.value(ray, after) - self.rays.value(ray, first);
        }
        cells.iter().for_each(|&cell| self.turn(cell));
        change
    }

    /// Finds the rays whose first occupied cell the flips of these cells change, with the nearest entry that they fill and whether they clear the
    /// first, and the blocks that they are part of.
    fn touch(&mut self, cells: &[usize]) {
        let Self {
            spec,
            rays,
            occupied,
            nearest,
            touches,
            touched,
            blocks,
            is_touched,
            is_counted,
            filled,
            cleared,
            ..
        } = self;
        *touches += 1;
        touched.clear();
        blocks.clear();
        for &cell in cells {
            let is_clearing = occupied[cell];
            for &(number, entry) in rays.through(cell) {
                let ray = number as usize;
                let first = nearest[ray][0];
                if if is_clearing { entry == first } else { entry < first } {
                    if is_touched[ray] != *touches {
                        is_touched[ray] = *touches;
                        filled[ray] = u32::MAX;
                        touched.push(number);
                    }
                    if is_clearing { cleared[ray] = *touches } else { filled[ray] = filled[ray].min(entry) }
                }
            }
            field::blocks(spec, cell, |centre, _| {
                if is_counted[centre] != *touches {
                    is_counted[centre] = *touches;
                    blocks.push(centre as u32);
                }
            });
        }
    }

    /// Log weight of the blocks that were touched, nats.
    fn prior_of_blocks(&self) -> f64 {
        self.blocks.iter().map(|&centre| self.field.weight(self.patterns[centre as usize].into())).sum()
    }

    /// Turns a cell in the map and its patterns, and nothing else.
    fn turn(&mut self, cell: usize) {
        self.occupied[cell] ^= true;
        let Self { spec, patterns, .. } = self;
        field::blocks(spec, cell, |centre, bits| patterns[centre] ^= bits as u16);
    }

    fn prior_change(&self, cell: usize) -> f64 {
        let mut change = 0.0;
        field::blocks(&self.spec, cell, |centre, bits| {
            let pattern = usize::from(self.patterns[centre]);
            change += self.field.weight(pattern ^ bits) - self.field.weight(pattern);
        });
        change
    }

    /// The first occupied entry of a ray from one on, or the end.
    fn next(&self, ray: usize, from: usize) -> usize {
        let end = self.rays.span(ray).end;
        let cells = self.rays.cells(from..end);
        cells.iter().position(|&cell| self.occupied[cell as usize]).map_or(end, |steps| from + steps)
    }

    /// Adds what entries are worth, and a constant, to what their flips gain.
    fn shift(&mut self, entries: std::ops::Range<usize>, by: f64) {
        let worth = self.rays.logs(entries.clone());
        for (&cell, log) in self.rays.cells(entries).iter().zip(worth) {
            self.gain[cell as usize] += log + by;
        }
    }

    /// Adds a constant to what flips of entries gain.
    fn lift(&mut self, entries: std::ops::Range<usize>, by: f64) {
        for &cell in self.rays.cells(entries) {
            self.gain[cell as usize] += by;
        }
    }

    /// An entry up to the second occupied one becomes occupied; what its own flip gains is left to the caller.
    fn fill(&mut self, ray: usize, entry: usize) {
        let span = self.rays.span(ray);
        let [first, second] = self.nearest[ray].map(|entry| entry as usize);
        let (before, next) = (self.rays.value(ray, first), self.rays.value(ray, second));
        let now = self.rays.value(ray, entry);
        if entry < first {
            self.lift(span.start..entry, before - now);
            let between = entry + 1..first;
            for (&cell, log) in self.rays.cells(between.clone()).iter().zip(self.rays.logs(between)) {
                self.gain[cell as usize] -= log - before;
            }
            if first < span.end {
                self.gain[self.rays.cell(first)] -= next - before;
            }
            self.nearest[ray] = [entry as u32, first as u32];
        } else {
            self.gain[self.rays.cell(first)] += now - next;
            self.nearest[ray] = [first as u32, entry as u32];
        }
    }

    /// The first or second occupied entry becomes free; what its own flip gains is left to the caller.
    fn clear(&mut self, ray: usize, entry: usize) {
        let span = self.rays.span(ray);
        let [first, second] = self.nearest[ray].map(|entry| entry as usize);
        let third = if second < span.end { self.next(ray, second + 1) } else { second };
        let (before, now, next) =
            (self.rays.value(ray, first), self.rays.value(ray, second), self.rays.value(ray, third));
        if entry == first {
            self.lift(span.start..entry, before - now);
            self.shift(entry + 1..second, -now);
            if second < span.end {
                self.gain[self.rays.cell(second)] += next - now;
            }
            self.nearest[ray] = [second as u32, third as u32];
        } else {
            self.gain[self.rays.cell(first)] += next - now;
            self.nearest[ray] = [first as u32, third as u32];
        }
    }
}
