//! Calibration: whether of the cells held occupied with 30 %, 30 % are.

use grid::Raster;
use serde::Serialize;

use crate::ScoreError;
use crate::judged::judged;
use crate::ranking::{Tie, ranked};

/// Number of equal-count bins of a reliability diagram, and of the calibration error. Enough to
/// show the shape, few enough that in a region of 1,000 cells a bin's observed share has a
/// standard error of 0.06 at the most.
pub const BINS: usize = 15;

/// One point of a reliability diagram.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bin {
    /// Mean probability of the bin's cells.
    pub mean_probability: f64,
    /// Share of them that is truly occupied.
    pub observed_share: f64,
    /// Number of cells.
    pub count: usize,
}

/// The reliability diagram over the known cells of `mask`: [`BINS`] bins of equal count (up to one
/// cell) from the least to the most probable; empty bins, where there are fewer cells than bins,
/// are left out.
///
/// **Ties.** Cells of equal probability cannot be told apart, so each enters with the mean outcome
/// of its tie; where a tie straddles two bins, both get the same share of it. The diagram
/// therefore does not depend on the order of the cells, and a constant map has one point 15 times.
///
/// # Errors
/// Rasters of different geometry; a cell that holds no probability.
pub fn reliability(
    map: &Raster<f64>,
    truth: &Raster<Option<bool>>,
    mask: &Raster<bool>,
) -> Result<Vec<Bin>, ScoreError> {
    Ok(equal_count_bins(&ranked(judged(map, truth, mask)?), BINS))
}

/// Bin b holds the ranks from `b n / bins` to `(b + 1) n / bins`, both rounded down.
pub(crate) fn equal_count_bins(ties: &[Tie], bins: usize) -> Vec<Bin> {
    let cells: usize = ties.iter().map(|tie| tie.cells).sum();
    let mut ties = ties.iter().copied();
    let (mut tie, mut left) = (Tie { p: 0.0, cells: 0, occupied: 0 }, 0);
    let mut filled = Vec::with_capacity(bins.min(cells));
    for bin in 0..bins {
        let count = (bin + 1) * cells / bins - bin * cells / bins;
        if count == 0 {
            continue;
        }
        let (mut missing, mut probability, mut observed) = (count, 0.0, 0.0);
        while missing > 0 {
            if left == 0 {
                let Some(next) = ties.next() else { break };
                (tie, left) = (next, next.cells);
            }
            let taken = missing.min(left);
            probability += taken as f64 * tie.p;
            observed += taken as f64 * tie.occupied as f64 / tie.cells as f64;
            missing -= taken;
            left -= taken;
        }
        let [mean_probability, observed_share] = [probability, observed].map(|sum| sum / count as f64);
        filled.push(Bin { mean_probability, observed_share, count });
    }
    filled
}

/// Sum over all cells of their bin's distance between probability and outcome: the expected
/// calibration error times the number of cells. Naeini, Cooper and Hauskrecht (2015), with bins of
/// equal count.
pub(crate) fn calibration_error_sum(bins: &[Bin]) -> f64 {
    bins.iter().map(|bin| bin.count as f64 * (bin.mean_probability - bin.observed_share).abs()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::judged::Judged;
    use proptest::prelude::*;

    fn bins(cells: &[(f64, bool)], bins: usize) -> Vec<Bin> {
        let judged = cells.iter().enumerate().map(|(cell, &(p, occupied))| Judged { cell, p, occupied });
        equal_count_bins(&ranked(judged), bins)
    }

    #[test]
    fn a_tie_across_a_boundary_is_shared() {
        let two = bins(&[(0.5, true), (0.25, false), (0.75, true), (0.5, false)], 2);
        let expected = [
            Bin { mean_probability: 0.375, observed_share: 0.25, count: 2 },
            Bin { mean_probability: 0.625, observed_share: 0.75, count: 2 },
        ];
        assert_eq!(two, expected);
        assert!((calibration_error_sum(&two) - 0.5).abs() < 1e-15);
    }

    #[test]
    fn a_constant_map_is_one_point() {
        let cells: Vec<_> = (0..30).map(|i| (0.25, i % 10 < 3)).collect();
        let bins = bins(&cells, BINS);
        assert_eq!(bins.len(), BINS);
        assert!(bins.iter().all(|b| b.count == 2 && (b.observed_share - 0.3).abs() < 1e-15));
        assert!((calibration_error_sum(&bins) / 30.0 - 0.05).abs() < 1e-15);
    }

    #[test]
    fn fewer_cells_than_bins_leave_bins_out() {
        assert_eq!(bins(&[], BINS), []);
        assert_eq!(bins(&[(0.3, true)], BINS), [Bin { mean_probability: 0.3, observed_share: 1.0, count: 1 }]);
        assert_eq!(bins(&[(0.3, true), (0.1, false)], BINS).len(), 2);
    }

    proptest! {
        #[test]
        fn equals_the_definition(
            cells in prop::collection::vec((0u8..12, any::<bool>()), 0..200), count in 1usize..20,
        ) {
            let cells: Vec<(f64, bool)> = cells.into_iter().map(|(p, o)| (f64::from(p) / 11.0, o)).collect();
            let bins = bins(&cells, count);
            // Slowly: replace every outcome by the mean over all cells of the same probability.
            let mut expected: Vec<(f64, f64)> = cells.iter().map(|&(p, _)| {
                let tie: Vec<_> = cells.iter().filter(|c| c.0.to_bits() == p.to_bits()).collect();
                (p, tie.iter().filter(|c| c.1).count() as f64 / tie.len() as f64)
            }).collect();
            expected.sort_by(|a, b| a.0.total_cmp(&b.0));
            let edge = |bin: usize| bin * cells.len() / count;
            let slices = (0..count).map(|b| &expected[edge(b)..edge(b + 1)]).filter(|slice| !slice.is_empty());
            prop_assert_eq!(slices.clone().count(), bins.len());
            for (slice, bin) in slices.zip(&bins) {
                let n = slice.len() as f64;
                prop_assert_eq!(slice.len(), bin.count);
                prop_assert!((slice.iter().map(|c| c.0).sum::<f64>() / n - bin.mean_probability).abs() < 1e-13);
                prop_assert!((slice.iter().map(|c| c.1).sum::<f64>() / n - bin.observed_share).abs() < 1e-13);
            }
            let occupied = cells.iter().filter(|c| c.1).count() as f64;
            let sum: f64 = bins.iter().map(|b| b.count as f64 * b.observed_share).sum();
            prop_assert!((sum - occupied).abs() < 1e-9, "every outcome is counted once");
        }

        #[test]
        fn the_order_of_the_cells_does_not_matter(
            cells in prop::collection::vec((0u8..6, any::<bool>()), 0..100), turn in 0usize..100,
        ) {
            let cells: Vec<(f64, bool)> = cells.into_iter().map(|(p, o)| (f64::from(p) / 5.0, o)).collect();
            let mut turned = cells.clone();
            turned.reverse();
            turned.rotate_left(turn.min(cells.len()));
            prop_assert_eq!(bins(&cells, BINS), bins(&turned, BINS));
        }
    }
}
