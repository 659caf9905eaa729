//! Agreement between rays, Eqs. (18)-(20): [`crate::PairwiseGrid::reconcile`] from a tally.

use grid::GridSpec;

use super::Cell;
use super::tally::{ABOVE, BELOW, LEFT, RIGHT, Tally};
use crate::Reconciliation;
use crate::pairs::{both_occupied, correlation};

/// An edge that no reading says anything of, owned by a cell that none says anything of.
struct Silent {
    low: usize,
    axis: usize,
    kept: f64,
    rule: Reconciliation,
}

/// Takes over what the tally holds, and empties it. O(cells touched).
///
/// With `d` for the probability that two neighbours differ, the product moment is `1 - 2 d`, and a joint is
/// `P(E_i, E_j) = (p_i + p_j - d) / 2`. `continuity` is false for a map of independent cells, which has no joints.
pub(super) fn agree(spec: &GridSpec, map: &mut [Cell], continuity: bool, tally: &mut Tally, rule: Reconciliation) {
    match rule {
        Reconciliation::AllEdges => all_edges(spec, map, continuity, tally),
        Reconciliation::Touched => touched(spec, map, continuity, tally),
    }
    tally.clear(map);
}

/// [`Reconciliation::AllEdges`]: an edge on no ray keeps the probability that its cells differ, so that its joint
/// moves by half of what its cells move. Two passes, in which nothing depends on what was touched first.
fn all_edges(spec: &GridSpec, map: &mut [Cell], continuity: bool, tally: &mut Tally) {
    let per_row = 1.0 / spec.width as f64;
    for number in 1..=tally.len() {
        let cell = tally.cell(number);
        let around = Around::of(spec, per_row, cell);
        let entry = tally.get(number);
        let here = &mut map[cell];
        let p = f64::from(here.occupied);
        let silent = (around.edges & !entry.edges).count_ones();
        let mean = share(entry.occupied + f64::from(silent) * p, entry.pairs + silent);
        here.occupied = (mean as f32).clamp(LEAST, MOST);
        here.set_moved((f64::from(here.occupied) - p) as f32);
    }
    if !continuity {
        return;
    }
    for number in 1..=tally.len() {
        let cell = tally.cell(number);
        let around = Around::of(spec, per_row, cell);
        let own = tally.get(number);
        let (p, moved) = (map[cell].occupied, map[cell].moved());
        for axis in 0..2 {
            let step = around.stride[axis];
            if around.edges & (RIGHT << axis) != 0 {
                let other = &map[cell + step];
                let (q, moved) = (other.occupied, moved + other.moved());
                let rays = own.rays[axis];
                let differ = share(own.differ[axis], rays) as f32;
                let said = 0.5 * (p + q - differ);
                let kept = map[cell].both[axis] + 0.5 * moved;
                map[cell].both[axis] = possible(p, q, if rays > 0 { said } else { kept });
            }
            if around.edges & (LEFT << axis) != 0 {
                let other = &mut map[cell - step];
                if !other.is_touched() {
                    other.both[axis] = possible(p, other.occupied, other.both[axis] + 0.5 * moved);
                }
            }
        }
    }
}

