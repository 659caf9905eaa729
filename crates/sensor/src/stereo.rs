//! The stereo camera of the paper: Eq. (21), Figures 6 and 7.

mod bins;

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::gaussian::{self, Gaussian};
use crate::lanes::{Beams, Lanes};
use crate::{FastKernel, InverseModel, Kernel, Parameters, Placement, ReadingKernel, normal};

/// A stereo camera as a sensor model: disparity is Gaussian about `focal_baseline / depth` with
/// probability `correct_match`, otherwise uniform over `0 ..= max_disparity`.
///
/// Depth is range times the cosine of the bearing. A correct match whose noisy disparity would
/// leave `0 ..= max_disparity` is no reading.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Stereo {
    /// Focal length times baseline, px·m. The default, 15, gives the paper's examples: 10 px at the
    /// 30th cell of 5 cm, 3 px at the 100th, 1 px at the 300th.
    pub focal_baseline: f64,
    /// Standard deviation of a correctly matched disparity, px. Default 0.5; the paper's Figure 6
    /// gives no number.
    pub disparity_sigma: f64,
    /// `P(T)`, the probability of a correct match, 0 to 1. Default 0.8 (Section 3.1).
    pub correct_match: f64,
    /// Largest disparity searched, px. Default 60 (Section 3.1).
    pub max_disparity: f64,
}

impl Default for Stereo {
    fn default() -> Self {
        Self { focal_baseline: 15.0, disparity_sigma: 0.5, correct_match: 0.8, max_disparity: 60.0 }
    }
}

impl Stereo {
    /// Noise-free disparity (px) of a point at `range` (m) on the ray at `bearing` (rad); infinite
    /// at range 0 and behind the image plane.
    pub fn disparity(&self, range: f64, bearing: f64) -> f64 {
        let depth = range * libm::cos(bearing);
        if depth > 0.0 { self.focal_baseline / depth } else { f64::INFINITY }
    }

    /// Range (m) at which a point on the ray at `bearing` (rad) has the given `disparity` (px).
    pub fn range(&self, disparity: f64, bearing: f64) -> f64 {
        self.focal_baseline / (disparity * libm::cos(bearing))
    }

    /// Disparity (px) at every range of one ray, infinite at range 0.
    fn at_cosine(&self, range: f64, cosine: f64) -> f64 {
        if range * cosine > 0.0 { self.focal_baseline / (range * cosine) } else { f64::INFINITY }
    }
}

/// Density of correct matches, as a share of that of false ones, that counts as nothing.
const NEGLIGIBLE: f64 = 1e-11;

impl Stereo {
    /// Standard deviations beyond which a correct match counts for nothing: where hardly any match is false, a
    /// reading far from every obstacle still comes from one, and farther tails matter.
    fn reach(&self) -> f64 {
        let correct = self.correct_match / self.disparity_sigma * normal::density(0.0);
        let least = NEGLIGIBLE * (1.0 - self.correct_match) / self.max_disparity;
        let reach = libm::sqrt(2.0 * libm::log(correct / least).max(0.0));
        reach.clamp(normal::REACH, normal::FARTHEST)
    }

    /// Ranges (m) up to which the Gaussian does not reach the reading, whose bearing has this cosine.
    fn front_m(&self, reading: f64, cosine: f64, reach: f64) -> [f64; 2] {
        let most = reading + reach * self.disparity_sigma;
        [0.0, if cosine > 0.0 { (1.0 - 1e-9) * self.focal_baseline / (most * cosine) } else { f64::INFINITY }]
    }

    /// [`FastKernel::spread_from`]: of the density at the disparities from 0 up to that of the range.
    fn spread(&self, reading: f64, cosine: f64, range: f64) -> f64 {
        if cosine <= 0.0 {
            return 0.0;
        }
        let density = |disparity: f64| normal::density((disparity - reading) / self.disparity_sigma);
        let at = self.at_cosine(range, cosine);
        let most = density(at.min(reading));
        self.correct_match / self.disparity_sigma * (most - density(0.0).min(density(at)))
    }

