//! Viewpoints that together see the floor, chosen greedily.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rayon::prelude::*;

use super::sight::Sight;
use super::space::Space;

/// Distance between the places that are tried, m, where that does not make too many.
const APART_M: f64 = 0.5;

/// Places tried at most; on larger maps they are farther apart.
const MOST_TRIED: usize = 6000;

/// Viewpoints at most: the tour looks at every pair of them.
const MOST: usize = 500;

/// A viewpoint has to show this share of the square of the range, or it is not worth the way.
pub(super) const WORTH: f64 = 0.02;

/// Cells to look from, the start first if one is given. From each the most new floor is seen at the time it is
/// chosen; that number only falls, so that the largest old number need be counted anew alone.
pub(super) fn choose(space: &Space, sight: &Sight, start: Option<usize>) -> Vec<usize> {
    let mut seen = vec![false; space.spec().cells()];
    let mut looker = sight.looker();
    let mut chosen = Vec::new();
    if let Some(start) = start {
        sight.around(start, &seen, &mut looker).into_iter().for_each(|cell| seen[cell] = true);
        chosen.push(start);
    }
    let tried = places(space);
    let gains: Vec<usize> =
        tried.par_iter().map_init(|| sight.looker(), |looker, &cell| sight.around(cell, &seen, looker).len()).collect();
    let mut queue: BinaryHeap<(usize, Reverse<usize>)> =
        gains.into_iter().zip(tried.into_iter().map(Reverse)).collect();
    let least = WORTH * sight.range_m() * sight.range_m() / space.spec().cell_area_m2();
    while let Some((_, Reverse(cell))) = queue.pop() {
        let found = sight.around(cell, &seen, &mut looker);
        let next = queue.peek().map_or(0, |(gain, _)| *gain);
        if found.len() < next {
            queue.push((found.len(), Reverse(cell)));
            continue;
        }
        if chosen.len() >= MOST || (!chosen.is_empty() && (found.len() as f64) < least) {
            break;
        }
        found.into_iter().for_each(|cell| seen[cell] = true);
        chosen.push(cell);
    }
    chosen
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