/// [`Reconciliation::Touched`]: an edge on no ray keeps its correlation, and has no say in the marginals.
fn touched(spec: &GridSpec, map: &mut [Cell], continuity: bool, tally: &mut Tally) {
    let rule = Reconciliation::Touched;
    let mut foreign = Vec::new();
    let per_row = 1.0 / spec.width as f64;
    for number in 1..=tally.len() {
        let cell = tally.cell(number);
        let around = Around::of(spec, per_row, cell);
        let own = *tally.get(number);
        let p = f64::from(map[cell].occupied);
        let mean = own.occupied / f64::from(own.pairs);
        let mut kept = own.differ;
        if continuity {
            for axis in 0..2 {
                let (after, before) = (RIGHT << axis, LEFT << axis);
                let step = around.stride[axis];
                if around.edges & after != 0 && own.rays[axis] == 0 {
                    kept[axis] = keeps(rule, p, f64::from(map[cell + step].occupied), f64::from(map[cell].both[axis]));
                }
                if around.edges & before != 0 && !map[cell - step].is_touched() {
                    let other = &map[cell - step];
                    // Rays that run along it say what it was.
                    let rule = if own.edges & before != 0 { Reconciliation::AllEdges } else { rule };
                    let kept = keeps(rule, p, f64::from(other.occupied), f64::from(other.both[axis]));
                    foreign.push(Silent { low: cell - step, axis, kept, rule });
                }
            }
        }
        let entry = tally.at(number);
        entry.occupied = mean;
        entry.differ = kept;
    }
    for (number, cell) in tally.touched() {
        map[cell].occupied = (tally.get(number).occupied as f32).clamp(LEAST, MOST);
    }
    if continuity {
        for (number, cell) in tally.touched() {
            let (own, around) = (tally.get(number), Around::of(spec, per_row, cell));
            for axis in 0..2 {
                if around.edges & (RIGHT << axis) != 0 {
                    let (p, q) = (map[cell].occupied, map[cell + around.stride[axis]].occupied);
                    map[cell].both[axis] = match own.rays[axis] {
                        0 => restored(rule, p, q, own.differ[axis]),
                        rays => from_differing(p, q, own.differ[axis] / f64::from(rays)),
                    };
                }
            }
        }
        for Silent { low, axis, kept, rule } in foreign {
            let other = low + [1, spec.width][axis];
            map[low].both[axis] = restored(rule, map[low].occupied, map[other].occupied, kept);
        }
    }
}

/// Bounds of a cell, within [`crate::EPSILON`] of 0 and 1 in double precision too.
pub(super) const LEAST: f32 = 1.000_000_1e-6;
/// The upper one.
pub(super) const MOST: f32 = 0.999_998_9;

/// A sum over its number; small numbers are the rule, and divisions are slow. 0 of none.
fn share(sum: f64, number: u32) -> f64 {
    const SMALL: [f64; 64] = {
        let mut inverse = [0.0; 64];
        let mut number = 1;
        while number < 64 {
            inverse[number] = 1.0 / number as f64;
            number += 1;
        }
        inverse
    };
    match SMALL.get(number as usize) {
        Some(inverse) => sum * inverse,
        None => sum / f64::from(number),
    }
}

/// What an edge on no ray keeps of its state before the scan.
fn keeps(rule: Reconciliation, p: f64, q: f64, both: f64) -> f64 {
    match rule {
        Reconciliation::AllEdges => p + q - 2.0 * both,
        Reconciliation::Touched => correlation(p, q, both),
    }
}

/// Its joint, from what it kept.
fn restored(rule: Reconciliation, p: f32, q: f32, kept: f64) -> f32 {
    match rule {
        Reconciliation::AllEdges => from_differing(p, q, kept),
        Reconciliation::Touched => both_occupied(f64::from(p), f64::from(q), kept) as f32,
    }
}

fn from_differing(p: f32, q: f32, differ: f64) -> f32 {
    possible(p, q, (0.5 * (f64::from(p) + f64::from(q) - differ)) as f32)
}

/// A joint as far as the marginals allow.
fn possible(p: f32, q: f32, both: f32) -> f32 {
    let (low, high) = ((p + q - 1.0).max(0.0), p.min(q));
    if both < low {
        low
    } else if both > high {
        high
    } else {
        both
    }
}

/// Where a cell is in the grid.
struct Around {
    /// The edges that it has.
    edges: u32,
    /// From a cell to the next along each axis.
    stride: [usize; 2],
}

impl Around {
    fn of(spec: &GridSpec, per_row: f64, cell: usize) -> Self {
        // Exact as long as a row has fewer than 2^20 cells, and far faster than a division of whole numbers.
        let row = ((cell as f64 + 0.5) * per_row) as usize;
        let column = cell - row * spec.width;
        let edge = |there: bool, edge: u32| if there { edge } else { 0 };
        let edges = edge(column + 1 < spec.width, RIGHT)
            | edge(row + 1 < spec.height, ABOVE)
            | edge(column > 0, LEFT)
            | edge(row > 0, BELOW);
        Self { edges, stride: [1, spec.width] }
    }
}
