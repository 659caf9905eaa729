//! What a chain saw of every cell, and whether chains agree: split R-hat and effective sample sizes.
//!
//! Gelman et al., "Bayesian Data Analysis", 3rd ed. 2013, Sections 11.4 and 11.5; Flegal and Jones, "Batch means and spectral
//! variance estimators in Markov chain Monte Carlo", Annals of Statistics 38, 2010.

use crate::memory::Held;

/// Batches of a stage, of which each half has five.
pub(super) const BATCHES: usize = 10;

/// A stage of one chain: for every series, the sum over each batch and the sum of squares over each half.
#[derive(Clone)]
pub(super) struct Tally {
    sweeps: usize,
    sums: Vec<[f64; BATCHES]>,
    squares: Vec<[f64; 2]>,
}

impl Tally {
    /// Of so many series over a stage of so many sweeps, a multiple of [`BATCHES`].
    pub(super) fn new(series: usize, sweeps: usize) -> Self {
        assert!(sweeps > 0 && sweeps.is_multiple_of(BATCHES), "whole batches");
        Self { sweeps, sums: vec![[0.0; BATCHES]; series], squares: vec![[0.0; 2]; series] }
    }

    /// Takes in a value of a series at a sweep of the stage, from 0.
    pub(super) fn add(&mut self, series: usize, sweep: usize, value: f64) {
        let batch = sweep * BATCHES / self.sweeps;
        self.sums[series][batch] += value;
        self.squares[series][batch * 2 / BATCHES] += value * value;
    }
}

impl Held for Tally {
    fn held(&self) -> usize {
        self.sums.held() + self.squares.held()
    }
}

/// What chains say of a series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Agreement {
    /// Mean over all chains.
    pub(super) mean: f64,
    /// Split R-hat: 1 where the halves of all chains agree; infinite where they stand still at different values.
    pub(super) r_hat: f64,
    /// Effective sample size of the mean, by batch means over all chains.
    pub(super) effective: f64,
}

/// What the tallies of several chains over the same stage say of a series.
pub(super) fn agreement(tallies: &[Tally], series: usize) -> Agreement {
    let sweeps = tallies[0].sweeps as f64;
    let half = 0.5 * sweeps;
    let halves = tallies.iter().flat_map(|tally| {
        [0, 1].map(|part| {
            let sums = &tally.sums[series][part * BATCHES / 2..(part + 1) * BATCHES / 2];
            let mean = sums.iter().sum::<f64>() / half;
            (mean, (tally.squares[series][part] / half - mean * mean).max(0.0) * half / (half - 1.0))
        })
    });
    let (means, variances): (Vec<f64>, Vec<f64>) = halves.unzip();
    let within = variances.iter().sum::<f64>() / variances.len() as f64;
    let mean = means.iter().sum::<f64>() / means.len() as f64;
    let between = variance(&means, mean);
    let total = within * (half - 1.0) / half + between;
    // Rounding of sums of squares is no movement.
    let still = 1e-12 * (1.0 + mean * mean);
    let r_hat = match (within > still, between > still) {
        (true, _) => (total / within).sqrt(),
        (false, true) => f64::INFINITY,
        (false, false) => 1.0,
    };
    let batches: Vec<f64> =
        tallies.iter().flat_map(|tally| tally.sums[series].iter().map(|sum| sum * BATCHES as f64 / sweeps)).collect();
    let of_mean = variance(&batches, mean) / batches.len() as f64;
    let draws = sweeps * tallies.len() as f64;
    let effective = if of_mean > still * 1e-6 { (total / of_mean).min(draws) } else { draws };
    Agreement { mean, r_hat, effective }
}

fn variance(values: &[f64], mean: f64) -> f64 {
    values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (values.len() - 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    /// Chains of an autoregressive series with coefficient `keep` about the given means.
    fn chains(means: [f64; 4], keep: f64, sweeps: usize) -> Vec<Tally> {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let chain = |mean: &f64| {
            let (mut tally, mut x) = (Tally::new(1, sweeps), 0.0);
            for sweep in 0..sweeps {
                x = keep * x + (1.0 - keep * keep).sqrt() * (12.0f64).sqrt() * (rng.random::<f64>() - 0.5);
                tally.add(0, sweep, mean + x);
            }
            tally
        };
        means.iter().map(chain).collect()
    }

    /// An autoregressive series of coefficient `a` is worth `(1 - a) / (1 + a)` of its length.
    #[test]
    fn series_are_worth_what_they_are_worth() {
        for (keep, share) in [(0.0, 1.0), (0.5, 1.0 / 3.0), (0.8, 1.0 / 9.0)] {
            let agreement = agreement(&chains([0.3; 4], keep, 4000), 0);
            assert!((agreement.mean - 0.3).abs() < 0.03 && agreement.r_hat < 1.01, "{agreement:?}");
            let worth = agreement.effective / 16_000.0;
            assert!(worth > 0.6 * share && worth < 1.7 * share, "{keep}: {worth}");
        }
    }

    #[test]
    fn chains_apart_are_told() {
        let agreement_of = |means| agreement(&chains(means, 0.0, 1000), 0);
        // Variance 1 within and 0.5 between: R-hat is the root of 1.5, or with split chains of about 1 + 0.5 * 6 / 7.
        let apart = agreement_of([0.0, 0.0, 1.0, 1.0]);
        assert!((apart.r_hat - (1.0f64 + 0.25 * 8.0 / 7.0).sqrt()).abs() < 0.03, "{apart:?}");
        // Batches of two kinds, 40 in all: their mean is as sure as 40 draws of variance 1/4, or 200 of all that there is.
        assert!(apart.effective > 150.0 && apart.effective < 250.0, "{apart:?}");
        let mut still: Vec<Tally> = (0..4).map(|_| Tally::new(1, 10)).collect();
        assert_eq!(agreement(&still, 0), Agreement { mean: 0.0, r_hat: 1.0, effective: 40.0 });
        (0..10).for_each(|sweep| still[0].add(0, sweep, 1.0));
        assert!(agreement(&still, 0).r_hat.is_infinite());
    }
}
