//! Rays past the cells that they move: they count, unmoved, where other rays move cells, since a cell is the mean of all rays
//! through it, Eq. (20).

use std::f64::consts::{PI, SQRT_2, TAU};

use grid::GridSpec;
use sensor::lanes::{LANES, Lanes, each};
use sensor::{Ray, in_lanes};

use crate::fast::inputs::Inputs;
use crate::fast::lines::Lines;
use crate::fast::passage::{Passage, Reach};
use crate::fast::sums::{Sums, word};
use crate::fast::tiles::{PATCH, SIDE, SQUARE_SIDE};
use crate::fast::walk::Walk;

/// The cells behind those that rays have moved, up to `until_m` (m) of each, in which others of the scan may have moved some.
pub(super) fn behind(reach: &[Reach], until_m: &[f64]) -> impl Iterator<Item = Passage> {
    let passages =
        reach.iter().zip(until_m).enumerate().filter(|(_, (reach, until_m))| !reach.whole && **until_m > reach.end_m);
    passages.map(|(ray, (reach, &until_m))| Passage {
        ray: ray as u32,
        from: reach.last,
        with_first: false,
        before: None,
        last: None,
        until_m,
    })
}

/// Adds to the sums the cells that rays pass and that another ray moves, unmoved, or those in patches with a sheet where cells
/// learn across rays. Which those are is in `before`, or else in the sums themselves.
pub(super) fn add(inputs: &Inputs, rays: &[Ray], passages: &[Passage], (before, sums): (Option<&Sums>, &mut Sums)) {
    let mut runs = Vec::new();
    let read = before.unwrap_or(sums);
    let extents = if inputs.hops == 0 { read.extents() } else { vec![[0xff; 2]; read.sheets().end] };
    passages.iter().for_each(|passage| find(inputs, &rays[passage.ray as usize], passage, (read, &extents), &mut runs));
    runs.chunks(LANES).for_each(|runs| add_runs(inputs, rays, runs, before, sums));
}

in_lanes! {
    fn add_runs<'a>(inputs: &'a Inputs<'a>, rays: &'a [Ray], runs: &'a [Passage], before: Option<&'a Sums>, sums: &'a mut Sums) {
        in_lockstep(inputs, rays, runs, (before, sums));
    }
}

/// Adds up to [`LANES`] runs.
#[inline(always)]
fn in_lockstep(inputs: &Inputs, rays: &[Ray], runs: &[Passage], (before, sums): (Option<&Sums>, &mut Sums)) {
    let mut lines = Lines::new(inputs.map.numbering);
    let mut previous: Lanes<Option<[u32; 2]>> = [None; LANES];
    for (lane, run) in runs.iter().enumerate() {
        let ray = &rays[run.ray as usize];
        lines.go_on_from(lane, ray.origin_m, ray.direction, run.from, f64::INFINITY);
        previous[lane] = run.before;
    }
    let mut open: Lanes<bool> = each(|lane| lane < runs.len());
    for k in 0.. {
        let (cell, entered) = (lines.cell(), lines.entered);
        let step = lines.step();
        for (lane, run) in runs.iter().enumerate() {
            let goes_on = lines.alive[lane] > 0.0;
            open[lane] &= entered[lane] <= run.until_m;
            if !open[lane] {
                continue;
            }
            if k > 0 || run.with_first {
                // The first cell of a ray and its last are in one pair each.
                let pairs = if previous[lane].is_some() && goes_on { 2 } else { 1 };
                pass(inputs, (before, sums), previous[lane], cell[lane], pairs);
            }
            previous[lane] = Some([cell[lane], step.edge[lane]]);
            let ends = run.last == Some(cell[lane]);
            if ends && goes_on {
                land(inputs, (before, sums), cell[lane], step.edge[lane]);
            }
            open[lane] = goes_on && !ends;
        }
        if open == [false; LANES] {
            break;
        }
    }
}

