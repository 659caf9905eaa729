//! What rules that look at one cell at a time ask of a sensor.

use std::ops::Range;

use crate::Kernel;

/// Where a chord lies with respect to a reading, for rules that look at one cell at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Placement {
    /// Nearer than the reading: the ray passed through.
    Nearer,
    /// Where the reading lies.
    Within,
    /// Behind the reading: nothing was seen of it.
    Behind,
}

/// The inverse sensor model of the conventional rules, Eqs. (22)-(26): a reading is a bin, and every cell is judged by itself.
///
/// The defaults are those of a sensor that measures ranges in m, all of them of the first occupied cell.
pub trait InverseModel: Kernel {
    /// `P(T)`: the probability that a reading comes from the first occupied cell at all.
    fn correct_match(&self) -> f64 {
        1.0
    }

    /// Range (m) along the ray at which a point gives this reading without noise, for rules that take a
    /// reading for a point; none where no finite range does (disparity 0, a ray behind the image plane, no echo).
    fn range_of(&self, reading: f64, _bearing: f64) -> Option<f64> {
        Some(reading).filter(|range| *range >= 0.0 && range.is_finite())
    }

    /// Standard deviation (m) of [`range_of`](Self::range_of) along the ray, by the noise of a reading that is no outlier, to first order; 0
    /// where it is not known, or the reading has no range.
    fn range_sigma(&self, _reading: f64, _bearing: f64) -> f64 {
        0.0
    }

    /// Half the bin, in the unit of the reading, that stands for one reading, for cells of side `cell_m` (m); above 0.
    fn half_bin(&self, cell_m: f64) -> f64 {
        0.5 * cell_m
    }

    /// Where the chord `enter ..= exit` lies with respect to `reading` +- `half_width`. Along a ray, chords are nearer, then within, then
    /// behind. Behind a reading without a range, if
    /// the sensor does not know better.
    fn placement(&self, reading: f64, half_width: f64, _bearing: f64, enter: f64, exit: f64) -> Placement {
        if reading.is_finite() && exit < reading - half_width {
            Placement::Nearer
        } else if reading.is_infinite() || enter > reading + half_width {
            Placement::Behind
        } else {
            Placement::Within
        }
    }

