//! What some time does to tiles: their places first, then the edges of these.

use sensor::in_lanes;
use sensor::lanes::{Lanes, each};

use crate::belief::renewal::{Elapsed, KINDS};
use crate::fast::bounds::{bounded, possible};
use crate::fast::map::{Map, Tile};
use crate::fast::renewal::{Changes, Shares, UNITS};
use crate::fast::tiles::{PATCH, SIDE, TILE, split};

/// What some time does to a place, in single precision.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    pub(super) kept: [[f32; KINDS]; KINDS],
    /// Probability that a place of each kind is renewed.
    pub(super) loss: [f32; KINDS],
    pub(super) same_kind: f32,
    pub(super) shares: [f32; KINDS],
}

impl Step {
    pub(super) fn of(elapsed: &Elapsed) -> Self {
        let single = |values: [f64; KINDS]| values.map(|value| value as f32);
        Self {
            kept: elapsed.kept.map(single),
            loss: single(elapsed.survival.map(|survival| 1.0 - survival)),
            same_kind: elapsed.same_kind as f32,
            shares: single(elapsed.shares),
        }
    }
}

/// A tile for which time has passed: what its cells were, and with which probability they are renewed, if occupied and if free.
#[derive(Debug, Clone)]
pub(super) struct Passed {
    pub(super) tile: usize,
    pub(super) step: Step,
    pub(super) occupied: [f32; TILE],
    pub(super) loss: [[f32; TILE]; 2],
}

/// Working memory: the tiles for which time passes now.
#[derive(Debug, Clone, Default)]
pub(super) struct Passing {
    pub(super) tiles: Vec<Passed>,
    /// How many of them there are now; the others are kept for the next scan.
    pub(super) number: usize,
    /// Of every tile of the map, its place among them, or [`STANDS`], or [`UNSEEN`].
    pub(super) places: Vec<u32>,
}

/// A tile that stands at the time that it stood at.
pub(super) const STANDS: u32 = u32::MAX - 1;

/// A tile of which nothing is known but the prior, which stands at any time.
pub(super) const UNSEEN: u32 = u32::MAX;

/// One end of a row of edges: what its cells were, and with which probability they are renewed, if occupied and if free.
#[derive(Clone, Copy)]
struct End {
    occupied: Lanes<f32>,
    loss: [Lanes<f32>; 2],
}

in_lanes! {
    /// Lets time pass for the tiles that are selected: first their places, then the edges of these.
    pub(super) fn pass<'a>(map: &'a mut Map, changes: &'a mut Changes) {
        places_and_edges(map, changes);
    }
}

#[inline(always)]
fn places_and_edges(map: &mut Map, changes: &mut Changes) {
    let Changes { prior: [prior, both], shares, passing, .. } = changes;
    for passed in &mut passing.tiles[..passing.number] {
        let (tile, shares) = (map.make(passed.tile), shares.make(passed.tile));
        for row in (0..TILE).step_by(SIDE) {
            places(passed, row, *prior, tile, shares);
        }
    }
    let drawn = [*prior, *both];
    for number in 0..passing.number {
        let Passed { tile, step, .. } = passing.tiles[number];
        let first = (tile * TILE) as u32;
        for patch in (first..first + TILE as u32).step_by(PATCH) {
            edges_within(map, passing, patch, &step, drawn);
            edges_from_before(map, passing, patch, &step, drawn);
        }
        map.summarise(tile);
    }
}

/// `P(E)` of a place that is renewed with the probability `lost` if it is occupied, and `drawn` if it is free.
#[inline(always)]
pub(super) fn after(p: f32, lost: f32, drawn: f32, prior: f32) -> f32 {
    bounded(p - p * lost + prior * (p * lost + (1.0 - p) * drawn))
}

