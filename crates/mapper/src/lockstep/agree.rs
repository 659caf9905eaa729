//! Agreement between rays, Eqs. (18)-(20): [`crate::PairwiseGrid::reconcile`] from a tally, patch by patch.

use pulp::{Arch, Simd, WithSimd};
use sensor::lanes::{Lanes, each};

use super::tally::{ABOVE, BELOW, Entry, LEFT, RIGHT, Tally};
use super::{Map, Tile, touched};
use crate::Reconciliation;
use crate::tiles::{Numbering, PATCH, SIDE, TILE, split};

/// Takes over what the tally holds, and empties it. O(cells of the patches touched).
///
/// With `d` for the probability that two neighbours differ, the product moment is `1 - 2 d`, and a joint is
/// `P(E_i, E_j) = (p_i + p_j - d) / 2`. `continuity` is false for a map of independent cells, which has no joints.
pub(super) fn agree(map: &mut Map, continuity: bool, tally: &mut Tally, rule: Reconciliation, moved: &mut Vec<Moved>) {
    match rule {
        Reconciliation::AllEdges => Arch::new().dispatch(AllEdges { map, continuity, tally, moved }),
        Reconciliation::Touched => touched::touched(map, continuity, tally),
    }
    tally.clear();
}

/// By how much the cells of a patch moved.
pub(super) type Moved = [f32; PATCH];

/// [`Reconciliation::AllEdges`]: an edge on no ray keeps the probability that its cells differ, so that its joint
/// moves by half of what its cells move. Two passes, in which nothing depends on what was touched first.
struct AllEdges<'a> {
    map: &'a mut Map,
    continuity: bool,
    tally: &'a Tally,
    moved: &'a mut Vec<Moved>,
}

impl WithSimd for AllEdges<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { map, continuity, tally, moved } = self;
        if moved.len() < tally.sheets().end {
            moved.resize(tally.sheets().end, [0.0; PATCH]);
        }
        for sheet in tally.sheets() {
            let first = first_of(tally, sheet);
            let missing = missing(&map.numbering, first);
            let (tile, from) = split(first);
            let occupied = patch_mut(&mut map.make(tile).occupied, from);
            marginals(occupied, tally.sheet(sheet), &missing, &mut moved[sheet]);
        }
        for sheet in tally.sheets().filter(|_| continuity) {
            let first = first_of(tally, sheet);
            let beyond = [0, 1].map(|axis| beyond(map, tally, moved, first, axis));
            let (tile, from) = split(first);
            joints(map.make(tile), from, tally.sheet(sheet), &moved[sheet], &beyond);
            for axis in 0..2 {
                match map.numbering.before(first, axis) {
                    Some(before) if tally.sheet_of(before as usize / PATCH).is_none() => {
                        follow(map, [before, first], axis, &moved[sheet]);
                    }
                    _ => {}
                }
            }
        }
    }
}

/// The first cell of a sheet's patch.
pub(super) fn first_of(tally: &Tally, sheet: usize) -> u32 {
    (tally.patch(sheet) * PATCH) as u32
}

#[inline(always)]
pub(super) fn patch(cells: &[f32; TILE], from: usize) -> &[f32; PATCH] {
    cells[from..from + PATCH].try_into().expect("a tile is made of patches")
}

#[inline(always)]
pub(super) fn patch_mut(cells: &mut [f32; TILE], from: usize) -> &mut [f32; PATCH] {
    (&mut cells[from..from + PATCH]).try_into().expect("a tile is made of patches")
}

#[inline(always)]
pub(super) fn row<T: Copy + Default>(cells: &[T; PATCH], row: usize) -> Lanes<T> {
    each(|c| cells[row * SIDE + c])
}

/// The edges that the cells of a patch at the border of the grid do not have.
pub(super) fn missing(numbering: &Numbering, first: u32) -> [u32; PATCH] {
    let (corner, spec) = (numbering.column_row(first), numbering.spec());
    let last = [spec.width - 1, spec.height - 1];
    let mut missing = [0; PATCH];
    if (0..2).any(|k| corner[k] == 0 || corner[k] + SIDE > last[k]) {
        for (place, missing) in missing.iter_mut().enumerate() {
            let at = [corner[0] + place % SIDE, corner[1] + place / SIDE];
            let outside = (0..2).any(|k| at[k] > last[k]);
            let edge = |absent: bool, edge: u32| if absent || outside { edge } else { 0 };
            *missing = edge(at[0] >= last[0], RIGHT)
                | edge(at[1] >= last[1], ABOVE)
                | edge(at[0] == 0, LEFT)
                | edge(at[1] == 0, BELOW);
        }
    }
    missing
}

