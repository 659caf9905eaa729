//! The cells of several rays and the transitions between them, read out of the map: one ray to a lane.

use sensor::lanes::{LANES, Lanes, each};
use sensor::{Ray, in_lanes};

use crate::belief::prior::Continuity;
use crate::fast::inputs::Inputs;
use crate::fast::lines::Lines;
use crate::fast::tiles::Numbering;
use crate::fast::walk::Place;
use crate::memory::Held;

/// Cells that are traced before the sensor model is asked about them.
pub(super) const BLOCK: usize = 16;

/// A cell that is occupied with a larger probability leaves to the ray behind it what a single does not hold to its last digit.
const SURELY: f32 = 0.9;

/// In the place of an edge: the cell is where a leap has landed.
pub(super) const LANDING: u32 = u32::MAX;

/// Cell `k` of every ray. A ray that has ended stays in its last cell.
#[derive(Default, Clone, Copy)]
pub(super) struct Step {
    pub(super) cell: Lanes<u32>,
    /// The edge from the cell before, or [`LANDING`].
    pub(super) edge: Lanes<u32>,
    /// Range at which it is entered, m.
    pub(super) entered: Lanes<f64>,
    /// `P(E)` before the reading.
    pub(super) before: Lanes<f32>,
    /// `P'(E)` times the evidence.
    pub(super) after: Lanes<f32>,
    /// Probability that the cell and the one before it differ, before the reading ...
    pub(super) differ_before: Lanes<f32>,
    /// ... and after it, times the evidence.
    pub(super) differ_after: Lanes<f32>,
}

/// The transitions of the chain into a cell; none into the cell after the last.
#[derive(Default, Clone, Copy)]
pub(super) struct Transition {
    /// `t = P(E_{j+1} | E_j)`.
    pub(super) stays: Lanes<f32>,
    /// `u = P(E_{j+1} | not E_j)`.
    pub(super) becomes: Lanes<f32>,
    /// `1 - u`, to its own last digit where other rays can make much of little.
    pub(super) passes: Lanes<f64>,
}

/// Rays on their way through the map. A buffer to fill again and again.
pub(super) struct Trace {
    pub(super) lines: Lines,
    /// Cells of every ray so far; 0 of a lane without one.
    pub(super) length: Lanes<u32>,
    /// The steps of all rays; those of the longest are [`taken`](Self::taken).
    pub(super) steps: Vec<Step>,
    pub(super) taken: usize,
    /// Ranges of the last block of cells, m: one more than it has steps.
    pub(super) ranges: Vec<Lanes<f64>>,
    /// Transitions into the cells of the last block; the one after them leads out of it.
    transitions: [Transition; BLOCK + 1],
    /// `P(E)` of the next cell, and the edge to it.
    occupied: Lanes<f32>,
    edge: Lanes<u32>,
}

impl Trace {
    /// No ray.
    pub(super) fn new(numbering: Numbering) -> Self {
        Self {
            lines: Lines::new(numbering),
            length: [0; LANES],
            steps: Vec::new(),
            taken: 0,
            ranges: vec![[0.0; LANES]],
            transitions: [Transition::default(); BLOCK + 1],
            occupied: [0.0; LANES],
            edge: [0; LANES],
        }
    }

    /// Begins with other rays. The first cell follows one that is certainly free, and begins with its prior.
    pub(super) fn start(&mut self, inputs: &Inputs, lines: Lines) {
        self.occupied = lines.cell().map(|cell| inputs.map.occupied(cell));
        let passes = each(|l| 1.0 - f64::from(self.occupied[l]));
        self.transitions[0] = Transition { becomes: self.occupied, passes, ..Transition::default() };
        self.ranges.truncate(1);
        (self.lines, self.length, self.taken, self.edge) = (lines, [0; LANES], 0, [0; LANES]);
    }

    /// A ray is taken from where it is to another cell, as from one that is certainly free.
    pub(super) fn leap(&mut self, l: usize, inputs: &Inputs, ray: &Ray, landing: Place) {
        self.lines.go_on_from(l, ray.origin_m, ray.direction, landing, f64::INFINITY);
        let occupied = inputs.map.occupied(inputs.map.numbering.at(landing.at));
        (self.occupied[l], self.edge[l]) = (occupied, LANDING);
        let into = &mut self.transitions[self.ranges.len() - 1];
        (into.stays[l], into.becomes[l], into.passes[l]) = (0.0, occupied, 1.0 - f64::from(occupied));
    }

