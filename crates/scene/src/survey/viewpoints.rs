//! Viewpoints that together see the floor, chosen greedily.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rayon::prelude::*;

use super::plan::{Progress, Watch};
use super::sight::{Looker, Sight};
use super::space::Space;
use super::view::{Seen, View};

/// Distance between the places that are tried, m, where that does not make too many.
const APART_M: f64 = 0.5;

/// Places tried at most; on larger maps they are farther apart.
const MOST_TRIED: usize = 6000;

/// Viewpoints at most: the tour looks at every pair of them.
const MOST: usize = 500;

/// A viewpoint has to show this share of the square of the range, or it is not worth the way.
pub(super) const WORTH: f64 = 0.02;

/// Views are kept up to this memory, bytes; others are traced again when they are asked for.
const MOST_KEPT: usize = 256 << 20;

/// Places whose views are traced in one go.
const AT_ONCE: usize = 128;

/// Cells to look from, the start first if one is given. From each the most new floor is seen at the time it is
/// chosen; that number only falls, so that the largest old number need be counted anew alone.
pub(super) fn choose(space: &Space, sight: &Sight, start: Option<usize>, progress: Watch) -> Vec<usize> {
    let mut seen = Seen::nothing(space.spec());
    let mut looker = sight.looker();
    let mut chosen = Vec::new();
    if let Some(start) = start {
        seen.add(&seen.view(&sight.around(start, &mut looker)));
        chosen.push(start);
    }
    let tried = places(space);
    let views = Views::of(&tried, sight, &seen, progress);
    let gain = |seen: &Seen, k: usize, looker: &mut Looker| match &views.kept[k] {
        Some(view) => seen.missing(view),
        None => seen.missing(&seen.view(&sight.around(tried[k], looker))),
    };
    let entry = |k: usize, gain| (gain, Reverse(tried[k]), k);
    let mut queue: BinaryHeap<_> = views.gains.iter().enumerate().map(|(k, &gain)| entry(k, gain)).collect();
    let least = WORTH * sight.range_m() * sight.range_m() / space.spec().cell_area_m2();
    while let Some((_, _, k)) = queue.pop() {
        let found = gain(&seen, k, &mut looker);
        let next = queue.peek().map_or(0, |(gain, ..)| *gain);
        if found < next {
            queue.push(entry(k, found));
            continue;
        }
        if chosen.len() >= MOST || (!chosen.is_empty() && (found as f64) < least) {
            break;
        }
        match &views.kept[k] {
            Some(view) => seen.add(view),
            None => seen.add(&seen.view(&sight.around(tried[k], &mut looker))),
        }
        chosen.push(tried[k]);
    }
    chosen
}

/// What is seen from every place.
struct Views {
    /// Cells that each shows beyond those seen from the start.
    gains: Vec<usize>,
    /// The views, as many as memory is given for.
    kept: Vec<Option<View>>,
}

impl Views {
    fn of(places: &[usize], sight: &Sight, seen: &Seen, progress: Watch) -> Self {
        let (mut gains, mut kept, mut bytes) = (Vec::new(), Vec::new(), 0);
        for some in places.chunks(AT_ONCE) {
            progress(Progress { step: "looking around", done: gains.len(), of: places.len() });
            let look = |looker: &mut Looker, &cell: &usize| seen.view(&sight.around(cell, looker));
            let views: Vec<View> = some.par_iter().map_init(|| sight.looker(), look).collect();
            for view in views {
                gains.push(seen.missing(&view));
                bytes += view.bytes();
                kept.push((bytes <= MOST_KEPT).then_some(view));
            }
        }
        Self { gains, kept }
    }
}

/// In each block of cells, the drivable cell nearest to the block's middle.
fn places(space: &Space) -> Vec<usize> {
    let spec = *space.spec();
    let mut side = ((APART_M / spec.cell_m).round() as usize).max(1);
    loop {
        let columns = spec.width.div_ceil(side);
        let mut best: Vec<Option<(usize, usize)>> = vec![None; columns * spec.height.div_ceil(side)];
        for cell in space.drivable() {
            let (column, row) = spec.column_row(cell);
            let off = |at: usize| (2 * (at % side) + 1).abs_diff(side).pow(2);
            let place = (off(column) + off(row), cell);
            let block = &mut best[row / side * columns + column / side];
            *block = Some(block.map_or(place, |b| b.min(place)));
        }
        let places: Vec<usize> = best.into_iter().flatten().map(|(_, cell)| cell).collect();
        if places.len() <= MOST_TRIED {
            return places;
        }
        side = side + side / 2 + 1;
    }
}
