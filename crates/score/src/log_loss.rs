//! Log loss: how surprised a map is by the truth.

use grid::Raster;

use crate::judged::judged;
use crate::threshold::CLIP;
use crate::{Metric, ScoreError};

/// Mean of `-ln p(truth)` over the known cells of `mask`, nats per cell, with p clipped to
/// `CLIP ..= 1 - CLIP` (see [`threshold::CLIP`](CLIP)). Good (1952), "Rational decisions".
///
/// Allocates nothing and takes few logarithms: cheap enough to show after every scan.
///
/// # Errors
/// Rasters of different geometry; a cell that holds no probability.
pub fn log_loss(map: &Raster<f64>, truth: &Raster<Option<bool>>, mask: &Raster<bool>) -> Result<Metric, ScoreError> {
    let mut loss = LogLoss::default();
    for j in judged(map, truth, mask)? {
        loss.add(j.p, j.occupied);
    }
    Ok(loss.metric())
}

/// A running sum of `-ln p(truth)`. It multiplies probabilities and takes the logarithm of the
/// product only when that becomes small, once in about fifty cells at the worst.
#[derive(Debug, Clone)]
pub(crate) struct LogLoss {
    sum: f64,
    product: f64,
    cells: usize,
}

impl Default for LogLoss {
    fn default() -> Self {
        Self { sum: 0.0, product: 1.0, cells: 0 }
    }
}

impl LogLoss {
    /// One factor of at least [`CLIP`] below this is still far from the smallest normal number, so
    /// the product keeps all its digits.
    const SMALL: f64 = 1e-200;

    pub(crate) fn add(&mut self, p: f64, occupied: bool) {
        let clipped = p.clamp(CLIP, 1.0 - CLIP);
        self.product *= if occupied { clipped } else { 1.0 - clipped };
        self.cells += 1;
        if self.product < Self::SMALL {
            self.sum -= libm::log(self.product);
            self.product = 1.0;
        }
    }

    /// Takes in other cells.
    pub(crate) fn merge(&mut self, other: &Self) {
        // The logarithm of a settled one is taken.
        self.sum += if other.product < 1.0 { other.sum - libm::log(other.product) } else { other.sum };
        self.cells += other.cells;
    }

    /// The same with its logarithm taken, so that merging it is one addition.
    pub(crate) fn settled(&self) -> Self {
        Self { sum: self.sum - libm::log(self.product), product: 1.0, cells: self.cells }
    }

    pub(crate) fn metric(&self) -> Metric {
        Metric::mean("log_loss", "nats/cell", self.sum - libm::log(self.product), self.cells)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn of(cells: &[(f64, bool)]) -> Option<f64> {
        let mut loss = LogLoss::default();
        cells.iter().for_each(|&(p, occupied)| loss.add(p, occupied));
        loss.metric().value
    }

    #[test]
    fn by_hand() {
        let value = of(&[(0.25, true), (0.25, false), (0.5, true)]).expect("defined");
        assert!((value - (4.0f64.ln() + (4.0f64 / 3.0).ln() + 2.0f64.ln()) / 3.0).abs() < 1e-15);
        assert_eq!(of(&[]), None);
    }

    #[test]
    fn certainty_is_clipped() {
        let wrong = of(&[(1.0, false)]).expect("defined");
        assert!((wrong - 1e4f64.ln()).abs() < 1e-11, "{wrong}");
        assert!((of(&[(0.0, true)]).expect("defined") - wrong).abs() < 1e-11);
        let right = of(&[(0.0, false)]).expect("defined");
        assert!((right - 1e-4).abs() < 1e-8, "{right}");
    }

    #[test]
    fn many_wrong_certainties_do_not_underflow() {
        let value = of(&vec![(0.0, true); 40_000]).expect("defined");
        assert!((value - 1e4f64.ln()).abs() < 1e-11, "{value}");
    }

    proptest! {
        #[test]
        fn equals_the_plain_sum(cells in prop::collection::vec((0.0f64..=1.0, any::<bool>()), 1..600)) {
            let plain: f64 = cells.iter().map(|&(p, occupied)| {
                let right = if occupied { p } else { 1.0 - p };
                -right.clamp(1e-4, 1.0 - 1e-4).ln()
            }).sum();
            let value = of(&cells).expect("defined");
            prop_assert!((value - plain / cells.len() as f64).abs() < 1e-11);
        }
    }
}
