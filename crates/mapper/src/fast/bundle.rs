//! Several rays from the map to the sums over rays: Eqs. (1)-(7), one ray to a lane.
//!
//! The sum beyond a cell, `B` of [`crate::exact`], is in the posterior only through the evidence and through `ff`,
//! which is what the other three entries leave of one. The evidence is also what the front pass adds up to at the
//! end. So one pass from the sensor is enough, and its values are normalised afterwards.

use sensor::lanes::{Beams, LANES, Lanes, each};
use sensor::{Ray, ReadingKernel, in_lanes};

use crate::fast::budget::{CUT, EVIDENT, LEAST_EVIDENCE, NEGLIGIBLE, OPEN, UNMOVED};
use crate::fast::inputs::Inputs;
use crate::fast::lines::Lines;
use crate::fast::passage::{Passage, Reach};
use crate::fast::settled::{self, Leaps};
use crate::fast::sums::{Entry, Sums, words};
use crate::fast::tail::Tail;
use crate::fast::tiles::Numbering;
use crate::fast::trace::{LANDING, Step, Trace, Transition};
use crate::fast::walk::Place;
use crate::memory::Held;
use crate::ray::past_the_map::PastTheMap;

/// What became of a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Outcome {
    /// It was added as far as it moves cells.
    Added(Reach),
    /// Single precision has no evidence for the reading; nothing was added.
    Unlikely,
    /// It leapt where it should not have; nothing was added.
    Leapt,
}

/// What the map says of the readings of up to [`LANES`] rays.
pub(super) struct Predicted {
    /// `P(o | O)`, per unit of the reading; of a lane without a ray, anything.
    pub(super) evidence: Lanes<f32>,
    /// Single precision has no evidence for the reading.
    pub(super) unlikely: Lanes<bool>,
    /// The ray leapt where it should not have.
    pub(super) leapt: Lanes<bool>,
}

/// Up to [`LANES`] rays. A buffer to fill again and again.
pub(super) struct Bundle {
    trace: Trace,
    front: Front,
    /// Likelihoods of the last block of cells.
    likelihood: Vec<Lanes<f32>>,
    /// What is followed no more, and the likelihood of all that lies behind.
    cut: Lanes<bool>,
    rest: Lanes<f32>,
    leaps: Leaps,
    tail: Tail,
    /// Number of cells that rays were updated over.
    pub(super) cells: u64,
    /// Number of cells that they leapt over.
    pub(super) skipped: u64,
}

/// What is known in front of, and at, the current cell of every ray, weighted with the likelihood of the reading: `W_E`,
/// `W_F` and `S` of [`crate::exact`].
#[derive(Default, Clone, Copy)]
struct Front {
    hit_occupied: Lanes<f32>,
    hit_free: Lanes<f32>,
    clear: Lanes<f64>,
}

impl Front {
    /// Moves on by a block of cells; `previous` is `P(E)` of the cell before it.
    #[inline(always)]
    fn advance(
        &mut self,
        mut previous: Lanes<f32>,
        steps: &mut [Step],
        transitions: &[Transition],
        likelihood: &[Lanes<f32>],
    ) {
        let Self { mut hit_occupied, mut hit_free, mut clear } = *self;
        for ((step, into), likelihood) in steps.iter_mut().zip(transitions).zip(likelihood) {
            let (t, u) = (into.stays, into.becomes);
            let leaves = each(|l| hit_occupied[l] * (1.0 - t[l])); // Eq. (5)
            let begins = each(|l| (hit_free[l] + clear[l] as f32 * likelihood[l]) * u[l]); // Eq. (6)
            step.differ_before = each(|l| previous[l] * (1.0 - t[l]) + (1.0 - previous[l]) * u[l]);
            step.differ_after = each(|l| leaves[l] + begins[l]);
            hit_occupied = each(|l| hit_occupied[l] * t[l] + begins[l]); // Eqs. (4), (6)
            hit_free = each(|l| leaves[l] + hit_free[l] * (1.0 - u[l])); // Eqs. (5), (7)
            let ahead = each(|l| clear[l] * into.passes[l]); // Eq. (13)
            clear = each(|l| if ahead[l] < f64::from(NEGLIGIBLE) { 0.0 } else { ahead[l] });
            step.after = hit_occupied;
            previous = step.before;
        }
        *self = Self { hit_occupied, hit_free, clear };
    }
}

