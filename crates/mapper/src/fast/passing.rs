//! Rays past the cells that they move: they count, unmoved, where other rays move cells, since a cell is the mean of all rays
//! through it, Eq. (20).

use grid::GridSpec;
use sensor::Ray;
use sensor::lanes::LANES;

use crate::fast::bundle::Reach;
use crate::fast::inputs::Inputs;
use crate::fast::lines::Lines;
use crate::fast::sums::{LEFT, Sums, rounded_one};
use crate::fast::tiles::PATCH;
use crate::fast::trace::BLOCK;

/// Adds to the sums, of every ray, the cells past its reach that another ray moves, unmoved, or those in patches
/// with a sheet where cells learn across rays. Which those are is in `before`, or else in the sums themselves.
///
/// All rays start in one place: such a cell is within the angle under which a cell is seen from there, and not
/// farther than the ray that reached farthest within that angle.
pub(super) fn add(
    inputs: &Inputs,
    reach: &[Reach],
    until_m: &[f64],
    bookmarks: &[Vec<Lines>],
    (before, sums): (Option<&Sums>, &mut Sums),
) {
    let bundles = reach.chunks(LANES).zip(until_m.chunks(LANES)).zip(bookmarks);
    for ((reach, until_m), bookmarks) in bundles {
        let open = |lane: usize| !reach[lane].whole && until_m[lane] > reach[lane].end_m;
        let Some(least) = (0..reach.len()).filter(|lane| open(*lane)).map(|lane| reach[lane].cells).min() else {
            continue;
        };
        // The cell before the first passing one is needed too.
        let block = (least as usize - 1) / BLOCK;
        let mut lines = bookmarks[block].clone();
        let mut previous = lines.cell();
        let mut edge = [0; LANES];
        for k in (block * BLOCK) as u32.. {
            let (cell, entered, alive) = (lines.cell(), lines.entered, lines.alive);
            let step = lines.step();
            if k >= least {
                let mut any = false;
                for lane in 0..reach.len() {
                    let inside = !reach[lane].whole && alive[lane] > 0.0 && entered[lane] <= until_m[lane];
                    any |= inside;
                    if inside && k >= reach[lane].cells {
                        let pairs = if lines.alive[lane] > 0.0 { 2 } else { 1 };
                        pass(inputs, (before, sums), [previous[lane], cell[lane]], edge[lane], pairs);
                    }
                }
                if !any {
                    break;
                }
            }
            previous = cell;
            edge = step.edge;
        }
    }
}

/// A cell that a ray passes unmoved, and the edge from the one before it.
fn pass(
    inputs: &Inputs,
    (before, sums): (Option<&Sums>, &mut Sums),
    [previous, cell]: [u32; 2],
    edge: u32,
    pairs: u32,
) {
    let counts = |sums: &Sums, cell: u32| match inputs.hops {
        0 => before.unwrap_or(sums).is_touched(cell),
        _ => before.unwrap_or(sums).sheet_of(cell as usize / PATCH).is_some(),
    };
    let (here, there) = (counts(sums, cell), counts(sums, previous));
    if !here && !there {
        return;
    }
    if here {
        let entry = sums.entry(cell);
        sums.add_cell(entry, pairs, f64::from(inputs.map.occupied(cell)));
    }
    let (low, axis) = (edge / 2, (edge % 2) as usize);
    let high = if previous == low { cell } else { previous };
    if counts(sums, high) {
        let entry = sums.entry(high);
        sums.at(entry).mark(LEFT << axis);
    }
    if counts(sums, low) {
        let [p, q, both] = inputs.map.pair([low, high], axis, inputs.continuity);
        let entry = sums.entry(low);
        sums.at(entry).add_differ(axis, rounded_one(p + q - 2.0 * both));
    }
}

/// Up to where another ray's cells are, that a ray can cross beyond its own reach, m: as far as any reached within the
/// angle, and across a cell and its neighbours, so many on either side.
pub(super) fn farthest(spec: &GridSpec, rays: &[Ray], reach: &[Reach], neighbours: usize) -> Vec<f64> {
    let mut order: Vec<usize> = (0..rays.len()).collect();
    let bearing = |ray: &usize| rays[*ray].bearing_rad;
    if !rays.is_sorted_by(|a, b| a.bearing_rad <= b.bearing_rad) {
        order.sort_by(|a, b| bearing(a).total_cmp(&bearing(b)));
    }
    let ends: Vec<f64> = order.iter().map(|ray| reach[*ray].end_m).collect();
    let all = ends.iter().copied().fold(0.0, f64::max);
    // `most[k][i]` is the maximum of 2^k ends from the i-th on.
    let mut most = vec![ends];
    while most[most.len() - 1].len() > 1 << (most.len() - 1) {
        let (last, half) = (&most[most.len() - 1], 1 << (most.len() - 1));
        most.push((0..last.len() - half).map(|i| last[i].max(last[i + half])).collect());
    }
    let span = order.last().map_or(0.0, bearing) - order.first().map_or(0.0, bearing);
    let diagonal_m = std::f64::consts::SQRT_2 * spec.cell_m * neighbours as f64;
    let mut until_m = vec![all; rays.len()];
    for ray in &order {
        let nearest_m = reach[*ray].end_m - diagonal_m;
        let angle = if nearest_m > diagonal_m { 1.6 * diagonal_m / nearest_m } else { std::f64::consts::TAU };
        if span + angle >= std::f64::consts::TAU {
            continue;
        }
        let at = bearing(ray);
        let first = order.partition_point(|other| bearing(other) < at - angle);
        let end = order.partition_point(|other| bearing(other) <= at + angle);
        let level = (end - first).ilog2() as usize;
        until_m[*ray] = most[level][first].max(most[level][end - (1 << level)]);
    }
    until_m.iter().map(|until_m| until_m + 2.0 * diagonal_m).collect()
}
