//! One map that is drawn again and again, and what its changes are worth.

use grid::GridSpec;

use crate::memory::Held;
use crate::rules::gibbs::field::{self, BlockField, PATTERNS};
use crate::rules::window::rays::{Nearest, Rays};

/// What a map is judged by: a prior over maps, the rays of the window, and what is left of those that have left it.
#[derive(Debug, Clone)]
pub(super) struct Target {
    spec: GridSpec,
    /// What an occupied cell adds to the log weight of a block, nats: by its bit in the block, times [`PATTERNS`], and the block's pattern.
    adds: Vec<f64>,
    field: BlockField,
    pub(super) rays: Rays,
    /// What the rays that left the window make of each cell, log odds in nats.
    pub(super) condensed: Vec<f64>,
}

impl Target {
    /// The prior alone.
    pub(super) fn new(spec: GridSpec, field: &BlockField) -> Self {
        let adds = |bit: usize, pattern: usize| field.weight(pattern | 1 << bit) - field.weight(pattern & !(1 << bit));
        let adds = (0..9).flat_map(|bit| (0..PATTERNS).map(move |pattern| adds(bit, pattern)));
        let (rays, condensed) = (Rays::new(spec.cells()), vec![0.0; spec.cells()]);
        Self { spec, adds: adds.collect(), field: field.clone(), rays, condensed }
    }

    /// The cells.
    pub(super) fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// Log odds of a cell given the patterns of the blocks, by the prior alone, nats.
    #[inline(always)]
    fn prior_log_odds(&self, patterns: &[u16], cell: usize) -> f64 {
        let width = self.spec.width;
        let (column, row) = self.spec.column_row(cell);
        if column > 0 && row > 0 && column + 1 < width && row + 1 < self.spec.height {
            let add = |bit: usize, centre: usize| self.adds[bit * PATTERNS + usize::from(patterns[centre])];
            let three = |bit: usize, last: usize| add(bit, last - 1) + add(bit - 1, last) + add(bit - 2, last + 1);
            // The cell is the last of the first block.
            return three(8, cell - width) + three(5, cell) + three(2, cell + width);
        }
        let mut sum = 0.0;
        field::blocks(&self.spec, cell, |centre, bits| {
            let pattern = usize::from(patterns[centre]);
            sum += self.field.weight(pattern | bits) - self.field.weight(pattern & !bits);
        });
        sum
    }
}

/// A map of occupied and free cells.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    occupied: Vec<bool>,
    /// Pattern of the block about each cell.
    patterns: Vec<u16>,
    /// The nearest occupied cells of the window's rays.
    nearest: Vec<Nearest>,
}

impl Chain {
    /// The map without obstacles, and no ray.
    pub(super) fn free(cells: usize) -> Self {
        Self { occupied: vec![false; cells], patterns: vec![0; cells], nearest: Vec::new() }
    }

    /// Whether a cell is occupied.
    pub(super) fn is_occupied(&self, cell: usize) -> bool {
        self.occupied[cell]
    }

    /// The nearest occupied cells of every ray.
    pub(super) fn nearest(&self) -> &[Nearest] {
        &self.nearest
    }

    /// Follows the rays that have come to the window since the last call.
    pub(super) fn follow(&mut self, rays: &Rays) {
        for place in self.nearest.len()..rays.count() {
            let cells = rays.cells(place).len();
            let first = self.next(rays, place, 0);
            let second = if first < cells { self.next(rays, place, first + 1) } else { first };
            let [value, without] = [first, second].map(|step| rays.value(place, step));
            self.nearest.push(Nearest { first: first as u32, second: second as u32, value, without });
        }
    }

    /// Forgets the oldest rays, so many of them.
    pub(super) fn forget(&mut self, rays: usize) {
        self.nearest.drain(..rays);
    }

