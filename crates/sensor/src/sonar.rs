//! A sonar: one echo from a cone, of the nearest thing in it.

use std::ops::Range;

use rand::Rng;
use serde::{Deserialize, Serialize};

use crate::lanes::{Beams, Lanes};
use crate::{FastKernel, InverseModel, Kernel, Laser, LaserError, Parameters, Placement};

/// A sonar as a sensor model. A reading is the range of the first echo in m, or `f64::INFINITY` where there was none.
///
/// In range it is a beam as [`Laser`] has it, with other numbers: of a pulse towards a surface at range `r` comes an echo of it, with
/// a probability that the pulse glances off ([`no_echo`](Self::no_echo): smooth walls are mirrors for sound) and one of an echo by a
/// detour, of another sonar or of noise (what is left: uniform). What makes it a sonar is that the surface is the nearest of all in a cone
/// [`width_rad`](Self::width_rad) wide, and that the reading does not tell where in it. A ray of its scan is the axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Sonar {
    /// Standard deviation of the range of a surface, m; above 0. Default 0.03, about 1 % of the range of 3 m at which the transducers of Polaroid are
    /// used in rooms (Elfes, "Sonar-based real-world mapping and navigation", IEEE Journal of Robotics and Automation 1987).
    pub range_sigma_m: f64,
    /// Range beyond which nothing is measured, m; above 0. Default 5.
    pub max_range_m: f64,
    /// `P(T)`: probability of an echo from the nearest surface in the cone, 0 to 1. Default 0.75, our choice.
    pub hit: f64,
    /// Probability of no echo although there is a surface, 0 to 1; with [`hit`](Self::hit) at most 1. Default 0.15, our choice.
    pub no_echo: f64,
    /// Things that are on no map, per metre, 1/m; from 0. Default 0.01, our choice.
    pub early_per_m: f64,
    /// Angle between the edges of the cone, rad; above 0 and below pi. Default 30 degrees, the main lobe of the transducers of Polaroid
    /// (Elfes 1987).
    pub width_rad: f64,
}

impl Default for Sonar {
    fn default() -> Self {
        Self {
            range_sigma_m: 0.03,
            max_range_m: 5.0,
            hit: 0.75,
            no_echo: 0.15,
            early_per_m: 0.01,
            width_rad: std::f64::consts::PI / 6.0,
        }
    }
}

impl Sonar {
    /// What becomes of a pulse in range.
    fn beam(&self) -> Laser {
        let Self { range_sigma_m, max_range_m, hit, no_echo, early_per_m, .. } = *self;
        Laser { range_sigma_m, max_range_m, hit, no_echo, early_per_m }
    }

    /// Verifies that every number is one that a sonar can have.
    ///
    /// # Errors
    /// The first that is not, with its bound.
    pub fn validate(&self) -> Result<(), LaserError> {
        self.beam().validate()?;
        let (field, value) = ("width_rad", self.width_rad);
        let bound = "an angle in rad, above 0 and below pi";
        let remedy = "give the angle between the edges of the cone, such as 0.52";
        let is_cone = value > 0.0 && value < std::f64::consts::PI;
        if is_cone { Ok(()) } else { Err(LaserError { field, value, bound, remedy }) }
    }

    /// The reading where the nearest surface in the cone is at `range_m` (m), if there is one: a range within `0 ..= max_range_m`, or
    /// `f64::INFINITY` without an echo.
    pub fn sample(&self, range_m: Option<f64>, rng: &mut impl Rng) -> f64 {
        self.beam().sample(range_m, rng)
    }
}

impl Kernel for Sonar {
    fn likelihood(&self, reading: f64, bearing: f64, ranges: &[f64], likelihood: &mut [f64]) {
        self.beam().likelihood(reading, bearing, ranges, likelihood);
    }

    fn width_rad(&self) -> f64 {
        self.width_rad
    }

    fn parameters(&self) -> Option<Parameters> {
        let Parameters { reading, mut noise, .. } = self.beam().parameters()?;
        noise.push(("width_rad", self.width_rad));
        Some(Parameters { kernel: "sonar", reading, noise })
    }
}

impl FastKernel for Sonar {
    fn likelihood_lanes(&self, beams: &Beams, ranges: &[Lanes<f64>], likelihood: &mut [Lanes<f32>]) {
        self.beam().likelihood_lanes(beams, ranges, likelihood);
    }

    fn constant_from(&self, reading: f64, bearing: f64) -> f64 {
        self.beam().constant_from(reading, bearing)
    }

