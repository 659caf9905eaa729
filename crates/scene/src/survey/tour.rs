//! The order of the viewpoints: nearest neighbour, then 2-opt.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::plan::{Progress, Watch};
use super::space::Space;

/// Improvements end on their own; this many rounds are a bound, not a need.
const MOST_ROUNDS: usize = 100;

/// The viewpoints in the order of a short tour that does not come back; the first one stays first if it is `fixed`.
pub(super) fn order(space: &Space, viewpoints: Vec<usize>, fixed: bool, progress: Watch) -> Vec<usize> {
    let found = AtomicUsize::new(0);
    let ways: Vec<Vec<u32>> = viewpoints
        .par_iter()
        .map(|&from| {
            let done = found.fetch_add(1, Ordering::Relaxed);
            progress(Progress { step: "finding ways", done, of: viewpoints.len() });
            let costs = space.ways().costs(from, &[]);
            viewpoints.iter().map(|&to| costs[to]).collect()
        })
        .collect();
    let starts = if fixed { 0..1 } else { 0..viewpoints.len() };
    let tours = starts.map(|start| nearest(&ways, start)).map(|tour| (cost(&ways, &tour), tour));
    let Some((_, mut tour)) = tours.min() else { return viewpoints };
    improve(&ways, &mut tour, usize::from(fixed));
    tour.into_iter().map(|k| viewpoints[k]).collect()
}

fn cost(ways: &[Vec<u32>], tour: &[usize]) -> u64 {
    tour.windows(2).map(|leg| u64::from(ways[leg[0]][leg[1]])).sum()
}

/// From `start`, always on to the nearest that is left.
fn nearest(ways: &[Vec<u32>], start: usize) -> Vec<usize> {
    let mut left: Vec<usize> = (0..ways.len()).filter(|&k| k != start).collect();
    let mut tour = vec![start];
    let mut at = start;
    while let Some(next) = (0..left.len()).min_by_key(|&k| (ways[at][left[k]], left[k])) {
        at = left.remove(next);
        tour.push(at);
    }
    tour
}

/// Turns parts of the tour round, from place `first` on, as long as that shortens it.
fn improve(ways: &[Vec<u32>], tour: &mut [usize], first: usize) {
    let way = |from: Option<&usize>, to: Option<&usize>| match (from, to) {
        (Some(&from), Some(&to)) => u64::from(ways[from][to]),
        _ => 0, // an open end
    };
    for _ in 0..MOST_ROUNDS {
        let mut better = false;
        for i in first..tour.len() {
            for j in i + 1..tour.len() {
                let (before, after) = (i.checked_sub(1).map(|k| &tour[k]), tour.get(j + 1));
                let (head, tail) = (Some(&tour[i]), Some(&tour[j]));
                if way(before, tail) + way(head, after) < way(before, head) + way(tail, after) {
                    tour[i..=j].reverse();
                    better = true;
                }
            }
        }
        if !better {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Distances along the axes between points.
    fn ways(points: &[(u32, u32)]) -> Vec<Vec<u32>> {
        let way = |a: &(u32, u32), b: &(u32, u32)| a.0.abs_diff(b.0) + a.1.abs_diff(b.1);
        points.iter().map(|a| points.iter().map(|b| way(a, b)).collect()).collect()
    }

    /// The shortest of all orders that begin with `tour`.
    fn shortest(ways: &[Vec<u32>], tour: &mut Vec<usize>) -> u64 {
        let left: Vec<usize> = (0..ways.len()).filter(|k| !tour.contains(k)).collect();
        let after = left.iter().map(|&next| {
            tour.push(next);
            let best = shortest(ways, tour);
            tour.pop();
            best
        });
        after.min().unwrap_or_else(|| cost(ways, tour))
    }

    proptest! {
        #[test]
        fn tours_visit_all_and_are_at_most_a_half_longer_than_the_shortest(
            points in prop::collection::vec((0u32..50, 0u32..50), 1..7), fixed: bool,
        ) {
            let ways = ways(&points);
            let mut tour = nearest(&ways, 0);
            let before = cost(&ways, &tour);
            improve(&ways, &mut tour, usize::from(fixed));
            let mut visited = tour.clone();
            visited.sort_unstable();
            prop_assert_eq!(visited, (0..points.len()).collect::<Vec<_>>());
            prop_assert!(cost(&ways, &tour) <= before);
            prop_assert!(!fixed || tour[0] == 0);
            let best = shortest(&ways, &mut if fixed { vec![0] } else { Vec::new() });
            prop_assert!(2 * cost(&ways, &tour) <= 3 * best, "{} {}", cost(&ways, &tour), best);
        }
    }
}
