//! The standard normal distribution.

use std::cmp::Ordering;

/// Probability of a value of at most `x`.
pub(crate) fn cdf(x: f64) -> f64 {
    0.5 * libm::erfc(-x * std::f64::consts::FRAC_1_SQRT_2)
}

/// The value that is not exceeded with probability `p`, 0 < p < 1, by bisection: it is needed a few
/// times per comparison, so that being right to the last digits is worth more than being fast.
/// `quantile(1 - p)` is exactly `-quantile(p)` wherever `1 - p` is exact.
pub(crate) fn quantile(p: f64) -> f64 {
    debug_assert!(p > 0.0 && p < 1.0, "{p} is not between 0 and 1");
    match p.total_cmp(&0.5) {
        Ordering::Greater => return -quantile(1.0 - p),
        Ordering::Equal => return 0.0, // where the bisection would stop a rounding short of it
        Ordering::Less => {}
    }
    // Below -38.5 the probability is no longer a normal number.
    let (mut low, mut high) = (-39.0, 0.0);
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        if cdf(middle) < p { low = middle } else { high = middle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// `scipy.stats.norm.cdf(x)` of scipy 1.17.
    const CDF: [(f64, f64); 6] = [
        (-1.0, 0.15865525393145707),
        (-1.959963984540054, 0.025),
        (-5.0, 2.866515718791933e-07),
        (-10.0, 7.61985302416047e-24),
        (-30.0, 4.906713927147908e-198),
        (2.0, 0.9772498680518208),
    ];

    #[test]
    fn equals_scipy() {
        for (x, p) in CDF {
            assert!((cdf(x) / p - 1.0).abs() < 1e-12, "cdf({x}) = {} and not {p}", cdf(x));
            assert!((quantile(p) / x - 1.0).abs() < 1e-13, "quantile({p}) = {} and not {x}", quantile(p));
        }
        // scipy.stats.norm.ppf(p)
        for (p, x) in [(0.2, -0.8416212335729142), (1e-10, -6.361340902404056), (1e-300, -37.0470962993612)] {
            assert!((quantile(p) / x - 1.0).abs() < 1e-13, "quantile({p}) = {} and not {x}", quantile(p));
        }
    }

    #[test]
    fn the_middle() {
        assert!((cdf(0.0) - 0.5).abs() < 1e-16);
        assert_eq!(quantile(0.5).to_bits(), 0.0f64.to_bits());
    }

    proptest! {
        #[test]
        fn one_undoes_the_other(p in 1e-12f64..1.0) {
            prop_assert!((cdf(quantile(p)) / p - 1.0).abs() < 1e-9);
        }

        #[test]
        fn symmetric(numerator in 1u32..1024) {
            let p = f64::from(numerator) / 1024.0;
            prop_assert_eq!(quantile(p).to_bits(), (-quantile(1.0 - p) + 0.0).to_bits());
        }
    }
}
