//! Several maps that are drawn again and again, a lane to each, and what their changes are worth.

use grid::GridSpec;
use sensor::lanes::{LANES, Lanes, each};

use crate::memory::Held;
use crate::rules::gibbs::field::{self, BlockField, PATTERNS};
use crate::rules::window::rays::{Crossing, Nearest, Rays};

/// Some of the maps, as bits.
pub(super) type Maps = u8;

const _: () = assert!(LANES == Maps::BITS as usize, "a bit for each map");

/// The maps in which something holds.
#[inline(always)]
pub(super) fn maps(holds: impl Fn(usize) -> bool) -> Maps {
    (0..LANES).fold(0, |maps, l| maps | Maps::from(holds(l)) << l)
}

/// Whether a map is among some.
#[inline(always)]
fn has(maps: Maps, map: usize) -> bool {
    maps >> map & 1 == 1
}

/// What maps are judged by: a prior over maps, the rays of the window, and what is left of those that have left it.
#[derive(Debug, Clone)]
pub(super) struct Target {
    spec: GridSpec,
    /// What an occupied cell adds to the log weight of a block, nats: by its bit in the block, and the block's pattern.
    adds: Vec<[f32; PATTERNS]>,
    field: BlockField,
    pub(super) rays: Rays,
    /// What the rays that left the window make of each cell, log odds in nats.
    pub(super) condensed: Vec<f64>,
}

impl Target {
    /// The prior alone.
    pub(super) fn new(spec: GridSpec, field: &BlockField) -> Self {
        let adds = |bit: usize, pattern: usize| {
            (field.weight(pattern | 1 << bit) - field.weight(pattern & !(1 << bit))) as f32
        };
        let adds = (0..9).map(|bit| std::array::from_fn(|pattern| adds(bit, pattern)));
        let (rays, condensed) = (Rays::new(spec.cells()), vec![0.0; spec.cells()]);
        Self { spec, adds: adds.collect(), field: field.clone(), rays, condensed }
    }

    /// The cells.
    pub(super) fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// Log odds of a cell given the patterns of the blocks, by the prior alone, nats.
    #[inline(always)]
    fn prior_log_odds(&self, patterns: &[Lanes<u16>], cell: usize) -> Lanes<f32> {
        let width = self.spec.width;
        let (column, row) = self.spec.column_row(cell);
        let mut sum = [0.0; LANES];
        if column > 0 && row > 0 && column + 1 < width && row + 1 < self.spec.height {
            // The cell is the last of the first block.
            for (blocks, middle) in self.adds.rchunks(3).zip([cell - width, cell, cell + width]) {
                for (adds, pattern) in blocks.iter().rev().zip(&patterns[middle - 1..=middle + 1]) {
                    sum = each(|l| sum[l] + adds[usize::from(pattern[l]) % PATTERNS]);
                }
            }
            return sum;
        }
        field::blocks(&self.spec, cell, |centre, bits| {
            let pattern = &patterns[centre];
            let add = |p: usize| (self.field.weight(p | bits) - self.field.weight(p & !bits)) as f32;
            sum = each(|l| sum[l] + add(usize::from(pattern[l])));
        });
        sum
    }
}

/// Maps of occupied and free cells.
#[derive(Debug, Clone)]
pub(super) struct Chains {
    /// The maps in which each cell is occupied.
    occupied: Vec<Maps>,
    /// Pattern of the block about each cell.
    patterns: Vec<Lanes<u16>>,
    /// The nearest occupied cells of the window's rays.
    nearest: Vec<Nearest>,
}

impl Chains {
    /// Maps without obstacles, and no ray.
    pub(super) fn free(cells: usize) -> Self {
        Self { occupied: vec![0; cells], patterns: vec![[0; LANES]; cells], nearest: Vec::new() }
    }

