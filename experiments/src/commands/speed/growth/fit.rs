//! The exponent of a power law.

/// Slope of the straight line of least squares through `(ln x, ln y)`: the exponent `b` of `y = a x^b`. None where
/// fewer than two different `x` have a `y`, both above 0 and finite.
pub fn exponent(points: &[(f64, f64)]) -> Option<f64> {
    let usable = points.iter().filter(|(x, y)| [x, y].iter().all(|v| v.is_finite() && **v > 0.0));
    let logs: Vec<(f64, f64)> = usable.map(|(x, y)| (libm::log(*x), libm::log(*y))).collect();
    let count = logs.len() as f64;
    let (x, y) = logs.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / count, b + y / count));
    let spread: f64 = logs.iter().map(|(at, _)| (at - x) * (at - x)).sum();
    let shared: f64 = logs.iter().map(|(at, value)| (at - x) * (value - y)).sum();
    (spread > 1e-12).then(|| shared / spread)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_gives_its_exponent() {
        for power in [0.0, 0.5, 1.0, 2.0, -1.0] {
            let points = [100.0, 300.0, 1e3, 3e3, 1e4].map(|x: f64| (x, 3e-9 * x.powf(power)));
            assert!((exponent(&points).expect("five points") - power).abs() < 1e-12);
        }
    }

    /// By hand: ln x = -1, 0, 1 and ln y = 0, 3, 3 have the slope 3 / 2.
    #[test]
    fn points_off_the_line_count_by_least_squares() {
        let e = std::f64::consts::E;
        let points = [(1.0 / e, 1.0), (1.0, e.powi(3)), (e, e.powi(3))];
        assert!((exponent(&points).expect("three points") - 1.5).abs() < 1e-12);
    }

    #[test]
    fn what_has_no_slope_has_no_exponent() {
        assert_eq!(exponent(&[]), None);
        assert_eq!(exponent(&[(1.0, 1.0)]), None);
        assert_eq!(exponent(&[(2.0, 1.0), (2.0, 3.0)]), None);
        assert_eq!(exponent(&[(1.0, 1.0), (2.0, 0.0), (3.0, f64::NAN)]), None);
    }
}