    /// A ray is followed no farther.
    pub(super) fn end(&mut self, l: usize) {
        self.lines.alive[l] = 0.0;
        let into = &mut self.transitions[self.ranges.len() - 1];
        (into.stays[l], into.becomes[l], into.passes[l]) = (0.0, 0.0, 1.0);
    }

    /// The cell that a ray was in before the one that it is in, and the edge between them; none of the first.
    pub(super) fn before(&self, l: usize) -> Option<[u32; 2]> {
        let last = self.steps[..self.taken].last()?;
        Some([last.cell[l], self.edge[l]])
    }

    /// Goes on by at most [`BLOCK`] cells.
    pub(super) fn go_on(&mut self, inputs: &Inputs) {
        self.transitions[0] = self.transitions[self.ranges.len() - 1];
        let needed = self.taken + BLOCK;
        if self.steps.len() < needed {
            self.steps.resize(needed, Step::default());
        }
        block(self, inputs);
    }

    /// The steps of the last block, with the transitions into each and the ranges.
    pub(super) fn last_block(&mut self) -> (&mut [Step], &[Transition]) {
        let cells = self.ranges.len() - 1;
        (&mut self.steps[self.taken - cells..self.taken], &self.transitions[..cells])
    }

    #[inline(always)]
    fn block(&mut self, inputs: &Inputs) {
        let mut lines = self.lines.clone();
        let (mut cell, mut edge, mut before) = (lines.cell(), self.edge, self.occupied);
        let mut length = each(|l| f64::from(self.length[l]));
        self.ranges.clear();
        self.ranges.push(lines.entered);
        for following in &mut self.transitions[1..] {
            let Some(step) = self.steps.get_mut(self.taken) else { return };
            length = each(|l| length[l] + lines.alive[l]);
            (step.cell, step.edge, step.entered, step.before) = (cell, edge, lines.entered, before);
            let crossing = lines.step();
            self.ranges.push(crossing.exit);
            (cell, edge) = (lines.cell(), crossing.edge);
            let next = each(|l| inputs.map.occupied(cell[l]));
            let edge_of = |l: usize| inputs.map.both(edge[l] / 2, (edge[l] % 2) as usize);
            let both = match inputs.continuity {
                Continuity::Kept => each(|l| f64::from(edge_of(l))),
                Continuity::Ignored => each(|l| f64::from(before[l]) * f64::from(next[l])),
            };
            let alive = each(|l| lines.alive[l] as f32);
            let single = each(|l| both[l] as f32);
            let t = each(|l| single[l] / before[l]);
            let t = each(|l| if t[l] < 1.0 { t[l] } else { 1.0 });
            let u = each(|l| (next[l] - single[l]) / (1.0 - before[l]));
            let u = each(|l| if u[l] > 0.0 { u[l] } else { 0.0 });
            let u = each(|l| if u[l] < 1.0 { u[l] } else { 1.0 });
            following.stays = each(|l| alive[l] * t[l]);
            following.becomes = each(|l| alive[l] * u[l]);
            // P(not E, not E_n) can be the last digit of a single: in walls, and where other rays can make much of little.
            let surely = u.iter().copied().fold(0.0, f32::max) > SURELY;
            following.passes = if surely || inputs.others.is_some() {
                let clear = each(|l| 1.0 - f64::from(before[l]));
                let free = each(|l| (clear[l] - (f64::from(next[l]) - both[l])) / clear[l]);
                let free = each(|l| if free[l] > 0.0 { free[l] } else { 0.0 });
                each(|l| if alive[l] > 0.0 { free[l] } else { 1.0 })
            } else {
                each(|l| 1.0 - f64::from(following.becomes[l]))
            };
            before = next;
            self.taken += 1;
            if lines.done() {
                break;
            }
        }
        (self.lines, self.edge, self.occupied) = (lines, edge, before);
        self.length = std::array::from_fn(|l| length[l] as u32);
    }
}

in_lanes! {
    fn block<'a>(trace: &'a mut Trace, inputs: &'a Inputs<'a>) {
        trace.block(inputs);
    }
}

impl Held for Trace {
    fn held(&self) -> usize {
        self.steps.held()
    }
}
