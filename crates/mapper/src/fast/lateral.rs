//! Edges on no ray by Jeffrey's rule, patch by patch: [`crate::PairwiseGrid::reconcile_laterally`] from sums over rays.

use sensor::in_lanes;
use sensor::lanes::{Lanes, each};

use crate::belief::lateral::Lateral;
use crate::fast::bounds::{bounded, possible};
use crate::fast::map::{Map, Tile};
use crate::fast::reconcile::{Moved, first_of, follow, missing, patch, patch_mut, row};
use crate::fast::sums::{ABOVE, BELOW, LEFT, RIGHT, Sheet, Sums};
use crate::fast::tiles::{PATCH, SIDE, split};
use crate::memory::Held;

/// The sides of a patch: an axis, and whether along it or against it.
const SIDES: [(usize, bool); 4] = [(0, true), (1, true), (0, false), (1, false)];

/// Working memory, a patch to a sheet.
#[derive(Default)]
pub(super) struct Layers {
    /// By how much cells have moved: what their neighbours learn from.
    moved: Vec<Moved>,
    /// The same after one more step.
    next: Vec<Moved>,
}

impl Held for Layers {
    fn held(&self) -> usize {
        self.moved.held() + self.next.held()
    }
}

in_lanes! {
    /// The map that agrees best with the rays and with what edges on no ray have learnt. O(cells of the patches touched, and of
    /// those around them).
    pub(super) fn reconcile<'a>(
        map: &'a mut Map,
        sums: &'a Sums,
        lateral: &'a Lateral,
        hops: usize,
        layers: &'a mut Layers,
    ) {
        hop_by_hop(map, sums, lateral, hops, layers);
    }
}

#[inline(always)]
fn hop_by_hop(map: &mut Map, sums: &Sums, lateral: &Lateral, hops: usize, layers: &mut Layers) {
    let Layers { moved, next } = layers;
    moved.clear();
    moved.push([0.0; PATCH]);
    for sheet in sums.sheets() {
        let (tile, from) = split(first_of(sums, sheet));
        moved.push(by_rays(patch(&map.at(tile).occupied, from), sums.sheet(sheet)));
    }
    next.resize(moved.len(), [0.0; PATCH]);
    for hop in 0..hops {
        if hop > 0 {
            std::mem::swap(moved, next);
        }
        for sheet in sums.sheets() {
            let first = first_of(sums, sheet);
            let around = SIDES.map(|side| Side::of(map, sums, moved, first, side));
            let (tile, from) = split(first);
            let missing = missing(&map.numbering, first);
            let place = (map.at(tile), from);
            marginals(place, &missing, sums.sheet(sheet), &around, lateral, &moved[sheet], &mut next[sheet]);
        }
    }
    let after = next;
    for sheet in sums.sheets() {
        let first = first_of(sums, sheet);
        let ahead = [SIDES[0], SIDES[1]].map(|side| Side::of(map, sums, moved, first, side));
        let [right, above] = [SIDES[0], SIDES[1]].map(|side| Side::of(map, sums, after, first, side).moved);
        let (tile, from) = split(first);
        let moves = [&moved[sheet], &after[sheet]];
        joints((map.make(tile), from), sums.sheet(sheet), &ahead, [&right, &above], lateral, moves);
    }
    for sheet in sums.sheets() {
        let (tile, from) = split(first_of(sums, sheet));
        let occupied = patch_mut(&mut map.make(tile).occupied, from);
        occupied.iter_mut().zip(&after[sheet]).for_each(|(p, after)| *p = bounded(*p + after));
    }
    for sheet in sums.sheets() {
        follow(map, sums, sheet, &after[sheet]);
    }
}

/// By how much rays alone move the cells of a patch.
#[inline(always)]
fn by_rays(occupied: &[f32; PATCH], sheet: &Sheet) -> Moved {
    let mut moved = [0.0; PATCH];
    for r in 0..SIDE {
        let (p, sums, pairs) = (row(occupied, r), sheet.occupied(r), sheet.pairs(r));
        let mean = each(|c| (sums[c] / pairs[c]) as f32);
        for c in 0..SIDE {
            moved[r * SIDE + c] = if pairs[c] > 0.0 { mean[c] - p[c] } else { 0.0 };
        }
    }
    moved
}