    fn constant_between(&self, reading: f64, bearing: f64) -> [f64; 2] {
        self.beam().constant_between(reading, bearing)
    }

    fn spread_from(&self, reading: f64, bearing: f64, range: f64) -> f64 {
        self.beam().spread_from(reading, bearing, range)
    }
}

/// Of the axis: rules that look at one cell at a time take the cone for a ray.
impl InverseModel for Sonar {
    fn correct_match(&self) -> f64 {
        self.hit
    }

    fn range_sigma(&self, reading: f64, bearing: f64) -> f64 {
        self.range_of(reading, bearing).map_or(0.0, |_| self.range_sigma_m)
    }

    fn half_bin(&self, cell_m: f64) -> f64 {
        self.beam().half_bin(cell_m)
    }

    fn placement(&self, reading: f64, half_width: f64, bearing: f64, enter: f64, exit: f64) -> Placement {
        self.beam().placement(reading, half_width, bearing, enter, exit)
    }

    fn bin_probability(&self, reading: f64, half_width: f64, bearing: f64, enter: f64, exit: f64) -> f64 {
        self.beam().bin_probability(reading, half_width, bearing, enter, exit)
    }

    fn bins(&self, reading: f64, half_width: f64, bearing: f64, ranges: &[f64], bins: &mut [f64]) -> Range<usize> {
        self.beam().bins(reading, half_width, bearing, ranges, bins)
    }

    fn false_match_probability(&self, reading: f64, half_width: f64) -> f64 {
        self.beam().false_match_probability(reading, half_width)
    }

    fn clear_until(&self, reading: f64, half_width: f64, bearing: f64) -> f64 {
        self.beam().clear_until(reading, half_width, bearing)
    }

    fn behind_from(&self, reading: f64, half_width: f64, bearing: f64) -> f64 {
        self.beam().behind_from(reading, half_width, bearing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng as _};

    #[test]
    fn every_number_has_bounds() {
        let usual = Sonar::default();
        assert_eq!(usual.validate(), Ok(()));
        for (sonar, start) in [
            (Sonar { range_sigma_m: 0.0, ..usual }, "range_sigma_m = 0: must be a positive length"),
            (Sonar { no_echo: 0.3, ..usual }, "no_echo = 0.3: must be such that hit and no_echo add up to at most 1"),
            (Sonar { width_rad: 0.0, ..usual }, "width_rad = 0: must be an angle in rad, above 0 and below pi"),
            (Sonar { width_rad: f64::NAN, ..usual }, "width_rad = NaN: must be"),
            (Sonar { width_rad: 3.2, ..usual }, "width_rad = 3.2: must be"),
        ] {
            let message = sonar.validate().expect_err(start).to_string();
            assert!(message.starts_with(start), "{message}");
        }
    }

    /// Chi square over bins of readings, and no echo: above its 99.9 % point once in a thousand seeds.
    #[test]
    fn the_histogram_of_samples_is_the_likelihood() {
        let sonar = Sonar { range_sigma_m: 0.1, max_range_m: 6.0, early_per_m: 0.1, ..Sonar::default() };
        let n = 100_000;
        for range_m in [Some(0.3), Some(2.0), Some(5.9), None] {
            let mut rng = ChaCha8Rng::seed_from_u64(3);
            let mut counts = [0.0; 61];
            for _ in 0..n {
                let reading = sonar.sample(range_m, &mut rng);
                counts[if reading.is_finite() { ((reading * 10.0) as usize).min(59) } else { 60 }] += 1.0;
            }
            let at = range_m.unwrap_or(100.0);
            let density = |reading: f64| {
                let mut likelihood = [0.0];
                sonar.likelihood(reading, 0.0, &[at, at], &mut likelihood);
                likelihood[0]
            };
            let expected = |bin: usize| match bin {
                60 => density(f64::INFINITY),
                _ => (0..20).map(|k| density(0.1 * bin as f64 + 0.005 * (f64::from(k) + 0.5))).sum::<f64>() * 0.005,
            };
            let chi: f64 = counts
                .iter()
                .enumerate()
                .map(|(bin, count)| {
                    let expected = f64::from(n) * expected(bin);
                    (count - expected) * (count - expected) / expected
                })
                .sum();
            assert!(chi < 99.6, "{range_m:?}: {chi} of 60 degrees of freedom");
            assert!(((0..=60).map(expected).sum::<f64>() - 1.0).abs() < 1e-3);
        }
    }
}
