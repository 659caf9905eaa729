//! A depth camera: ranges whose noise grows with the square of the range.

use rand::{Rng, RngExt as _};
use rand_distr::StandardNormal;
use serde::{Deserialize, Serialize};

use crate::{FastKernel, InverseModel, Kernel, Parameters, Stereo};

/// A depth camera as a sensor model. A reading is a range in m; a pixel without one says nothing.
///
/// A depth camera finds a disparity too, of a pattern that it throws on the scene, but gives it as a range: what is normal about its
/// true value, with one standard deviation, is the inverse `1 / range`. To first order the range's is
/// [`inverse_sigma_per_m`](Self::inverse_sigma_per_m) times the square of the range, as measured by Khoshelham and Elberink, "Accuracy
/// and resolution of Kinect depth data for indoor mapping applications", Sensors 2012. With `s` for it, `M = max_range_m`, and `phi` the
/// standard normal density, a surface at range `r` gives a reading with density (1/m)
///
/// ```text
/// p(o | r) = hit phi((1/o - 1/r) / s) / (s o^2) + (1 - hit) / M,   0 < o <= M
/// ```
///
/// averaged over the chord of a cell, uniformly in inverse range. A reading of the surface that would lie beyond `M` is none; with
/// these the readings of every range add up to one. Pixels without a reading, such as those on surfaces seen at a grazing angle, say nothing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Depth {
    /// Standard deviation of the inverse range, 1/m; above 0. Default 0.001425: half a pixel of the Kinect (Khoshelham and Elberink 2012), 4 cm at
    /// 5 m.
    pub inverse_sigma_per_m: f64,
    /// Range beyond which nothing is measured, m; above 0. Default 5.
    pub max_range_m: f64,
    /// `P(T)`: probability that a reading is of the first surface, 0 to 1; the rest is uniform. Default 0.95, our choice.
    pub hit: f64,
}

impl Default for Depth {
    fn default() -> Self {
        Self { inverse_sigma_per_m: 0.001_425, max_range_m: 5.0, hit: 0.95 }
    }
}

impl Depth {
    /// The stereo camera whose disparity is the inverse range, for one reading: its false matches have the density of this reading's.
    fn inverse(&self, reading: f64) -> Stereo {
        Stereo {
            focal_baseline: 1.0,
            disparity_sigma: self.inverse_sigma_per_m,
            correct_match: self.hit,
            max_disparity: self.max_range_m / (reading * reading),
        }
    }

    /// A bin of ranges as its middle and half its width in inverse range, 1/m.
    fn inverse_bin(reading: f64, half_width: f64) -> [f64; 2] {
        let [high, low] = [reading - half_width, reading + half_width].map(|range| 1.0 / range.max(LEAST_M));
        [0.5 * (low + high), 0.5 * (high - low)]
    }

    /// The reading of a surface at `range_m` (m) that gives one: a range within `0 ..= max_range_m`, or none where noise takes it beyond.
    pub fn sample(&self, range_m: f64, rng: &mut impl Rng) -> Option<f64> {
        let reading = if rng.random::<f64>() < self.hit {
            let noise: f64 = rng.sample(StandardNormal);
            1.0 / (1.0 / range_m + self.inverse_sigma_per_m * noise)
        } else {
            self.max_range_m * rng.random::<f64>()
        };
        Some(reading).filter(|reading| *reading > 0.0 && *reading <= self.max_range_m)
    }
}

/// No range is told apart from this, m.
const LEAST_M: f64 = 1e-3;

/// Whether a reading says anything.
fn says(reading: f64) -> bool {
    reading >= LEAST_M && reading.is_finite()
}

impl Kernel for Depth {
    fn likelihood(&self, reading: f64, _bearing: f64, ranges: &[f64], likelihood: &mut [f64]) {
        if !says(reading) {
            return likelihood.fill((1.0 - self.hit) / self.max_range_m);
        }
        self.inverse(reading).likelihood(1.0 / reading, 0.0, ranges, likelihood);
        // Densities per 1/m of inverse range become those per m.
        likelihood.iter_mut().for_each(|likelihood| *likelihood /= reading * reading);
    }

