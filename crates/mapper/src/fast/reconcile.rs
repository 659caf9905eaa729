//! Agreement between rays, Eqs. (18)-(20): [`crate::PairwiseGrid::reconcile`] from sums over rays, patch by patch.

use sensor::in_lanes;
use sensor::lanes::{Lanes, each};

use crate::belief::prior::Continuity;
use crate::fast::bounds::{bounded, possible};
use crate::fast::map::{Map, Tile};
use crate::fast::sums::{ABOVE, BELOW, LEFT, RIGHT, Sheet, Sums};
use crate::fast::tiles::{Numbering, PATCH, SIDE, TILE, split};

/// By how much the cells of a patch moved.
pub(super) type Moved = [f32; PATCH];

in_lanes! {
    /// [`Reconciliation::AllEdges`](crate::Reconciliation::AllEdges): an edge on no ray keeps the probability that its cells differ,
    /// so that its joint moves by half of what its cells move. Two passes, in which nothing depends on what was touched first.
    /// O(cells of the patches touched).
    ///
    /// With `d` for the probability that two neighbours differ, the product moment is `1 - 2 d`, and a joint is
    /// `P(E_i, E_j) = (p_i + p_j - d) / 2`. A map without continuity has no joints.
    ///
    /// What was summed is forgotten patch by patch, and what is known of the patches brought up to date, while they are at hand.
    pub(super) fn all_edges<'a>(map: &'a mut Map, continuity: Continuity, sums: &'a mut Sums, moved: &'a mut Vec<Moved>) {
        two_passes(map, continuity, sums, moved);
    }
}

#[inline(always)]
fn two_passes(map: &mut Map, continuity: Continuity, sums: &mut Sums, moved: &mut Vec<Moved>) {
    if moved.len() < sums.sheets().end {
        moved.resize(sums.sheets().end, [0.0; PATCH]);
    }
    for sheet in sums.sheets() {
        let first = first_of(sums, sheet);
        let missing = missing(&map.numbering, first);
        let (tile, from) = split(first);
        let occupied = patch_mut(&mut map.make(tile).occupied, from);
        marginals(occupied, sums.sheet(sheet), &missing, &mut moved[sheet]);
    }
    for sheet in sums.sheets() {
        let first = first_of(sums, sheet);
        if continuity == Continuity::Kept {
            let ahead = [0, 1].map(|axis| ahead(map, sums, moved, first, axis));
            let (tile, from) = split(first);
            joints(map.make(tile), from, sums.sheet(sheet), &moved[sheet], &ahead);
            follow(map, sums, sheet, &moved[sheet]);
        }
        sums.empty(sheet);
        map.summarise_patch(first, continuity);
    }
    sums.forget();
}

