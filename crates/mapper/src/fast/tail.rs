//! The likelihood of a reading past the last cell, for several rays at once: the sum of [`crate::past_the_map`] as an
//! integral.

use sensor::lanes::{Beams, LANES, Lanes};
use sensor::{SensorModel, exp_minus};

#[cfg(any(doc, test))]
use crate::fast::budget::TAIL;
use crate::ray::past_the_map::{self, PastTheMap};

/// Nodes and weights of the Gauss-Legendre rule on 0 ..= 1.
const RULE: [[f64; 2]; 5] = [
    [0.046_910_077_030_668, 0.118_463_442_528_094_5],
    [0.230_765_344_947_158_45, 0.239_314_335_249_683_23],
    [0.5, 0.284_444_444_444_444_44],
    [0.769_234_655_052_841_5, 0.239_314_335_249_683_23],
    [0.953_089_922_969_332, 0.118_463_442_528_094_5],
];

/// More cells than this before the likelihood is smooth are summed in double precision.
const MOST_CELLS: usize = 512;

/// Mean free paths after which nothing is left.
const LEFT: f64 = 18.0;

/// More panels than this too.
const MOST_PANELS: usize = 64;

/// How the integral is divided.
struct Panels {
    /// `-ln(1 - u0)`.
    per_cell: f64,
    /// Panels of the same length ...
    even: usize,
    /// ... and how often the last of them is halved.
    halvings: i32,
}

/// Working memory.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tail {
    ranges: Vec<Lanes<f64>>,
    weights: Vec<Lanes<f32>>,
    likelihood: Vec<Lanes<f32>>,
    slope: Vec<Lanes<f32>>,
}

impl Tail {
    /// [`past_the_map::likelihood`] of every lane that is `wanted`, to [`TAIL`] of its value; anything for the others.
    ///
    /// Cells are summed one by one up to where a chord is short beside the sensor's sigma. From there on the sum is
    /// the integral of `lambda exp(-lambda x) L` over the distance `x`, `exp(-lambda chord) = 1 - u0`, and two terms
    /// that the finite length of the chords leaves: hits are not spread evenly over a chord, and the kernel is
    /// averaged evenly in disparity and not in range. The integral is taken over the inverse range, in which the
    /// kernel is a Gaussian, by panels of a fixed rule.
    pub(crate) fn likelihood(
        &mut self,
        sensor: &dyn SensorModel,
        beams: &Beams,
        wanted: &Lanes<bool>,
        past: &Lanes<PastTheMap>,
    ) -> Lanes<f32> {
        self.fast(sensor, beams, wanted, past).unwrap_or_else(|| {
            let exact =
                |l: usize| past_the_map::likelihood(sensor, beams.reading[l], beams.bearing_rad[l], &past[l]) as f32;
            std::array::from_fn(|l| if wanted[l] { exact(l) } else { 1.0 })
        })
    }

    /// None where that would be slower, or not accurate.
    fn fast(
        &mut self,
        sensor: &dyn SensorModel,
        beams: &Beams,
        wanted: &Lanes<bool>,
        past: &Lanes<PastTheMap>,
    ) -> Option<Lanes<f32>> {
        let onset = past[0].onset;
        if !(1e-6..0.2).contains(&onset) {
            return None;
        }
        let per_cell = -libm::log1p(-onset);
        let (mut cells, mut panels) = (0, 1);
        for l in (0..LANES).filter(|l| wanted[*l]) {
            let PastTheMap { from_m, chord_m, .. } = past[l];
            let smooth_m = sensor.smooth_from(beams.bearing_rad[l], chord_m);
            let missing = ((smooth_m - from_m) / chord_m).ceil().max(0.0);
            if missing > MOST_CELLS as f64 {
                return None;
            }
            cells = cells.max(missing as usize);
            // In a panel the inverse range changes by less than sigma, and the mass by less than a factor e.
            let from_m = from_m.max(smooth_m);
            let needed = (4.0 * chord_m * (from_m / smooth_m).powi(2)).recip() * from_m;
            panels = panels.max((needed.max(per_cell / chord_m * from_m).ceil() + 1.0).min(1e6) as usize);
        }
        if panels > MOST_PANELS {
            return None;
        }
        // Until a mass of e^-18 is left.
        let reached = |l: usize| {
            let PastTheMap { from_m, chord_m, .. } = past[l];
            let from_m = from_m + cells as f64 * chord_m;
            1.0 + LEFT * chord_m / (per_cell * from_m.max(chord_m))
        };
        let farthest = (0..LANES).filter(|l| wanted[*l]).map(reached).fold(1.0, f64::max);
        let halvings = (libm::log2(farthest / panels as f64).ceil() as i32).max(1);
        let mut sum = [0.0f32; LANES];
        let mut mass = [1.0f32; LANES];
        let mut from_m: Lanes<f64> = std::array::from_fn(|l| past[l].from_m);
        if cells > 0 {
            self.ranges.clear();
            let range = |k: usize| std::array::from_fn(|l| from_m[l] + k as f64 * past[l].chord_m);
            self.ranges.extend((0..=cells).map(range));
            self.likelihood.resize(cells.max(self.likelihood.len()), [0.0; LANES]);
            sensor.likelihood_lanes(beams, &self.ranges, &mut self.likelihood[..cells]);
            let (hit, pass) = (onset as f32, 1.0 - onset as f32);
            for likelihood in &self.likelihood[..cells] {
                for l in 0..LANES {
                    sum[l] += mass[l] * hit * likelihood[l];
                    mass[l] *= pass;
                }
            }
            from_m = self.ranges[cells];
        }
        let integral = self.integral(sensor, beams, &from_m, past, Panels { per_cell, even: panels, halvings })?;
        Some(std::array::from_fn(|l| sum[l] + mass[l] * integral[l]))
    }