    fn parameters(&self) -> Option<Parameters> {
        let Self { inverse_sigma_per_m, max_range_m, hit } = *self;
        let noise = vec![("inverse_sigma_per_m", inverse_sigma_per_m), ("max_range_m", max_range_m), ("hit", hit)];
        Some(Parameters { kernel: "depth", reading: "range_m", noise })
    }
}

impl FastKernel for Depth {
    fn constant_from(&self, reading: f64, _bearing: f64) -> f64 {
        if says(reading) { self.inverse(reading).constant_from(1.0 / reading, 0.0) } else { 0.0 }
    }

    fn constant_between(&self, reading: f64, _bearing: f64) -> [f64; 2] {
        if says(reading) { self.inverse(reading).constant_between(1.0 / reading, 0.0) } else { [0.0, f64::INFINITY] }
    }

    fn spread_from(&self, reading: f64, _bearing: f64, range: f64) -> f64 {
        let of_inverse = |reading: f64| self.inverse(reading).spread_from(1.0 / reading, 0.0, range);
        if says(reading) { of_inverse(reading) / (reading * reading) } else { 0.0 }
    }
}

impl InverseModel for Depth {
    fn correct_match(&self) -> f64 {
        self.hit
    }

    /// A reading near the largest range is the least certain: its standard deviation there, and at least half a cell.
    fn half_bin(&self, cell_m: f64) -> f64 {
        (self.inverse_sigma_per_m * self.max_range_m * self.max_range_m).max(0.5 * cell_m)
    }

    fn bin_probability(&self, reading: f64, half_width: f64, _bearing: f64, enter: f64, exit: f64) -> f64 {
        if !says(reading) {
            return 0.0;
        }
        let [middle, half] = Self::inverse_bin(reading, half_width);
        self.inverse(reading).bin_probability(middle, half, 0.0, enter, exit)
    }

    fn false_match_probability(&self, _reading: f64, half_width: f64) -> f64 {
        2.0 * half_width / self.max_range_m
    }

    fn behind_from(&self, reading: f64, half_width: f64, _bearing: f64) -> f64 {
        (1.0 + 1e-9) * (reading + half_width).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Placement;
    use proptest::prelude::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng as _};

    fn density(depth: &Depth, reading: f64, enter: f64, exit: f64) -> f64 {
        let mut out = [0.0];
        depth.likelihood(reading, 0.3, &[enter, exit], &mut out);
        out[0]
    }

    /// Chi square over bins of readings, and none: above its 99.9 % point once in a thousand seeds.
    #[test]
    fn the_histogram_of_samples_is_the_likelihood() {
        let depth = Depth { inverse_sigma_per_m: 0.02, max_range_m: 6.0, hit: 0.8 };
        let n = 100_000;
        for range_m in [0.5, 2.0, 4.0, 5.8] {
            let mut rng = ChaCha8Rng::seed_from_u64(9);
            let mut counts = [0.0; 61];
            for _ in 0..n {
                counts[depth.sample(range_m, &mut rng).map_or(60, |reading| ((reading * 10.0) as usize).min(59))] +=
                    1.0;
            }
            // The midpoint rule in steps far below the least standard deviation.
            let share = |bin: usize| {
                (0..400)
                    .map(|k| density(&depth, 0.1 * bin as f64 + 0.00025 * (f64::from(k) + 0.5), range_m, range_m))
                    .sum::<f64>()
                    * 0.00025
            };
            let shares: Vec<f64> = (0..60).map(share).collect();
            // What lies beyond the largest range, in the tail of the normal distribution of the inverse.
            let beyond = depth.hit * crate::normal::cumulative((1.0 / 6.0 - 1.0 / range_m) / 0.02);
            assert!((shares.iter().sum::<f64>() + beyond - 1.0).abs() < 1e-3, "{range_m}: all add up to one");
            let all = shares.into_iter().chain([beyond]).zip(counts).filter(|(share, _)| *share > 1e-6);
            let chi: f64 = all
                .map(|(share, count)| {
                    let expected = f64::from(n) * share;
                    (count - expected) * (count - expected) / expected
                })
                .sum();
            assert!(chi < 99.6, "{range_m}: {chi} of 60 degrees of freedom");
        }
    }

