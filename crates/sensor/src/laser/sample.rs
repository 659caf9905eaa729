//! Sampling the ranges that a laser would measure.

use rand::{Rng, RngExt as _};
use rand_distr::{Exp1, StandardNormal};

use super::Laser;

impl Laser {
    /// The reading of a beam whose first surface is at `range_m` (m), if there is one: a range within
    /// `0 ..= max_range_m`, or `f64::INFINITY` without an echo.
    pub fn sample(&self, range_m: Option<f64>, rng: &mut impl Rng) -> f64 {
        let fate: f64 = rng.random();
        let reading = if fate < self.hit {
            let noise: f64 = rng.sample(StandardNormal);
            let early: f64 = rng.sample(Exp1);
            let surface_m = range_m.map_or(f64::INFINITY, |range_m| (range_m + self.range_sigma_m * noise).abs());
            surface_m.min(early / self.early_per_m)
        } else if fate < self.hit + self.no_echo {
            f64::INFINITY
        } else {
            self.max_range_m * rng.random::<f64>()
        };
        if reading <= self.max_range_m { reading } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Kernel as _;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng as _};

    /// Chi square over bins of readings, and no echo: above its 99.9 % point once in a thousand seeds.
    #[test]
    fn the_histogram_of_samples_is_the_likelihood() {
        let laser = Laser { range_sigma_m: 0.1, max_range_m: 6.0, hit: 0.7, no_echo: 0.1, early_per_m: 0.1 };
        let n = 200_000;
        for range_m in [Some(0.05), Some(2.0), Some(5.9), Some(6.2), None] {
            let mut rng = ChaCha8Rng::seed_from_u64(11);
            let mut counts = [0.0; 121];
            for _ in 0..n {
                let reading = laser.sample(range_m, &mut rng);
                counts[if reading.is_finite() { (reading / 0.05) as usize } else { 120 }] += 1.0;
            }
            let surface_m = range_m.unwrap_or(1e6);
            let at = |reading: f64| {
                let mut out = [0.0];
                laser.likelihood(reading, 0.0, &[surface_m; 2], &mut out);
                out[0]
            };
            let chi_square: f64 = (0..121)
                .map(|bin| {
                    // Simpson's rule over twenty parts of a bin.
                    let part = |k: usize| 0.05 * (bin as f64 + k as f64 / 40.0);
                    let simpson = |k: usize| at(part(2 * k)) + 4.0 * at(part(2 * k + 1)) + at(part(2 * k + 2));
                    let share = (0..20).map(simpson).sum::<f64>() * 0.05 / 120.0;
                    let expected = f64::from(n) * if bin < 120 { share } else { at(f64::INFINITY) };
                    (counts[bin] - expected).powi(2) / expected
                })
                .sum();
            assert!(chi_square < 173.6, "chi square {chi_square} of 121 bins, surface at {range_m:?}");
        }
    }

    #[test]
    fn without_people_and_outliers_nothing_is_read_before_the_surface() {
        let laser = Laser { early_per_m: 0.0, hit: 0.8, no_echo: 0.2, ..Laser::default() };
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let readings: Vec<f64> = (0..10_000).map(|_| laser.sample(Some(10.0), &mut rng)).collect();
        assert!(readings.iter().all(|o| o.is_infinite() || (o - 10.0).abs() < 0.2));
        let lost = readings.iter().filter(|o| o.is_infinite()).count() as f64 / 1e4;
        assert!((lost - 0.2).abs() < 0.016, "{lost}");
        assert!((0..100).all(|_| laser.sample(None, &mut rng).is_infinite()));
    }
}
