//! Reliability over many maps: bins of probability that can be added up.

use grid::Raster;
use serde::{Deserialize, Serialize};

use crate::ScoreError;
use crate::judged::judged;

/// Edges of the bins: fine near 0 and 1, where maps are decided, and where a tenth of a bin would hide
/// whether one in a hundred or one in fifty of the cells held free is occupied.
pub const PROBABILITY_EDGES: [f64; 19] =
    [0.0, 0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 0.98, 0.99, 1.0];

/// The cells whose probability lies between two neighbouring [`PROBABILITY_EDGES`], the lower one
/// included; the last bin includes 1. Unlike the bins of [`reliability`](crate::reliability), which hold
/// equal counts of one map, those of several maps can be merged.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ProbabilityBin {
    /// Number of cells.
    pub cells: u64,
    /// Number of them that are truly occupied.
    pub occupied: u64,
    /// Sum of their probabilities.
    pub probability_sum: f64,
}

impl ProbabilityBin {
    /// Takes in the same bin of another map.
    pub fn merge(&mut self, other: &Self) {
        self.cells += other.cells;
        self.occupied += other.occupied;
        self.probability_sum += other.probability_sum;
    }

    /// Mean probability of the cells; `None` of an empty bin.
    pub fn mean_probability(&self) -> Option<f64> {
        (self.cells > 0).then(|| self.probability_sum / self.cells as f64)
    }

    /// Share of the cells that is truly occupied; `None` of an empty bin.
    pub fn observed_share(&self) -> Option<f64> {
        (self.cells > 0).then(|| self.occupied as f64 / self.cells as f64)
    }
}

/// Sorts the known cells of `mask` into bins of probability: one bin fewer than [`PROBABILITY_EDGES`].
///
/// # Errors
/// Rasters of different geometry; a cell that holds no probability.
pub fn probability_bins(
    map: &Raster<f64>,
    truth: &Raster<Option<bool>>,
    mask: &Raster<bool>,
) -> Result<Vec<ProbabilityBin>, ScoreError> {
    let mut bins = vec![ProbabilityBin::default(); PROBABILITY_EDGES.len() - 1];
    let last = bins.len() - 1;
    for j in judged(map, truth, mask)? {
        let bin = PROBABILITY_EDGES.partition_point(|&edge| edge <= j.p).saturating_sub(1).min(last);
        bins[bin].merge(&ProbabilityBin { cells: 1, occupied: u64::from(j.occupied), probability_sum: j.p });
    }
    Ok(bins)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::drawn;
    use proptest::prelude::*;

    fn bins(world: &[&str], map: &[f64]) -> Result<Vec<ProbabilityBin>, ScoreError> {
        let truth = drawn(world);
        probability_bins(&Raster::new(*truth.spec(), map.to_vec()), &truth, &truth.map(|_| true))
    }

    #[test]
    fn by_hand() {
        let found = bins(&["#.#.?#"], &[0.0, 0.005, 0.01, 0.1, 0.1, 1.0]).expect("valid");
        let filled: Vec<_> = found.iter().enumerate().filter(|(_, b)| b.cells > 0).collect();
        let expected = [(0, 2, 1, 0.005), (1, 1, 1, 0.01), (4, 1, 0, 0.1), (17, 1, 1, 1.0)];
        assert_eq!(filled.len(), expected.len());
        for ((at, bin), (k, cells, occupied, sum)) in filled.into_iter().zip(expected) {
            assert_eq!((at, bin.cells, bin.occupied), (k, cells, occupied));
            assert!((bin.probability_sum - sum).abs() < 1e-15);
        }
        assert_eq!((found[0].observed_share(), found[2].observed_share()), (Some(0.5), None));
        assert_eq!((found[17].mean_probability(), found[2].mean_probability()), (Some(1.0), None));
        assert!(matches!(bins(&["."], &[f64::NAN]), Err(ScoreError::Probability { .. })));
    }

    proptest! {
        /// Every bin against a filter of its own, and two maps against both as one.
        #[test]
        fn merging_maps_is_binning_their_cells(cells in prop::collection::vec((0u32..=1000, any::<bool>()), 2..40), cut in 1usize..39) {
            let cut = cut.min(cells.len() - 1);
            let of = |part: &[(u32, bool)]| {
                let world: String = part.iter().map(|c| if c.1 { '#' } else { '.' }).collect();
                bins(&[&world], &part.iter().map(|c| f64::from(c.0) / 1000.0).collect::<Vec<_>>()).expect("valid")
            };
            let whole = of(&cells);
            let mut merged = of(&cells[..cut]);
            merged.iter_mut().zip(of(&cells[cut..])).for_each(|(bin, other)| bin.merge(&other));
            for (k, (bin, merged)) in whole.iter().zip(&merged).enumerate() {
                prop_assert_eq!((bin.cells, bin.occupied), (merged.cells, merged.occupied));
                prop_assert!((bin.probability_sum - merged.probability_sum).abs() < 1e-12);
                let [from, to] = [PROBABILITY_EDGES[k], PROBABILITY_EDGES[k + 1]];
                let inside = |c: &&(u32, bool)| {
                    let p = f64::from(c.0) / 1000.0;
                    from <= p && (p < to || k == whole.len() - 1)
                };
                prop_assert_eq!(bin.cells, cells.iter().filter(inside).count() as u64);
                prop_assert_eq!(bin.occupied, cells.iter().filter(inside).filter(|c| c.1).count() as u64);
            }
        }
    }
}
