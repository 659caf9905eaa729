//! Shortest ways over cells.

use crate::{GridSpec, Raster};

/// A cell that no way leads to.
pub const UNREACHED: u32 = u32::MAX;

/// Steps to neighbours, along the sides first.
const AROUND: [[isize; 2]; 8] = [[1, 0], [0, 1], [-1, 0], [0, -1], [1, 1], [-1, 1], [-1, -1], [1, -1]];

/// What a step costs: whole numbers, so that sums and ties are the same on every machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StepCosts {
    /// To a cell beside.
    pub straight: u32,
    /// To a cell beyond a corner.
    pub aslant: u32,
}

impl StepCosts {
    /// 5 and 7: a step aslant is 1 % too short.
    pub const COARSE: Self = Self { straight: 5, aslant: 7 };
    /// 29 and 41: a step aslant is 0.03 % too short.
    pub const FINE: Self = Self { straight: 29, aslant: 41 };
}

/// Cells of a set and the steps between them: to the eight neighbours, aslant only where both cells beside are of the
/// set too. Then a disc that stands clear of other cells at every centre ([`clear`](crate::clear)) clears them on
/// every step as well.
#[derive(Debug, Clone)]
pub struct Lattice {
    set: Raster<bool>,
    /// The steps of [`AROUND`] that lead from each cell, a bit for each.
    moves: Vec<u8>,
    /// How far in the index each of them leads, and what it costs.
    around: [(isize, u32); 8],
    /// More than any step costs.
    buckets: usize,
}

impl Lattice {
    /// The lattice of the cells of `set`. O(cells).
    pub fn new(set: Raster<bool>, costs: StepCosts) -> Self {
        let moves = (0..set.values().len()).map(|cell| if set[cell] { moves(&set, cell) } else { 0 }).collect();
        let StepCosts { straight, aslant } = costs;
        let width = set.spec().width as isize;
        let around = AROUND.map(|[dx, dy]| (dy * width + dx, if dx == 0 || dy == 0 { straight } else { aslant }));
        Self { set, moves, around, buckets: straight.max(aslant) as usize + 1 }
    }

    /// Where its cells are.
    pub fn spec(&self) -> &GridSpec {
        self.set.spec()
    }

    /// Whether a cell is of the set.
    pub fn holds(&self, cell: usize) -> bool {
        self.set[cell]
    }

    /// The cells of the set, rising.
    pub fn cells(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.moves.len()).filter(|&cell| self.set[cell])
    }

    /// The neighbours that one can step to, with the cost of the step.
    pub fn steps(&self, cell: usize) -> impl Iterator<Item = (usize, u32)> + '_ {
        let mut left = self.moves[cell];
        std::iter::from_fn(move || {
            let k = (left != 0).then(|| left.trailing_zeros() as usize)?;
            left &= left - 1;
            let (by, cost) = self.around[k];
            Some((cell.wrapping_add_signed(by), cost))
        })
    }

    /// The cost of a shortest way from `from` to every cell, [`UNREACHED`] where there is none. Where `until` names
    /// cells, the search ends with the last of them: right for them and for all cells nearer.
    ///
    /// Dijkstra's search with Dial's queue (1969): as steps cost little, what is under way lies in few buckets. O(cells).
    pub fn costs(&self, from: usize, until: &[usize]) -> Vec<u32> {
        let mut costs = vec![UNREACHED; self.moves.len()];
        let mut buckets: Vec<Vec<u32>> = vec![Vec::new(); self.buckets];
        costs[from] = 0;
        buckets[0].push(from as u32);
        let (mut cost, mut bucket, mut waiting, mut missing) = (0u32, 0usize, 1usize, until.len());
        while waiting > 0 {
            while let Some(cell) = buckets[bucket].pop().map(|cell| cell as usize) {
                waiting -= 1;
                if costs[cell] != cost {
                    continue; // reached by a shorter way since
                }
                if !until.is_empty() {
                    missing -= until.iter().filter(|&&goal| goal == cell).count();
                    if missing == 0 {
                        return costs;
                    }
                }
                for (to, step) in self.steps(cell) {
                    if cost + step < costs[to] {
                        costs[to] = cost + step;
                        let there = bucket + step as usize;
                        buckets[if there < self.buckets { there } else { there - self.buckets }].push(to as u32);
                        waiting += 1;
                    }
                }
            }
            cost += 1;
            bucket = if bucket + 1 < self.buckets { bucket + 1 } else { 0 };
        }
        costs
    }

    /// A shortest way to `to` from where `costs` were counted, from `to` backwards, both ends included; none where
    /// none leads there. Of equals it is always the same one.
    pub fn way_back(&self, costs: &[u32], to: usize) -> Option<Vec<usize>> {
        let mut way = vec![to];
        let mut at = to;
        if costs[to] == UNREACHED {
            return None;
        }
        while costs[at] > 0 {
            let before = |&(next, step): &(usize, u32)| costs[next].checked_add(step) == Some(costs[at]);
            (at, _) = self.steps(at).find(before)?;
            way.push(at);
        }
        Some(way)
    }
}