in_lanes! {
    fn advance<'a>(
        front: &'a mut Front,
        previous: Lanes<f32>,
        steps: &'a mut [Step],
        transitions: &'a [Transition],
        likelihood: &'a [Lanes<f32>],
    ) {
        front.advance(previous, steps, transitions, likelihood);
    }
}

impl Bundle {
    pub(super) fn new(numbering: Numbering) -> Self {
        Self {
            trace: Trace::new(numbering),
            front: Front::default(),
            likelihood: Vec::new(),
            cut: [false; LANES],
            rest: [0.0; LANES],
            leaps: Leaps::default(),
            tail: Tail::default(),
            cells: 0,
            skipped: 0,
        }
    }

    /// Adds the posteriors of up to [`LANES`] rays with readings to the sums, as far as they move cells, and tells what
    /// became of each. `first` is the number of the first among those of the scan; they leap over settled patches, if wanted.
    pub(super) fn update(
        &mut self,
        inputs: &Inputs,
        (first, rays): (usize, &[Ray]),
        leap: bool,
        sums: &mut Sums,
    ) -> Lanes<Outcome> {
        let Predicted { evidence, unlikely, leapt } = self.predict(inputs, (first, rays), leap);
        let followed = self.trace.length;
        self.cells += followed.iter().map(|length| u64::from(*length)).sum::<u64>();
        self.skipped += self.leaps.cells.iter().map(|cells| u64::from(*cells)).sum::<u64>();
        let likely = each(|l| if unlikely[l] || leapt[l] { 0 } else { followed[l] });
        let normalise = evidence.map(|evidence| 1.0 / evidence); // alpha of Eq. (1)
        let steps = &self.trace.steps[..self.trace.taken];
        let reach = reach(steps, &likely, &normalise);
        // Cells of every ray that was followed to the border; more than any other has.
        let lines = &self.trace.lines;
        let whole = each(|l| if lines.alive[l] <= 0.0 && !self.cut[l] { likely[l] } else { u32::MAX });
        let longest = reach.into_iter().max().unwrap_or(0) as usize;
        add(&steps[..longest], &reach, &whole, &normalise, sums);
        std::array::from_fn(|l| {
            if leapt[l] {
                return Outcome::Leapt;
            }
            if unlikely[l] {
                return Outcome::Unlikely;
            }
            let end_m = if reach[l] == likely[l] { lines.entered[l] } else { steps[reach[l] as usize].entered[l] };
            let last = reach[l].checked_sub(1).map_or(lines.place(l), |k| {
                let step = &steps[k as usize];
                let at = inputs.map.numbering.column_row(step.cell[l]).map(|at| at as u32);
                Place { at, entered: step.entered[l] }
            });
            Outcome::Added(Reach { last, end_m, whole: reach[l] == whole[l] })
        })
    }

    /// How likely the readings of up to [`LANES`] rays are, with `leap` and `first` as in [`update`](Self::update); the rays are
    /// followed as far as that needs, and nothing is added to any sum.
    pub(super) fn predict(&mut self, inputs: &Inputs, (first, rays): (usize, &[Ray]), leap: bool) -> Predicted {
        let mut beams = Beams::default();
        let mut lines = Lines::new(inputs.map.numbering);
        for (lane, ray) in rays.iter().enumerate() {
            let Some(reading) = ray.reading else { continue };
            if lines.start(lane, ray.origin_m, ray.direction, f64::INFINITY) {
                beams.reading[lane] = reading;
                beams.bearing_rad[lane] = ray.bearing_rad;
            }
        }
        self.trace.start(inputs, lines);
        let kernel = &*inputs.sensor.of_readings(&beams);
        self.leaps.start(inputs, kernel, leap);
        self.follow(inputs, kernel, first, rays);
        let followed = self.trace.length;
        let evidence = self.evidence(inputs, kernel, (first, &beams), rays);
        let unlikely: Lanes<bool> =
            each(|l| followed[l] > 0 && !(evidence[l] > LEAST_EVIDENCE && evidence[l] < f32::INFINITY));
        let leapt: Lanes<bool> = each(|l| !self.leaps.hold(l, evidence[l]) || self.leaps.cells[l] > 0 && unlikely[l]);
        Predicted { evidence, unlikely, leapt }
    }

    /// The cells that rays of the last update have leapt over, with their lanes.
    pub(super) fn passages(&self) -> &[(usize, Passage)] {
        &self.leaps.passages
    }

