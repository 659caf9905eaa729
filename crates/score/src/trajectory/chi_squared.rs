//! The chi-squared distribution.

/// Terms after which the sums below have long converged, for up to 10^9 degrees of freedom.
const TERMS: usize = 1_000_000;

/// Probability of a value of at most `x` with `freedom` degrees of freedom: the regularised incomplete gamma function `P(k/2, x/2)`, by its
/// series below the mean and by the continued fraction of its complement above (Press et al. 2007, Section 6.2).
pub(super) fn cdf(x: f64, freedom: f64) -> f64 {
    let [a, x] = [0.5 * freedom, 0.5 * x];
    if x <= 0.0 {
        return 0.0;
    }
    let scale = libm::exp(a * libm::log(x) - x - libm::lgamma(a));
    if x < a + 1.0 {
        let mut term = 1.0 / a;
        let mut sum = term;
        for k in 1..TERMS {
            term *= x / (a + k as f64);
            sum += term;
            if term < 1e-17 * sum {
                break;
            }
        }
        return scale * sum;
    }
    // By the method of Lentz.
    let mut b = x + 1.0 - a;
    let mut c = 1e300;
    let mut d = 1.0 / b;
    let mut fraction = d;
    for k in 1..TERMS {
        let numerator = -(k as f64) * (k as f64 - a);
        b += 2.0;
        d = 1.0 / tiny_at_least(numerator * d + b);
        c = tiny_at_least(b + numerator / c);
        fraction *= d * c;
        if (d * c - 1.0).abs() < 1e-16 {
            break;
        }
    }
    1.0 - scale * fraction
}

fn tiny_at_least(value: f64) -> f64 {
    if value.abs() < 1e-300 { 1e-300 } else { value }
}

/// The value that is not exceeded with probability `p`, 0 < p < 1, by bisection.
pub(crate) fn quantile(p: f64, freedom: f64) -> f64 {
    debug_assert!(p > 0.0 && p < 1.0 && freedom > 0.0, "{p} of {freedom}");
    // Thirty standard deviations above the mean, and more for few degrees of freedom.
    let (mut low, mut high) = (0.0, freedom + 30.0 * libm::sqrt(2.0 * freedom) + 100.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if cdf(middle, freedom) < p { low = middle } else { high = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms_and_tables() {
        // Of two degrees of freedom: 1 - exp(-x / 2).
        for x in [0.01, 0.5, 2.0, 3.9, 4.1, 20.0] {
            assert!((cdf(x, 2.0) - (1.0 - libm::exp(-0.5 * x))).abs() < 1e-13, "{x}");
        }
        // Of one: the normal distribution.
        for x in [0.3f64, 1.0, 4.0, 9.0] {
            assert!((cdf(x, 1.0) - libm::erf(libm::sqrt(0.5 * x))).abs() < 1e-13, "{x}");
        }
        // Of four: 1 - (1 + x / 2) exp(-x / 2); even degrees of freedom have such sums.
        for (p, freedom) in [(0.025, 4.0), (0.5, 4.0), (0.975, 4.0)] {
            let x = quantile(p, freedom);
            assert!((1.0 - (1.0 + 0.5 * x) * libm::exp(-0.5 * x) - p).abs() < 1e-12, "{p}");
        }
        // Table of percentage points (Pearson and Hartley 1954).
        for (p, freedom, expected) in
            [(0.95, 3.0, 7.815), (0.025, 3.0, 0.216), (0.975, 30.0, 46.979), (0.025, 100.0, 74.222)]
        {
            assert!((quantile(p, freedom) - expected).abs() < 5e-4, "{p} {freedom}: {}", quantile(p, freedom));
        }
    }

    #[test]
    fn of_many_degrees_of_freedom_it_is_nearly_normal() {
        let freedom = 30_000.0;
        let off = (quantile(0.975, freedom) - freedom) / libm::sqrt(2.0 * freedom);
        assert!((off - 1.96).abs() < 0.02, "{off}");
    }
}