/// Opens sheets for patches with cells that are at most `hops`, no more than a patch has along a side, from one of which
/// is on a ray.
pub(super) fn open(map: &Map, sums: &mut Sums, hops: usize) {
    let row = |cells: u64, row: usize| cells >> (row * SIDE) & 0xff;
    // Columns and rows from which the patch beside can be reached, by the direction to it.
    let columns = [(1, 0xff << (SIDE - hops) & 0xff), (-1, 0xff >> (SIDE - hops)), (0, 0xff)];
    let rows = [(1, SIDE - hops..SIDE), (-1, 0..hops), (0, 0..SIDE)];
    for sheet in sums.sheets() {
        let first = first_of(sums, sheet);
        let cells = sums.sheet(sheet);
        let on_rays = (0..PATCH).fold(0u64, |on_rays, place| on_rays | u64::from(cells.is_touched(place)) << place);
        for (y, rows) in &rows {
            let cells = rows.clone().fold(0, |cells, number| cells | row(on_rays, number));
            for (x, _) in columns.iter().filter(|(x, columns)| (*x, *y) != (0, 0) && cells & columns != 0) {
                let beside = if *x == 0 { Some(first) } else { next_to(map, first, 0, *x > 0) };
                let cell = beside.and_then(|cell| if *y == 0 { Some(cell) } else { next_to(map, cell, 1, *y > 0) });
                cell.map(|cell| sums.entry(cell));
            }
        }
    }
}

/// Place in a patch of the k-th cell of a column (axis 0) or row (1).
#[inline(always)]
fn line(axis: usize, number: usize, k: usize) -> usize {
    if axis == 0 { k * SIDE + number } else { number * SIDE + k }
}

/// The first cell of the patch beside the one that begins with `first`.
fn next_to(map: &Map, first: u32, axis: usize, forward: bool) -> Option<u32> {
    let last = first + line(axis, SIDE - 1, 0) as u32;
    let cell = if forward { map.numbering.after(last, axis) } else { map.numbering.before(first, axis) };
    cell.map(|cell| cell - cell % PATCH as u32)
}

/// The cells beside a patch, before the scan: their probabilities, by how much they moved, and their joints with the
/// next along the axis.
struct Side {
    occupied: Lanes<f32>,
    moved: Lanes<f32>,
    both: Lanes<f32>,
}

impl Side {
    #[inline(always)]
    fn of(map: &Map, sums: &Sums, moved: &[Moved], first: u32, (axis, forward): (usize, bool)) -> Self {
        let Some(cell) = next_to(map, first, axis, forward) else {
            return Self { occupied: [0.5; SIDE], moved: [0.0; SIDE], both: [0.25; SIDE] };
        };
        let (tile, from) = split(cell);
        let tile = map.at(tile);
        let pick = |cells: &[f32; PATCH]| each(|k| cells[line(axis, if forward { 0 } else { SIDE - 1 }, k)]);
        let moved = sums.sheet_of(cell as usize / PATCH).map_or([0.0; SIDE], |sheet| pick(&moved[sheet]));
        Self { occupied: pick(patch(&tile.occupied, from)), moved, both: pick(patch(&tile.both[axis], from)) }
    }
}

/// A row of cells with what is to its right or left.
#[inline(always)]
fn shifted(row: &Lanes<f32>, beyond: f32, forward: bool) -> Lanes<f32> {
    if forward {
        each(|c| if c + 1 < SIDE { row[(c + 1) % SIDE] } else { beyond })
    } else {
        each(|c| if c > 0 { row[(c + SIDE - 1) % SIDE] } else { beyond })
    }
}

