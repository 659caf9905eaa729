//! A stereo camera that looks all round.

use std::ops::Range;

use crate::lanes::{Beams, LANES, Lanes};
use crate::{FastKernel, InverseModel, Kernel, Parameters, Placement, ReadingKernel, Stereo};

/// An omnidirectional stereo camera as a sensor model: two images all round, one above the other, as Miura et al. (IROS 2002) mount
/// them.
///
/// There is no image plane that depth could be measured from: the disparity of a point is `focal_baseline` over its *range*, at
/// whatever bearing. All else is as [`Stereo`] has it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Omnidirectional(pub Stereo);

/// The bearing at which depth is range.
const AHEAD: f64 = 0.0;

fn ahead(beams: &Beams) -> Beams {
    Beams { bearing_rad: [AHEAD; LANES], ..*beams }
}

impl Kernel for Omnidirectional {
    fn likelihood(&self, reading: f64, _bearing: f64, ranges: &[f64], likelihood: &mut [f64]) {
        self.0.likelihood(reading, AHEAD, ranges, likelihood);
    }

    fn parameters(&self) -> Option<Parameters> {
        self.0.parameters().map(|parameters| Parameters { kernel: "omnidirectional", ..parameters })
    }
}

impl FastKernel for Omnidirectional {
    fn likelihood_lanes(&self, beams: &Beams, ranges: &[Lanes<f64>], likelihood: &mut [Lanes<f32>]) {
        self.0.likelihood_lanes(&ahead(beams), ranges, likelihood);
    }

    fn point_lanes(
        &self,
        beams: &Beams,
        ranges: &[Lanes<f64>],
        likelihood: &mut [Lanes<f32>],
        slope: &mut [Lanes<f32>],
    ) -> bool {
        self.0.point_lanes(&ahead(beams), ranges, likelihood, slope)
    }

    fn smooth_from(&self, _bearing: f64, chord_m: f64) -> f64 {
        self.0.smooth_from(AHEAD, chord_m)
    }

    fn constant_from(&self, reading: f64, _bearing: f64) -> f64 {
        self.0.constant_from(reading, AHEAD)
    }

    fn constant_between(&self, reading: f64, _bearing: f64) -> [f64; 2] {
        self.0.constant_between(reading, AHEAD)
    }

    fn spread_from(&self, reading: f64, _bearing: f64, range: f64) -> f64 {
        self.0.spread_from(reading, AHEAD, range)
    }

    fn of_readings(&self, beams: &Beams) -> Box<dyn ReadingKernel + '_> {
        self.0.of_readings(&ahead(beams))
    }
}

impl InverseModel for Omnidirectional {
    fn correct_match(&self) -> f64 {
        self.0.correct_match
    }

    fn range_of(&self, reading: f64, _bearing: f64) -> Option<f64> {
        self.0.range_of(reading, AHEAD)
    }

    fn half_bin(&self, cell_m: f64) -> f64 {
        self.0.half_bin(cell_m)
    }

    fn placement(&self, reading: f64, half_width: f64, _bearing: f64, enter: f64, exit: f64) -> Placement {
        self.0.placement(reading, half_width, AHEAD, enter, exit)
    }

    fn bin_probability(&self, reading: f64, half_width: f64, _bearing: f64, enter: f64, exit: f64) -> f64 {
        self.0.bin_probability(reading, half_width, AHEAD, enter, exit)
    }

    fn bins(&self, reading: f64, half_width: f64, _bearing: f64, ranges: &[f64], bins: &mut [f64]) -> Range<usize> {
        self.0.bins(reading, half_width, AHEAD, ranges, bins)
    }

    fn false_match_probability(&self, reading: f64, half_width: f64) -> f64 {
        self.0.false_match_probability(reading, half_width)
    }

    fn clear_until(&self, reading: f64, half_width: f64, _bearing: f64) -> f64 {
        self.0.clear_until(reading, half_width, AHEAD)
    }

    fn behind_from(&self, reading: f64, half_width: f64, _bearing: f64) -> f64 {
        self.0.behind_from(reading, half_width, AHEAD)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Matcher, Mismatches, Surface};
    use proptest::prelude::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng as _};

    proptest! {
        /// Behind the robot as well as ahead of it.
        #[test]
        fn depth_is_range_at_every_bearing(reading in 0.5f64..50.0, bearing in -4.0f64..4.0, at in 0.3f64..10.0) {
            let all_round = Omnidirectional(Stereo::default());
            let chord = [at, at + 0.05];
            let [mut found, mut ahead] = [[0.0]; 2];
            all_round.likelihood(reading, bearing, &chord, &mut found);
            Stereo::default().likelihood(reading, 0.0, &chord, &mut ahead);
            prop_assert_eq!(found[0].to_bits(), ahead[0].to_bits());
            prop_assert_eq!(all_round.range_of(reading, bearing), Some(15.0 / reading));
            let mut lanes = [[0.0f32; LANES]];
            let beams = Beams { reading: [reading; LANES], bearing_rad: [bearing; LANES] };
            all_round.likelihood_lanes(&beams, &chord.map(|range| [range; LANES]), &mut lanes);
            prop_assert!((f64::from(lanes[0][3]) / found[0] - 1.0).abs() < 5e-6);
        }
    }

    /// Chi square over bins of disparities, of a surface behind the camera: above its 99.9 % point once in a thousand seeds.
    #[test]
    fn the_histogram_of_samples_is_the_likelihood() {
        let matcher = Matcher { detection_rate: 1.0, mismatches: Mismatches::Independent, ..Matcher::default() };
        let (n, bins, range_m) = (100_000usize, 60, 1.5);
        let surfaces = vec![Some(Surface { range_m, texture: 1.0 }); n];
        let stream = |column: usize| {
            let mut rng = ChaCha8Rng::seed_from_u64(5);
            rng.set_word_pos(64 * column as u128);
            rng
        };
        let readings = matcher.scan(&vec![AHEAD; n], &surfaces, stream);
        let density = |reading: f64| {
            let mut out = [0.0];
            Omnidirectional(matcher.stereo).likelihood(reading, 2.5, &[range_m, range_m], &mut out);
            out[0]
        };
        let mut counts = vec![0.0; bins];
        readings.iter().flatten().for_each(|reading| counts[(*reading as usize).min(bins - 1)] += 1.0);
        let expected = |bin: usize| {
            n as f64 * (0..100).map(|k| density(bin as f64 + 0.01 * (f64::from(k) + 0.5))).sum::<f64>() * 0.01
        };
        let chi: f64 = counts.iter().enumerate().map(|(bin, c)| (c - expected(bin)).powi(2) / expected(bin)).sum();
        assert!(chi < 99.6, "{chi} of 59 degrees of freedom");
        assert!(((0..bins).map(expected).sum::<f64>() / n as f64 - 1.0).abs() < 1e-3);
    }
}
