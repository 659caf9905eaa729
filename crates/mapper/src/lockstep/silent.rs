//! Rays beyond what they say anything of: they count where other rays speak, since a cell is the mean of all rays
//! through it, Eq. (20).

use grid::GridSpec;
use sensor::Ray;
use sensor::lanes::LANES;

use super::bundle::{BLOCK, Reach, World};
use super::tally::{LEFT, Tally};
use crate::lines::Lines;
use crate::tiles::PATCH;

/// Adds to the tally, of every ray, the cells from its reach on that another ray has reached, unmoved, or those in patches
/// with a sheet where cells learn across rays. Which those are is in `spoken`, or else in the tally itself.
///
/// All rays start in one place: such a cell is within the angle under which a cell is seen from there, and not
/// farther than the ray that reached farthest within that angle.
pub(super) fn add(
    world: &World,
    reach: &[Reach],
    until_m: &[f64],
    bookmarks: &[Vec<Lines>],
    (spoken, tally): (Option<&Tally>, &mut Tally),
) {
    let bundles = reach.chunks(LANES).zip(until_m.chunks(LANES)).zip(bookmarks);
    for ((reach, until_m), bookmarks) in bundles {
        let open = |lane: usize| !reach[lane].whole && until_m[lane] > reach[lane].end_m;
        let Some(least) = (0..reach.len()).filter(|lane| open(*lane)).map(|lane| reach[lane].cells).min() else {
            continue;
        };
        // The cell before the first silent one is needed too.
        let block = (least as usize - 1) / BLOCK;
        let mut lines = bookmarks[block].clone();
        let mut before = lines.cell();
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
                        count(world, (spoken, tally), [before[lane], cell[lane]], edge[lane], pairs);
                    }
                }
                if !any {
                    break;
                }
            }
            before = cell;
            edge = step.edge;
        }
    }
}

/// A silent cell, and the edge from the one before it.
fn count(
    world: &World,
    (spoken, tally): (Option<&Tally>, &mut Tally),
    [before, cell]: [u32; 2],
    edge: u32,
    pairs: u32,
) {
    let spoken_of = |tally: &Tally, cell: u32| match world.lateral {
        false => spoken.unwrap_or(tally).is_touched(cell),
        true => spoken.unwrap_or(tally).sheet_of(cell as usize / PATCH).is_some(),
    };
    let (here, there) = (spoken_of(tally, cell), spoken_of(tally, before));
    if !here && !there {
        return;
    }
    if here {
        let entry = tally.entry(cell);
        tally.cell_of(entry, pairs, f64::from(world.map.occupied(cell)));
    }
    let (low, axis) = (edge / 2, (edge % 2) as usize);
    let high = if before == low { cell } else { before };
    if spoken_of(tally, high) {
        let entry = tally.entry(high);
        tally.at(entry).mark(LEFT << axis);
    }
    if spoken_of(tally, low) {
        let [p, q] = [low, high].map(|cell| f64::from(world.map.occupied(cell)));
        let both = if world.continuity { f64::from(world.map.both(low, axis)) } else { p * q };
        let entry = tally.entry(low);
        tally.at(entry).differs(axis, super::rounded(p + q - 2.0 * both));
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
