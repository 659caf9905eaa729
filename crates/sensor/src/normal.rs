//! The standard normal distribution, exact in its tails.

use std::f64::consts::{FRAC_1_SQRT_2, PI};
use std::sync::LazyLock;

use crate::lanes::{LANES, Lanes, each};

/// Beyond this many standard deviations the density is below 1e-15 and counts as nothing, beside anything else.
pub(crate) const REACH: f64 = 8.5;

/// Beyond this many it is no longer a number, and nothing even where there is nothing else.
pub(crate) const FARTHEST: f64 = 39.0;

/// Density of the standard normal distribution.
pub(crate) fn density(x: f64) -> f64 {
    libm::exp(-0.5 * x * x) / libm::sqrt(2.0 * PI)
}

/// Probability in the tail beyond `|x|`.
fn tail(x: f64) -> f64 {
    0.5 * libm::erfc(x.abs() * FRAC_1_SQRT_2)
}

/// Probability between `low` and `high`, without cancellation in the tails.
pub(crate) fn between(low: f64, high: f64) -> f64 {
    within(low, high, REACH)
}

/// The same, nothing beyond `reach`.
fn within(low: f64, high: f64, reach: f64) -> f64 {
    debug_assert!(low <= high, "{low} > {high}");
    if low > reach || high < -reach {
        0.0
    } else if low > 0.0 || high < 0.0 {
        (tail(low) - tail(high)).abs()
    } else {
        1.0 - tail(low) - tail(high)
    }
}

/// Mean density over `low ..= high`, nothing beyond `reach`; where the interval is short, the series about
/// its middle, which leaves out terms of order `width^4 / 1920`.
pub(crate) fn mean_density(low: f64, high: f64, reach: f64) -> f64 {
    const SHORT: f64 = 1e-3;
    let width = high - low;
    if width >= SHORT {
        return within(low, high, reach) / width;
    }
    let middle = 0.5 * (low + high);
    if middle.abs() > reach {
        return 0.0;
    }
    density(middle) * (1.0 + width * width * (middle * middle - 1.0) / 24.0)
}

/// Mean of the cumulative distribution over `low ..= high`, 0 before `-reach` and 1 beyond `reach`; where the interval is
/// short, the series about its middle, which leaves out terms of order `width^4 / 1920`. Never below 0, where nothing but
/// rounding is left.
pub(crate) fn mean_cumulative(low: f64, high: f64, reach: f64) -> f64 {
    mean_cumulative_by(&mut exact_integral, low, high, reach)
}

/// The same by whoever knows the exact integral.
fn mean_cumulative_by(integral: &mut impl FnMut(f64) -> f64, low: f64, high: f64, reach: f64) -> f64 {
    const SHORT: f64 = 1e-3;
    let width = high - low;
    if high < -reach {
        0.0
    } else if low > reach || width == f64::INFINITY {
        1.0
    } else if width >= SHORT {
        ((integral(high) - integral(low)) / width).clamp(0.0, 1.0)
    } else {
        let middle = 0.5 * (low + high);
        (exact_cumulative(middle) - width * width * middle * density(middle) / 24.0).clamp(0.0, 1.0)
    }
}

/// [`mean_cumulative`] over one interval after the other, the first of which ends where the next begins: integrals are kept to there.
pub(crate) struct MeanCumulative {
    /// Where, and the integral; the last two.
    kept: [(f64, f64); 2],
}

impl MeanCumulative {
    pub(crate) fn new() -> Self {
        Self { kept: [(f64::NAN, f64::NAN); 2] }
    }

    /// The mean over `low ..= high`.
    pub(crate) fn over(&mut self, low: f64, high: f64, reach: f64) -> f64 {
        let kept = &mut self.kept;
        let mut integral = |x: f64| {
            if let Some((_, integral)) = kept.iter().find(|(at, _)| at.to_bits() == x.to_bits()) {
                return *integral;
            }
            *kept = [kept[1], (x, exact_integral(x))];
            kept[1].1
        };
        mean_cumulative_by(&mut integral, low, high, reach)
    }
}

/// `x Phi(x) + phi(x)` without the table, exact in the tail too.
fn exact_integral(x: f64) -> f64 {
    let beyond = (density(x) - x.abs() * tail(x)).max(0.0);
    if x < 0.0 { beyond } else { x + beyond }
}

/// Antiderivative of the cumulative distribution: `x Phi(x) + phi(x)`, to 1e-12, from a table.
pub(crate) fn cumulative_integral(x: f64) -> f64 {
    if x < -REACH { 0.0 } else { from_table(&INTEGRALS, x).unwrap_or(x) }
}

