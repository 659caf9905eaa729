//! Weights of particles, and which of them go on.

/// Weights that add up to one from logarithms of weights; equal ones where no particle has any.
pub fn normalised(log_weights: &[f64]) -> Vec<f64> {
    let most = log_weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if most == f64::NEG_INFINITY {
        return vec![1.0 / log_weights.len() as f64; log_weights.len()];
    }
    let weights: Vec<f64> = log_weights.iter().map(|log| libm::exp(log - most)).collect();
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| weight / sum).collect()
}

/// `N_eff = 1 / sum w^2` of weights that add up to one: from 1, where one has it all, to their number (Doucet, "On sequential
/// simulation-based methods for Bayesian filtering", 1998).
pub fn effective(weights: &[f64]) -> f64 {
    1.0 / weights.iter().map(|weight| weight * weight).sum::<f64>()
}

/// Of which particle each of the next ones is a copy: the low-variance sampler (Thrun, Burgard and Fox, Probabilistic Robotics, Table
/// 4.4), as many as there are weights. `share`, 0 to 1 without 1, is drawn uniformly; the expected number of copies of a particle
/// is its weight times their number, and the number is that rounded up or down.
///
/// # Panics
/// Unless there are weights.
pub fn low_variance(weights: &[f64], share: f64) -> Vec<usize> {
    assert!(!weights.is_empty(), "there is a particle");
    let step = 1.0 / weights.len() as f64;
    let (mut which, mut sum) = (0, weights[0]);
    let next = |k: usize| {
        let mark = (k as f64 + share) * step;
        // The last takes what rounding leaves of one.
        while mark >= sum && which + 1 < weights.len() {
            which += 1;
            sum += weights[which];
        }
        which
    };
    (0..weights.len()).map(next).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::stream;
    use proptest::prelude::*;

    #[test]
    fn resampling_is_unbiased_over_a_million_draws() {
        let weights = normalised(&[-0.3, -4.0, -1.1, -1.2, -0.1, -7.0, -2.5, -0.9, -3.3, -1.6]);
        let mut rng = stream(11, 0, 0);
        let mut counts = [0u64; 10];
        const ROUNDS: u32 = 100_000;
        for _ in 0..ROUNDS {
            low_variance(&weights, rng.random()).into_iter().for_each(|which| counts[which] += 1);
        }
        assert_eq!(counts.iter().sum::<u64>(), 1_000_000);
        for (count, weight) in counts.iter().zip(&weights) {
            let (expected, share) = (10.0 * weight * f64::from(ROUNDS), 10.0 * weight);
            // Copies of a particle are its share rounded down or up.
            let up = share.fract();
            let sigma = (f64::from(ROUNDS) * up * (1.0 - up)).sqrt();
            assert!((*count as f64 - expected).abs() <= 4.5 * sigma + 1e-6, "{count} {expected} {sigma}");
        }
    }

    proptest! {
        #[test]
        fn copies_are_the_share_rounded(logs in prop::collection::vec(-20.0f64..0.0, 1..50), share in 0.0f64..1.0) {
            let weights = normalised(&logs);
            prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            let chosen = low_variance(&weights, share);
            prop_assert_eq!(chosen.len(), weights.len());
            for (k, weight) in weights.iter().enumerate() {
                let (copies, expected) = (chosen.iter().filter(|which| **which == k).count() as f64, weight * weights.len() as f64);
                prop_assert!((copies - expected).abs() < 1.0 + 1e-9, "{copies} {expected}");
            }
            let effective = effective(&weights);
            prop_assert!((1.0 - 1e-12..=weights.len() as f64 * (1.0 + 1e-12)).contains(&effective));
        }
    }

    #[test]
    fn without_any_weight_all_are_alike() {
        assert_eq!(normalised(&[f64::NEG_INFINITY; 4]), [0.25; 4]);
        assert!((effective(&[0.25; 4]) - 4.0).abs() < 1e-12);
        assert_eq!(low_variance(&[0.0, 1.0, 0.0], 0.999), [1, 1, 1]);
    }
}
