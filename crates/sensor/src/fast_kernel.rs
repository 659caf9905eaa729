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