/// A row of places after some time.
#[inline(always)]
fn places(passed: &mut Passed, row: usize, prior: f32, tile: &mut Tile, shares: &mut Shares) {
    let step = &passed.step;
    let p: Lanes<f32> = each(|c| passed.occupied[row + c]);
    let not_p = each(|c| 1.0 - p[c]);
    // P(kind | E), P(kind | not E).
    let kinds = [kinds(&shares.of[0], row), kinds(&shares.of[1], row)];
    let (lost, drawn) = (weighted(&step.loss, &kinds[0]), weighted(&step.loss, &kinds[1]));
    passed.loss[0][row..row + SIDE].copy_from_slice(&lost);
    passed.loss[1][row..row + SIDE].copy_from_slice(&drawn);
    let after = each(|c| after(p[c], lost[c], drawn[c], prior));
    tile.occupied[row..row + SIDE].copy_from_slice(&after);
    let noise = dither(passed.tile, row, shares.at_s);
    for k in 1..KINDS {
        let (left_e, left_f) = (weighted(&step.kept[k], &kinds[0]), weighted(&step.kept[k], &kinds[1]));
        let (left_e, left_f) = (each(|c| p[c] * left_e[c]), each(|c| not_p[c] * left_f[c]));
        let was = each(|c| p[c] * kinds[0][k][c] + not_p[c] * kinds[1][k][c]);
        let is = each(|c| step.same_kind * was[c] + (1.0 - step.same_kind) * step.shares[k]);
        let renewed = each(|c| more(is[c] - left_e[c] - left_f[c], 0.0));
        let occupied = each(|c| (left_e[c] + prior * renewed[c]) / after[c]);
        let free = each(|c| (left_f[c] + (1.0 - prior) * renewed[c]) / (1.0 - after[c]));
        for (x, share) in [occupied, free].iter().enumerate() {
            let shift = 8 * (2 * x + k - 1) as u32;
            let up = each(|c| ((noise[c] >> shift) & 255) as i32 as f32 * (1.0 / 256.0));
            let units = each(|c| whole(share[c] * UNITS + up[c]));
            shares.of[x][k - 1][row..row + SIDE].copy_from_slice(&units);
        }
    }
}

/// `P(kind | E)`, or `P(kind | not E)`, of a row of places.
#[inline(always)]
fn kinds(of: &[[u16; TILE]; 2], row: usize) -> [Lanes<f32>; KINDS] {
    let second = each(|c| f32::from(of[0][row + c]) * (1.0 / UNITS));
    let third = each(|c| f32::from(of[1][row + c]) * (1.0 / UNITS));
    [each(|c| 1.0 - second[c] - third[c]), second, third]
}

/// A sum over kinds.
#[inline(always)]
fn weighted(by: &[f32; KINDS], of: &[Lanes<f32>; KINDS]) -> Lanes<f32> {
    each(|c| by[0] * of[0][c] + by[1] * of[1][c] + by[2] * of[2][c])
}

/// The larger, without a care for what is no number.
#[inline(always)]
fn more(x: f32, y: f32) -> f32 {
    if x > y { x } else { y }
}

/// The smaller.
#[inline(always)]
fn less(x: f32, y: f32) -> f32 {
    if x < y { x } else { y }
}

/// The whole part of a number of units, from 0 to below 65,536, by the low bits of a number so large that it has no others.
#[inline(always)]
fn whole(units: f32) -> u16 {
    const WHOLE: f32 = 12_582_912.0; // 3 times 2^22
    let units = if units < UNITS { units } else { UNITS };
    ((units - 0.5 + WHOLE).to_bits() & 0xffff) as u16
}

/// Four numbers of 8 bits for each cell of a row, by which shares are rounded: to the one or the other side as often as keeps their mean,
/// since what a short time adds is less than a unit.
#[inline(always)]
fn dither(tile: usize, row: usize, at_s: f64) -> Lanes<u32> {
    let time = at_s.to_bits();
    let seed = (time ^ (time >> 32)) as u32 ^ ((tile * TILE + row) as u32).wrapping_mul(0x9e37_79b9);
    each(|c| {
        let mixed = (seed ^ (c as u32).wrapping_mul(0x85eb_ca6b)).wrapping_mul(0xc2b2_ae35);
        let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x27d4_eb2f);
        mixed ^ (mixed >> 13)
    })
}

impl Passing {
    /// The cells from `from` on, each `stride` behind the one before, at one end of edges; the other end passes through `step`.
    #[inline(always)]
    fn end(&self, map: &Map, from: u32, stride: usize, step: &Step) -> End {
        let number = from;
        let (tile, from) = split(from);
        match self.places[tile] {
            STANDS => End { occupied: map.line(number, stride), loss: [[0.0; SIDE]; 2] },
            UNSEEN => {
                let loss =
                    step.loss[0] * step.shares[0] + step.loss[1] * step.shares[1] + step.loss[2] * step.shares[2];
                End { occupied: map.line(number, stride), loss: [[loss; SIDE]; 2] }
            }
            place => {
                let passed = &self.tiles[place as usize];
                End {
                    occupied: each(|k| passed.occupied[from + k * stride]),
                    loss: [each(|k| passed.loss[0][from + k * stride]), each(|k| passed.loss[1][from + k * stride])],
                }
            }
        }
    }
}