/// The first pass: a cell is the mean of what rays say of it and, for every edge that no ray runs along, of what it was.
#[inline(always)]
fn marginals(occupied: &mut [f32; PATCH], sheet: &[Entry; PATCH], missing: &[u32; PATCH], moved: &mut Moved) {
    for r in 0..SIDE {
        let entries = &sheet[r * SIDE..(r + 1) * SIDE];
        let (p, missing) = (row(occupied, r), row(missing, r));
        let edges = each(|c| entries[c].edges() | missing[c]);
        let silent = each(|c| 4 - ((edges[c] & 1) + ((edges[c] >> 1) & 1) + ((edges[c] >> 2) & 1) + (edges[c] >> 3)));
        let sum = each(|c| entries[c].occupied + f64::from(silent[c] as i32) * f64::from(p[c]));
        let number = each(|c| f64::from((entries[c].pairs() + silent[c]) as i32));
        let mean = each(|c| (sum[c] / number[c]) as f32);
        let mean = each(|c| if mean[c] > LEAST { mean[c] } else { LEAST });
        let mean = each(|c| if mean[c] < MOST { mean[c] } else { MOST });
        // A cell alone in its grid has no edge.
        let after = each(|c| if number[c] > 0.0 { mean[c] } else { p[c] });
        for c in 0..SIDE {
            moved[r * SIDE + c] = after[c] - p[c];
            occupied[r * SIDE + c] = after[c];
        }
    }
}

/// What lies beyond the last column (0) or row (1) of a patch: probabilities, and by how much they moved.
fn beyond(map: &Map, tally: &Tally, moved: &[Moved], first: u32, axis: usize) -> [Lanes<f32>; 2] {
    let last = first + ((SIDE - 1) * [1, SIDE][axis]) as u32;
    let Some(after) = map.numbering.after(last, axis) else { return [[0.5; SIDE], [0.0; SIDE]] };
    let (tile, from) = split(after);
    let line = |cells: &[f32; PATCH]| each(|k| cells[k * [SIDE, 1][axis]]);
    let moved = tally.sheet_of(after as usize / PATCH).map_or([0.0; SIDE], |sheet| line(&moved[sheet]));
    [line(patch(&map.at(tile).occupied, from)), moved]
}

/// The second pass: the edges to the right and to the upper neighbours.
#[inline(always)]
fn joints(tile: &mut Tile, from: usize, sheet: &[Entry; PATCH], moved: &Moved, beyond: &[[Lanes<f32>; 2]; 2]) {
    let [[right, right_moved], [above, above_moved]] = beyond;
    let occupied = patch(&tile.occupied, from);
    let [to_right, to_above] = &mut tile.both;
    let both = [patch_mut(to_right, from), patch_mut(to_above, from)];
    for r in 0..SIDE {
        let entries = &sheet[r * SIDE..(r + 1) * SIDE];
        let (p, m) = (row(occupied, r), row(moved, r));
        let along = |row: &Lanes<f32>, last: f32| each(|c| if c + 1 < SIDE { row[(c + 1) % SIDE] } else { last });
        let others = [
            (along(&p, right[r]), along(&m, right_moved[r])),
            if r + 1 < SIDE { (row(occupied, r + 1), row(moved, r + 1)) } else { (*above, *above_moved) },
        ];
        for (axis, (q, other)) in others.iter().enumerate() {
            let old = row(both[axis], r);
            let rays = each(|c| f64::from(entries[c].rays(axis) as i32));
            let differ = each(|c| (entries[c].differ[axis] / rays[c]) as f32);
            let said = each(|c| 0.5 * (p[c] + q[c] - differ[c]));
            let kept = each(|c| old[c] + 0.5 * (m[c] + other[c]));
            for c in 0..SIDE {
                both[axis][r * SIDE + c] = possible(p[c], q[c], if rays[c] > 0.0 { said[c] } else { kept[c] });
            }
        }
    }
}

/// The edges into a patch from the one before it, of which nothing was said.
pub(super) fn follow(map: &mut Map, [before, first]: [u32; 2], axis: usize, moved: &Moved) {
    for k in (0..SIDE).map(|k| k * [SIDE, 1][axis]).filter(|k| moved[*k] != 0.0) {
        let q = map.occupied(first + k as u32);
        let (tile, place) = split(before + k as u32);
        let other = map.make(tile);
        let both = &mut other.both[axis][place];
        *both = possible(other.occupied[place], q, *both + 0.5 * moved[k]);
    }
}

/// Bounds of a cell, within [`crate::EPSILON`] of 0 and 1 in double precision too.
pub(super) const LEAST: f32 = 1.000_000_1e-6;
/// The upper one.
pub(super) const MOST: f32 = 0.999_998_9;

/// A joint as far as the marginals allow.
#[inline(always)]
pub(super) fn possible(p: f32, q: f32, both: f32) -> f32 {
    let low = if p + q > 1.0 { p + q - 1.0 } else { 0.0 };
    let high = if p < q { p } else { q };
    let both = if both > low { both } else { low };
    if both < high { both } else { high }
}