/// The parts of a passage in patches where it meets rows and columns that rays were added through, each from the cell before them
/// to the cell behind them.
fn find(inputs: &Inputs, ray: &Ray, passage: &Passage, (sums, extents): (&Sums, &[[u8; 2]]), runs: &mut Vec<Passage>) {
    let numbering = &inputs.map.numbering;
    let mut walk = Walk::new(numbering, ray.origin_m, ray.direction, passage.from);
    // The run that is open, and what one begins with that is opened now.
    let mut run: Option<Passage> = None;
    let mut begin = Passage { last: None, ..*passage };
    loop {
        let place = walk.place;
        let number = numbering.at(place.at);
        // Nothing is met in a square in which no ray was added.
        let square = numbering.square_at(place.at);
        let is_busy = sums.is_busy(square);
        let crossing = if is_busy { walk.crossing::<SIDE>() } else { walk.crossing::<SQUARE_SIDE>() };
        let crosses = |k: usize| {
            let [a, b] = [place.at[k], crossing.last.at[k]].map(|at| at % SIDE as u32);
            (0xffu8 << a.min(b)) & (0xff >> (SIDE as u32 - 1 - a.max(b)))
        };
        let meets = |sheet: usize| extents[sheet][0] & crosses(1) > 0 && extents[sheet][1] & crosses(0) > 0;
        if is_busy && sums.sheet_of(number as usize / PATCH).is_some_and(meets) {
            run = run.or(Some(begin));
        } else if let Some(run) = run.take() {
            runs.push(Passage { last: Some(number), ..run });
        }
        let ends = passage.last.is_some_and(|last| match is_busy {
            true => last as usize / PATCH == number as usize / PATCH,
            false => numbering.square_of(last) == square,
        });
        let Some(next) = crossing.next.filter(|next| !ends && next.entered <= passage.until_m) else {
            runs.extend(run.map(|run| Passage { last: passage.last, ..run }));
            return;
        };
        begin = Passage { from: crossing.last, with_first: false, before: None, last: None, ..*passage };
        walk.place = next;
    }
}

/// The cell that a leap has landed in, and the edge from there, which its ray has added: another ray may have moved the cell.
#[inline(always)]
fn land(inputs: &Inputs, (before, sums): (Option<&Sums>, &mut Sums), cell: u32, edge: u32) {
    if edge / 2 != cell && counts(inputs, before.unwrap_or(sums), cell) {
        let entry = sums.entry(cell);
        sums.mark(entry, (edge % 2) as usize);
    }
}

/// Whether a cell that a ray passes counts.
#[inline(always)]
fn counts(inputs: &Inputs, sums: &Sums, cell: u32) -> bool {
    match inputs.hops {
        0 => sums.is_touched(cell),
        _ => sums.sheet_of(cell as usize / PATCH).is_some(),
    }
}

/// A cell that a ray passes unmoved, and the edge from the one before it.
#[inline(always)]
fn pass(
    inputs: &Inputs,
    (before, sums): (Option<&Sums>, &mut Sums),
    previous: Option<[u32; 2]>,
    cell: u32,
    pairs: u32,
) {
    let counts = |sums: &Sums, cell: u32| counts(inputs, before.unwrap_or(sums), cell);
    let here = counts(sums, cell);
    if here {
        let entry = sums.entry(cell);
        sums.add_cell(entry, pairs, word(f64::from(inputs.map.occupied(cell))));
    }
    let Some([previous, edge]) = previous.filter(|[previous, _]| here || counts(sums, *previous)) else { return };
    let (low, axis) = (edge / 2, (edge % 2) as usize);
    let high = if previous == low { cell } else { previous };
    if counts(sums, high) {
        let entry = sums.entry(high);
        sums.mark(entry, axis);
    }
    // A settled cell that no ray moves has a sheet where one has landed in it: that ray has added the edge.
    if before.unwrap_or(sums).sheet_of(low as usize / PATCH).is_some() {
        let [p, q, both] = inputs.map.pair([low, high], axis, inputs.continuity);
        let entry = sums.entry(low);
        sums.add_differ(entry, axis, word(p + q - 2.0 * both));
    }
}

