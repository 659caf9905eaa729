//! Shortest ways over the grid, in fifths of a cell.

use super::space::Space;

/// A cell that no way leads to.
pub(super) const UNREACHED: u32 = u32::MAX;

/// Steps cost 5 or 7, so that all costs under way lie within eight numbers: Dial's queue of buckets.
const BUCKETS: usize = 8;

/// The cost of the way from `from` to every cell; where `until` is given, right for it and for all cells nearer.
pub(super) fn all(space: &Space, from: usize, until: Option<usize>) -> Vec<u32> {
    let mut costs = vec![UNREACHED; space.spec().cells()];
    let mut buckets: [Vec<usize>; BUCKETS] = Default::default();
    costs[from] = 0;
    buckets[0].push(from);
    let (mut cost, mut waiting) = (0u32, 1usize);
    while waiting > 0 {
        let bucket = cost as usize % BUCKETS;
        while let Some(cell) = buckets[bucket].pop() {
            waiting -= 1;
            if costs[cell] != cost {
                continue; // reached by a shorter way since
            }
            if until == Some(cell) {
                return costs;
            }
            for (to, step) in space.steps(cell) {
                if cost + step < costs[to] {
                    costs[to] = cost + step;
                    buckets[(cost + step) as usize % BUCKETS].push(to);
                    waiting += 1;
                }
            }
        }
        cost += 1;
    }
    costs
}

/// A shortest way from one cell to another, both included.
pub(super) fn path(space: &Space, from: usize, to: usize) -> Vec<usize> {
    let costs = all(space, to, Some(from));
    let mut path = vec![from];
    let mut at = from;
    while at != to {
        let before = |&(next, step): &(usize, u32)| costs[next] != UNREACHED && costs[next] + step == costs[at];
        let Some((next, _)) = space.steps(at).find(before) else { break };
        path.push(next);
        at = next;
    }
    path
}
