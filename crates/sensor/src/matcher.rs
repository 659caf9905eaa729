//! Sampling the disparities that a stereo camera would measure.

use rand::{Rng, RngExt as _};
use rand_distr::StandardNormal;
use serde::{Deserialize, Serialize};

use crate::{Mismatches, Stereo};

/// What a viewing ray of a simulated scan ends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Distance along the ray, m.
    pub range_m: f64,
    /// Factor on the detection rate, 0 to 1.
    pub texture: f64,
}

/// The random numbers of a column.
pub(crate) struct Draws<R> {
    /// What the two images hold: edges and mismatches.
    pub(crate) image: R,
    /// The noise of correct matches, where it is another's than the image's.
    pub(crate) noise: Option<R>,
}

impl<R: Rng> Draws<R> {
    /// A standard normal number.
    pub(crate) fn normal(&mut self) -> f64 {
        self.noise.as_mut().unwrap_or(&mut self.image).sample(StandardNormal)
    }
}

/// A simulated stereo matcher: [`Stereo`] turned round, from a true range to a reading.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Matcher {
    /// The camera's model.
    pub stereo: Stereo,
    /// Probability, 0 to 1, that an image column holds an edge to match, on a surface with texture
    /// 1. Edge-based stereo gives no reading where there is no edge.
    pub detection_rate: f64,
    /// Disparities are rounded to multiples of this many px: 1 for whole-pixel matching, a fraction
    /// for sub-pixel interpolation, 0 for none.
    pub quantisation: f64,
    /// How mismatches are distributed over the image. The paper's, independent, is not written to
    /// files, so that what was recorded before there was another reads the same.
    #[serde(default, skip_serializing_if = "Mismatches::are_independent")]
    pub mismatches: Mismatches,
}

impl Default for Matcher {
    /// The paper's camera, an edge in 60 % of the columns, no quantisation.
    fn default() -> Self {
        let mismatches = Mismatches::Independent;
        Self { stereo: Stereo::default(), detection_rate: 0.6, quantisation: 0.0, mismatches }
    }
}

impl Matcher {
    /// The disparities (px) of one scan: one per bearing (rad), from what each ray ends on, if on
    /// anything.
    ///
    /// `stream(column)` gives the random numbers of a column. With independent mismatches a column
    /// draws from its own numbers alone, as [`sample`](Self::sample) does; with clustered ones
    /// whether it is a mismatch follows from the columns before it too.
    ///
    /// # Panics
    /// Unless there are as many surfaces as bearings.
    pub fn scan<R: Rng>(
        &self,
        bearings_rad: &[f64],
        surfaces: &[Option<Surface>],
        stream: impl FnMut(usize) -> R,
    ) -> Vec<Option<f64>> {
        self.scan_again(bearings_rad, surfaces, stream, |_| None)
    }

    /// As [`scan`](Self::scan), of a scene that was seen before: `noise(column)`, where there is any, gives the Gaussian
    /// part of the column's reading, and `stream(column)` all else: whether there is an edge to match, whether the match fails,
    /// and of what. With the `stream` of an earlier scan of the same surfaces from the same place its mismatches repeat, as
    /// they do on real pairs, while the noise is fresh.
    ///
    /// # Panics
    /// Unless there are as many surfaces as bearings.
    pub fn scan_again<R: Rng>(
        &self,
        bearings_rad: &[f64],
        surfaces: &[Option<Surface>],
        mut stream: impl FnMut(usize) -> R,
        mut noise: impl FnMut(usize) -> Option<R>,
    ) -> Vec<Option<f64>> {
        assert_eq!(bearings_rad.len(), surfaces.len(), "one surface, or none, per bearing");
        let draws = |column| Draws { image: stream(column), noise: noise(column) };
        match &self.mismatches {
            Mismatches::Clustered(clustering) => clustering.scan(self, bearings_rad, surfaces, draws),
            Mismatches::Independent => {
                let mut draws = draws;
                let columns = bearings_rad.iter().zip(surfaces).enumerate();
                let read = |(column, (&bearing, surface)): (usize, (&f64, &Option<Surface>))| {
                    surface.and_then(|s| self.drawn(s.range_m, bearing, s.texture, &mut draws(column)))
                };
                columns.map(read).collect()
            }
        }
    }