    /// Probability that a reading of an obstacle in the chord `enter ..= exit` falls into the bin
    /// `reading` +- `half_width`, if it is a correct match: `P(o | F_k, T)` as a probability. By default the integral of
    /// the kernel over the bin, by Simpson's rule over 128 parts.
    fn bin_probability(&self, reading: f64, half_width: f64, bearing: f64, enter: f64, exit: f64) -> f64 {
        const PARTS: u32 = 128;
        let density = |reading: f64| {
            let mut likelihood = [0.0];
            self.likelihood(reading, bearing, &[enter, exit], &mut likelihood);
            likelihood[0]
        };
        let all = if reading.is_infinite() {
            density(reading)
        } else {
            let at = |k: u32| density(reading + half_width * (2.0 * f64::from(k) / f64::from(PARTS) - 1.0));
            let inner = (1..PARTS).map(|k| at(k) * if k % 2 == 1 { 4.0 } else { 2.0 });
            (at(0) + inner.sum::<f64>() + at(PARTS)) * 2.0 * half_width / f64::from(3 * PARTS)
        };
        let false_matches = (1.0 - self.correct_match()) * self.false_match_probability(reading, half_width);
        if self.correct_match() > 0.0 { ((all - false_matches) / self.correct_match()).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// [`bin_probability`](Self::bin_probability) of every chord `ranges[k] ..= ranges[k + 1]` of a ray that does not lie behind the reading,
    /// to the bit, into `bins`; and which chords lie [`Within`](Placement::Within): those before them are nearer, those after them behind. For
    /// sensors that can share work between the chords of a ray.
    ///
    /// `ranges` never decreases and is one longer than `bins`; what is in `bins` of chords behind the reading means nothing.
    fn bins(&self, reading: f64, half_width: f64, bearing: f64, ranges: &[f64], bins: &mut [f64]) -> Range<usize> {
        let mut nearer = 0;
        for (k, (bin, chord)) in bins.iter_mut().zip(ranges.windows(2)).enumerate() {
            match self.placement(reading, half_width, bearing, chord[0], chord[1]) {
                Placement::Nearer => nearer = k + 1,
                Placement::Within => {}
                Placement::Behind => return nearer..k,
            }
            *bin = self.bin_probability(reading, half_width, bearing, chord[0], chord[1]);
        }
        nearer..bins.len()
    }

    /// Probability that a false match falls into the bin `reading` +- `half_width`:
    /// `P(o | F_k, not T)` as a probability. Times `1 - P(T)` it is, for a bin of width 1, the least that the
    /// likelihood of the reading can be.
    fn false_match_probability(&self, _reading: f64, _half_width: f64) -> f64 {
        0.0
    }

    /// Range (m) up to which a chord is [`Nearer`](Placement::Nearer) than `reading` +- `half_width` and its
    /// [`bin_probability`](Self::bin_probability) is 0, so that no chord need be asked about; 0 where it is not known.
    fn clear_until(&self, _reading: f64, _half_width: f64, _bearing: f64) -> f64 {
        0.0
    }

    /// Range (m) such that every chord that begins beyond it is [`Behind`](Placement::Behind) `reading` +-
    /// `half_width`; infinite where it is not known.
    fn behind_from(&self, _reading: f64, _half_width: f64, _bearing: f64) -> f64 {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Laser, Stereo};
    use proptest::prelude::*;

    /// A sensor by its kernel alone.
    struct Bare<S>(S);

    impl<S: Kernel> Kernel for Bare<S> {
        fn likelihood(&self, reading: f64, bearing: f64, ranges: &[f64], likelihood: &mut [f64]) {
            self.0.likelihood(reading, bearing, ranges, likelihood);
        }
    }

    impl<S: Kernel> InverseModel for Bare<S> {}

    /// A sensor that says of every chord what another does, one by one.
    struct OneByOne<S>(S);

    impl<S: Kernel> Kernel for OneByOne<S> {
        fn likelihood(&self, reading: f64, bearing: f64, ranges: &[f64], likelihood: &mut [f64]) {
            self.0.likelihood(reading, bearing, ranges, likelihood);
        }
    }

    impl<S: InverseModel> InverseModel for OneByOne<S> {
        fn placement(&self, reading: f64, half_width: f64, bearing: f64, enter: f64, exit: f64) -> Placement {
            self.0.placement(reading, half_width, bearing, enter, exit)
        }

        fn bin_probability(&self, reading: f64, half_width: f64, bearing: f64, enter: f64, exit: f64) -> f64 {
            self.0.bin_probability(reading, half_width, bearing, enter, exit)
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

        /// To the bit: readings at the sensor, beyond all cells, without range; bearings behind the camera; chords of no length.
        #[test]
        fn bins_of_a_ray_are_those_of_its_chords(
            reading in prop_oneof![4 => 0.0f64..70.0, 4 => 0.0f64..4.0, 1 => Just(0.0), 1 => Just(f64::INFINITY)],
            half_width in prop_oneof![0.01f64..1.0, Just(0.5)], sigma in 0.02f64..1.0,
            bearing in prop_oneof![8 => -1.5f64..1.5, 1 => 1.5f64..4.0, 1 => Just(std::f64::consts::FRAC_PI_2)],
            chords in prop::collection::vec(prop_oneof![8 => 0.0f64..0.08, 1 => Just(0.0), 1 => 0.0f64..1e-9, 1 => 0.1f64..2.0], 0..200), max_range_m in 1.0f64..10.0,
        ) {
            let ranges = chords.iter().scan(0.0, |range, chord| { *range += chord; Some(*range) });
            let ranges: Vec<f64> = std::iter::once(0.0).chain(ranges).collect();
            let stereo = Stereo { disparity_sigma: sigma, ..Stereo::default() };
            let laser = Laser { range_sigma_m: 0.3 * sigma, max_range_m, ..Laser::default() };
            let sensors: [(&dyn InverseModel, &dyn InverseModel); 2] = [(&stereo, &OneByOne(stereo)), (&laser, &OneByOne(laser))];
            for (sensor, one_by_one) in sensors {
                let [mut bins, mut expected] = [vec![f64::NAN; chords.len()], vec![f64::NAN; chords.len()]];
                let within = sensor.bins(reading, half_width, bearing, &ranges, &mut bins);
                prop_assert_eq!(&within, &one_by_one.bins(reading, half_width, bearing, &ranges, &mut expected));
                let bits = |bins: &[f64]| bins[..within.end].iter().map(|bin| bin.to_bits()).collect::<Vec<_>>();
                prop_assert_eq!(bits(&bins), bits(&expected));
            }
        }
    }

    proptest! {
        /// The closed forms of both sensors, where every reading is a correct match.
        #[test]
        fn defaults_are_what_sensors_have_in_closed_form(
            reading in 1.0f64..9.0, half_width in 0.01f64..0.5, away in -1.0f64..1.0, chord in 0.01f64..0.1,
        ) {
            let enter = (reading + away).max(0.5);
            let exit = enter + chord;
            let laser = Laser { range_sigma_m: 0.1, hit: 1.0, no_echo: 0.0, ..Laser::default() };
            let bare = Bare(laser);
            let bin = bare.bin_probability(reading, half_width, 0.0, enter, exit);
            prop_assert!((bin - laser.bin_probability(reading, half_width, 0.0, enter, exit)).abs() < 1e-5, "{bin}");
            let placed = bare.placement(reading, half_width, 0.0, enter, exit);
            prop_assert_eq!(placed, laser.placement(reading, half_width, 0.0, enter, exit));
            prop_assert_eq!(bare.range_of(reading, 0.0), laser.range_of(reading, 0.0));
            let none = bare.bin_probability(f64::INFINITY, half_width, 0.0, enter, exit);
            prop_assert!((none - laser.bin_probability(f64::INFINITY, half_width, 0.0, enter, exit)).abs() < 1e-12);
            let stereo = Stereo { correct_match: 1.0, ..Stereo::default() };
            let disparity = stereo.disparity(reading, 0.1);
            let bin = Bare(stereo).bin_probability(disparity, half_width, 0.1, enter, exit);
            prop_assert!((bin - stereo.bin_probability(disparity, half_width, 0.1, enter, exit)).abs() < 1e-5, "{bin}");
        }
    }
}