    /// Follows the rays, to the border or to where the rest moves nothing: the front pass of Eqs. (4)-(7).
    fn follow(&mut self, inputs: &Inputs, kernel: &dyn ReadingKernel, first: usize, rays: &[Ray]) {
        self.front = Front { clear: [1.0; LANES], ..Front::default() };
        self.cut = [false; LANES];
        let mut previous = [0.0; LANES];
        while !self.trace.lines.done() {
            rays.iter().enumerate().for_each(|(l, ray)| self.leap(l, inputs, ray, &mut previous));
            self.trace.go_on(inputs);
            let ranges = &self.trace.ranges;
            self.likelihood.resize(ranges.len() - 1, [0.0; LANES]);
            kernel.likelihood(ranges, &mut self.likelihood); // Eq. (21)
            if let Some(others) = inputs.others {
                others.join_lanes(first, ranges, &mut self.likelihood);
            }
            let (steps, transitions) = self.trace.last_block();
            advance(&mut self.front, previous, steps, transitions, &self.likelihood);
            let Some(last) = steps.last().copied() else { break };
            previous = last.before;
            // Each by itself, so that it does not matter with which others it was taken.
            for l in 0..LANES {
                if self.trace.lines.alive[l] > 0.0 && self.is_settled(l, inputs, kernel, first, &last) {
                    (self.cut[l], self.rest[l]) = (true, self.likelihood[self.likelihood.len() - 1][l]);
                    self.trace.end(l);
                }
            }
        }
    }

    /// Takes a ray over settled patches, if it is in one: the chain goes on from the cell behind them, where all hits that lie
    /// before it have the one likelihood of this part of the kernel.
    fn leap(&mut self, l: usize, inputs: &Inputs, ray: &Ray, previous: &mut Lanes<f32>) {
        let [from_m, until_m] = self.leaps.flat_m[l];
        let place = self.trace.lines.place(l);
        if self.trace.lines.alive[l] <= 0.0 || place.entered < from_m || place.entered >= until_m {
            return;
        }
        let Some(leap) = settled::leap(inputs.map, inputs.squares, ray, place, until_m) else { return };
        let last = Some(inputs.map.numbering.at(leap.landing.at));
        let before = self.trace.before(l);
        let passage = Passage { ray: 0, from: place, with_first: true, before, last, until_m: f64::INFINITY };
        self.leaps.passages.push((l, passage));
        self.trace.leap(l, inputs, ray, leap.landing);
        let Front { hit_occupied, hit_free, clear } = &mut self.front;
        let hit = clear[l] as f32 * leap.hazard;
        (hit_occupied[l], hit_free[l]) = (0.0, hit_occupied[l] + hit_free[l] + hit * self.leaps.likelihood[l]);
        clear[l] -= f64::from(hit);
        previous[l] = 0.0;
        self.leaps.hit[l] += hit;
        self.leaps.cells[l] += leap.cells;
    }

    /// Whether the cells that a ray has not crossed yet learn nothing: their likelihoods hardly differ from that of the `last`, so
    /// that it does not matter which of them is hit, and what is known of the last is what was known. Then the chain goes on
    /// as it would without a reading, and what it differs by falls from cell to cell.
    fn is_settled(&self, l: usize, inputs: &Inputs, kernel: &dyn ReadingKernel, first: usize, last: &Step) -> bool {
        let Some(likelihood) = self.likelihood.last() else { return false };
        let Front { hit_occupied, hit_free, clear } = self.front;
        let evidence = hit_occupied[l] + hit_free[l] + clear[l] as f32 * likelihood[l];
        let moved = (hit_occupied[l] - last.before[l] * evidence).abs();
        let spread = || match inputs.others {
            Some(others) => others.spread_from(first + l, last.entered[l]),
            None => kernel.spread_from(l, last.entered[l]),
        };
        moved <= CUT * evidence && clear[l] * spread() <= f64::from(CUT * evidence)
    }