/// The first cell of a sheet's patch.
pub(super) fn first_of(sums: &Sums, sheet: usize) -> u32 {
    (sums.patch(sheet) * PATCH) as u32
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

/// The first pass: a cell is the mean of its rays and, for every edge that no ray runs along, of what it was, Eq. (20).
#[inline(always)]
fn marginals(occupied: &mut [f32; PATCH], sheet: &Sheet, missing: &[u32; PATCH], moved: &mut Moved) {
    for r in 0..SIDE {
        if !sheet.is_busy(r) {
            moved[r * SIDE..(r + 1) * SIDE].fill(0.0);
            continue;
        }
        let (p, missing) = (row(occupied, r), row(missing, r));
        let on_rays = sheet.edges(r);
        let edges = each(|c| on_rays[c] | missing[c]);
        let off_rays = each(|c| 4 - ((edges[c] & 1) + ((edges[c] >> 1) & 1) + ((edges[c] >> 2) & 1) + (edges[c] >> 3)));
        let off_rays = each(|c| off_rays[c] as i32 as f32);
        let (sums, pairs) = (sheet.occupied(r), sheet.pairs(r));
        let sum = each(|c| sums[c] as f32 + off_rays[c] * p[c]);
        let number = each(|c| pairs[c] as f32 + off_rays[c]);
        let mean = each(|c| bounded(sum[c] / number[c]));
        // A cell alone in its grid has no edge.
        let after = each(|c| if number[c] > 0.0 { mean[c] } else { p[c] });
        for c in 0..SIDE {
            moved[r * SIDE + c] = after[c] - p[c];
            occupied[r * SIDE + c] = after[c];
        }
    }
}

/// What lies ahead of the last column (0) or row (1) of a patch: probabilities, and by how much they moved.
fn ahead(map: &Map, sums: &Sums, moved: &[Moved], first: u32, axis: usize) -> [Lanes<f32>; 2] {
    let last = first + ((SIDE - 1) * [1, SIDE][axis]) as u32;
    let Some(after) = map.numbering.after(last, axis) else { return [[0.5; SIDE], [0.0; SIDE]] };
    let (tile, from) = split(after);
    let line = |cells: &[f32; PATCH]| each(|k| cells[k * [SIDE, 1][axis]]);
    let moved = sums.sheet_of(after as usize / PATCH).map_or([0.0; SIDE], |sheet| line(&moved[sheet]));
    [line(patch(&map.at(tile).occupied, from)), moved]
}

/// The second pass: the edges to the right and to the upper neighbours.
#[inline(always)]
fn joints(tile: &mut Tile, from: usize, sheet: &Sheet, moved: &Moved, ahead: &[[Lanes<f32>; 2]; 2]) {
    let [[right, right_moved], [above, above_moved]] = ahead;
    let occupied = patch(&tile.occupied, from);
    let [to_right, to_above] = &mut tile.both;
    let both = [patch_mut(to_right, from), patch_mut(to_above, from)];
    for r in 0..SIDE {
        let beyond = if r + 1 < SIDE { row(moved, r + 1) } else { *above_moved };
        if !sheet.is_busy(r) && beyond.iter().chain([&right_moved[r]]).all(|moved| moved.abs() <= 0.0) {
            continue;
        }
        let (p, m) = (row(occupied, r), row(moved, r));
        let along = |row: &Lanes<f32>, last: f32| each(|c| if c + 1 < SIDE { row[(c + 1) % SIDE] } else { last });
        let others = [
            (along(&p, right[r]), along(&m, right_moved[r])),
            (if r + 1 < SIDE { row(occupied, r + 1) } else { *above }, beyond),
        ];
        for (axis, (q, other)) in others.iter().enumerate() {
            let old = row(both[axis], r);
            let (sums, rays) = (sheet.differ(axis, r), sheet.rays(axis, r));
            let rays = each(|c| rays[c] as f32);
            let differ = each(|c| sums[c] as f32 / rays[c]);
            let by_rays = each(|c| 0.5 * (p[c] + q[c] - differ[c]));
            let kept = each(|c| old[c] + 0.5 * (m[c] + other[c]));
            for c in 0..SIDE {
                both[axis][r * SIDE + c] = possible(p[c], q[c], if rays[c] > 0.0 { by_rays[c] } else { kept[c] });
            }
        }
    }
}

/// The edges into the patch of a sheet from those before it, if no ray crosses these: joints move by half of what the patch does.
#[inline(always)]
pub(super) fn follow(map: &mut Map, sums: &Sums, sheet: usize, moved: &Moved) {
    let first = first_of(sums, sheet);
    for axis in 0..2 {
        match map.numbering.before(first, axis) {
            Some(before) if sums.sheet_of(before as usize / PATCH).is_none() => {
                follow_across(map, [before, first], axis, moved);
            }
            _ => {}
        }
    }
}

fn follow_across(map: &mut Map, [before, first]: [u32; 2], axis: usize, moved: &Moved) {
    let stride = [SIDE, 1][axis];
    if (0..SIDE).all(|k| moved[k * stride] == 0.0) {
        return;
    }
    let q = map.line(first, stride);
    let (tile, from) = split(before);
    let other = map.make(tile);
    for k in (0..SIDE).filter(|k| moved[k * stride] != 0.0) {
        let place = from + k * stride;
        let both = &mut other.both[axis][place];
        *both = possible(other.occupied[place], q[k], *both + 0.5 * moved[k * stride]);
    }
}