/// The cumulative distribution, to 1e-12, from a table.
pub(crate) fn cumulative(x: f64) -> f64 {
    if x < -REACH { 0.0 } else { from_table(&CUMULATIVES, x).unwrap_or(1.0) }
}

/// What a table holds of a place from `-REACH` on; none beyond `REACH`.
fn from_table(table: &Table, x: f64) -> Option<f64> {
    let place = (x + REACH) * PER_UNIT;
    (place < STEPS as f64).then(|| cubic(table[place as usize], place.fract()))
}

/// The cubic that has value and slope at both ends of a step of a table, error below step^4 / 384 times the fourth derivative.
#[inline(always)]
fn cubic([[a, da], [b, db]]: [[f64; 2]; 2], t: f64) -> f64 {
    let s = 1.0 - t;
    (a * (1.0 + 2.0 * t) + da * t) * s * s + (b * (1.0 + 2.0 * s) - db * s) * t * t
}

/// A function with a table, in lanes.
#[derive(Clone, Copy)]
pub(crate) struct LaneTable {
    table: &'static Table,
    /// Beyond the table the function is this, or its argument where there is none.
    beyond: Option<f64>,
}

impl LaneTable {
    /// [`cumulative`], to the bit.
    pub(crate) fn cumulative() -> Self {
        Self { table: &CUMULATIVES, beyond: Some(1.0) }
    }

    /// [`cumulative_integral`], to the bit.
    pub(crate) fn cumulative_integral() -> Self {
        Self { table: &INTEGRALS, beyond: None }
    }

