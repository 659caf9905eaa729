//! What lets mappers take several rays at a time, and stop where nothing changes any more.

use crate::Kernel;
use crate::lanes::{Beams, LANES, Lanes};

/// A kernel for several rays at a time, and bounds on it. A sensor that has none of this is slower, and no less exact.
pub trait FastKernel: Kernel {
    /// [`likelihood`](Kernel::likelihood) of several rays at once, in single precision: `likelihood[k][l]` is that of lane
    /// `l` in the chord `ranges[k][l] ..= ranges[k + 1][l]`. It may differ from that by 5e-6 of its value.
    fn likelihood_lanes(&self, beams: &Beams, ranges: &[Lanes<f64>], likelihood: &mut [Lanes<f32>]) {
        one_by_one(self, beams, ranges, likelihood);
    }

    /// `P(o | a surface at range r)` and its derivative with respect to the range, per m, for ranges (m) of every
    /// lane, both as accurate as [`likelihood_lanes`](Self::likelihood_lanes); false where neither is known.
    fn point_lanes(
        &self,
        _beams: &Beams,
        _ranges: &[Lanes<f64>],
        _likelihood: &mut [Lanes<f32>],
        _slope: &mut [Lanes<f32>],
    ) -> bool {
        false
    }

    /// Range (m) from which on a chord of the given length (m) is so short that the likelihood is nearly constant
    /// over it, to one part in four; infinite where that is not known.
    fn smooth_from(&self, _bearing: f64, _chord_m: f64) -> f64 {
        f64::INFINITY
    }

    /// Range (m) along the ray from which on `P(o | F_k)` no longer changes, so that a chain need not be
    /// followed further; infinite where it always does.
    fn constant_from(&self, _reading: f64, _bearing: f64) -> f64 {
        f64::INFINITY
    }

    /// Ranges (m) between which all chords have the same likelihood, so that they need not be asked about one by one;
    /// twice the same where there are none.
    fn constant_between(&self, _reading: f64, _bearing: f64) -> [f64; 2] {
        [0.0; 2]
    }

    /// At most so much, per unit of the reading, do the likelihoods of two cells from `range` (m) on differ, however far
    /// they are; infinite where that is not known.
    fn spread_from(&self, _reading: f64, _bearing: f64, _range: f64) -> f64 {
        f64::INFINITY
    }

    /// The kernel of several readings, to be asked about one stretch of their rays after the other. A sensor that has none of its own
    /// answers by the functions above.
    fn of_readings(&self, beams: &Beams) -> Box<dyn ReadingKernel + '_> {
        Box::new(AskedAnew { kernel: self, beams: *beams })
    }
}

/// What [`FastKernel`] says of the readings of several rays, a lane to each: what depends on the readings alone is computed once.
pub trait ReadingKernel {
    /// [`FastKernel::likelihood_lanes`] of these readings.
    fn likelihood(&self, ranges: &[Lanes<f64>], likelihood: &mut [Lanes<f32>]);

    /// [`FastKernel::constant_between`] of the reading of a lane.
    fn constant_between(&self, lane: usize) -> [f64; 2];

    /// [`FastKernel::spread_from`] of the reading of a lane.
    fn spread_from(&self, lane: usize, range: f64) -> f64;
}

/// Nothing is computed once.
struct AskedAnew<'a, K: ?Sized> {
    kernel: &'a K,
    beams: Beams,
}

impl<K: FastKernel + ?Sized> ReadingKernel for AskedAnew<'_, K> {
    fn likelihood(&self, ranges: &[Lanes<f64>], likelihood: &mut [Lanes<f32>]) {
        self.kernel.likelihood_lanes(&self.beams, ranges, likelihood);
    }

    fn constant_between(&self, lane: usize) -> [f64; 2] {
        self.kernel.constant_between(self.beams.reading[lane], self.beams.bearing_rad[lane])
    }

    fn spread_from(&self, lane: usize, range: f64) -> f64 {
        self.kernel.spread_from(self.beams.reading[lane], self.beams.bearing_rad[lane], range)
    }
}

/// [`FastKernel::likelihood_lanes`] by [`Kernel::likelihood`], one lane after the other.
pub(crate) fn one_by_one(
    sensor: &(impl Kernel + ?Sized),
    beams: &Beams,
    ranges: &[Lanes<f64>],
    likelihood: &mut [Lanes<f32>],
) {
    let mut exact = vec![0.0; likelihood.len()];
    for lane in 0..LANES {
        let along: Vec<f64> = ranges.iter().map(|range| range[lane]).collect();
        sensor.likelihood(beams.reading[lane], beams.bearing_rad[lane], &along, &mut exact);
        likelihood.iter_mut().zip(&exact).for_each(|(to, from)| to[lane] = *from as f32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Laser, Omnidirectional, Stereo};
    use proptest::prelude::*;

    proptest! {
        /// To the bit, from the sensor to behind the reading.
        #[test]
        fn what_is_computed_once_is_what_is_asked_anew(
            share in prop::array::uniform8(0.0f64..1.2), bearing_rad in prop::array::uniform8(-1.7f64..1.7), step in 0.001f64..0.2,
        ) {
            let laser = Laser { max_range_m: 8.0, ..Laser::default() };
            let stereo = Stereo { max_disparity: 8.0, ..Stereo::default() };
            let kernels: [&dyn FastKernel; 3] = [&laser, &stereo, &Omnidirectional(stereo)];
            let reading = share.map(|share| if share < 1.0 { 8.0 * share } else { f64::INFINITY });
            let ranges: Vec<Lanes<f64>> = (0..60).map(|k| [step * f64::from(k); LANES]).collect();
            for (number, kernel) in kernels.into_iter().enumerate() {
                let reading = if number == 0 { reading } else { reading.map(|reading| reading.min(8.0)) };
                let beams = Beams { reading, bearing_rad };
                let of_readings = kernel.of_readings(&beams);
                let (mut found, mut expected) = (vec![[0.0; LANES]; 59], vec![[0.0; LANES]; 59]);
                of_readings.likelihood(&ranges, &mut found);
                kernel.likelihood_lanes(&beams, &ranges, &mut expected);
                prop_assert_eq!(bits(&found), bits(&expected));
                for l in 0..LANES {
                    let (reading, bearing) = (reading[l], bearing_rad[l]);
                    let between = kernel.constant_between(reading, bearing);
                    prop_assert_eq!(of_readings.constant_between(l).map(f64::to_bits), between.map(f64::to_bits));
                    for range in ranges.iter().map(|range| range[l]) {
                        let spread = kernel.spread_from(reading, bearing, range);
                        prop_assert_eq!(of_readings.spread_from(l, range).to_bits(), spread.to_bits());
                    }
                }
            }
        }
    }

    fn bits(likelihood: &[Lanes<f32>]) -> Vec<u32> {
        likelihood.iter().flatten().map(|likelihood| likelihood.to_bits()).collect()
    }
}
