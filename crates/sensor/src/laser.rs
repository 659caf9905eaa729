//! A laser range finder: a beam that stops at the first thing in its way, or does not come back.
//!
//! The parts are those of the beam model of Thrun, Burgard and Fox, "Probabilistic Robotics", MIT Press 2005, 6.3.1.
//! There they are weights that are normalised for every beam; here they are what becomes of a pulse, so that the
//! readings of a surface at any range add up to one as they are.

pub(crate) mod check;
mod curve;
mod sample;
#[cfg(test)]
mod tests;

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::lanes::{Beams, Lanes};
use crate::{FastKernel, InverseModel, Kernel, Parameters, Placement, ReadingKernel, normal};
use curve::{Curve, Curves};

/// A laser range finder as a sensor model. A reading is a range in m, or `f64::INFINITY` where there was no echo.
///
/// A pulse towards a surface at range `r` is, with probability
///
/// - [`hit`](Self::hit), reflected. The surface appears at `z = |r + range_sigma_m n|`, n standard normal: a range is
///   never negative. What is on no map, such as people, stands in the way with [`early_per_m`](Self::early_per_m) in
///   every metre, the first of it at `e`: the reading is the lesser of `z` and `e`, and no echo beyond `max_range_m`;
/// - [`no_echo`](Self::no_echo), lost, on a black or slanted surface: no echo, at whatever range;
/// - otherwise an outlier, from crosstalk or stray light: uniform over `0 ..= max_range_m`.
///
/// So the density (1/m) of an echo at `o`, and the probability of no echo, are, with `phi` and `Phi` of the standard
/// normal distribution, `s = range_sigma_m`, `l = early_per_m`, `M = max_range_m`,
///
/// ```text
/// p(o | r)       = hit exp(-l o) (phi(x) / s + l Phi(x)) + (1 - hit - no_echo) / M,   x = (r - o) / s
/// P(no echo | r) = hit exp(-l M) Phi((r - M) / s) + no_echo
/// ```
///
/// averaged over the chord of a cell, uniformly in range. (Within a few sigma of the sensor the first terms count once
/// more, for `-r` in the place of `r`.) Together they are one for every `r`.
///
/// As functions of `r` both are a level, a bump and another level: nothing changes with what lies well in front of the
/// reading, or of `M`, nor with what lies well behind. That needs a rate of things in the way that is the same in every
/// metre, for then whether something stands before `o` does not depend on what is behind `o`; and lost pulses that are
/// lost whatever they meet. The noise does not grow with range, or the averages would have no closed form.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Laser {
    /// Standard deviation of the range of a surface, m; above 0. Default 0.025: a SICK LMS scatters by 0.01 and is off
    /// by up to 0.035 in one direction on one surface and in another on the next (SICK, "Measurement errors LMSxxx":
    /// statistical 6 to 14 mm, systematic 25 to 50 mm for the LMS5xx); a map sees both.
    pub range_sigma_m: f64,
    /// Range beyond which nothing is measured, m; above 0. Default 80, that of the SICK LMS 2xx and 5xx.
    pub max_range_m: f64,
    /// `P(T)`: probability that a pulse comes back from the first thing in its way, 0 to 1. Default 0.93, our choice.
    pub hit: f64,
    /// Probability that a pulse is lost although there is a surface, 0 to 1; with [`hit`](Self::hit) at most 1. The
    /// rest are outliers. Default 0.05, the weight of AMCL, which leaves 0.02 for outliers.
    pub no_echo: f64,
    /// How many things that are on no map stand in a metre of beam, 1/m; from 0. Default 0.002, our choice: one beam of
    /// 5 m in a hundred meets somebody.
    pub early_per_m: f64,
}

impl Default for Laser {
    fn default() -> Self {
        Self { range_sigma_m: 0.025, max_range_m: 80.0, hit: 0.93, no_echo: 0.05, early_per_m: 0.002 }
    }
}

impl Laser {
    /// Probability of an outlier, what [`hit`](Self::hit) and [`no_echo`](Self::no_echo) leave of one.
    pub fn outlier(&self) -> f64 {
        (1.0 - self.hit - self.no_echo).max(0.0)
    }