    /// The first occupied cell of a ray from one on, or the number of its cells.
    fn next(&self, rays: &Rays, place: usize, from: usize) -> usize {
        let cells = rays.cells(place);
        (from..cells.len()).find(|&step| self.occupied[cells[step] as usize]).unwrap_or(cells.len())
    }

    /// Log odds that a cell is occupied given all others, nats. O(rays of the window through it).
    pub(super) fn log_odds(&self, target: &Target, cell: usize) -> f64 {
        let mut sum = target.condensed[cell] + target.prior_log_odds(&self.patterns, cell);
        for crossing in target.rays.through(cell) {
            let nearest = &self.nearest[target.rays.place(crossing.ray)];
            if crossing.step < nearest.first {
                sum += f64::from(crossing.log - nearest.value);
            } else if crossing.step == nearest.first {
                sum += f64::from(nearest.value - nearest.without);
            }
        }
        sum
    }

    /// What swapping an occupied and a free cell would add to the log posterior, nats.
    pub(super) fn swap_gain(&mut self, target: &Target, occupied: usize, free: usize) -> f64 {
        debug_assert!(self.occupied[occupied] && !self.occupied[free], "one of the two is occupied");
        let mut gain =
            target.condensed[free] - target.condensed[occupied] - target.prior_log_odds(&self.patterns, occupied);
        self.turn(target, occupied);
        gain += target.prior_log_odds(&self.patterns, free);
        self.turn(target, occupied);
        let rays = &target.rays;
        let (mut from, mut to) = (rays.through(occupied).iter().peekable(), rays.through(free).iter().peekable());
        loop {
            // Some rays cross both.
            let places = [from.peek(), to.peek()].map(|next| next.map_or(usize::MAX, |next| rays.place(next.ray)));
            let place = places[0].min(places[1]);
            let Some(nearest) = self.nearest.get(place) else { return gain };
            let (mut first, mut value) = (nearest.first, nearest.value);
            if let Some(emptied) = from.next_if(|next| rays.place(next.ray) == place)
                && emptied.step == first
            {
                (first, value) = (nearest.second, nearest.without);
            }
            if let Some(filled) = to.next_if(|next| rays.place(next.ray) == place)
                && filled.step < first
            {
                value = filled.log;
            }
            gain += f64::from(value - nearest.value);
        }
    }

    /// Turns a cell, and follows its rays.
    pub(super) fn flip(&mut self, target: &Target, cell: usize) {
        self.turn(target, cell);
        let rays = &target.rays;
        for crossing in rays.through(cell) {
            let (place, step) = (rays.place(crossing.ray), crossing.step);
            let nearest = self.nearest[place];
            let after = |step: u32| self.next(rays, place, step as usize + 1);
            self.nearest[place] = if self.occupied[cell] {
                if step < nearest.first {
                    Nearest { first: step, second: nearest.first, value: crossing.log, without: nearest.value }
                } else if step < nearest.second {
                    Nearest { second: step, without: crossing.log, ..nearest }
                } else {
                    continue;
                }
            } else if step == nearest.first {
                let third = after(nearest.second);
                let (first, value) = (nearest.second, nearest.without);
                Nearest { first, second: third as u32, value, without: rays.value(place, third) }
            } else if step == nearest.second {
                let third = after(nearest.second);
                Nearest { second: third as u32, without: rays.value(place, third), ..nearest }
            } else {
                continue;
            };
        }
    }

    /// Turns a cell in the map and its patterns, and nothing else.
    fn turn(&mut self, target: &Target, cell: usize) {
        self.occupied[cell] ^= true;
        field::blocks(&target.spec, cell, |centre, bits| self.patterns[centre] ^= bits as u16);
    }
}

impl Held for Chain {
    fn held(&self) -> usize {
        self.occupied.held() + self.patterns.held() + self.nearest.held()
    }
}

impl Held for Target {
    fn held(&self) -> usize {
        self.adds.held() + self.rays.held() + self.condensed.held()
    }
}