    fn lanes(&self, beams: &Beams) -> Gaussian {
        let cosine = beams.bearing_rad.map(libm::cos);
        Gaussian {
            disparity_range: cosine.map(|c| if c > 0.0 { self.focal_baseline / c } else { f64::INFINITY }),
            reading: beams.reading,
            sharpness: 1.0 / self.disparity_sigma,
            scale: (self.correct_match / self.disparity_sigma) as f32,
            floor: ((1.0 - self.correct_match) / self.max_disparity) as f32,
            reach: self.reach(),
        }
    }
}

impl Kernel for Stereo {
    /// Eq. (21): `P(o | F_k) = P(T) g_k(o) + (1 - P(T)) / D`, in 1/px, where `g_k` is the Gaussian
    /// averaged over the chord, uniformly in disparity. A kernel taken at the centre of a cell
    /// would miss near readings: at 0.5 m a cell of 5 cm spans 3 px, six standard deviations.
    fn likelihood(&self, reading: f64, bearing: f64, ranges: &[f64], likelihood: &mut [f64]) {
        debug_assert_eq!(ranges.len(), likelihood.len() + 1);
        let cosine = libm::cos(bearing);
        let false_match = (1.0 - self.correct_match) / self.max_disparity;
        let scale = self.correct_match / self.disparity_sigma;
        let reach = self.reach();
        let standardised = |range| (self.at_cosine(range, cosine) - reading) / self.disparity_sigma;
        let mut near = standardised(ranges[0]);
        for (l, &exit) in likelihood.iter_mut().zip(&ranges[1..]) {
            let far = standardised(exit);
            // A chord that starts at the sensor spans all disparities: nothing of it is matched.
            let g = if near.is_finite() { normal::mean_density(far, near, reach) } else { 0.0 };
            *l = scale * g + false_match;
            near = far;
        }
    }

    fn parameters(&self) -> Option<Parameters> {
        let Self { focal_baseline, disparity_sigma, correct_match, max_disparity } = *self;
        let noise = vec![
            ("focal_baseline", focal_baseline),
            ("disparity_sigma", disparity_sigma),
            ("correct_match", correct_match),
            ("max_disparity", max_disparity),
        ];
        Some(Parameters { kernel: "stereo", reading: "disparity_px", noise })
    }
}

impl FastKernel for Stereo {
    fn likelihood_lanes(&self, beams: &Beams, ranges: &[Lanes<f64>], likelihood: &mut [Lanes<f32>]) {
        debug_assert_eq!(ranges.len(), likelihood.len() + 1);
        gaussian::chords(&self.lanes(beams), ranges, likelihood);
    }

    fn point_lanes(
        &self,
        beams: &Beams,
        ranges: &[Lanes<f64>],
        likelihood: &mut [Lanes<f32>],
        slope: &mut [Lanes<f32>],
    ) -> bool {
        gaussian::points(&self.lanes(beams), ranges, likelihood, slope);
        true
    }

    /// Where a chord is a quarter of a standard deviation.
    fn smooth_from(&self, bearing: f64, chord_m: f64) -> f64 {
        libm::sqrt(4.0 * chord_m * self.focal_baseline / (libm::cos(bearing).abs() * self.disparity_sigma))
    }

    /// Where the Gaussian of the farthest disparities no longer reaches the reading.
    fn constant_from(&self, reading: f64, bearing: f64) -> f64 {
        let least = reading - self.reach() * self.disparity_sigma;
        let cosine = libm::cos(bearing);
        if least > 0.0 && cosine > 0.0 { self.focal_baseline / (least * cosine) } else { f64::INFINITY }
    }

    fn constant_between(&self, reading: f64, bearing: f64) -> [f64; 2] {
        self.front_m(reading, libm::cos(bearing), self.reach())
    }

    fn spread_from(&self, reading: f64, bearing: f64, range: f64) -> f64 {
        self.spread(reading, libm::cos(bearing), range)
    }

