//! Several rays from the map to the tally: Eqs. (1)-(7), one ray to a lane.

use pulp::{Arch, Simd, WithSimd};
use sensor::lanes::{Beams, LANES, Lanes, each};
use sensor::{Ray, SensorModel};

use super::Map;
use super::tail::Tail;
use super::tally::{Tally, rounded};
use crate::beyond::Beyond;
use crate::lateral::Across;
use crate::lines::Lines;
use crate::tiles::Numbering;

/// What rays read from a map and the mapper's setup.
pub(super) struct World<'a> {
    pub(super) map: &'a Map,
    /// Whether neighbours know of each other.
    pub(super) continuity: bool,
    pub(super) sensor: &'a dyn SensorModel,
    /// `u0` of an unseen world.
    pub(super) onset: f64,
    /// What the rays of the scan say of each other.
    pub(super) across: Option<&'a Across>,
    /// Whether cells on no ray learn from those on one.
    pub(super) lateral: bool,
}

/// Cells that are traced before the sensor model is asked about them.
pub(super) const BLOCK: usize = 64;

/// Less than this, in front of the last cell, is nothing: what lies beyond does not matter ...
const NOTHING: f32 = 1e-9;

/// ... where the evidence is at least this. Of a reading that has less, what lies beyond may be most of it.
const EVIDENT: f32 = 1e-3;

/// Evidence below this is left to double precision.
const LEAST_EVIDENCE: f32 = 1e-20;

/// Below this, what is left in front is nothing: it stops the walk through subnormal numbers.
const NEGLIGIBLE: f32 = 1e-30;

/// From the cell on behind which a reading moves no probability of a cell, or of two neighbours being different, by
/// more than this, it says nothing.
const SILENT: f32 = 1e-6;

/// A ray is followed no farther than to where the rest of it moves no probability by more than this and as much again:
/// half of [`SILENT`].
const CUT: f32 = 5e-7;

/// How far a ray has something to say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reach {
    /// Number of cells.
    pub(super) cells: u32,
    /// Range at which it leaves the last of them, m.
    pub(super) end_m: f64,
    /// Whether that is the border of the map.
    pub(super) whole: bool,
    /// Whether single precision has no evidence for the reading; nothing of it was said then.
    pub(super) unlikely: bool,
}

/// Rays in lockstep. A buffer to fill again and again.
///
/// The sum beyond a cell, `B` of [`crate::exact`], is in the posterior only through the evidence and through `ff`,
/// which is what the other three entries leave of one. The evidence is also what the front pass adds up to at the
/// end. So one pass from the sensor is enough, and its values are normalised afterwards.
pub(super) struct Bundle {
    lines: Lines,
    /// Number of the first ray among those of the scan.
    first: usize,
    tail: Tail,
    front: Front,
    /// Ranges of a block of cells, and the likelihoods.
    ranges: Vec<Lanes<f64>>,
    likelihood: Vec<Lanes<f32>>,
    /// The steps of the longest ray are [`taken`](Self::taken); the one after them has the transitions out of the last.
    steps: Vec<Step>,
    taken: usize,
    /// Cells of every ray, later of its reach; 0 of a lane without one.
    length: Lanes<u32>,
    /// Cells of every ray that was followed to the border; more than any other has.
    whole: Lanes<u32>,
    /// Number of cells that rays were updated over.
    pub(super) cells: u64,
}

/// Cell `k` of every ray. A ray that has ended stays in its last cell.
#[derive(Default, Clone, Copy)]
struct Step {
    cell: Lanes<u32>,
    /// The edge from the cell before.
    edge: Lanes<u32>,
    /// `P(E)`, and later `P'(E)` times the evidence.
    before: Lanes<f32>,
    after: Lanes<f32>,
    /// Transitions into the cell, `t` and `u`; once they are used, the probability that the cell and the one before
    /// it differ, before the reading, and after it times the evidence.
    stays: Lanes<f32>,
    becomes: Lanes<f32>,
    /// `1 - u`, where other rays can make much of little.
    passes: Lanes<f32>,
    /// Range at which it is entered, m.
    entered: Lanes<f64>,
}

/// What is known in front of, and at, the current cell of every ray, weighted with the likelihood of the reading, as
/// in [`crate::exact`].
#[derive(Default, Clone, Copy)]
struct Front {
    hit_occupied: Lanes<f32>,
    hit_free: Lanes<f32>,
    clear: Lanes<f32>,
    /// `P(E)` of the cell before.
    before: Lanes<f32>,
}