/// A cell is the mean of its rays and, for every edge that no ray runs along, of what it has learnt itself, of
/// what its neighbour has learnt, and of what it was.
#[inline(always)]
fn marginals(
    (tile, from): (&Tile, usize),
    missing: &[u32; PATCH],
    sheet: &Sheet,
    [right, above, left, below]: &[Side; 4],
    lateral: &Lateral,
    moved: &Moved,
    next: &mut Moved,
) {
    let occupied = patch(&tile.occupied, from);
    let both = [0, 1].map(|axis| patch(&tile.both[axis], from));
    let (learnt, weight) = (lateral.learnt as f32, 2.0 * lateral.learnt + lateral.before);
    for r in 0..SIDE {
        let (p, m, missing) = (row(occupied, r), row(moved, r), row(missing, r));
        let [to_right, to_above] = both.map(|both| row(both, r));
        let on_rays = sheet.edges(r);
        let edges = each(|c| on_rays[c] | missing[c]);
        let up = if r + 1 < SIDE { [row(occupied, r + 1), row(moved, r + 1)] } else { [above.occupied, above.moved] };
        let down = if r > 0 {
            [row(occupied, r - 1), row(moved, r - 1), row(both[1], r - 1)]
        } else {
            [below.occupied, below.moved, below.both]
        };
        let others = [
            (RIGHT, shifted(&p, right.occupied[r], true), shifted(&m, right.moved[r], true), to_right),
            (ABOVE, up[0], up[1], to_above),
            (
                LEFT,
                shifted(&p, left.occupied[r], false),
                shifted(&m, left.moved[r], false),
                shifted(&to_right, left.both[r], false),
            ),
            (BELOW, down[0], down[1], down[2]),
        ];
        let (mut learnt_of, mut off_rays) = ([0.0f32; SIDE], [0.0f32; SIDE]);
        for (edge, q, moved, both) in others {
            let counts = each(|c| if edges[c] & edge == 0 { 1.0f32 } else { 0.0 });
            // P(E | E_n) - P(E | not E_n); the covariance over the variance is the same, but not in single precision.
            let gain = each(|c| both[c] / q[c] - (p[c] - both[c]) / (1.0 - q[c]));
            learnt_of = each(|c| learnt_of[c] + counts[c] * (m[c] + gain[c] * moved[c]));
            off_rays = each(|c| off_rays[c] + counts[c]);
        }
        let (sums, pairs) = (sheet.occupied(r), sheet.pairs(r));
        let sum = each(|c| (sums[c] - pairs[c] * f64::from(p[c])) + f64::from(learnt * learnt_of[c]));
        let number = each(|c| pairs[c] + weight * f64::from(off_rays[c]));
        let after = each(|c| p[c] + (sum[c] / number[c]) as f32);
        let after = each(|c| bounded(after[c]));
        for c in 0..SIDE {
            next[r * SIDE + c] = if number[c] > 0.0 { after[c] - p[c] } else { 0.0 };
        }
    }
}

/// The edges to the right and to the upper neighbours.
#[inline(always)]
fn joints(
    (tile, from): (&mut Tile, usize),
    sheet: &Sheet,
    [right, above]: &[Side; 2],
    after: [&Lanes<f32>; 2],
    lateral: &Lateral,
    [moved, moves]: [&Moved; 2],
) {
    let occupied = patch(&tile.occupied, from);
    let share = (lateral.learnt / (2.0 * lateral.learnt + lateral.before)) as f32;
    let [to_right, to_above] = &mut tile.both;
    let both = [patch_mut(to_right, from), patch_mut(to_above, from)];
    for r in 0..SIDE {
        let (p, m, d) = (row(occupied, r), row(moved, r), row(moves, r));
        let others = [
            [shifted(&p, right.occupied[r], true), shifted(&m, right.moved[r], true), shifted(&d, after[0][r], true)],
            if r + 1 < SIDE {
                [row(occupied, r + 1), row(moved, r + 1), row(moves, r + 1)]
            } else {
                [above.occupied, above.moved, *after[1]]
            },
        ];
        for (axis, [q, other, e]) in others.iter().enumerate() {
            let old = row(both[axis], r);
            let (sums, rays) = (sheet.differ(axis, r), sheet.rays(axis, r));
            let differ = each(|c| (sums[c] / rays[c]) as f32);
            let now = each(|c| [bounded(p[c] + d[c]), bounded(q[c] + e[c])]);
            let by_rays = each(|c| 0.5 * (now[c][0] + now[c][1] - differ[c]));
            // 1 - P(E_n | E) - P(E_n | not E): what the probability that the two differ learns from either.
            let here = each(|c| (1.0 - old[c] / p[c] - (q[c] - old[c]) / (1.0 - p[c])) * m[c]);
            let there = each(|c| (1.0 - old[c] / q[c] - (p[c] - old[c]) / (1.0 - q[c])) * other[c]);
            let kept = each(|c| old[c] + 0.5 * (d[c] + e[c] - share * (here[c] + there[c])));
            for c in 0..SIDE {
                both[axis][r * SIDE + c] =
                    possible(now[c][0], now[c][1], if rays[c] > 0.0 { by_rays[c] } else { kept[c] });
            }
        }
    }
}