    fn of_readings(&self, beams: &Beams) -> Box<dyn ReadingKernel + '_> {
        Box::new(Readings { stereo: self, cosine: beams.bearing_rad.map(libm::cos), lanes: self.lanes(beams) })
    }
}

/// The readings of several rays.
struct Readings<'a> {
    stereo: &'a Stereo,
    /// Of the bearings.
    cosine: Lanes<f64>,
    lanes: Gaussian,
}

impl ReadingKernel for Readings<'_> {
    fn likelihood(&self, ranges: &[Lanes<f64>], likelihood: &mut [Lanes<f32>]) {
        debug_assert_eq!(ranges.len(), likelihood.len() + 1);
        gaussian::chords(&self.lanes, ranges, likelihood);
    }

    fn constant_between(&self, lane: usize) -> [f64; 2] {
        self.stereo.front_m(self.lanes.reading[lane], self.cosine[lane], self.lanes.reach)
    }

    fn spread_from(&self, lane: usize, range: f64) -> f64 {
        self.stereo.spread(self.lanes.reading[lane], self.cosine[lane], range)
    }
}

impl InverseModel for Stereo {
    fn correct_match(&self) -> f64 {
        self.correct_match
    }

    fn placement(&self, reading: f64, half_width: f64, bearing: f64, enter: f64, exit: f64) -> Placement {
        let cosine = libm::cos(bearing);
        if self.at_cosine(exit, cosine) > reading + half_width {
            Placement::Nearer
        } else if self.at_cosine(enter, cosine) < reading - half_width {
            Placement::Behind
        } else {
            Placement::Within
        }
    }

    fn bin_probability(&self, reading: f64, half_width: f64, bearing: f64, enter: f64, exit: f64) -> f64 {
        let cosine = libm::cos(bearing);
        let [near, far] = [enter, exit].map(|r| self.at_cosine(r, cosine) / self.disparity_sigma);
        if !near.is_finite() {
            return 0.0;
        }
        let [low, high] = [reading - half_width, reading + half_width].map(|o| o / self.disparity_sigma);
        let span = near - far;
        if span < 1e-3 {
            let middle = 0.5 * (near + far);
            return normal::between(low - middle, high - middle);
        }
        // The mean over the chord's disparities d of Phi(high - d) - Phi(low - d).
        let integral = |edge: f64| normal::cumulative_integral(edge - far) - normal::cumulative_integral(edge - near);
        ((integral(high) - integral(low)) / span).clamp(0.0, 1.0)
    }

    /// A chord ends where the next begins, so that there is one pair of integrals per grid line; where the bin is clear there is none.
    fn bins(&self, reading: f64, half_width: f64, bearing: f64, ranges: &[f64], bins: &mut [f64]) -> Range<usize> {
        let cosine = libm::cos(bearing);
        let [low, high] = [reading - half_width, reading + half_width];
        let clear_m = self.clear_until(reading, half_width, bearing);
        let clear = if clear_m > 0.0 { ranges[1..].partition_point(|exit| *exit <= clear_m) } else { 0 };
        bins[..clear].fill(0.0);
        let nearer = clear + ranges[clear + 1..].partition_point(|exit| self.at_cosine(*exit, cosine) > high);
        let end =
            clear + ranges[clear..ranges.len() - 1].partition_point(|enter| self.at_cosine(*enter, cosine) >= low);
        bins::fill(self, cosine, [low, high], &ranges[clear..=end], &mut bins[clear..end]);
        nearer.min(end)..end
    }

    /// Where the Gaussian of the farthest disparity no longer reaches the bin, and a little before.
    fn clear_until(&self, reading: f64, half_width: f64, bearing: f64) -> f64 {
        let least = reading + half_width + 1.001 * normal::REACH * self.disparity_sigma;
        let cosine = libm::cos(bearing);
        if cosine > 0.0 && least > 0.0 { self.focal_baseline / (least * cosine) } else { 0.0 }
    }

    fn behind_from(&self, reading: f64, half_width: f64, bearing: f64) -> f64 {
        let least = reading - half_width;
        let cosine = libm::cos(bearing);
        if cosine > 0.0 && least > 0.0 { (1.0 + 1e-9) * self.focal_baseline / (least * cosine) } else { f64::INFINITY }
    }

