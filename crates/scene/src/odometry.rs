//! What a robot's odometry measures along a drive.

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use rand_distr::{Exp1, StandardNormal};
use sensor::{OdometryNoise, Pose, Step};

/// Random streams of the seed, far from those of scans, layouts, and what moves.
const NOISE: u64 = u64::MAX - (3 << 32);
const SLIPS: u64 = NOISE - 1;

/// How far odometry is off: the standard motion model, with a bias and slip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Odometry {
    /// Standard deviations of every step from one scan to the next.
    pub noise: OdometryNoise,
    /// What is measured of a distance beyond it, m per m: a wheel whose radius is taken for too large.
    pub bias_m_per_m: f64,
    /// What is measured of a turn beyond it, rad per rad: a track that is taken for too narrow.
    pub bias_rad_per_rad: f64,
    /// The turn that is measured of a straight way, rad per m, counter-clockwise: wheels of two radii.
    pub bias_rad_per_m: f64,
    /// Mean number of slips per metre driven, at places independent of each other.
    pub slips_per_m: f64,
    /// Mean of what a slip adds to the distance measured, m; its distribution is exponential: wheels turn, the robot does
    /// not.
    pub slip_m: f64,
    /// Standard deviation of what a slip adds to the turn measured, rad.
    pub slip_rad: f64,
}

impl Default for Odometry {
    /// The standard noise and nothing else; a slip, where some are asked for, has 5 cm and 2 degrees.
    fn default() -> Self {
        Self {
            noise: OdometryNoise::STANDARD,
            bias_m_per_m: 0.0,
            bias_rad_per_rad: 0.0,
            bias_rad_per_m: 0.0,
            slips_per_m: 0.0,
            slip_m: 0.05,
            slip_rad: 2f64.to_radians(),
        }
    }
}

impl Odometry {
    /// What odometry measures of a drive through `poses`: as many poses, of which the first is true.
    ///
    /// The same seed gives the same odometry. It reads random streams of its own, so that neither readings nor anything
    /// else moves; the places of slips depend on the seed and on `slips_per_m` alone. A robot that stands measures nothing.
    pub fn measure(&self, poses: &[Pose], seed: u64) -> Vec<Pose> {
        let stream = |number| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(number);
            rng
        };
        let (mut noise, mut wheels) = (stream(NOISE), Wheels::new(self, stream(SLIPS)));
        let Some(&first) = poses.first() else { return Vec::new() };
        let steps = poses.windows(2).map(|pair| Step::between(pair[0], pair[1]));
        let measured = steps.scan(first, |at, driven| {
            let off = self.noise.sample(&driven, &mut noise);
            *at = wheels.slipped(self.biased(&driven, off)).end(*at);
            Some(*at)
        });
        [first].into_iter().chain(measured).collect()
    }

    /// The step `off`, which is `driven` with noise, and with the bias of `driven`.
    fn biased(&self, driven: &Step, off: Step) -> Step {
        let half_rad = 0.5 * self.bias_rad_per_m * driven.distance_m;
        Step {
            first_turn_rad: off.first_turn_rad + self.bias_rad_per_rad * driven.first_turn_rad + half_rad,
            distance_m: off.distance_m + self.bias_m_per_m * driven.distance_m,
            second_turn_rad: off.second_turn_rad + self.bias_rad_per_rad * driven.second_turn_rad + half_rad,
        }
    }
}

/// Wheels that slip now and then.
struct Wheels<'a> {
    odometry: &'a Odometry,
    rng: ChaCha8Rng,
    /// How far it is to the next slip, m.
    ahead_m: f64,
}

impl<'a> Wheels<'a> {
    fn new(odometry: &'a Odometry, mut rng: ChaCha8Rng) -> Self {
        let ahead_m = rng.sample::<f64, _>(Exp1) / odometry.slips_per_m;
        Self { odometry, rng, ahead_m }
    }

    /// The step with what slips add to it.
    fn slipped(&mut self, mut step: Step) -> Step {
        self.ahead_m -= step.distance_m.abs();
        let forwards = 1f64.copysign(step.distance_m);
        while self.ahead_m < 0.0 {
            let mut draw = |exponential: bool| -> f64 {
                if exponential { self.rng.sample(Exp1) } else { self.rng.sample(StandardNormal) }
            };
            step.distance_m += forwards * self.odometry.slip_m * draw(true);
            step.second_turn_rad += self.odometry.slip_rad * draw(false);
            self.ahead_m += draw(true) / self.odometry.slips_per_m;
        }
        step
    }
}

#[cfg(test)]
mod tests;