/// Tracing a block of cells, with what the processor has.
struct Trace<'a>(&'a mut Bundle, &'a World<'a>);

impl WithSimd for Trace<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.0.trace(self.1);
    }
}

/// The likelihoods of all rays, of a block from that of its own.
struct Join<'a>(&'a mut Bundle, &'a Across);

impl WithSimd for Join<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self(bundle, across) = self;
        across.join_lanes(bundle.first, &bundle.ranges, &mut bundle.likelihood);
    }
}

/// The front pass over the steps from the given one on.
struct Advance<'a>(&'a mut Bundle, usize);

impl WithSimd for Advance<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.0.advance(self.1);
    }
}

/// Normalising, and telling the tally.
struct Tell<'a>(&'a mut Bundle, &'a Lanes<f32>, &'a mut Tally);

impl WithSimd for Tell<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.0.tell(self.1, self.2);
    }
}

impl Bundle {
    pub(super) fn new(numbering: Numbering) -> Self {
        Self {
            lines: Lines::new(numbering),
            first: 0,
            tail: Tail::default(),
            front: Front::default(),
            ranges: Vec::new(),
            likelihood: Vec::new(),
            steps: Vec::new(),
            taken: 0,
            length: [0; LANES],
            whole: [0; LANES],
            cells: 0,
        }
    }

    /// Adds what up to [`LANES`] rays with readings say to the tally, as far as they say anything, and gives how far
    /// that is. `first` is the number of the first among those of the scan.
    pub(super) fn update(
        &mut self,
        world: &World,
        (first, rays): (usize, &[Ray]),
        tally: &mut Tally,
        bookmarks: &mut Vec<Lines>,
    ) -> Lanes<Reach> {
        let mut beams = Beams::default();
        self.first = first;
        self.lines = Lines::new(world.map.numbering);
        for (lane, ray) in rays.iter().enumerate() {
            let Some(reading) = ray.reading else { continue };
            if self.lines.start(lane, ray.origin_m, ray.direction, f64::INFINITY) {
                beams.reading[lane] = reading;
                beams.bearing_rad[lane] = ray.bearing_rad;
            }
        }
        self.walk(world, &beams, bookmarks);
        self.cells += self.length.iter().map(|length| u64::from(*length)).sum::<u64>();
        let evidence = self.evidence(world, &beams, rays);
        let mut unlikely = [false; LANES];
        for l in 0..LANES {
            if self.length[l] > 0 && !(evidence[l] > LEAST_EVIDENCE && evidence[l] < f32::INFINITY) {
                unlikely[l] = true;
                self.length[l] = 0;
            }
        }
        let normalise = evidence.map(|evidence| 1.0 / evidence);
        let reach = self.reach(&normalise);
        self.taken = reach.into_iter().max().unwrap_or(0) as usize;
        let followed = std::mem::replace(&mut self.length, reach);
        let ends = |l: usize| self.lines.alive[l] <= 0.0;
        self.whole = std::array::from_fn(|l| if ends(l) { followed[l] } else { u32::MAX });
        Arch::new().dispatch(Tell(self, &normalise, tally));
        std::array::from_fn(|l| {
            let whole = reach[l] == self.whole[l];
            let last = reach[l] == followed[l];
            let end_m = if last { self.lines.entered[l] } else { self.steps[reach[l] as usize].entered[l] };
            Reach { cells: reach[l], end_m, whole, unlikely: unlikely[l] }
        })
    }

