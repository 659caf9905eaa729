use std::path::Path;

use super::*;
use crate::{Scene, World, drive, simulate};

const QUIET: Odometry = Odometry {
    noise: OdometryNoise::NONE,
    bias_m_per_m: 0.0,
    bias_rad_per_rad: 0.0,
    bias_rad_per_m: 0.0,
    slips_per_m: 0.0,
    slip_m: 0.05,
    slip_rad: 0.03,
};

/// A square of 2 m, driven in steps of 0.1 m with turns of 9 degrees, a stand at its start, and 1 m back.
fn square() -> Vec<Pose> {
    let mut poses = vec![Pose { x_m: 1.0, y_m: 1.0, theta_rad: 0.3 }; 3];
    let mut go = |distance_m: f64, turn_rad: f64| {
        let step = Step { first_turn_rad: 0.0, distance_m, second_turn_rad: turn_rad };
        poses.push(step.end(poses[poses.len() - 1]));
    };
    for _ in 0..4 {
        (0..20).for_each(|_| go(0.1, 0.0));
        (0..10).for_each(|_| go(0.0, 9f64.to_radians()));
    }
    (0..10).for_each(|_| go(-0.1, 0.0));
    poses
}

fn measured(odometry: Odometry, seed: u64) -> Pose {
    let measured = odometry.measure(&square(), seed);
    assert_eq!(measured.len(), square().len());
    measured[measured.len() - 1]
}

fn off(odometry: Odometry, seed: u64) -> [f64; 2] {
    let (end, truth) = (measured(odometry, seed), square()[square().len() - 1]);
    [libm::hypot(end.x_m - truth.x_m, end.y_m - truth.y_m), end.theta_rad - truth.theta_rad]
}

#[test]
fn odometry_without_an_error_is_the_drive() {
    for (measured, driven) in QUIET.measure(&square(), 1).iter().zip(&square()) {
        assert!((measured.x_m - driven.x_m).abs() < 1e-9 && (measured.y_m - driven.y_m).abs() < 1e-9);
        assert!((measured.theta_rad - driven.theta_rad).abs() < 1e-9, "headings go on beyond a revolution");
    }
    assert!(QUIET.measure(&[], 1).is_empty());
}

#[test]
fn every_bias_shows_as_it_is_defined() {
    // 360 degrees are turned in all, 8 m driven on and 1 m back.
    let turned = off(Odometry { bias_rad_per_rad: 0.02, ..QUIET }, 1)[1];
    assert!((turned - 0.02 * 360f64.to_radians()).abs() < 1e-9, "{turned}");
    let curved = off(Odometry { bias_rad_per_m: 0.01, ..QUIET }, 1)[1];
    assert!((curved - 0.01 * 7.0).abs() < 1e-9, "a way back turns the other way: {curved}");
    let long = Odometry { bias_m_per_m: 0.05, ..QUIET }.measure(&square(), 1);
    let side = libm::hypot(long[22].x_m - long[2].x_m, long[22].y_m - long[2].y_m);
    assert!((side - 2.1).abs() < 1e-9, "{side}");
}

/// 400 drives straight on: the spread of what is measured, and the mean and number of slips.
#[test]
fn noise_and_slips_are_as_many_and_as_large_as_asked_for() {
    let straight: Vec<Pose> = (0..101).map(|k| Pose { x_m: 0.1 * f64::from(k), y_m: 0.0, theta_rad: 0.0 }).collect();
    let spread = |odometry: Odometry| -> Vec<[f64; 2]> {
        let end = |seed| odometry.measure(&straight, seed)[100];
        (0..400).map(|seed| [end(seed).x_m - 10.0, end(seed).theta_rad]).collect()
    };
    let moments = |values: Vec<f64>| {
        let mean = values.iter().sum::<f64>() / 400.0;
        (mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 400.0).sqrt())
    };
    let noise = OdometryNoise { m_per_m: 0.1, ..OdometryNoise::NONE };
    let (mean, deviation) = moments(spread(Odometry { noise, ..QUIET }).iter().map(|v| v[0]).collect());
    // A hundred steps, each of 0.1 m with a deviation of 0.01 m.
    assert!(mean.abs() < 0.02 && (deviation - 0.1).abs() < 0.015, "{mean} {deviation}");
    let noise = OdometryNoise { rad_per_m: 0.05, ..OdometryNoise::NONE };
    let (mean, deviation) = moments(spread(Odometry { noise, ..QUIET }).iter().map(|v| v[1]).collect());
    // Two turns a step, each with a deviation of 0.005 rad.
    assert!(mean.abs() < 0.015 && (deviation - 0.05 * 2f64.sqrt()).abs() < 0.01, "{mean} {deviation}");
    // Two slips in 10 m, of 0.05 m in the mean; a compound Poisson sum has variance 2 x 2 x 0.05^2.
    let slips = Odometry { slips_per_m: 0.2, slip_rad: 0.0, ..QUIET };
    let (mean, deviation) = moments(spread(slips).iter().map(|v| v[0]).collect());
    assert!((mean - 0.1).abs() < 0.02 && (deviation - 0.1).abs() < 0.02, "{mean} {deviation}");
    let without = spread(slips).iter().filter(|v| v[0].abs() < 1e-12).count() as f64 / 400.0;
    assert!((without - (-2f64).exp()).abs() < 0.07, "{without}");
    let (mean, deviation) =
        moments(spread(Odometry { slip_m: 0.0, slip_rad: 0.1, ..slips }).iter().map(|v| v[1]).collect());
    assert!(mean.abs() < 0.03 && (deviation - 0.1 * 2f64.sqrt()).abs() < 0.03, "{mean} {deviation}");
}

