//! The normal distribution in single precision, for several rays at a time.

use crate::lanes::{LANES, Lanes, each};
use crate::{in_lanes, normal};

/// Chords of at most so many standard deviations are taken by a series about their middle ...
const SHORT: f32 = 0.5;

/// ... and longer ones in parts, up to this many.
const MOST_PARTS: u32 = 32;

/// The kernel of a Gaussian in disparity, a ray to a lane.
pub(crate) struct Gaussian {
    /// Disparity times range, px·m; infinite where the ray sees nothing.
    pub(crate) disparity_range: Lanes<f64>,
    /// Reading, px.
    pub(crate) reading: Lanes<f64>,
    /// 1 / sigma, 1/px.
    pub(crate) sharpness: f64,
    /// Factor on the mean density ...
    pub(crate) scale: f32,
    /// ... and what is added to it.
    pub(crate) floor: f32,
    /// Standard deviations beyond which the density counts for nothing.
    pub(crate) reach: f64,
}

impl Gaussian {
    /// Standard deviations of a surface at `range` from the reading.
    #[inline(always)]
    fn standardised(&self, range: &Lanes<f64>) -> Lanes<f64> {
        std::array::from_fn(|l| (self.disparity_range[l] / range[l] - self.reading[l]) * self.sharpness)
    }

    /// The likelihood of every chord.
    #[inline(always)]
    fn chords(&self, ranges: &[Lanes<f64>], likelihood: &mut [Lanes<f32>]) {
        let reach = self.reach as f32;
        let mut near = self.standardised(&ranges[0]);
        for (out, range) in likelihood.iter_mut().zip(&ranges[1..]) {
            let far = self.standardised(range);
            let width = each(|l| (near[l] - far[l]) as f32);
            let middle = each(|l| (0.5 * (near[l] + far[l])) as f32);
            let end = each(|l| far[l] as f32);
            // Of chords that the density does not reach, and of those that begin at the sensor, nothing is needed.
            let begin = each(|l| near[l] as f32);
            let wide = each(|l| if end[l] < reach { width[l] } else { 0.0 });
            let wide = each(|l| if wide[l] < f32::INFINITY { wide[l] } else { 0.0 });
            let long = each(|l| if wide[l] > SHORT { 1.0 } else { 0.0 });
            let mean = if long.iter().sum::<f32>() <= 0.0 {
                each(|l| short(middle[l], wide[l]))
            } else {
                self.long(&near, &far, wide.iter().copied().fold(0.0, f32::max))
            };
            // Far behind the reading the series is no longer the density, which is nothing there.
            let wide = each(|l| if begin[l] > -reach { wide[l] } else { 0.0 });
            *out = each(|l| if wide[l] > 0.0 { mean[l] } else { 0.0 });
            *out = each(|l| self.scale * out[l] + self.floor);
            near = far;
        }
    }

    /// Mean densities of chords of which at least one is long.
    #[inline(never)]
    fn long(&self, near: &Lanes<f64>, far: &Lanes<f64>, longest: f32) -> Lanes<f32> {
        let parts = ((longest / SHORT).min(MOST_PARTS as f32) as u32 + 1).next_power_of_two().min(MOST_PARTS);
        let share = 1.0 / f64::from(parts);
        let mut sum = [0.0f32; LANES];
        for part in 0..parts {
            let at = (f64::from(part) + 0.5) * share;
            for l in 0..LANES {
                let width = near[l] - far[l];
                sum[l] += short((far[l] + at * width) as f32, (share * width) as f32);
            }
        }
        std::array::from_fn(|l| {
            let width = (near[l] - far[l]) as f32;
            let too_long =
                width > SHORT * MOST_PARTS as f32 && (far[l] as f32) < self.reach as f32 && width < f32::INFINITY;
            if too_long { normal::mean_density(far[l], near[l], self.reach) as f32 } else { sum[l] * share as f32 }
        })
    }

    /// Likelihood of a surface at each range, and its derivative, per m.
    #[inline(always)]
    fn points(&self, ranges: &Lanes<f64>) -> [Lanes<f32>; 2] {
        let reach = self.reach as f32;
        let z = self.standardised(ranges);
        let density: Lanes<f32> = std::array::from_fn(|l| {
            let at = z[l] as f32;
            if at.abs() < reach { self.scale * density(at * at) } else { 0.0 }
        });
        let slope = std::array::from_fn(|l| {
            // d z / d r = -K / (r^2 sigma) and d phi / d z = -z phi.
            let steepness = self.disparity_range[l] / (ranges[l] * ranges[l]) * self.sharpness;
            if density[l] > 0.0 { density[l] * (z[l] * steepness) as f32 } else { 0.0 }
        });
        [std::array::from_fn(|l| density[l] + self.floor), slope]
    }
}

in_lanes! {
    /// [`Gaussian::chords`], in lanes.
    pub(crate) fn chords<'a>(lanes: &'a Gaussian, ranges: &'a [Lanes<f64>], likelihood: &'a mut [Lanes<f32>]) {
        lanes.chords(ranges, likelihood);
    }
}

in_lanes! {
    /// [`Gaussian::points`] of every range, in lanes.
    pub(crate) fn points<'a>(
        lanes: &'a Gaussian,
        ranges: &'a [Lanes<f64>],
        likelihood: &'a mut [Lanes<f32>],
        slope: &'a mut [Lanes<f32>],
    ) {
        for ((range, likelihood), slope) in ranges.iter().zip(likelihood).zip(slope) {
            [*likelihood, *slope] = lanes.points(range);
        }
    }
}

