//! Cells in order of their probability, cells of equal probability taken together.

use crate::judged::Judged;

/// Probabilities are taken to so many steps from 0 to 1: what differs by less than 1e-9 is rounding, and
/// whether a cell that no ray has changed ranks above another must not hang on it.
const STEPS: f64 = 1e9;

/// All judged cells that hold the same probability, to one of [`STEPS`]; `p` is their mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tie {
    pub(crate) p: f64,
    pub(crate) cells: usize,
    pub(crate) occupied: usize,
}

/// The ties from the least to the most probable. What is computed from them cannot depend on the
/// order of the cells.
pub(crate) fn ranked(cells: impl Iterator<Item = Judged>) -> Vec<Tie> {
    let step = |p: f64| (p * STEPS).round() + 0.0; // + 0.0: no minus zero
    let mut cells: Vec<(f64, bool)> = cells.map(|j| (j.p, j.occupied)).collect();
    cells.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let tie = |cells: &[(f64, bool)]| Tie {
        p: cells.iter().map(|c| c.0).sum::<f64>() / cells.len() as f64,
        cells: cells.len(),
        occupied: cells.iter().filter(|c| c.1).count(),
    };
    cells.chunk_by(|a, b| step(a.0).total_cmp(&step(b.0)).is_eq()).map(tie).collect()
}

/// Probability that a random occupied cell ranks above a random free one, a tie counting one half;
/// `None` where a class is missing. Hanley and McNeil (1982).
pub(crate) fn auc(ties: &[Tie]) -> Option<f64> {
    // Twice the number of pairs in order: whole numbers below 2^62, exact whatever the sum's order.
    let (mut ordered, mut free, mut occupied) = (0u64, 0u64, 0u64);
    for tie in ties {
        let (tie_occupied, tie_free) = (tie.occupied as u64, (tie.cells - tie.occupied) as u64);
        ordered += tie_occupied * (2 * free + tie_free);
        free += tie_free;
        occupied += tie_occupied;
    }
    (free > 0 && occupied > 0).then(|| ordered as f64 / (2 * free * occupied) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn rank(cells: &[(f64, bool)]) -> Vec<Tie> {
        ranked(cells.iter().enumerate().map(|(cell, &(p, occupied))| Judged { cell, p, occupied }))
    }

    #[test]
    fn ties_are_counted_together_and_zero_has_no_sign() {
        let ties = rank(&[(0.5, true), (0.0, false), (0.5, false), (-0.0, true), (0.5, true)]);
        assert_eq!(ties, [Tie { p: 0.0, cells: 2, occupied: 1 }, Tie { p: 0.5, cells: 3, occupied: 2 }]);
    }

    #[test]
    fn rounding_ranks_nothing() {
        let noise = |k: i32| 0.1 + f64::from(k) * 1e-17;
        let ties = rank(&[(noise(0), true), (noise(3), false), (noise(-2), true), (0.1 + 2e-9, false)]);
        assert_eq!(ties.iter().map(|tie| (tie.cells, tie.occupied)).collect::<Vec<_>>(), [(3, 2), (1, 0)]);
        assert_eq!(rank(&[(0.0, true), (1.0, true)]).iter().map(|tie| tie.p).collect::<Vec<_>>(), [0.0, 1.0]);
    }

    #[test]
    fn auc_by_hand() {
        // Pairs in order: 0.9 above both free cells, 0.4 above one and level with the other.
        assert_eq!(auc(&rank(&[(0.9, true), (0.4, true), (0.4, false), (0.1, false)])), Some(3.5 / 4.0));
        assert_eq!(auc(&rank(&[(0.2, true), (0.8, false)])), Some(0.0));
        assert_eq!(auc(&rank(&[(0.3, true), (0.3, false), (0.3, false)])), Some(0.5));
        for one_class in [&[][..], &[(0.3, true), (0.8, true)], &[(0.3, false)]] {
            assert_eq!(auc(&rank(one_class)), None, "{one_class:?}");
        }
    }

    proptest! {
        #[test]
        fn auc_equals_all_pairs(cells in prop::collection::vec((0u8..20, any::<bool>()), 0..120)) {
            let cells: Vec<(f64, bool)> = cells.into_iter().map(|(p, o)| (f64::from(p) / 19.0, o)).collect();
            let (mut sum, mut pairs) = (0.0, 0.0);
            for (p, _) in cells.iter().filter(|c| c.1) {
                for (q, _) in cells.iter().filter(|c| !c.1) {
                    pairs += 1.0;
                    sum += if p > q { 1.0 } else if p < q { 0.0 } else { 0.5 };
                }
            }
            let value = auc(&rank(&cells));
            prop_assert_eq!(value.is_some(), pairs > 0.0);
            prop_assert!(value.is_none_or(|v| (v - sum / pairs).abs() < 1e-12));
        }
    }
}