    /// Probability that a pulse meets nothing that is on no map up to `range_m`.
    fn passes(&self, range_m: f64) -> f64 {
        libm::exp(-self.early_per_m * range_m.max(0.0))
    }

    /// Probability that a surface in the chord `enter ..= exit` appears beyond `at_m`, which is not negative.
    fn appears_beyond(&self, at_m: f64, enter: f64, exit: f64) -> f64 {
        let beyond = |near: f64, far: f64| {
            let [near, far] = [near, far].map(|range| (range - at_m) / self.range_sigma_m);
            normal::mean_cumulative(near, far, normal::REACH)
        };
        beyond(enter, exit) + beyond(-exit, -enter)
    }
}

/// That a reading lies beyond `at_m`, for one chord of a ray after the other: a surface appears beyond it and nothing stands before it.
struct Beyond {
    at_m: f64,
    passes: f64,
    surface: normal::MeanCumulative,
    mirrored: normal::MeanCumulative,
}

impl Beyond {
    fn probability(&mut self, laser: &Laser, enter: f64, exit: f64) -> f64 {
        let sigmas = |range: f64| (range - self.at_m) / laser.range_sigma_m;
        let surface = self.surface.over(sigmas(enter), sigmas(exit), normal::REACH);
        let mirrored = self.mirrored.over(sigmas(-exit), sigmas(-enter), normal::REACH);
        self.passes * (surface + mirrored)
    }
}

impl Kernel for Laser {
    fn likelihood(&self, reading: f64, _bearing: f64, ranges: &[f64], likelihood: &mut [f64]) {
        debug_assert_eq!(ranges.len(), likelihood.len() + 1);
        let curve = Curve::new(self, reading);
        for (l, chord) in likelihood.iter_mut().zip(ranges.windows(2)) {
            *l = curve.mean(chord[0], chord[1]);
        }
    }

    fn parameters(&self) -> Option<Parameters> {
        let Self { range_sigma_m, max_range_m, hit, no_echo, early_per_m } = *self;
        let noise = vec![
            ("range_sigma_m", range_sigma_m),
            ("max_range_m", max_range_m),
            ("hit", hit),
            ("no_echo", no_echo),
            ("early_per_m", early_per_m),
        ];
        Some(Parameters { kernel: "laser", reading: "range_m", noise })
    }
}

impl FastKernel for Laser {
    fn likelihood_lanes(&self, beams: &Beams, ranges: &[Lanes<f64>], likelihood: &mut [Lanes<f32>]) {
        debug_assert_eq!(ranges.len(), likelihood.len() + 1);
        curve::fill(&Curves::new(self, beams), ranges, likelihood);
    }

    /// Behind an echo, and behind the largest range for no echo.
    fn constant_from(&self, reading: f64, _bearing: f64) -> f64 {
        Curve::new(self, reading).behind_m()
    }

    /// None behind an echo, and behind the largest range for no echo, whose probability is at most one before.
    fn spread_from(&self, reading: f64, _bearing: f64, range: f64) -> f64 {
        Curve::new(self, reading).spread_from(range)
    }

    fn constant_between(&self, reading: f64, _bearing: f64) -> [f64; 2] {
        Curve::new(self, reading).front_m()
    }

    fn of_readings(&self, beams: &Beams) -> Box<dyn ReadingKernel + '_> {
        Box::new(Curves::new(self, beams))
    }
}

impl ReadingKernel for Curves {
    fn likelihood(&self, ranges: &[Lanes<f64>], likelihood: &mut [Lanes<f32>]) {
        curve::fill(self, ranges, likelihood);
    }

    fn constant_between(&self, lane: usize) -> [f64; 2] {
        self.curves[lane].front_m()
    }

    fn spread_from(&self, lane: usize, range: f64) -> f64 {
        self.curves[lane].spread_from(range)
    }
}

impl InverseModel for Laser {
    fn correct_match(&self) -> f64 {
        self.hit
    }

