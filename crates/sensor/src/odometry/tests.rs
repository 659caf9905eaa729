use std::f64::consts::{FRAC_PI_2, PI};

use proptest::prelude::*;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng as _};

use super::*;

fn pose(x_m: f64, y_m: f64, theta_rad: f64) -> Pose {
    Pose { x_m, y_m, theta_rad }
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

#[test]
fn a_way_on_and_a_way_back() {
    let on = Step::between(pose(1.0, 1.0, FRAC_PI_2), pose(1.0, 3.0, FRAC_PI_2 + 0.2));
    assert!(close(on.first_turn_rad, 0.0) && close(on.distance_m, 2.0) && close(on.second_turn_rad, 0.2), "{on:?}");
    let back = Step::between(pose(1.0, 1.0, FRAC_PI_2), pose(1.0, -1.0, FRAC_PI_2 + 0.2));
    assert!(close(back.first_turn_rad, 0.0) && close(back.distance_m, -2.0), "{back:?}");
    assert!(close(back.second_turn_rad, 0.2), "{back:?}");
    let spot = Step::between(pose(1.0, 1.0, 3.0), pose(1.0, 1.0, -3.0));
    assert!(close(spot.first_turn_rad, 0.0) && close(spot.distance_m, 0.0), "{spot:?}");
    assert!(close(spot.second_turn_rad, 2.0 * PI - 6.0), "the short way round: {spot:?}");
}

proptest! {
    #[test]
    fn a_step_leads_from_one_pose_to_the_other(
        (x, y, theta) in (-9.0..9.0f64, -9.0..9.0f64, -7.0..7.0f64),
        (u, v, phi) in (-9.0..9.0f64, -9.0..9.0f64, -7.0..7.0f64),
    ) {
        let step = Step::between(pose(x, y, theta), pose(u, v, phi));
        let there = step.end(pose(x, y, theta));
        prop_assert!((there.x_m - u).abs() < 1e-12 && (there.y_m - v).abs() < 1e-12);
        prop_assert!(wrapped_rad(there.theta_rad - phi).abs() < 1e-12);
        prop_assert!(step.first_turn_rad.abs() <= FRAC_PI_2 && step.second_turn_rad.abs() <= PI);
    }

    #[test]
    fn a_step_does_not_depend_on_the_frame(
        (x, y, theta) in (-9.0..9.0f64, -9.0..9.0f64, -3.0..3.0f64),
        (d, a, b) in (prop_oneof![-3.0..-0.01f64, 0.01..3.0f64], -1.5..1.5f64, -1.5..1.5f64),
    ) {
        let step = Step { first_turn_rad: a, distance_m: d, second_turn_rad: b };
        let from = pose(x, y, theta);
        let again = Step::between(from, step.end(from));
        prop_assert!((again.first_turn_rad - a).abs() < 1e-9, "{:?} {:?}", again, step);
        prop_assert!((again.distance_m - d).abs() < 1e-9 && (again.second_turn_rad - b).abs() < 1e-9);
    }

    #[test]
    fn an_angle_is_wrapped_by_whole_turns(angle in -1e3..1e3f64) {
        let wrapped = wrapped_rad(angle);
        prop_assert!(wrapped > -PI && wrapped <= PI);
        let turns = (angle - wrapped) / (2.0 * PI);
        prop_assert!((turns - turns.round()).abs() < 1e-12);
    }
}

#[test]
fn the_ends_of_the_circle() {
    assert!(close(wrapped_rad(PI), PI) && close(wrapped_rad(-PI), PI) && close(wrapped_rad(3.0 * PI), PI));
    assert!(close(wrapped_rad(0.5), 0.5));
}

#[test]
fn the_standard_case_is_what_it_says() {
    let degrees = |rad: f64| rad.to_degrees();
    let straight = OdometryNoise::STANDARD.sigmas(&Step { distance_m: 1.0, ..Step::default() });
    assert!(close(straight[1], 0.1) && close(degrees(straight[0]), 1.0) && close(degrees(straight[2]), 1.0));
    let spot = OdometryNoise::STANDARD.sigmas(&Step { second_turn_rad: FRAC_PI_2, ..Step::default() });
    assert!(close(degrees(spot[0] + spot[2]), 5.0), "{spot:?}");
}

/// A robot that turns on the spot, whose odometry rounds its position to a micrometre somewhere beside it.
#[test]
fn rounding_of_a_turn_on_the_spot_is_no_turn_of_a_quarter() {
    let [still, rounded] = [pose(0.0, 0.0, 0.1), pose(-1e-6, 1e-6, 0.1)].map(|to| {
        let step = Step::between(pose(0.0, 0.0, 0.0), to);
        OdometryNoise::STANDARD.sigmas(&step)
    });
    for (a, b) in still.iter().zip(rounded) {
        assert!((a - b).abs() < 1e-6, "{still:?} {rounded:?}");
    }
}

/// Means, standard deviations and correlations of 100,000 steps, each within four standard errors.
#[test]
fn samples_have_the_moments_of_the_model() {
    let noise = OdometryNoise { rad_per_rad: 0.1, rad_per_m: 0.02, m_per_m: 0.05, m_per_rad: 0.03 };
    let measured = Step { first_turn_rad: 0.4, distance_m: -0.8, second_turn_rad: -0.7 };
    // Sums of squares, written out once more.
    let sigma = [
        (0.04f64.powi(2) + 0.016f64.powi(2)).sqrt(),
        (0.04f64.powi(2) + 0.012f64.powi(2) + 0.021f64.powi(2)).sqrt(),
        (0.07f64.powi(2) + 0.016f64.powi(2)).sqrt(),
    ];
    let n = 100_000;
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let z: Vec<[f64; 3]> = (0..n)
        .map(|_| {
            let step = noise.sample(&measured, &mut rng);
            [
                (step.first_turn_rad - 0.4) / sigma[0],
                (step.distance_m + 0.8) / sigma[1],
                (step.second_turn_rad + 0.7) / sigma[2],
            ]
        })
        .collect();
    let mean = |of: &dyn Fn(&[f64; 3]) -> f64| z.iter().map(of).sum::<f64>() / f64::from(n);
    let error = 1.0 / f64::from(n).sqrt();
    for i in 0..3 {
        assert!(mean(&|z| z[i]).abs() < 4.0 * error, "mean of part {i}");
        assert!((mean(&|z| z[i] * z[i]) - 1.0).abs() < 4.0 * 2.0f64.sqrt() * error, "variance of part {i}");
        assert!(mean(&|z| z[i] * z[(i + 1) % 3]).abs() < 4.0 * error, "part {i} and the next");
    }
}

/// The density of a fine lattice of steps adds up to one, and its mean logarithm over samples is minus the entropy.
#[test]
fn the_density_is_that_of_the_samples() {
    let noise = OdometryNoise { rad_per_rad: 0.1, rad_per_m: 0.02, m_per_m: 0.05, m_per_rad: 0.03 };
    let measured = Step { first_turn_rad: 0.4, distance_m: 0.8, second_turn_rad: 3.1 };
    let sigmas = noise.sigmas(&measured);
    let offsets: Vec<f64> = (-30..=30).map(|k| 0.2 * f64::from(k)).collect();
    let mut total = 0.0;
    for a in &offsets {
        for d in &offsets {
            for b in &offsets {
                let driven = Step {
                    first_turn_rad: measured.first_turn_rad + a * sigmas[0],
                    distance_m: measured.distance_m + d * sigmas[1],
                    // Beyond pi as it stands: the same turn on the circle.
                    second_turn_rad: wrapped_rad(measured.second_turn_rad + b * sigmas[2]),
                };
                total += noise.log_density(&driven, &measured).exp();
            }
        }
    }
    total *= sigmas.iter().product::<f64>() * 0.2f64.powi(3);
    assert!((total - 1.0).abs() < 1e-6, "{total}");

    let n = 100_000;
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mean =
        (0..n).map(|_| noise.log_density(&noise.sample(&measured, &mut rng), &measured)).sum::<f64>() / f64::from(n);
    let entropy: f64 = sigmas.iter().map(|sigma| (sigma * (2.0 * PI * std::f64::consts::E).sqrt()).ln()).sum();
    // Half a chi square of three degrees of freedom has variance 3/2.
    assert!((mean + entropy).abs() < 4.0 * (1.5 / f64::from(n)).sqrt(), "{mean} {entropy}");
}

#[test]
fn without_noise_only_what_was_measured_is_possible() {
    let measured = Step { first_turn_rad: 0.4, distance_m: 0.8, second_turn_rad: 0.1 };
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let drawn = OdometryNoise::NONE.sample(&measured, &mut rng);
    assert!(close(drawn.distance_m, 0.8) && close(drawn.first_turn_rad, 0.4) && close(drawn.second_turn_rad, 0.1));
    assert!(close(OdometryNoise::NONE.log_density(&drawn, &measured), 0.0));
    let other = Step { distance_m: 0.81, ..measured };
    assert!(OdometryNoise::NONE.log_density(&other, &measured).is_infinite());
}

#[test]
fn what_is_no_standard_deviation_is_named() {
    assert_eq!(OdometryNoise::STANDARD.check(), Ok(()));
    for value in [-0.1, f64::NAN, f64::INFINITY] {
        let error = OdometryNoise { m_per_m: value, ..OdometryNoise::NONE }.check().expect_err("no deviation");
        assert_eq!(error.name, "m_per_m");
        assert!(error.to_string().contains(&value.to_string()), "{error}");
    }
}