    /// `P(o | O)` of every ray: what the front pass adds up to, and what lies past the last cell, be that the last of the map or
    /// the one at which the ray was cut.
    fn evidence(
        &mut self,
        inputs: &Inputs,
        kernel: &dyn ReadingKernel,
        (first, beams): (usize, &Beams),
        rays: &[Ray],
    ) -> Lanes<f32> {
        let Front { hit_occupied, hit_free, clear } = self.front;
        let clear = clear.map(|clear| clear as f32);
        let Trace { lines, length, .. } = &self.trace;
        let nothing = each(|l| OPEN * ((hit_occupied[l] + hit_free[l]) / EVIDENT).min(1.0));
        let mut wanted: Lanes<bool> = each(|l| length[l] > 0 && clear[l] > nothing[l] && !self.cut[l]);
        let mut none = [1.0; LANES];
        if let Some(others) = inputs.others {
            none = each(|l| if wanted[l] { others.past_the_map(first + l, lines.entered[l]) } else { 1.0 });
        } else if wanted != [false; LANES] {
            let mut border = [[0.0; LANES]];
            kernel.likelihood(&[lines.entered; 2], &mut border);
            let [border] = border;
            // Where all that lies past the border is as likely as what lies on it.
            let flat = each(|l| {
                let spread = kernel.spread_from(l, lines.entered[l]);
                let evidence = hit_occupied[l] + hit_free[l] + clear[l] * border[l];
                f64::from(clear[l]) * spread <= f64::from(CUT * evidence)
            });
            wanted = each(|l| wanted[l] && !flat[l]);
            if wanted != [false; LANES] {
                let past = std::array::from_fn(|l| {
                    let direction = rays.get(l).map_or([1.0, 0.0], |ray| ray.direction);
                    PastTheMap::at(lines.entered[l], direction, inputs.map.numbering.spec().cell_m, inputs.onset)
                });
                none = self.tail.likelihood(inputs.sensor, beams, &wanted, &past); // Eq. (7), k to infinity
            }
            none = each(|l| if flat[l] { border[l] } else { none[l] });
        }
        none = each(|l| if self.cut[l] { self.rest[l] } else { none[l] });
        each(|l| hit_occupied[l] + hit_free[l] + clear[l] * none[l])
    }
}

impl Held for Bundle {
    fn held(&self) -> usize {
        self.trace.held()
    }
}

/// Number of cells of every ray, of so many, up to the last that the reading moves; at least one.
fn reach(steps: &[Step], length: &Lanes<u32>, normalise: &Lanes<f32>) -> Lanes<u32> {
    let mut reach = [0; LANES];
    let mut open = length.map(|length| length > 0);
    for (k, step) in steps.iter().enumerate().rev() {
        let moves = each(|l| {
            let moved = (step.after[l] * normalise[l] - step.before[l]).abs();
            let differs = (step.differ_after[l] * normalise[l] - step.differ_before[l]).abs();
            open[l] && (k as u32) < length[l] && (moved > UNMOVED || differs > UNMOVED || k == 0)
        });
        for l in (0..LANES).filter(|l| moves[*l]) {
            reach[l] = k as u32 + 1;
            open[l] = false;
        }
        if open == [false; LANES] {
            break;
        }
    }
    reach
}

in_lanes! {
    fn add<'a>(
        steps: &'a [Step],
        reach: &'a Lanes<u32>,
        whole: &'a Lanes<u32>,
        normalise: &'a Lanes<f32>,
        sums: &'a mut Sums,
    ) {
        add_normalised(steps, reach, whole, normalise, sums);
    }
}

/// Adds the normalised posteriors of every ray to the sums of Eq. (20), up to its reach; `whole` is the number of its cells.
#[inline(always)]
fn add_normalised(steps: &[Step], reach: &Lanes<u32>, whole: &Lanes<u32>, normalise: &Lanes<f32>, sums: &mut Sums) {
    let mut previous = [Entry::default(); LANES];
    // Where leaps have landed a step before.
    let mut landed = [LANDING; LANES];
    for (k, step) in steps.iter().enumerate() {
        let occupied = words(&each(|l| step.after[l] * normalise[l]));
        let differ = words(&each(|l| step.differ_after[l] * normalise[l]));
        for l in 0..LANES {
            if k as u32 >= reach[l] {
                continue;
            }
            let (cell, edge) = (step.cell[l], step.edge[l]);
            if edge == LANDING {
                // A settled cell: it is passed, and only the edge behind it is not.
                landed[l] = cell;
                continue;
            }
            let here = sums.entry(cell);
            // A cell inside the ray is in two pairs, the first and the last are in one.
            let end = k == 0 || k as u32 + 1 == whole[l];
            let pairs = if end { 1 } else { 2 };
            if k == 0 {
                sums.add_cell(here, pairs, occupied[l]);
            } else {
                let forward = edge / 2 != cell;
                if landed[l] != LANDING {
                    let low = if forward { sums.entry(landed[l]) } else { Entry::default() };
                    (previous[l], landed[l]) = (low, LANDING);
                }
                sums.add_step([previous[l], here], forward, (edge % 2) as usize, (pairs, occupied[l], differ[l]));
            }
            previous[l] = here;
        }
    }
}
