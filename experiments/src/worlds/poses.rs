//! Poses that are wrong: what mappers are told of where the sensor stood, in place of the truth.

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use rand_distr::StandardNormal;
use scene::{Drive, Odometry, Simulation};
use score::Alignment;
use sensor::{OdometryNoise, Pose};

/// Random stream of the errors that are fresh at every scan, far from those of readings and odometry.
const FRESH: u64 = u64::MAX - (4 << 32);

/// How wrong recorded poses are. By the same seed errors are the same multiples of these numbers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WrongPoses {
    /// Standard deviation of x and of y, fresh at every scan, m.
    pub sigma_m: f64,
    /// Standard deviation of the heading, fresh at every scan, rad.
    pub sigma_rad: f64,
    /// Poses drift as odometry does whose noise is this many times the standard one ([`OdometryNoise::STANDARD`]).
    pub drift: f64,
}

impl WrongPoses {
    /// Poses as they are recorded.
    pub const NONE: Self = Self { sigma_m: 0.0, sigma_rad: 0.0, drift: 0.0 };

    /// Whether there is no error.
    pub fn is_none(&self) -> bool {
        self.sigma_m <= 0.0 && self.sigma_rad <= 0.0 && self.drift <= 0.0
    }

    /// Puts wrong poses in the place of those that a drive's scans have. Readings stay.
    pub fn mistake(&self, simulation: &mut Simulation, drive: &Drive, seed: u64) {
        if self.is_none() {
            return;
        }
        let driven: Vec<Pose> = drive.poses.iter().map(|timed| timed.pose).collect();
        let odometry = Odometry { noise: OdometryNoise::STANDARD.scaled(self.drift), ..Odometry::default() };
        let drifted = if self.drift > 0.0 { odometry.measure(&driven, seed) } else { driven.clone() };
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(FRESH);
        let mut fresh = |sigma: f64| sigma * rng.sample::<f64, _>(StandardNormal);
        for (scan, (drifted, driven)) in simulation.scans.iter_mut().zip(drifted.iter().zip(&driven)) {
            let mut pose = scan.scan.pose;
            pose.x_m += drifted.x_m - driven.x_m + fresh(self.sigma_m);
            pose.y_m += drifted.y_m - driven.y_m + fresh(self.sigma_m);
            pose.theta_rad += drifted.theta_rad - driven.theta_rad + fresh(self.sigma_rad);
            scan.move_to(pose);
        }
    }
}