/// The edges of a patch to the right and to the upper neighbours.
#[inline(always)]
fn edges_within(map: &mut Map, passing: &Passing, patch: u32, step: &Step, drawn: [f32; 2]) {
    let (tile, from) = split(patch);
    let last = (SIDE - 1) as u32;
    let right = match map.numbering.after(patch + last, 0) {
        Some(after) => (passing.end(map, after, SIDE, step), map.line(after, SIDE)),
        None => NOTHING,
    };
    let above = match map.numbering.after(patch + last * SIDE as u32, 1) {
        Some(after) => (passing.end(map, after, 1, step), map.line(after, 1)),
        None => NOTHING,
    };
    let mut row = (passing.end(map, patch, 1, step), map.line(patch, 1));
    for r in 0..SIDE {
        let next = match r + 1 < SIDE {
            true => {
                let next = patch + ((r + 1) * SIDE) as u32;
                (passing.end(map, next, 1, step), map.line(next, 1))
            }
            false => above,
        };
        let (here, now) = &row;
        let beside = End {
            occupied: along(&here.occupied, right.0.occupied[r]),
            loss: [along(&here.loss[0], right.0.loss[0][r]), along(&here.loss[1], right.0.loss[1][r])],
        };
        let [to_right, to_above] = &mut map.make(tile).both;
        edges(to_right, from + r * SIDE, [here, &beside], [now, &along(now, right.1[r])], drawn);
        edges(to_above, from + r * SIDE, [here, &next.0], [now, &next.1], drawn);
        row = next;
    }
}

/// Beyond the border of the grid: edges to there are not read.
const NOTHING: (End, Lanes<f32>) = (End { occupied: [0.5; SIDE], loss: [[0.0; SIDE]; 2] }, [0.5; SIDE]);

/// A row moved to the left, with what comes from its right.
#[inline(always)]
fn along(row: &Lanes<f32>, last: f32) -> Lanes<f32> {
    each(|c| if c + 1 < SIDE { row[(c + 1) % SIDE] } else { last })
}

/// The edges into a patch from those before it, where these stand still.
#[inline(always)]
fn edges_from_before(map: &mut Map, passing: &Passing, patch: u32, step: &Step, drawn: [f32; 2]) {
    for axis in 0..2 {
        let Some(before) = map.numbering.before(patch, axis) else { continue };
        let (tile, from) = split(before);
        if passing.places[tile] != STANDS {
            continue;
        }
        let stride = [SIDE, 1][axis];
        let ends = [passing.end(map, before, stride, step), passing.end(map, patch, stride, step)];
        let now = [map.line(before, stride), map.line(patch, stride)];
        let all = &mut map.make(tile).both[axis];
        let mut both = [0.0; TILE];
        (0..SIDE).for_each(|k| both[k] = all[from + k * stride]);
        edges(&mut both, 0, [&ends[0], &ends[1]], [&now[0], &now[1]], drawn);
        (0..SIDE).for_each(|k| all[from + k * stride] = both[k]);
    }
}

/// A row of edges after some time, from what their ends were and are: [`crate::pairs::renewal::both_after`].
#[inline(always)]
fn edges(joints: &mut [f32; TILE], from: usize, was: [&End; 2], is: [&Lanes<f32>; 2], [prior, both]: [f32; 2]) {
    let [first, second] = was;
    let ee: Lanes<f32> = each(|c| joints[from + c]);
    let ef = each(|c| more(first.occupied[c] - ee[c], 0.0));
    let fe = each(|c| more(second.occupied[c] - ee[c], 0.0));
    let ff = each(|c| more(1.0 - ee[c] - ef[c] - fe[c], 0.0));
    let ([a, not_a], [b, not_b]) = (&first.loss, &second.loss);
    let neither = each(|c| ee[c] * (1.0 - more(a[c], b[c])));
    let one = each(|c| {
        ee[c] * (more(a[c], b[c]) - less(a[c], b[c]))
            + ef[c] * more(not_b[c] - a[c], 0.0)
            + fe[c] * more(not_a[c] - b[c], 0.0)
    });
    let together = each(|c| {
        ee[c] * less(a[c], b[c])
            + ef[c] * less(a[c], not_b[c])
            + fe[c] * less(not_a[c], b[c])
            + ff[c] * less(not_a[c], not_b[c])
    });
    for c in 0..SIDE {
        joints[from + c] = possible(is[0][c], is[1][c], neither[c] + prior * one[c] + both * together[c]);
    }
}