    /// The maps in which a cell is occupied.
    #[inline(always)]
    pub(super) fn occupied(&self, cell: usize) -> Maps {
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
            let first: Lanes<usize> = std::array::from_fn(|l| self.next(rays, place, 0, l));
            let second = std::array::from_fn(|l| self.next(rays, place, (first[l] + 1).min(cells), l));
            let [value, without] = [first, second].map(|steps| steps.map(|step| rays.value(place, step)));
            let [first, second] = [first, second].map(|steps| steps.map(|step| step as u32));
            self.nearest.push(Nearest { first, second, value, without });
        }
    }

    /// Forgets the oldest rays, so many of them.
    pub(super) fn forget(&mut self, rays: usize) {
        self.nearest.drain(..rays);
    }

    /// The first cell of a ray from one on that is occupied in a map, or the number of its cells.
    fn next(&self, rays: &Rays, place: usize, from: usize, map: usize) -> usize {
        let cells = rays.cells(place);
        (from..cells.len()).find(|&step| has(self.occupied[cells[step] as usize], map)).unwrap_or(cells.len())
    }

    /// Log odds that a cell is occupied given all others, nats, by the rays of the window through it. O(rays).
    #[inline(always)]
    pub(super) fn log_odds(&self, target: &Target, cell: usize, crossings: &[Crossing]) -> Lanes<f32> {
        let condensed = target.condensed[cell] as f32;
        let prior = target.prior_log_odds(&self.patterns, cell);
        let mut sum = each(|l| condensed + prior[l]);
        for crossing in crossings {
            let gain = self.nearest[crossing.place as usize].gain(crossing.step, crossing.log);
            sum = each(|l| sum[l] + gain[l]);
        }
        sum
    }

    /// Turns a cell in some maps, and follows the rays of the window through it.
    #[inline(always)]
    pub(super) fn flip(&mut self, target: &Target, cell: usize, crossings: &[Crossing], which: Maps) {
        self.turn(target, cell, which);
        let on = self.occupied[cell] & which;
        let off = which & !on;
        let fills = each(|l| has(on, l));
        let rays = &target.rays;
        for crossing in crossings {
            let (place, step) = (crossing.place as usize, crossing.step);
            let Nearest { first, second, value, without } = self.nearest[place];
            let nearer = each(|l| fills[l] & (step < first[l]));
            let between = each(|l| fills[l] & (step > first[l]) & (step < second[l]));
            let nearest = &mut self.nearest[place];
            nearest.second = each(|l| if between[l] { step } else { second[l] });
            nearest.second = each(|l| if nearer[l] { first[l] } else { nearest.second[l] });
            nearest.without = each(|l| if between[l] { crossing.log } else { without[l] });
            nearest.without = each(|l| if nearer[l] { value[l] } else { nearest.without[l] });
            nearest.first = each(|l| if nearer[l] { step } else { first[l] });
            nearest.value = each(|l| if nearer[l] { crossing.log } else { value[l] });
            let loses = maps(|l| (step == first[l]) | (step == second[l])) & off;
            if loses == 0 {
                continue;
            }
            for l in (0..LANES).filter(|l| has(loses, *l)) {
                let third = self.next(rays, place, second[l] as usize + 1, l);
                let nearest = &mut self.nearest[place];
                if step == first[l] {
                    (nearest.first[l], nearest.value[l]) = (second[l], without[l]);
                }
                (nearest.second[l], nearest.without[l]) = (third as u32, rays.value(place, third));
            }
        }
    }

    /// Turns a cell in some maps and their patterns, and nothing else.
    #[inline(always)]
    fn turn(&mut self, target: &Target, cell: usize, which: Maps) {
        self.occupied[cell] ^= which;
        let turned = each(|l| has(which, l));
        field::blocks(&target.spec, cell, |centre, bits| {
            let pattern = &mut self.patterns[centre];
            *pattern = each(|l| pattern[l] ^ if turned[l] { bits as u16 } else { 0 });
        });
    }
}

impl Held for Chains {
    fn held(&self) -> usize {
        self.occupied.held() + self.patterns.held() + self.nearest.held()
    }
}

impl Held for Target {
    fn held(&self) -> usize {
        self.adds.held() + self.rays.held() + self.condensed.held()
    }
}