/// Mean of the standard normal density over a short interval about `middle`: the series up to `width^6`.
#[inline(always)]
fn short(middle: f32, width: f32) -> f32 {
    let (a, w) = (middle * middle, width * width);
    let second = a - 1.0;
    let fourth = (a - 6.0) * a + 3.0;
    let sixth = ((a - 15.0) * a + 45.0) * a - 15.0;
    density(a) * (1.0 + w * (1.0 / 24.0) * (second + w * (1.0 / 80.0) * (fourth + w * (1.0 / 168.0) * sixth)))
}

/// `exp(-x)` for `x` from 0; relative error below 1e-6 up to 10, and below 1e-5 beyond.
#[inline(always)]
pub fn exp_minus(x: f32) -> f32 {
    const SCALE: f32 = 1.0 / PEAK;
    SCALE * density(2.0 * x)
}

const PEAK: f32 = 0.398_942_3;

/// Density of the standard normal distribution at `x`, of which the square is given; relative error below 1e-6 for
/// squares up to 20, and below 1e-5 beyond, where it is small.
#[inline(always)]
fn density(square: f32) -> f32 {
    const HALF_LOG2_E: f32 = 0.5 * std::f32::consts::LOG2_E;
    const ROUND: f32 = 12_582_912.0; // 1.5 * 2^23: adding it rounds to a whole number
    let x = (-HALF_LOG2_E * square).max(-125.0);
    let rounded = x + ROUND;
    let f = x - (rounded - ROUND);
    // 2^f for f in -0.5 ..= 0.5.
    let power = 1.0
        + f * (std::f32::consts::LN_2
            + f * (0.240_226_5
                + f * (0.055_504_11 + f * (0.009_618_129 + f * (0.001_333_355_8 + f * 0.000_154_035_3)))));
    let exponent = rounded.to_bits().wrapping_sub(ROUND.to_bits()).wrapping_add(127) << 23;
    PEAK * power * f32::from_bits(exponent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fast_kernel::one_by_one;
    use crate::lanes::Beams;
    use crate::{FastKernel as _, Kernel as _, Stereo};
    use proptest::prelude::*;

    #[test]
    fn the_density_is_that_of_the_normal_distribution() {
        for k in 0..=3_900 {
            let x = f64::from(k) * 0.01;
            let square = (x * x) as f32;
            let exact = normal::density(libm::sqrt(f64::from(square)));
            let relative = if x < 4.5 { 1e-6 } else { 1e-5 };
            let error = (f64::from(density(square)) - exact).abs();
            assert!(error <= relative * exact + 1e-37, "{x}: {error} of {exact}");
        }
    }

    proptest! {
        /// For any camera, any reading and any chords, long and short, the likelihood is that of double precision.
        #[test]
        fn lanes_are_the_rays_one_by_one(
            reading in prop::array::uniform8(0.0f64..60.0), bearing in prop::array::uniform8(-1.2f64..1.2),
            first in prop::array::uniform8(0.0f64..30.0), step in 0.001f64..0.3,
            sigma in (-6.0f64..2.0).prop_map(|power| 10.0f64.powf(power)), correct in 0.05f64..0.99,
        ) {
            let stereo = Stereo { disparity_sigma: sigma, correct_match: correct, ..Stereo::default() };
            let beams = Beams { reading, bearing_rad: bearing };
            let ranges: Vec<Lanes<f64>> =
                (0..100).map(|k| std::array::from_fn(|l| if k == 0 && l == 3 { 0.0 } else { first[l] + step * f64::from(k) })).collect();
            let mut expected = vec![[0.0; LANES]; 99];
            one_by_one(&stereo, &beams, &ranges, &mut expected);
            let mut found = expected.clone();
            stereo.likelihood_lanes(&beams, &ranges, &mut found);
            for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
                for l in 0..LANES {
                    let error = (found[l] - expected[l]).abs();
                    prop_assert!(error <= 5e-6 * expected[l], "chord {k} lane {l}: {} {}", found[l], expected[l]);
                }
            }
        }

        #[test]
        fn points_are_chords_of_no_length(
            reading in prop::array::uniform8(0.0f64..60.0), range in prop::array::uniform8(0.3f64..30.0), bearing in -1.2f64..1.2,
        ) {
            let stereo = Stereo::default();
            let beams = Beams { reading, bearing_rad: [bearing; LANES] };
            let (mut found, mut slope) = ([0.0; LANES], [0.0; LANES]);
            let known = stereo.point_lanes(&beams, &[range], std::slice::from_mut(&mut found), std::slice::from_mut(&mut slope));
            prop_assert!(known);
            for l in 0..LANES {
                let at = |r: f64| { let mut out = [0.0]; stereo.likelihood(reading[l], bearing, &[r, r + 1e-9], &mut out); out[0] };
                prop_assert!((f64::from(found[l]) / at(range[l]) - 1.0).abs() < 5e-6);
                let numeric = (at(range[l] + 1e-6) - at(range[l] - 1e-6)) / 2e-6;
                prop_assert!((f64::from(slope[l]) - numeric).abs() < 1e-3 * (numeric.abs() + 1e-3), "{} {numeric}", slope[l]);
            }
        }
    }
}