    /// The disparity (px) read on a ray at `bearing` (rad) whose first surface is at `range` (m)
    /// and has the given `texture` (0 to 1), or none. Mismatches are the paper's, independent ones:
    /// others need the whole scan, see [`scan`](Self::scan).
    ///
    /// There is no reading where the column has no edge, and where a correct match would leave
    /// `0 ..= max_disparity`.
    pub fn sample(&self, range: f64, bearing: f64, texture: f64, rng: &mut impl Rng) -> Option<f64> {
        self.drawn(range, bearing, texture, &mut Draws { image: rng, noise: None })
    }

    fn drawn<R: Rng>(&self, range: f64, bearing: f64, texture: f64, draws: &mut Draws<R>) -> Option<f64> {
        let Stereo { disparity_sigma, correct_match, max_disparity, .. } = self.stereo;
        if draws.image.random::<f64>() >= self.detection_rate * texture {
            return None;
        }
        let disparity = if draws.image.random::<f64>() < correct_match {
            self.stereo.disparity(range, bearing) + disparity_sigma * draws.normal()
        } else {
            max_disparity * draws.image.random::<f64>()
        };
        self.reading(disparity)
    }

    /// The reading of a disparity (px): rounded, and none outside the search range.
    pub(crate) fn reading(&self, disparity: f64) -> Option<f64> {
        self.quantised(disparity).filter(|d| (0.0..=self.stereo.max_disparity).contains(d))
    }

    /// The noise-free disparity (px) of a surface at `range` (m), if it is within the search range.
    pub fn noise_free(&self, range: f64, bearing: f64) -> Option<f64> {
        Some(self.stereo.disparity(range, bearing)).filter(|&d| d <= self.stereo.max_disparity)
    }

    fn quantised(&self, disparity: f64) -> Option<f64> {
        let step = self.quantisation;
        let rounded = if step > 0.0 { libm::rint(disparity / step) * step } else { disparity };
        rounded.is_finite().then_some(rounded)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng as _};

    fn samples(matcher: Matcher, range: f64, texture: f64, n: usize) -> Vec<Option<f64>> {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        (0..n).map(|_| matcher.sample(range, 0.0, texture, &mut rng)).collect()
    }

    const MATCHER: Matcher = Matcher {
        stereo: Stereo { focal_baseline: 15.0, disparity_sigma: 0.5, correct_match: 0.8, max_disparity: 60.0 },
        detection_rate: 1.0,
        quantisation: 0.0,
        mismatches: Mismatches::Independent,
    };

    #[test]
    fn a_scan_of_independent_mismatches_is_its_columns_one_by_one() {
        let stream = |column: usize| {
            let mut rng = ChaCha8Rng::seed_from_u64(3);
            rng.set_word_pos(64 * column as u128);
            rng
        };
        let bearings: Vec<f64> = (0..200).map(|k| 0.005 * f64::from(k - 100)).collect();
        let surface =
            |k: usize| (!k.is_multiple_of(7)).then_some(Surface { range_m: 1.0 + 0.02 * k as f64, texture: 0.8 });
        let surfaces: Vec<_> = (0..200).map(surface).collect();
        let readings = MATCHER.scan(&bearings, &surfaces, stream);
        for (k, reading) in readings.iter().enumerate() {
            let expected = surfaces[k].and_then(|s| MATCHER.sample(s.range_m, bearings[k], 0.8, &mut stream(k)));
            assert_eq!(*reading, expected, "column {k}");
        }
        assert!(readings.iter().flatten().count() > 100);
    }

