//! A sensor of your own: a time-of-flight camera whose noise grows with the square of the range.
//!
//! `cargo run -p mapper --example own_sensor`

#![allow(clippy::print_stdout, reason = "it shows what it finds")]

use std::sync::Arc;

use grid::GridSpec;
use mapper::{Model, catalogue};
use sensor::{FastKernel, InverseModel, Kernel, Pose, Scan};

/// Its readings are ranges in m.
#[derive(Clone, Copy)]
struct TimeOfFlight {
    /// Probability that a reading is of the first surface on its ray.
    hit: f64,
    /// Standard deviation of such a reading, m: `near_m` at the camera, and `growth_per_m` times the range squared more.
    near_m: f64,
    growth_per_m: f64,
    /// Other readings lie anywhere up to here, m.
    most_m: f64,
}

impl Default for TimeOfFlight {
    fn default() -> Self {
        Self { hit: 0.9, near_m: 0.005, growth_per_m: 0.004, most_m: 8.0 }
    }
}

impl TimeOfFlight {
    fn sigma_m(&self, range_m: f64) -> f64 {
        self.near_m + self.growth_per_m * range_m * range_m
    }

    /// Density of a right reading, 1/m, of a surface anywhere in a chord: the mean over points half a sigma apart at most.
    fn density(&self, reading: f64, enter: f64, exit: f64) -> f64 {
        let points = ((exit - enter) / (0.5 * self.sigma_m(enter))).ceil().clamp(1.0, 256.0);
        let at = |k: f64| {
            let range = enter + (k + 0.5) / points * (exit - enter);
            let sigma = self.sigma_m(range);
            let z = (reading - range) / sigma;
            (-0.5 * z * z).exp() / (sigma * std::f64::consts::TAU.sqrt())
        };
        (0..points as u32).map(|k| at(f64::from(k))).sum::<f64>() / points
    }
}

impl Kernel for TimeOfFlight {
    fn likelihood(&self, reading: f64, _bearing: f64, ranges: &[f64], likelihood: &mut [f64]) {
        for (chord, value) in ranges.windows(2).zip(likelihood) {
            *value = self.hit * self.density(reading, chord[0], chord[1]) + (1.0 - self.hit) / self.most_m;
        }
    }
}

// For rules that look at one cell at a time.
impl InverseModel for TimeOfFlight {
    fn correct_match(&self) -> f64 {
        self.hit
    }

    fn half_bin(&self, cell_m: f64) -> f64 {
        self.sigma_m(0.5 * self.most_m).max(0.5 * cell_m)
    }

    fn false_match_probability(&self, _reading: f64, half_width: f64) -> f64 {
        2.0 * half_width / self.most_m
    }
}

// Slower than with bounds, and no less exact.
impl FastKernel for TimeOfFlight {}

fn main() {
    let camera = TimeOfFlight::default();

    // The likelihoods of all readings of a surface add up to one.
    let mut likelihood = [0.0];
    let step = 1e-3;
    let all = (0..8000).map(|k| {
        camera.likelihood((f64::from(k) + 0.5) * step, 0.0, &[3.0, 3.05], &mut likelihood);
        likelihood[0] * step
    });
    assert!((all.sum::<f64>() - 1.0).abs() < 1e-6);

    // A corridor of one row of cells with a wall at 3 m, seen ten times.
    let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 80, height: 1 };
    let model = Model::new(grid, Arc::new(camera));
    for name in ["visibility", "conventional"] {
        let mut mapper = catalogue::find(name).expect("a mapper").mapper(&model);
        for k in 0..10 {
            mapper.integrate(&Scan {
                time_s: 0.1 * f64::from(k),
                pose: Pose { x_m: 0.0, y_m: 0.02, theta_rad: 0.0 },
                bearings_rad: vec![0.0; 2],
                readings: vec![Some(3.0 + 0.01 * (f64::from(k) - 4.5)), None],
                ..Scan::default()
            });
        }
        let map = mapper.occupancy();
        let wall = (59..62).map(|cell| map[cell]).fold(0.0, f64::max);
        println!("{name}: {:.3} at 1.5 m, {wall:.3} about the wall, {:.3} behind it", map[30], map[75]);
        assert!(map[30] < 0.02 && wall > 0.5 && map[75] > 0.05);
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn it_does_what_the_guide_says() {
        super::main();
    }
}
