//! A tour as straight legs.

use grid::GridSpec;
use rayon::prelude::*;

use super::space::Space;
use crate::geometry::distance as between;

/// The stops of a way through the cells of `tour`, in which the robot drives straight from each to the next.
pub(super) fn straight(space: &Space, tour: &[usize]) -> Vec<usize> {
    let legs: Vec<Vec<usize>> = tour.par_windows(2).map(|ends| pulled(space, &path(space, ends[0], ends[1]))).collect();
    let mut stops: Vec<usize> = tour.first().copied().into_iter().collect();
    stops.extend(legs.into_iter().flat_map(|leg| leg.into_iter().skip(1)));
    if let [only] = stops[..] {
        // One look shows all; a route needs a second place.
        let costs = space.ways().costs(only, &[]);
        let farthest = space.drivable().max_by_key(|&cell| (costs[cell], std::cmp::Reverse(cell)));
        let there = farthest.map(|cell| pulled(space, &path(space, only, cell)));
        stops.extend(there.into_iter().flatten().skip(1));
    }
    stops
}

/// A shortest way from one cell to another, both included.
fn path(space: &Space, from: usize, to: usize) -> Vec<usize> {
    let costs = space.ways().costs(to, &[from]);
    space.ways().way_back(&costs, from).unwrap_or_else(|| vec![from])
}

/// A path made straight: from every stop to the farthest cell of the path to which all the way is clear.
fn pulled(space: &Space, path: &[usize]) -> Vec<usize> {
    let mut stops = vec![path[0]];
    let mut at = 0;
    while at + 1 < path.len() {
        // A step to a neighbour is always clear.
        let mut to = at + 1;
        while to + 1 < path.len() && space.leg(path[at], path[to + 1]) {
            to += 1;
        }
        stops.push(path[to]);
        at = to;
    }
    stops
}

/// The stops in m, to the millimetre, and whether the route was cut at `max_length_m`.
pub(super) fn stops_m(spec: &GridSpec, route: &[usize], max_length_m: Option<f64>) -> (Vec<[f64; 2]>, bool) {
    let rounded = |at: [f64; 2]| at.map(|v| libm::rint(v * 1e3) / 1e3);
    let mut left = max_length_m.unwrap_or(f64::INFINITY);
    let mut stops = Vec::with_capacity(route.len());
    for (k, &cell) in route.iter().enumerate() {
        let to = spec.centre(cell);
        let from = if k == 0 { to } else { spec.centre(route[k - 1]) };
        let length = between(from, to);
        if length > left {
            let at = [0, 1].map(|a| from[a] + left / length * (to[a] - from[a]));
            // A stub shorter than a cell is no leg.
            if stops.len() < 2 || left >= spec.cell_m {
                stops.push(rounded(at));
            }
            return (stops, true);
        }
        left -= length;
        stops.push(rounded(to));
    }
    (stops, false)
}

/// Length of the way from stop to stop, m.
pub(crate) fn length_m(stops_m: &[[f64; 2]]) -> f64 {
    stops_m.windows(2).map(|leg| between(leg[0], leg[1])).sum()
}