    fn range_sigma(&self, reading: f64, bearing: f64) -> f64 {
        self.range_of(reading, bearing).map_or(0.0, |_| self.range_sigma_m)
    }

    /// Without an echo, chords up to the largest range were passed and nothing is known of those beyond.
    fn placement(&self, reading: f64, half_width: f64, _bearing: f64, enter: f64, exit: f64) -> Placement {
        if reading.is_infinite() {
            return if exit <= self.max_range_m { Placement::Nearer } else { Placement::Behind };
        }
        if exit < reading - half_width {
            Placement::Nearer
        } else if enter > reading + half_width {
            Placement::Behind
        } else {
            Placement::Within
        }
    }

    /// Of no echo, which is one event, its probability, whatever the width.
    fn bin_probability(&self, reading: f64, half_width: f64, _bearing: f64, enter: f64, exit: f64) -> f64 {
        // The reading lies beyond `at_m` where the surface appears beyond it and nothing stands before it.
        let beyond = |at_m: f64| self.passes(at_m) * self.appears_beyond(at_m, enter, exit);
        if reading.is_infinite() {
            return beyond(self.max_range_m);
        }
        (beyond((reading - half_width).max(0.0)) - beyond((reading + half_width).max(0.0))).clamp(0.0, 1.0)
    }

    /// Where the bin is clear, and where chords lie behind it, nothing need be known of them.
    fn bins(&self, reading: f64, half_width: f64, bearing: f64, ranges: &[f64], bins: &mut [f64]) -> Range<usize> {
        let place = |chord: usize| self.placement(reading, half_width, bearing, ranges[chord], ranges[chord + 1]);
        let clear_m = self.clear_until(reading, half_width, bearing);
        let clear = if clear_m > 0.0 { ranges[1..].partition_point(|exit| *exit <= clear_m) } else { 0 };
        bins[..clear].fill(0.0);
        let ends_m = if reading.is_infinite() {
            [self.max_range_m; 2]
        } else {
            [reading - half_width, reading + half_width].map(|m| m.max(0.0))
        };
        let mut beyond = ends_m.map(|at_m| Beyond {
            at_m,
            passes: self.passes(at_m),
            surface: normal::MeanCumulative::new(),
            mirrored: normal::MeanCumulative::new(),
        });
        let mut nearer = clear;
        for k in clear..bins.len() {
            match place(k) {
                Placement::Nearer => nearer = k + 1,
                Placement::Within => {}
                Placement::Behind => return nearer..k,
            }
            let [first, second] = &mut beyond;
            let near = first.probability(self, ranges[k], ranges[k + 1]);
            bins[k] = if reading.is_infinite() {
                near
            } else {
                (near - second.probability(self, ranges[k], ranges[k + 1])).clamp(0.0, 1.0)
            };
        }
        nearer..bins.len()
    }

    /// Where no surface appears in the bin any more, and a little before.
    fn clear_until(&self, reading: f64, half_width: f64, _bearing: f64) -> f64 {
        let least_m = if reading.is_infinite() { self.max_range_m } else { reading - half_width };
        // Nor does any mirror image, where this is not negative.
        (least_m - 1.001 * normal::REACH * self.range_sigma_m).max(0.0)
    }

    fn behind_from(&self, reading: f64, half_width: f64, _bearing: f64) -> f64 {
        let end_m = if reading.is_infinite() { self.max_range_m } else { reading + half_width };
        (1.0 + 1e-9) * end_m.max(0.0)
    }

    fn false_match_probability(&self, reading: f64, half_width: f64) -> f64 {
        let share = |part: f64| if self.hit < 1.0 { part / (1.0 - self.hit) } else { 0.0 };
        if reading.is_infinite() {
            share(self.no_echo)
        } else {
            2.0 * half_width / self.max_range_m * share(self.outlier())
        }
    }

    /// One standard deviation, as the paper's 0.5 px are; but the obstacle is anywhere in its cell, so at least half a
    /// cell: with less, a cell that holds what was read could seem unlikely to have been read.
    fn half_bin(&self, cell_m: f64) -> f64 {
        self.range_sigma_m.max(0.5 * cell_m)
    }
}