/// Which steps of [`AROUND`] lead from a cell to another one of the set; aslant only between two others.
fn moves(set: &Raster<bool>, cell: usize) -> u8 {
    let spec = set.spec();
    let (column, row) = spec.column_row(cell);
    let held = |[dx, dy]: [isize; 2]| {
        let to = column.checked_add_signed(dx).zip(row.checked_add_signed(dy));
        to.is_some_and(|(c, r)| c < spec.width && r < spec.height && set[spec.index(c, r)])
    };
    let leads = |[dx, dy]: [isize; 2]| held([dx, dy]) && held([dx, 0]) && held([0, dy]);
    (0..AROUND.len()).filter(|&k| leads(AROUND[k])).fold(0, |bits, k| bits | 1 << k)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The cost to every cell by relaxing every step between every two cells until nothing changes (Bellman and Ford),
    /// with the rule of the steps written out anew.
    fn slow_costs(set: &Raster<bool>, from: usize, costs: StepCosts) -> Vec<u32> {
        let spec = *set.spec();
        let step = |a: usize, b: usize| {
            let ((ca, ra), (cb, rb)) = (spec.column_row(a), spec.column_row(b));
            let beside = [spec.index(ca, rb), spec.index(cb, ra)].iter().all(|cell| set[*cell]);
            match (ca.abs_diff(cb), ra.abs_diff(rb)) {
                (0, 1) | (1, 0) if set[a] && set[b] => Some(costs.straight),
                (1, 1) if set[a] && set[b] && beside => Some(costs.aslant),
                _ => None,
            }
        };
        let mut found = vec![UNREACHED; spec.cells()];
        found[from] = 0;
        loop {
            let before = found.clone();
            for (a, b) in (0..spec.cells()).flat_map(|a| (0..spec.cells()).map(move |b| (a, b))) {
                if let Some(step) = step(a, b).filter(|_| found[a] != UNREACHED) {
                    found[b] = found[b].min(found[a] + step);
                }
            }
            if found == before {
                return found;
            }
        }
    }

    fn sets() -> impl Strategy<Value = Raster<bool>> {
        (1usize..9, 1usize..9).prop_flat_map(|(width, height)| {
            let spec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width, height };
            prop::collection::vec(prop::bool::weighted(0.75), width * height)
                .prop_map(move |cells| Raster::new(spec, cells))
        })
    }

    proptest! {
        #[test]
        fn costs_are_those_of_a_slow_search_and_ways_add_up_to_them(
            set in sets(), ends in prop::collection::vec(any::<prop::sample::Index>(), 1..5), fine in any::<bool>(),
        ) {
            let costs = if fine { StepCosts::FINE } else { StepCosts::COARSE };
            let ends: Vec<usize> = ends.iter().map(|end| end.index(set.spec().cells())).collect();
            let (from, goals) = (ends[0], &ends[1..]);
            let (lattice, slow) = (Lattice::new(set.clone(), costs), slow_costs(&set, from, costs));
            prop_assert_eq!(&lattice.costs(from, &[]), &slow);
            let found = lattice.costs(from, goals);
            for &goal in goals {
                prop_assert_eq!(found[goal], slow[goal], "as far as it is asked for");
                let Some(way) = lattice.way_back(&found, goal) else {
                    prop_assert_eq!(slow[goal], UNREACHED);
                    continue;
                };
                prop_assert_eq!((way[0], way[way.len() - 1]), (goal, from));
                let steps: Option<Vec<u32>> = way.windows(2).map(|pair| {
                    lattice.steps(pair[0]).find(|(to, _)| *to == pair[1]).map(|(_, step)| step)
                }).collect();
                prop_assert_eq!(steps.map(|steps| steps.iter().sum::<u32>()), Some(slow[goal]));
            }
        }
    }

    #[test]
    fn no_way_cuts_a_corner() {
        let spec = GridSpec { cell_m: 1.0, origin_m: [0.0; 2], width: 2, height: 2 };
        let lattice = |set: [bool; 4]| Lattice::new(Raster::new(spec, set.to_vec()), StepCosts::FINE);
        assert_eq!(lattice([true, true, true, true]).costs(0, &[])[3], 41);
        assert_eq!(lattice([true, true, false, true]).costs(0, &[])[3], 58);
        assert_eq!(lattice([true, false, false, true]).costs(0, &[])[3], UNREACHED);
        assert_eq!(lattice([true, true, false, true]).cells().collect::<Vec<_>>(), [0, 1, 3]);
    }
}