    /// Memory held, bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of::<Step>() * self.steps.capacity()
    }

    /// Follows the rays, to the border or to where the rest says nothing: the front pass of Eqs. (4)-(7).
    fn walk(&mut self, world: &World, beams: &Beams, bookmarks: &mut Vec<Lines>) {
        bookmarks.clear();
        self.taken = 0;
        self.length = [0; LANES];
        let before: Lanes<f32> = self.lines.cell().map(|cell| world.map.occupied(cell));
        // Nothing is in front of the first cell: it follows a cell that is certainly free, and begins with its prior.
        self.front = Front { clear: [1.0; LANES], before, ..Front::default() };
        let arch = Arch::new();
        self.grow();
        self.steps[0] = Step { becomes: before, passes: each(|l| 1.0 - before[l]), ..Step::default() };
        while !self.lines.done() {
            let from = self.taken;
            bookmarks.push(self.lines.clone());
            self.grow();
            arch.dispatch(Trace(self, world));
            self.likelihood.resize(self.ranges.len() - 1, [0.0; LANES]);
            world.sensor.likelihood_lanes(beams, &self.ranges, &mut self.likelihood);
            if let Some(across) = world.across {
                arch.dispatch(Join(self, across));
            }
            arch.dispatch(Advance(self, from));
            if (0..LANES).all(|l| self.lines.alive[l] <= 0.0 || self.is_settled(l, world, beams)) {
                break;
            }
        }
    }

    /// Whether the cells that a ray has not crossed yet learn nothing: their likelihoods hardly differ, so that it does
    /// not matter which of them is hit, and what is known of the cell before them is what was known. Then the chain goes on as
    /// it would without a reading, and what it differs by falls from cell to cell.
    fn is_settled(&self, l: usize, world: &World, beams: &Beams) -> bool {
        let (Some(likelihood), step) = (self.likelihood.last(), &self.steps[self.taken - 1]) else { return false };
        let Front { hit_occupied, hit_free, clear, .. } = self.front;
        let evidence = hit_occupied[l] + hit_free[l] + clear[l] * likelihood[l];
        let moved = (hit_occupied[l] - step.before[l] * evidence).abs();
        let from_m = self.lines.entered[l];
        let spread = || match world.across {
            Some(across) => across.spread_from(self.first + l, from_m),
            None => world.sensor.spread_from(beams.reading[l], beams.bearing_rad[l], from_m),
        };
        moved <= CUT * evidence && f64::from(clear[l]) * spread() <= f64::from(CUT * evidence)
    }

    /// Makes room for a block, and the step after it.
    fn grow(&mut self) {
        let needed = self.taken + BLOCK + 1;
        if self.steps.len() < needed {
            self.steps.resize(needed, Step::default());
        }
    }

    /// At most [`BLOCK`] cells, with the transitions into them and out of the last.
    #[inline(always)]
    fn trace(&mut self, world: &World) {
        let mut lines = self.lines.clone();
        let mut cell = lines.cell();
        let mut length = each(|l| f64::from(self.length[l]));
        let mut before = self.front.before;
        self.ranges.clear();
        self.ranges.push(lines.entered);
        for _ in 0..BLOCK {
            let [step, following, ..] = &mut self.steps[self.taken..] else { return };
            length = each(|l| length[l] + lines.alive[l]);
            step.cell = cell;
            step.before = before;
            step.entered = lines.entered;
            let crossing = lines.step();
            self.ranges.push(crossing.exit);
            following.edge = crossing.edge;
            cell = lines.cell();
            let next = each(|l| world.map.occupied(cell[l]));
            let both = if world.continuity {
                each(|l| {
                    let edge = crossing.edge[l];
                    world.map.both(edge / 2, (edge % 2) as usize)
                })
            } else {
                each(|l| before[l] * next[l])
            };
            let alive = each(|l| lines.alive[l] as f32);
            let t = each(|l| both[l] / before[l]);
            let t = each(|l| if t[l] < 1.0 { t[l] } else { 1.0 });
            let u = each(|l| (next[l] - both[l]) / (1.0 - before[l]));
            let u = each(|l| if u[l] > 0.0 { u[l] } else { 0.0 });
            let u = each(|l| if u[l] < 1.0 { u[l] } else { 1.0 });
            following.stays = each(|l| alive[l] * t[l]);
            following.becomes = each(|l| alive[l] * u[l]);
            following.passes = if world.across.is_some() {
                // P(not E, not E_n) can be the last digit of a single.
                let clear = each(|l| 1.0 - f64::from(before[l]));
                let free = each(|l| (clear[l] - (f64::from(next[l]) - f64::from(both[l]))) / clear[l]);
                let free = each(|l| if free[l] > 0.0 { free[l] as f32 } else { 0.0 });
                each(|l| if alive[l] > 0.0 { free[l] } else { 1.0 })
            } else {
                each(|l| 1.0 - following.becomes[l])
            };
            before = next;
            self.taken += 1;
            if lines.done() {
                break;
            }
        }
        self.front.before = before;
        self.length = std::array::from_fn(|l| length[l] as u32);
        self.lines = lines;
    }

    /// The front pass over a block.
    #[inline(always)]
    fn advance(&mut self, from: usize) {
        let Front { mut hit_occupied, mut hit_free, mut clear, .. } = self.front;
        let mut previous = if from == 0 { [0.0; LANES] } else { self.steps[from - 1].before };
        for (step, likelihood) in self.steps[from..self.taken].iter_mut().zip(&self.likelihood) {
            let (t, u) = (step.stays, step.becomes);
            let leaves = each(|l| hit_occupied[l] * (1.0 - t[l])); // Eq. (5)
            let begins = each(|l| (hit_free[l] + clear[l] * likelihood[l]) * u[l]); // Eq. (6)
            step.stays = each(|l| previous[l] * (1.0 - t[l]) + (1.0 - previous[l]) * u[l]);
            step.becomes = each(|l| leaves[l] + begins[l]);
            hit_occupied = each(|l| hit_occupied[l] * t[l] + begins[l]);
            hit_free = each(|l| leaves[l] + hit_free[l] * (1.0 - u[l]));
            let ahead = each(|l| clear[l] * step.passes[l]);
            clear = each(|l| if ahead[l] < NEGLIGIBLE { 0.0 } else { ahead[l] });
            step.after = hit_occupied;
            previous = step.before;
        }
        self.front = Front { hit_occupied, hit_free, clear, ..self.front };
    }

    /// `P(o | O)` of every ray: what the front pass adds up to, and what lies beyond the last cell. Where that is the
    /// map, any of its cells does.
    fn evidence(&mut self, world: &World, beams: &Beams, rays: &[Ray]) -> Lanes<f32> {
        let Front { hit_occupied, hit_free, clear, .. } = self.front;
        let goes_on: Lanes<bool> = self.lines.alive.map(|alive| alive > 0.0);
        let nothing = each(|l| NOTHING * ((hit_occupied[l] + hit_free[l]) / EVIDENT).min(1.0));
        let open = |l: usize| self.length[l] > 0 && clear[l] > nothing[l] && !goes_on[l];
        let wanted: Lanes<bool> = std::array::from_fn(open);
        let mut none = [1.0; LANES];
        if let Some(across) = world.across {
            let beyond = |l: usize| across.beyond(self.first + l, self.lines.entered[l]);
            none = std::array::from_fn(|l| if wanted[l] { beyond(l) } else { 1.0 });
        } else if wanted != [false; LANES] {
            let beyond = std::array::from_fn(|l| {
                let direction = rays.get(l).map_or([1.0, 0.0], |ray| ray.direction);
                Beyond::at(self.lines.entered[l], direction, world.map.numbering.spec().cell_m, world.onset)
            });
            none = self.tail.likelihood(world.sensor, beams, &wanted, &beyond);
        }
        if let Some(last) = self.likelihood.last() {
            none = std::array::from_fn(|l| if goes_on[l] { last[l] } else { none[l] });
        }
        std::array::from_fn(|l| hit_occupied[l] + hit_free[l] + clear[l] * none[l])
    }

    /// Number of cells of every ray of which the reading says anything.
    fn reach(&self, normalise: &Lanes<f32>) -> Lanes<u32> {
        let mut reach = [0; LANES];
        let mut open = self.length.map(|length| length > 0);
        for (k, step) in self.steps[..self.taken].iter().enumerate().rev() {
            let speaks = each(|l| {
                let moved = (step.after[l] * normalise[l] - step.before[l]).abs();
                let differs = (step.becomes[l] * normalise[l] - step.stays[l]).abs();
                open[l] && (k as u32) < self.length[l] && (moved > SILENT || differs > SILENT || k == 0)
            });
            for l in (0..LANES).filter(|l| speaks[*l]) {
                reach[l] = k as u32 + 1;
                open[l] = false;
            }
            if open == [false; LANES] {
                break;
            }
        }
        reach
    }

    /// Normalises, and tells the tally; `length` is how far.
    #[inline(always)]
    fn tell(&mut self, normalise: &Lanes<f32>, tally: &mut Tally) {
        let mut previous = [0usize; LANES];
        for (k, step) in self.steps[..self.taken].iter().enumerate() {
            let occupied = rounded(&std::array::from_fn(|l| step.after[l] * normalise[l]));
            let differ = rounded(&std::array::from_fn(|l| step.becomes[l] * normalise[l]));
            for l in 0..LANES {
                if k as u32 >= self.length[l] {
                    continue;
                }
                let cell = step.cell[l];
                let here = tally.entry(cell);
                // A cell inside the ray is in two pairs, the first and the last are in one.
                let end = k == 0 || k as u32 + 1 == self.whole[l];
                tally.cell_of(here, if end { 1 } else { 2 }, occupied[l]);
                if k > 0 {
                    let edge = step.edge[l];
                    let up = edge / 2 != cell;
                    let (low, high) = if up { (previous[l], here) } else { (here, previous[l]) };
                    tally.pair(low, high, (edge % 2) as usize, differ[l]);
                }
                previous[l] = here;
            }
        }
    }
}