    fn false_match_probability(&self, _reading: f64, half_width: f64) -> f64 {
        2.0 * half_width / self.max_disparity
    }

    /// Half a pixel, as the paper has it.
    fn half_bin(&self, _cell_m: f64) -> f64 {
        0.5
    }

    fn range_of(&self, reading: f64, bearing: f64) -> Option<f64> {
        Some(self.range(reading, bearing)).filter(|range| *range >= 0.0 && range.is_finite())
    }

    /// `r = f B / (d cos b)`, so that `dr = r dd / d`.
    fn range_sigma(&self, reading: f64, bearing: f64) -> f64 {
        self.range_of(reading, bearing).map_or(0.0, |range_m| range_m * self.disparity_sigma / reading)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const STEREO: Stereo =
        Stereo { focal_baseline: 15.0, disparity_sigma: 0.5, correct_match: 0.8, max_disparity: 60.0 };

    fn likelihood(reading: f64, bearing: f64, enter: f64, exit: f64) -> f64 {
        let mut out = [0.0];
        STEREO.likelihood(reading, bearing, &[enter, exit], &mut out);
        out[0]
    }

    /// The chord's average by brute force: many points, uniform in disparity.
    fn averaged(bearing: f64, enter: f64, exit: f64, f: impl Fn(f64) -> f64) -> f64 {
        let [near, far] = [enter, exit].map(|r| STEREO.disparity(r, bearing));
        let n = 20_000;
        (0..n).map(|i| f(far + (near - far) * (f64::from(i) + 0.5) / f64::from(n))).sum::<f64>() / f64::from(n)
    }

    #[test]
    fn the_papers_disparities() {
        for (cell, disparity) in [(30.0, 10.0), (100.0, 3.0), (300.0, 1.0)] {
            assert!((STEREO.disparity(cell * 0.05, 0.0) - disparity).abs() < 1e-12);
        }
        // Depth, not range: seen from the side the same range is a larger disparity.
        assert!((STEREO.disparity(2.0, std::f64::consts::FRAC_PI_3) - 15.0).abs() < 1e-12);
        assert!((STEREO.range(15.0, std::f64::consts::FRAC_PI_3) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn limits() {
        let floor = 0.2 / 60.0;
        assert!((likelihood(10.0, 0.0, 9.0, 9.05) - floor).abs() < 1e-15, "far from the reading only false matches");
        assert!((likelihood(10.0, 0.0, 0.0, 0.05) - floor).abs() < 1e-15, "the cell of the sensor matches nothing");
        assert!((likelihood(10.0, 0.0, 0.0, 0.0) - floor).abs() < 1e-15, "nor does a chord without length there");
        assert!((likelihood(10.0, 3.0, 1.5, 1.55) - floor).abs() < 1e-15, "nor a ray behind the image plane");
        let peak = 0.8 / (0.5 * (2.0 * std::f64::consts::PI).sqrt()) + floor;
        assert!((likelihood(10.0, 0.0, 1.5, 1.5) - peak).abs() < 1e-12);
    }

    /// As far as the cameras of all scenes reach; their likelihoods do not depend on what comes farther out.
    #[test]
    fn without_false_matches_the_tails_count() {
        assert!((STEREO.reach() - normal::REACH).abs() < 1e-15);
        for (correct_match, sigmas) in [(1.0, 12.0_f64), (1.0, 30.0), (1.0 - 1e-12, 9.5)] {
            let sure = Stereo { correct_match, ..STEREO };
            // A point, and a chord seen from its near end: phi(z) and the tail beyond z, from the asymptotic series.
            let at = |z: f64| 15.0 / (10.0 + 0.5 * z);
            let density = (-0.5 * sigmas * sigmas).exp() / (2.0 * std::f64::consts::PI).sqrt();
            let false_match = (1.0 - correct_match) / 60.0;
            let mut found = [0.0; 2];
            sure.likelihood(10.0, 0.0, &[at(sigmas), at(sigmas), at(sigmas)], &mut found);
            assert!(
                (found[0] / (correct_match * density / 0.5 + false_match) - 1.0).abs() < 1e-9,
                "{sigmas}: {found:?}"
            );
            let width = 6.0;
            sure.likelihood(10.0, 0.0, &[at(sigmas + width), at(sigmas)], &mut found[..1]);
            let z2 = sigmas * sigmas;
            let tail = density / sigmas * (1.0 - 1.0 / z2 + 3.0 / (z2 * z2) - 15.0 / (z2 * z2 * z2));
            let expected = correct_match * tail / width / 0.5 + false_match;
            assert!((found[0] / expected - 1.0).abs() < 1e-4, "{sigmas}: {found:?} {expected}");
        }
        let impossible = Stereo { correct_match: 1.0, ..STEREO };
        assert!(impossible.constant_from(10.0, 0.0).is_infinite(), "10 px are 20 sigma from infinity");
        assert!(impossible.constant_from(20.0, 0.0).is_finite(), "20 px are 40");
    }

    #[test]
    fn a_reading_is_a_point_unless_it_is_at_infinity() {
        assert!((STEREO.range_of(10.0, 0.0).expect("finite") - 1.5).abs() < 1e-12);
        assert_eq!(STEREO.range_of(0.0, 0.0), None, "no parallax");
        assert_eq!(STEREO.range_of(10.0, 3.0), None, "behind the image plane");
    }

    #[test]
    fn ends_in_the_middle_of_a_wide_chord() {
        // At half a metre a cell spans six sigma: the reading is inside although its centre is far.
        assert!(likelihood(28.0, 0.0, 0.5, 0.55) > 0.25 * 0.8);
    }

    proptest! {
        #[test]
        fn equals_the_average_over_the_chord(
            reading in 0.0f64..60.0, bearing in -1.0f64..1.0, enter in 0.3f64..15.0, chord in 0.0f64..0.1,
        ) {
            let gaussian = |d: f64| (-0.5 * ((reading - d) / 0.5).powi(2)).exp() / (0.5 * (2.0 * std::f64::consts::PI).sqrt());
            let expected = 0.8 * averaged(bearing, enter, enter + chord, gaussian) + 0.2 / 60.0;
            prop_assert!((likelihood(reading, bearing, enter, enter + chord) - expected).abs() < 2e-6);
        }

        #[test]
        fn integrates_to_one_over_the_readings(range in 0.4f64..6.0, chord in 0.001f64..0.1, bearing in -0.8f64..0.8) {
            // Well inside 0 ..= 60 px no correct match is lost.
            let d = STEREO.disparity(range, bearing);
            prop_assume!(STEREO.disparity(range + chord, bearing) > 4.5 && d < 55.0);
            let n = 60_000;
            let sum: f64 = (0..n).map(|i| likelihood((f64::from(i) + 0.5) * 1e-3, bearing, range, range + chord)).sum();
            prop_assert!((sum * 1e-3 - 1.0).abs() < 1e-6, "{}", sum * 1e-3);
        }

        /// From there on it is that of false matches alone, to the bit, and just before it is not yet.
        #[test]
        fn settles_where_it_says(reading in 0.0f64..60.0, bearing in -1.0f64..1.0, further in 0.0f64..100.0) {
            let from = STEREO.constant_from(reading, bearing);
            let floor = (1.0 - STEREO.correct_match) / STEREO.max_disparity;
            if from.is_finite() {
                let there = from * (1.0 + 1e-9) + further;
                prop_assert_eq!(likelihood(reading, bearing, there, there + 0.05).to_bits(), floor.to_bits());
                let before = STEREO.range(reading - 8.0 * STEREO.disparity_sigma, bearing);
                prop_assert!(before < from && likelihood(reading, bearing, before, before) > floor);
            } else {
                prop_assert!(reading <= 8.5 * STEREO.disparity_sigma);
            }
        }

        #[test]
        fn is_the_same_where_it_says(reading in 0.0f64..60.0, bearing in -1.6f64..1.6, ends in prop::array::uniform2(0.0f64..1.0)) {
            let [from, until] = STEREO.constant_between(reading, bearing);
            let floor = (1.0 - STEREO.correct_match) / STEREO.max_disparity;
            let [enter, exit] = ends.map(|share| from + share * (until.min(1e6) - from));
            prop_assert_eq!(likelihood(reading, bearing, enter.min(exit), enter.max(exit)).to_bits(), floor.to_bits());
        }

        #[test]
        fn likelihoods_beyond_differ_by_no_more_than_the_spread(
            reading in 0.0f64..60.0, bearing in -1.7f64..1.7, from in 0.05f64..30.0, further in prop::array::uniform2(0.0f64..200.0),
        ) {
            let spread = STEREO.spread_from(reading, bearing, from);
            let [a, b] = further.map(|further| likelihood(reading, bearing, from + further, from + further + 0.05));
            prop_assert!((a - b).abs() <= spread + 1e-9, "{a} {b} {spread}");
            prop_assert!(spread <= STEREO.spread_from(reading, bearing, 0.9 * from));
            let far = STEREO.spread_from(reading, bearing, 1e9);
            prop_assert!((0.0..1e-6).contains(&far), "{far}");
        }

        #[test]
        fn the_bin_is_the_integral_of_the_density(
            reading in 0.0f64..40.0, half_width in 0.01f64..2.0, enter in 0.4f64..8.0, chord in 0.0f64..0.1,
        ) {
            let n = 2_000;
            let step = 2.0 * half_width / f64::from(n);
            let density = |o: f64| (likelihood(o, 0.0, enter, enter + chord) - 0.2 / 60.0) / 0.8;
            let sum: f64 = (0..n).map(|i| density(reading - half_width + (f64::from(i) + 0.5) * step)).sum();
            let bin = STEREO.bin_probability(reading, half_width, 0.0, enter, enter + chord);
            prop_assert!((sum * step - bin).abs() < 1e-5, "{} {bin}", sum * step);
        }

        #[test]
        fn what_is_clear_or_behind_needs_no_asking(
            reading in 0.0f64..60.0, w in 0.01f64..2.0, bearing in -1.2f64..1.2, share in 0.0f64..1.0, part in 0.0f64..1.0,
        ) {
            // Almost as far as the Gaussian of the farthest disparity reaches the bin, and not farther.
            let clear_m = STEREO.clear_until(reading, w, bearing);
            let sigmas = |n: f64| STEREO.range(reading + w + n * STEREO.disparity_sigma, bearing);
            prop_assert!(sigmas(8.6) < clear_m && clear_m < sigmas(8.5), "{clear_m}");
            let enter = share * clear_m;
            let exit = enter + part * (clear_m - enter);
            prop_assert_eq!(STEREO.placement(reading, w, bearing, enter, exit), Placement::Nearer);
            prop_assert_eq!(STEREO.bin_probability(reading, w, bearing, enter, exit).to_bits(), 0.0f64.to_bits());
            let behind_m = STEREO.behind_from(reading, w, bearing);
            prop_assert_eq!(behind_m.is_finite(), reading > w);
            if behind_m.is_finite() {
                let from = behind_m * (1.0 + 1e-12) + share;
                prop_assert_eq!(STEREO.placement(reading, w, bearing, from, from + part), Placement::Behind);
                let before = behind_m * (1.0 - 1e-8);
                prop_assert_eq!(STEREO.placement(reading, w, bearing, before, before), Placement::Within);
            }
        }

        #[test]
        fn placement_follows_the_interval(reading in 0.0f64..20.0, w in 0.0f64..2.0, enter in 0.0f64..20.0, chord in 0.0f64..0.1) {
            let near = STEREO.disparity(enter, 0.0);
            let far = STEREO.disparity(enter + chord, 0.0);
            let expected = if far > reading + w { Placement::Nearer } else if near < reading - w { Placement::Behind } else { Placement::Within };
            prop_assert_eq!(STEREO.placement(reading, w, 0.0, enter, enter + chord), expected);
        }
    }
}