    #[inline(always)]
    pub(crate) fn at(self, x: &Lanes<f64>) -> Lanes<f64> {
        /// A sum with 2^52 has no fraction, and its low bits are the other number.
        const WHOLE: f64 = 4_503_599_627_370_496.0;
        let end = STEPS as f64;
        let last = end.next_down();
        let place = each(|l| (x[l] + REACH) * PER_UNIT);
        let inside = each(|l| if place[l] > 0.0 { place[l] } else { 0.0 });
        let inside = each(|l| if inside[l] < last { inside[l] } else { last });
        let nearest = each(|l| (inside[l] + WHOLE) - WHOLE);
        let number = each(|l| if nearest[l] > inside[l] { nearest[l] - 1.0 } else { nearest[l] });
        let t = each(|l| inside[l] - number[l]);
        let number: Lanes<u32> = each(|l| (number[l] + WHOLE).to_bits() as u32);
        let (mut a, mut da, mut b, mut db) = ([0.0; LANES], [0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for l in 0..LANES {
            [[a[l], da[l]], [b[l], db[l]]] = self.table[number[l] as usize % ROOM];
        }
        let inner = each(|l| cubic([[a[l], da[l]], [b[l], db[l]]], t[l]));
        let beyond = each(|l| self.beyond.unwrap_or(x[l]));
        let inner = each(|l| if place[l] < end { inner[l] } else { beyond[l] });
        each(|l| if x[l] < -REACH { 0.0 } else { inner[l] })
    }
}

/// Steps of the table per unit.
const PER_UNIT: f64 = 256.0;

/// Steps of the table, and room for so many that a remainder is a place in it.
const STEPS: usize = (2.0 * REACH * PER_UNIT) as usize;
const ROOM: usize = STEPS.next_power_of_two();

/// Value and slope times step, at both ends of every step from `-REACH` to `REACH`.
type Table = [[[f64; 2]; 2]; ROOM];

/// The table of a function by its value and slope.
fn table(value_and_slope: impl Fn(f64) -> [f64; 2]) -> Box<Table> {
    let at = |k: usize| {
        let [value, slope] = value_and_slope(k as f64 / PER_UNIT - REACH);
        [value, slope / PER_UNIT]
    };
    let mut table = Box::new([[[0.0; 2]; 2]; ROOM]);
    for (k, step) in table[..STEPS].iter_mut().enumerate() {
        *step = [at(k), at(k + 1)];
    }
    table
}

/// `Phi`, without the table.
fn exact_cumulative(x: f64) -> f64 {
    if x < 0.0 { tail(x) } else { 1.0 - tail(x) }
}

static INTEGRALS: LazyLock<Box<Table>> =
    LazyLock::new(|| table(|x| [x * exact_cumulative(x) + density(x), exact_cumulative(x)]));

static CUMULATIVES: LazyLock<Box<Table>> = LazyLock::new(|| table(|x| [exact_cumulative(x), density(x)]));

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_probabilities() {
        assert!((between(-1.0, 1.0) - 0.682_689_492_137_085_9).abs() < 1e-15);
        assert!((between(-f64::INFINITY, 0.0) - 0.5).abs() < 1e-15);
        // Phi(-5) - Phi(-6), from tables of the upper tail.
        let upper = 2.866_515_718_791_939e-7 - 9.865_876_450_376_946e-10;
        assert!((between(5.0, 6.0) / upper - 1.0).abs() < 1e-12);
        assert!((between(-6.0, -5.0) / upper - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_table_of_the_cumulative_distribution_is_that_to_its_twelfth_digit() {
        for k in 0..40_000 {
            let x = f64::from(k) * 5e-4 - 10.0;
            assert!((cumulative(x) - exact_cumulative(x)).abs() < 1e-12, "{x}");
        }
        assert_eq!(
            [cumulative(f64::NEG_INFINITY), cumulative(f64::INFINITY)].map(f64::to_bits),
            [0.0f64, 1.0].map(f64::to_bits)
        );
    }

    #[test]
    fn the_mean_density_has_no_seam_where_the_series_takes_over() {
        for middle in [-4.0, -1.0, 0.0, 0.3, 2.5, 6.0] {
            let [series, exact] =
                [0.999_999e-3, 1.000_001e-3].map(|w| mean_density(middle - w / 2.0, middle + w / 2.0, REACH));
            assert!((series - exact).abs() < 2e-13, "{middle}: {series} {exact}");
            assert!((mean_density(middle, middle, REACH) - density(middle)).abs() < 1e-16);
        }
    }

    /// By Simpson's rule, also where next to nothing is left, and across the seam to the series.
    #[test]
    fn the_mean_of_the_cumulative_distribution() {
        let cumulative = |x: f64| if x < 0.0 { tail(x) } else { 1.0 - tail(x) };
        for low in [-30.0, -8.0, -3.0, -0.2, 0.0, 1.0, 5.0] {
            for width in [0.0, 1e-6, 0.999e-3, 1.001e-3, 0.3, 4.0] {
                let at = |k: usize| cumulative(low + width * k as f64 / 20_000.0);
                let sum: f64 = (0..10_000).map(|k| at(2 * k) + 4.0 * at(2 * k + 1) + at(2 * k + 2)).sum();
                let found = mean_cumulative(low, low + width, FARTHEST);
                assert!((found / (sum / 60_000.0) - 1.0).abs() < 1e-9, "{low} {width}: {found} {}", sum / 60_000.0);
            }
        }
        assert!((mean_cumulative(-50.0, f64::INFINITY, REACH) - 1.0).abs() < 1e-15);
        assert!((mean_cumulative(-1e9, 1e9, REACH) - 0.5).abs() < 1e-12);
        assert!(mean_cumulative(-9.0, -8.6, REACH).abs() < 1e-300);
    }

    #[test]
    fn the_table_is_the_cumulative_integral() {
        for k in -90_000..=90_000 {
            let x = f64::from(k) * 1.000_37e-4;
            let cumulative = if x < 0.0 { tail(x) } else { 1.0 - tail(x) };
            let error = cumulative_integral(x) - (x * cumulative + density(x));
            assert!(error.abs() < 1e-12, "{x}: {error}");
        }
        assert!(cumulative_integral(f64::INFINITY).is_infinite());
    }

    #[test]
    fn in_lanes_it_is_the_same_to_the_bit() {
        let at = |k: i32| f64::from(k) * 1.000_37e-2;
        for k in (-2000..2000).step_by(LANES) {
            let mut x = each(|l| at(k + l as i32));
            x[3] = [f64::NEG_INFINITY, f64::INFINITY, -REACH, REACH, -0.0][k as usize % 5];
            // In the last step of the table.
            x[5] = REACH - f64::from(k.abs()) * 2e-6;
            let found = LaneTable::cumulative_integral().at(&x);
            assert_eq!(found.map(f64::to_bits), x.map(|x| cumulative_integral(x).to_bits()), "{x:?}");
            let found = LaneTable::cumulative().at(&x);
            assert_eq!(found.map(f64::to_bits), x.map(|x| cumulative(x).to_bits()), "{x:?}");
        }
    }

    #[test]
    fn the_cumulative_integral_grows_by_the_probability() {
        // Simpson's rule over [a, a + h] as the slow reference.
        let phi = |x: f64| between(-f64::INFINITY, x);
        for a in [-9.0, -3.0, -0.5, 0.0, 1.0, 4.0, 9.0] {
            let h = 1e-2;
            let simpson = h / 6.0 * (phi(a) + 4.0 * phi(a + h / 2.0) + phi(a + h));
            assert!((cumulative_integral(a + h) - cumulative_integral(a) - simpson).abs() < 1e-12, "{a}");
        }
    }
}