    fn integral(
        &mut self,
        sensor: &dyn SensorModel,
        beams: &Beams,
        from_m: &Lanes<f64>,
        past: &Lanes<PastTheMap>,
        Panels { per_cell, even: panels, halvings }: Panels,
    ) -> Option<Lanes<f32>> {
        self.ranges.clear();
        self.weights.clear();
        self.ranges.push(*from_m);
        self.weights.push([0.0; LANES]);
        // From 1 down to one panel before 0, where ranges go to infinity: from there on each is half as long.
        let even = (1..panels).map(|k| [k, k + 1].map(|k| k as f64 / panels as f64));
        let halved = (0..halvings).map(|k| [k + 1, k].map(|k| 0.5f64.powi(k) / panels as f64));
        for [low, high] in even.chain(halved) {
            for [node, weight] in RULE {
                let inverse = low + (high - low) * node;
                let (mut ranges, mut weights) = ([0.0; LANES], [0.0f32; LANES]);
                for l in 0..LANES {
                    let rate = per_cell / past[l].chord_m;
                    ranges[l] = from_m[l] / inverse;
                    let mass = exp_minus((rate * (ranges[l] - from_m[l])).min(80.0) as f32);
                    // d r = from / inverse^2 d inverse
                    weights[l] = (weight * (high - low) * rate * from_m[l] / (inverse * inverse)) as f32 * mass;
                }
                self.ranges.push(ranges);
                self.weights.push(weights);
            }
        }
        let nodes = self.ranges.len();
        self.likelihood.resize(nodes.max(self.likelihood.len()), [0.0; LANES]);
        self.slope.resize(nodes.max(self.slope.len()), [0.0; LANES]);
        let (likelihood, slope) = (&mut self.likelihood[..nodes], &mut self.slope[..nodes]);
        if !sensor.point_lanes(beams, &self.ranges, likelihood, slope) {
            return None;
        }
        let (mut whole, mut integral) = ([0.0f32; LANES], [0.0f32; LANES]);
        for k in 1..nodes {
            for l in 0..LANES {
                let tilt = (past[l].chord_m * past[l].chord_m / (6.0 * self.ranges[k][l])) as f32;
                whole[l] += self.weights[k][l];
                integral[l] += self.weights[k][l] * (likelihood[k][l] - tilt * slope[k][l]);
            }
        }
        let uneven = (per_cell * per_cell / 12.0) as f32;
        Some(std::array::from_fn(|l| {
            let mean = integral[l] / whole[l];
            mean + uneven * (mean - likelihood[0][l])
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use sensor::Stereo;

    proptest! {
        #[test]
        fn it_is_the_sum_over_cells(
            reading in prop::array::uniform8(0.0f64..30.0), bearing in prop::array::uniform8(-1.2f64..1.2),
            from in prop::array::uniform8(0.0f64..40.0), chord in prop::array::uniform8(0.01f64..0.1),
            onset in 0.002f64..0.15, sigma in 0.1f64..2.0,
        ) {
            let stereo = Stereo { disparity_sigma: sigma, ..Stereo::default() };
            let beams = Beams { reading, bearing_rad: bearing };
            let lanes: Lanes<PastTheMap> = std::array::from_fn(|l| PastTheMap { from_m: from[l], chord_m: chord[l], onset });
            let found = Tail::default().fast(&stereo, &beams, &[true; LANES], &lanes);
            // Fails too where fewer than one case in five is fast.
            prop_assume!(found.is_some());
            let found = found.expect("just asked");
            for l in 0..LANES {
                let expected = past_the_map::likelihood(&stereo, reading[l], bearing[l], &lanes[l]);
                let error = (f64::from(found[l]) / expected - 1.0).abs();
                prop_assert!(error < TAIL, "{error} {:?} reading {} bearing {}", lanes[l], reading[l], bearing[l]);
            }
        }

        /// The paper's camera and prior, after a room: always.
        #[test]
        fn the_papers_camera_takes_the_integral(
            reading in prop::array::uniform8(0.0f64..60.0), bearing in prop::array::uniform8(-0.7f64..0.7),
            from in prop::array::uniform8(1.0f64..12.0), chord in prop::array::uniform8(0.035f64..0.05),
        ) {
            let beams = Beams { reading, bearing_rad: bearing };
            let lanes: Lanes<PastTheMap> =
                std::array::from_fn(|l| PastTheMap { from_m: from[l], chord_m: chord[l], onset: 0.0129 });
            prop_assert!(Tail::default().fast(&Stereo::default(), &beams, &[true; LANES], &lanes).is_some());
        }
    }
}