/// Up to where another ray's cells are, that a ray can cross beyond its own reach, m: as far as any reached within the
/// angle, and across a cell and its neighbours, so many on either side; and as far as those of other sensors, up to `others_m`.
/// Where cells learn across rays, whole patches count, and not cells alone: the angle does not shrink with range then.
pub(super) fn farthest(
    spec: &GridSpec,
    (rays, reach): (&[Ray], &[Reach]),
    others_m: f64,
    neighbours: usize,
) -> Vec<f64> {
    let bearing = |ray: usize| rays[ray].bearing_rad.rem_euclid(TAU);
    let mut order: Vec<usize> = (0..rays.len()).collect();
    order.sort_by(|a, b| bearing(*a).total_cmp(&bearing(*b)));
    // Once round, and half of it again on either side.
    let before = order.partition_point(|ray| bearing(*ray) < PI);
    let turns = [(&order[before..], -TAU), (&order[..], 0.0), (&order[..before], TAU)];
    let round = || turns.iter().flat_map(|(order, turn)| order.iter().map(move |ray| (*ray, *turn)));
    let bearings: Vec<f64> = round().map(|(ray, turn)| bearing(ray) + turn).collect();
    let most = RangeMaximum::new(round().map(|(ray, _)| reach[ray].end_m).collect());
    let all = most.over(0, bearings.len());
    let diagonal_m = SQRT_2 * spec.cell_m * neighbours as f64;
    let mut until_m = vec![all; rays.len()];
    for (place, ray) in (order.len() - before..).zip(&order) {
        let nearest_m = reach[*ray].end_m - diagonal_m;
        if nearest_m > diagonal_m {
            let within = (1.6 * diagonal_m / nearest_m, nearest_m);
            until_m[*ray] = common_m(&bearings, &most, place, within, neighbours == 1);
        }
    }
    until_m.iter().map(|until_m| until_m.max(others_m) + 2.0 * diagonal_m).collect()
}

/// Up to where the ray with a place in the order of bearings can cross cells of others, m, where it can cross those of rays within
/// some angle at some range: at twice the range they are within half the angle, if it `shrinks`.
fn common_m(
    bearings: &[f64],
    most: &RangeMaximum,
    ray: usize,
    (mut angle, mut range_m): (f64, f64),
    shrinks: bool,
) -> f64 {
    let at = bearings[ray];
    let mut within = 0..bearings.len();
    let mut until_m: f64 = 0.0;
    loop {
        let first = within.start + bearings[within.start..=ray].partition_point(|bearing| *bearing < at - angle);
        let end = ray + bearings[ray..within.end].partition_point(|bearing| *bearing <= at + angle);
        within = first..end;
        let reached_m = most.over(first, end);
        if !shrinks {
            return reached_m;
        }
        // Whoever is not within half of the angle is not crossed from here on.
        range_m *= 2.0;
        until_m = until_m.max(reached_m.min(range_m));
        if reached_m <= range_m || within.len() == 1 {
            return until_m.max(if within.len() == 1 { reached_m } else { 0.0 });
        }
        angle *= 0.5;
    }
}

/// The largest of consecutive values, in constant time.
struct RangeMaximum {
    /// `levels[k][i]` is the maximum of 2^k values from the i-th on.
    levels: Vec<Vec<f64>>,
}

impl RangeMaximum {
    fn new(values: Vec<f64>) -> Self {
        let mut levels = vec![values];
        while levels[levels.len() - 1].len() > 1 << (levels.len() - 1) {
            let (last, half) = (&levels[levels.len() - 1], 1 << (levels.len() - 1));
            levels.push((0..last.len() - half).map(|i| last[i].max(last[i + half])).collect());
        }
        Self { levels }
    }

    /// Of those from `first` to before `end`; 0 of none.
    fn over(&self, first: usize, end: usize) -> f64 {
        if first >= end {
            return 0.0;
        }
        let level = (end - first).ilog2() as usize;
        self.levels[level][first].max(self.levels[level][end - (1 << level)])
    }
}