    /// The spread of what is read of surfaces twice as far away is four times as wide.
    #[test]
    fn noise_grows_with_the_square_of_the_range() {
        let depth = Depth { hit: 1.0, max_range_m: 100.0, ..Depth::default() };
        let spread = |range_m: f64| {
            let mut rng = ChaCha8Rng::seed_from_u64(4);
            let of = |_| depth.sample(range_m, &mut rng).map_or(0.0, |reading| (reading - range_m).powi(2));
            ((0..20_000).map(of).sum::<f64>() / 20_000.0).sqrt()
        };
        for (range_m, expected) in [(1.0, 0.001_425), (2.0, 0.0057), (4.0, 0.0228)] {
            assert!((spread(range_m) / expected - 1.0).abs() < 0.03, "{range_m}: {}", spread(range_m));
        }
    }

    proptest! {
        #[test]
        fn equals_the_average_over_the_chord(reading in 0.2f64..5.0, enter in 0.3f64..5.0, chord in 0.0f64..0.1) {
            let depth = Depth { inverse_sigma_per_m: 0.01, ..Depth::default() };
            let [near, far] = [1.0 / enter, 1.0 / (enter + chord)];
            let n = 4000;
            let at = |i: i32| 1.0 / (far + (near - far) * (f64::from(i) + 0.5) / f64::from(n));
            let expected = (0..n).map(|i| {
                let x = (1.0 / reading - 1.0 / at(i)) / 0.01;
                0.95 * (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt() / (0.01 * reading * reading) + 0.05 / 5.0
            }).sum::<f64>() / f64::from(n);
            let found = density(&depth, reading, enter, enter + chord);
            prop_assert!((found / expected - 1.0).abs() < 1e-4, "{} {}", found, expected);
        }

        /// Against Simpson's rule, the default of every sensor; and nothing more changes where it is said not to.
        #[test]
        fn bins_and_bounds_are_those_of_the_kernel(
            reading in 0.5f64..4.5, half_width in 0.02f64..0.2, away in -0.5f64..0.5, chord in 0.01f64..0.1,
        ) {
            struct Bare(Depth);
            impl Kernel for Bare {
                fn likelihood(&self, reading: f64, bearing: f64, ranges: &[f64], likelihood: &mut [f64]) {
                    self.0.likelihood(reading, bearing, ranges, likelihood);
                }
            }
            impl InverseModel for Bare {}
            let depth = Depth { inverse_sigma_per_m: 0.02, hit: 1.0, ..Depth::default() };
            let enter = (reading + away).max(0.3);
            let found = depth.bin_probability(reading, half_width, 0.0, enter, enter + chord);
            let expected = Bare(depth).bin_probability(reading, half_width, 0.0, enter, enter + chord);
            prop_assert!((found - expected).abs() < 1e-4, "{} {}", found, expected);
            let sure = Depth::default();
            let last = sure.constant_from(reading, 0.0);
            if last.is_finite() {
                let [a, b] = [density(&sure, reading, last, last + 0.1), density(&sure, reading, last + 3.0, last + 4.0)];
                prop_assert!((a / b - 1.0).abs() < 1e-6);
            }
            let [from, until] = sure.constant_between(reading, 0.0);
            let [a, b] = [density(&sure, reading, from, from + 0.01), density(&sure, reading, 0.9 * until, until)];
            prop_assert!((a / b - 1.0).abs() < 1e-6);
            let behind = depth.behind_from(reading, half_width, 0.0);
            prop_assert_eq!(depth.placement(reading, half_width, 0.0, behind, behind + 0.1), Placement::Behind);
            let most = sure.spread_from(reading, 0.0, enter);
            let differ = (density(&sure, reading, enter, enter) - density(&sure, reading, enter + chord, enter + chord)).abs();
            prop_assert!(differ <= most * (1.0 + 1e-6) + 1e-9, "{} {}", differ, most);
        }
    }

    #[test]
    fn what_cannot_be_read_says_nothing() {
        let depth = Depth::default();
        for reading in [0.0, -1.0, f64::INFINITY] {
            let values: Vec<u64> = [0.5, 2.0, 9.0].map(|at| density(&depth, reading, at, at + 0.1).to_bits()).to_vec();
            assert!(values.windows(2).all(|pair| pair[0] == pair[1]), "{reading}");
            assert!(depth.constant_from(reading, 0.0) < 1e-9);
        }
    }
}