/// Moves the poses of all scans as an alignment moves a map.
pub fn moved(simulation: &mut Simulation, by: &Alignment) {
    let (sin, cos) = libm::sincos(by.turn_rad);
    for scan in &mut simulation.scans {
        let mut pose = scan.scan.pose;
        let [x, y] = [pose.x_m - by.pivot_m[0], pose.y_m - by.pivot_m[1]];
        pose.x_m = by.pivot_m[0] + by.shift_m[0] + cos * x - sin * y;
        pose.y_m = by.pivot_m[1] + by.shift_m[1] + sin * x + cos * y;
        pose.theta_rad += by.turn_rad;
        scan.move_to(pose);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    use crate::worlds::ground::Ground;
    use scene::Scene;

    const ROOM: &str = r#"
name = "test"
bounds = { min = [0.0, 0.0], max = [6.0, 4.0] }
waypoints = { A = [1.0, 1.0], B = [5.0, 1.0], C = [5.0, 3.0], D = [1.0, 3.0] }
route.stops = ["A", "B", "C", "D", "A"]
camera.columns = 4
robot.scan_interval = 0.1
grid.cell = 0.5
"#;

    fn ground() -> Ground {
        Ground::new(Scene::parse(ROOM, Path::new("test.toml"), None).expect("valid"), 0.1).expect("a way")
    }

    /// The poses' errors in x, y and heading.
    fn errors(wrong: WrongPoses, seed: u64) -> Vec<[f64; 3]> {
        let ground = ground();
        let mut simulation = scene::simulate(&ground.scene, &ground.world, &ground.drive, seed);
        let readings = simulation.clone();
        wrong.mistake(&mut simulation, &ground.drive, seed);
        let of = |k: usize| (&simulation.scans[k].scan, &readings.scans[k].scan, ground.drive.poses[k].pose);
        let error = |k: usize| {
            let (scan, as_read, driven) = of(k);
            assert_eq!((&scan.readings, scan.time_s), (&as_read.readings, as_read.time_s));
            [scan.pose.x_m - driven.x_m, scan.pose.y_m - driven.y_m, scan.pose.theta_rad - driven.theta_rad]
        };
        (0..simulation.scans.len()).map(error).collect()
    }

    fn zero(value: f64) -> bool {
        value.abs() < f64::MIN_POSITIVE
    }

    #[test]
    fn without_an_error_poses_are_those_recorded_to_the_bit() {
        assert!(errors(WrongPoses::NONE, 3).iter().flatten().all(|error| zero(*error)));
    }

    #[test]
    fn fresh_errors_have_the_spread_asked_for_and_scale_with_it() {
        let wrong = WrongPoses { sigma_m: 0.05, sigma_rad: 0.02, drift: 0.0 };
        let (once, twice) = (errors(wrong, 3), errors(WrongPoses { sigma_m: 0.1, sigma_rad: 0.04, ..wrong }, 3));
        let n = once.len() as f64;
        assert!(n > 250.0, "{n}");
        for (part, sigma) in [0.05, 0.05, 0.02].into_iter().enumerate() {
            let deviation = (once.iter().map(|error| error[part].powi(2)).sum::<f64>() / n).sqrt();
            assert!((deviation / sigma - 1.0).abs() < 4.0 / (2.0 * n).sqrt(), "{part}: {deviation}");
            let follow = once.windows(2).map(|pair| pair[0][part] * pair[1][part]).sum::<f64>() / n;
            assert!(follow.abs() < 4.0 * sigma * sigma / n.sqrt(), "each is fresh: {part} {follow}");
            assert!(once.iter().zip(&twice).all(|(a, b)| (2.0 * a[part] - b[part]).abs() < 1e-12));
        }
        assert_ne!(once, errors(wrong, 4));
    }

    #[test]
    fn drift_grows_along_the_drive_and_is_what_odometry_measures() {
        let wrong = WrongPoses { drift: 1.0, ..WrongPoses::NONE };
        let rms = |at: usize| {
            let of = |seed| errors(wrong, seed)[at][..2].iter().map(|e| e * e).sum::<f64>();
            ((0..20).map(of).sum::<f64>() / 20.0).sqrt()
        };
        let last = errors(wrong, 0).len() - 1;
        assert!(
            zero(rms(0)) && rms(last / 4) > 0.0 && rms(last) > 2.0 * rms(last / 8),
            "{} {}",
            rms(last / 8),
            rms(last)
        );
        let driven: Vec<Pose> = ground().drive.poses.iter().map(|timed| timed.pose).collect();
        let measured = Odometry::default().measure(&driven, 5)[last];
        let [x, y, turn] = errors(wrong, 5)[last];
        assert!(
            (driven[last].x_m + x - measured.x_m).abs() < 1e-9 && (driven[last].y_m + y - measured.y_m).abs() < 1e-9
        );
        assert!((driven[last].theta_rad + turn - measured.theta_rad).abs() < 1e-9);
    }

    #[test]
    fn poses_move_as_maps_do() {
        let by = Alignment { pivot_m: [1.0, 2.0], shift_m: [0.5, -0.25], turn_rad: 0.3, at_bound: false };
        let ground = ground();
        let mut simulation = scene::simulate(&ground.scene, &ground.world, &ground.drive, 1);
        moved(&mut simulation, &by);
        for (scan, timed) in simulation.scans.iter().zip(&ground.drive.poses) {
            let [x, y] = timed.pose.position_m();
            let spec = grid::GridSpec { cell_m: 1.0, origin_m: [x, y], width: 1, height: 1 };
            let there = by.of(&grid::Frame::straight(spec));
            assert!((scan.scan.pose.x_m - there.spec.origin_m[0]).abs() < 1e-12);
            assert!((scan.scan.pose.y_m - there.spec.origin_m[1]).abs() < 1e-12);
            assert!((scan.scan.pose.theta_rad - timed.pose.theta_rad - there.yaw_rad).abs() < 1e-12);
        }
    }
}