    #[test]
    fn a_scene_seen_again_repeats_its_mismatches_with_fresh_noise() {
        let stream = |seed: u64, column: usize| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_word_pos(64 * column as u128);
            rng
        };
        let bearings: Vec<f64> = (0..400).map(|k| 0.002 * f64::from(k - 200)).collect();
        let surfaces = vec![Some(Surface { range_m: 1.5, texture: 0.9 }); 400];
        let clustered = Mismatches::Clustered(crate::Clustering { copies: 0.0, ..Default::default() });
        for mismatches in [Mismatches::Independent, clustered] {
            let matcher = Matcher { mismatches, ..MATCHER };
            let first = matcher.scan(&bearings, &surfaces, |column| stream(1, column));
            let again = matcher.scan_again(&bearings, &surfaces, |c| stream(1, c), |c| Some(stream(2, c)));
            let (mut repeated, mut fresh) = (0, Vec::new());
            for (k, (a, b)) in first.iter().zip(&again).enumerate() {
                assert_eq!(a.is_some(), b.is_some(), "column {k} has its edge as before");
                let (Some(a), Some(b)) = (a, b) else { continue };
                if a.to_bits() == b.to_bits() { repeated += 1 } else { fresh.push(b - a) }
            }
            let deviation = (fresh.iter().map(|d| d * d).sum::<f64>() / fresh.len() as f64).sqrt();
            let expected = 0.5 * std::f64::consts::SQRT_2;
            assert!((40..120).contains(&repeated), "a fifth of 360 fails: {repeated}");
            assert!((deviation - expected).abs() < 0.1, "{deviation} {expected}");
        }
    }

    #[test]
    fn the_histogram_of_samples_is_the_likelihood() {
        use crate::InverseModel as _;
        let n = 200_000;
        let readings = samples(MATCHER, 1.5, 1.0, n);
        let near: Vec<f64> = readings.iter().flatten().copied().filter(|d| (d - 10.0).abs() < 2.5).collect();
        let mut chi_square = 0.0;
        for bin in 0..20 {
            let low = 8.0 + 0.2 * f64::from(bin);
            let count = near.iter().filter(|d| (low..low + 0.2).contains(*d)).count() as f64;
            let expected = n as f64
                * (0.8 * MATCHER.stereo.bin_probability(low + 0.1, 0.1, 0.0, 1.5, 1.5)
                    + 0.2 * MATCHER.stereo.false_match_probability(low + 0.1, 0.1));
            chi_square += (count - expected).powi(2) / expected;
        }
        assert!(chi_square < 45.3, "chi square {chi_square} of 20 bins is above its 99.9 % point");
        let false_matches = readings.iter().flatten().filter(|d| (**d - 10.0).abs() > 5.0).count() as f64;
        let expected = n as f64 * 0.2 * 50.0 / 60.0;
        assert!((false_matches - expected).abs() < 5.0 * expected.sqrt(), "{false_matches} {expected}");
    }

    #[test]
    fn detection_rate_and_texture_thin_the_readings() {
        let matcher = Matcher { detection_rate: 0.5, ..MATCHER };
        let share = samples(matcher, 1.5, 0.6, 100_000).iter().flatten().count() as f64 / 1e5;
        assert!((share - 0.3).abs() < 0.008, "{share}");
        assert_eq!(samples(matcher, 1.5, 0.0, 1000).iter().flatten().count(), 0);
    }

    #[test]
    fn a_correct_match_outside_the_search_range_is_no_reading() {
        let sure = Matcher { stereo: Stereo { correct_match: 1.0, ..MATCHER.stereo }, ..MATCHER };
        assert_eq!(samples(sure, 0.2, 1.0, 1000).iter().flatten().count(), 0, "75 px");
        let far = samples(sure, 150.0, 1.0, 20_000);
        let share = far.iter().flatten().count() as f64 / 2e4;
        assert!((share - 0.579).abs() < 0.02, "at 0.1 px, Phi(0.2) of the matches stay above 0: {share}");
        assert!(far.iter().flatten().all(|d| (0.0..=60.0).contains(d)));
        assert_eq!(samples(sure, 0.0, 1.0, 10), vec![None; 10], "touching the lens");
    }

    #[test]
    fn quantised_to_whole_and_fractional_pixels() {
        for step in [1.0, 0.25] {
            let matcher = Matcher { quantisation: step, ..MATCHER };
            for d in samples(matcher, 1.5, 1.0, 1000).into_iter().flatten() {
                assert!((d / step - (d / step).round()).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn noise_free_readings_end_at_the_search_range() {
        assert_eq!(MATCHER.noise_free(1.5, 0.0), Some(10.0));
        assert_eq!(MATCHER.noise_free(0.1, 0.0), None);
    }
}