#[test]
fn a_seed_fixes_it_and_a_robot_that_stands_measures_nothing() {
    let odometry = Odometry { slips_per_m: 1.0, ..Odometry::default() };
    assert_eq!(odometry.measure(&square(), 5), odometry.measure(&square(), 5));
    assert_ne!(odometry.measure(&square(), 5), odometry.measure(&square(), 6));
    assert!(odometry.measure(&square(), 5)[..3].iter().all(|pose| *pose == square()[0]));
    assert!(off(odometry, 5)[0] > 1e-3);
}

const ROOM: &str = r#"
name = "test"
bounds = { min = [0.0, 0.0], max = [6.0, 4.0] }
waypoints = { A = [1.0, 1.0], B = [3.0, 1.0], C = [3.0, 3.0] }
route.stops = ["A", { at = "B", wait_s = 2.0 }, "C"]
camera.columns = 30
robot = { jitter_m = 0.01 }
[[box]]
center = [5.0, 2.0]
size = [0.4, 3.0]
"#;

fn simulated(text: &str) -> crate::Simulation {
    let scene = Scene::parse(text, Path::new("test.toml"), None).expect("a valid scene");
    let drive = drive(&scene).expect("a free way");
    simulate(&scene, &World::new(&scene), &drive, 7)
}

#[test]
fn a_scene_with_odometry_reads_what_it_read_without() {
    let without = simulated(ROOM);
    assert!(without.scans.iter().all(|scan| scan.odometry.is_none()));
    for section in ["[odometry]\n", "[odometry]\nslips_per_m = 2.0\nbias_deg_per_m = 1.0\ndeg_per_deg = 0.2\n"] {
        let mut with = simulated(&format!("{ROOM}{section}"));
        let first = with.scans[0].odometry.expect("of this scene");
        assert_eq!(first, with.scans[0].scan.pose, "it begins at the true pose");
        let last = with.scans[with.scans.len() - 1].clone();
        assert_ne!(last.odometry, Some(last.scan.pose));
        with.scans.iter_mut().for_each(|scan| scan.odometry = None);
        assert_eq!(with, without);
    }
}

#[test]
fn the_section_says_degrees_and_is_silent_about_the_standard_case() {
    let odometry = |section: &str| {
        let scene = Scene::parse(&format!("{ROOM}{section}"), Path::new("test.toml"), None).expect("a valid scene");
        scene.odometry
    };
    assert_eq!(odometry(""), None);
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{a} {b}");
    let silent = odometry("[odometry]\n").expect("given");
    close(silent.noise.rad_per_rad, OdometryNoise::STANDARD.rad_per_rad);
    close(silent.noise.rad_per_m, OdometryNoise::STANDARD.rad_per_m);
    close(silent.noise.m_per_m, OdometryNoise::STANDARD.m_per_m);
    close(silent.noise.m_per_rad, OdometryNoise::STANDARD.m_per_rad);
    close(silent.slip_rad, 2f64.to_radians());
    let said = odometry(
        "[odometry]\ndeg_per_deg = 0.1\ndeg_per_m = 3.0\nm_per_m = 0.2\nm_per_deg = 0.001\nbias_deg_per_deg = 0.01\n\
         bias_deg_per_m = -0.5\nbias_m_per_m = 0.02\nslips_per_m = 0.1\nslip_m = 0.3\nslip_deg = 4.0\n",
    );
    let said = said.expect("given");
    close(said.noise.rad_per_rad, 0.1);
    close(said.noise.rad_per_m, 3f64.to_radians());
    close(said.noise.m_per_m, 0.2);
    close(said.noise.m_per_rad, 0.001 * 180.0 / std::f64::consts::PI);
    close(said.bias_rad_per_rad, 0.01);
    close(said.bias_rad_per_m, -(0.5f64.to_radians()));
    close(said.bias_m_per_m, 0.02);
    close(said.slips_per_m, 0.1);
    close(said.slip_m, 0.3);
    close(said.slip_rad, 4f64.to_radians());
}
