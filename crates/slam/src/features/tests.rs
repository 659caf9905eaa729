//! Oracles: dense algebra, differences, sums over lattices.

use nalgebra::{DMatrix, DVector, Matrix2, Matrix2x3, Matrix3, Vector2, Vector3};
use proptest::prelude::*;
use rand_distr::StandardNormal;
use sensor::{Camera, FeatureCamera, FeatureReading, Matcher, OdometryNoise, Pose, Step, wrapped_rad};

use super::association::Candidate;
use super::landmark::{Landmark, noise, vector};
use super::map::{Map, Meant};
use super::options::Association;
use super::proposal::{Belief, Measured};
use crate::random::stream;

fn camera() -> FeatureCamera {
    let matcher = Matcher { detection_rate: 0.9, ..Matcher::default() };
    FeatureCamera::of(&Camera { columns: 200, field_of_view_rad: 1.2 }, &matcher)
}

fn pose(x_m: f64, y_m: f64, theta_rad: f64) -> Pose {
    Pose { x_m, y_m, theta_rad }
}

fn reading(bearing_rad: f64, disparity_px: f64) -> FeatureReading {
    FeatureReading { bearing_rad, disparity_px, identity: None }
}

fn landmark(from: Pose, bearing_rad: f64, disparity_px: f64) -> Landmark {
    Landmark::first(0, &camera(), from, &reading(bearing_rad, disparity_px), 0.0)
}

prop_compose! {
    /// A landmark before the camera that first saw it, and another camera before which it lies too.
    fn view()(x in -3.0f64..3.0, y in -3.0f64..3.0, theta in -3.0f64..3.0, bearing in -0.5f64..0.5, disparity in 1.5f64..20.0,
              ahead in -0.5f64..0.5, left in -0.4f64..0.4, turn in -0.4f64..0.4) -> (Landmark, Pose) {
        let anchor = pose(x, y, theta);
        let depth = 15.0 / disparity;
        let (sin, cos) = theta.sin_cos();
        let (a, b) = (ahead * depth, left * depth);
        (landmark(anchor, bearing, disparity), pose(x + cos * a - sin * b, y + sin * a + cos * b, theta + turn))
    }
}

proptest! {
    #[test]
    fn a_landmark_is_expected_where_its_place_is_seen((landmark, from) in view()) {
        let camera = camera();
        let (at, _) = landmark.place(&camera);
        let seen = camera.expected(from, at).expect("in front");
        let expected = landmark.expected(&camera, from).expect("in front").reading;
        prop_assert!((expected.x - seen[0]).abs() < 1e-9 && (expected.y / seen[1] - 1.0).abs() < 1e-9);
    }

    #[test]
    fn derivatives_are_those_of_differences((landmark, from) in view()) {
        let camera = camera();
        let expected = landmark.expected(&camera, from).expect("in front");
        let difference = |landmark: [&Landmark; 2], from: [Pose; 2], step: f64| {
            let at = |k: usize| landmark[k].expected(&camera, from[k]).expect("in front").reading;
            (at(1) - at(0)) / (2.0 * step)
        };
        let near = |a: Vector2<f64>, b: Vector2<f64>| (a - b).norm() < 1e-5 * (1.0 + b.norm());
        const STEP: f64 = 1e-6;
        for k in 0..2 {
            let moved = |by: f64| { let mut other = landmark; other.mean[k] += by; other };
            let found = difference([&moved(-STEP), &moved(STEP)], [from; 2], STEP);
            prop_assert!(near(expected.by_landmark.column(k).into(), found), "{found} {:?}", expected.by_landmark);
        }
        let moved = |k: usize, by: f64| match k {
            0 => Pose { x_m: from.x_m + by, ..from },
            1 => Pose { y_m: from.y_m + by, ..from },
            _ => Pose { theta_rad: from.theta_rad + by, ..from },
        };
        for k in 0..3 {
            let found = difference([&landmark; 2], [moved(k, -STEP), moved(k, STEP)], STEP);
            prop_assert!(near(expected.by_pose.column(k).into(), found), "{found} {:?}", expected.by_pose);
        }
    }

    /// The textbook's formulas in nalgebra's dense algebra, on a covariance that a few updates have made.
    #[test]
    fn the_update_is_that_of_dense_algebra((mut landmark, from) in view(), off in prop::array::uniform2(-2.0f64..2.0)) {
        let camera = camera();
        for _ in 0..2 {
            let expected = landmark.expected(&camera, from).expect("in front");
            let reading = expected.reading + Vector2::new(off[0] * camera.bearing_sigma_rad, off[1] * 0.5);
            let dense = |m: &Matrix2<f64>| DMatrix::from_column_slice(2, 2, m.as_slice());
            let (h, p, r) = (dense(&expected.by_landmark), dense(&landmark.covariance), dense(&noise(&camera)));
            let s = &h * &p * h.transpose() + r;
            let gain = &p * h.transpose() * s.clone().lu().try_inverse().expect("positive");
            let innovation = DVector::from_column_slice((reading - expected.reading).as_slice());
            let mean = DVector::from_column_slice(landmark.mean.as_slice()) + &gain * innovation;
            let covariance = (DMatrix::identity(2, 2) - &gain * &h) * &p;
            landmark.take(&camera, &expected, reading);
            for k in 0..2 {
                prop_assert!((landmark.mean[k] - mean[k]).abs() <= 1e-12 * mean.amax().max(1.0));
                for j in 0..2 {
                    let scale = (p[(j, j)] * p[(k, k)]).sqrt();
                    prop_assert!((landmark.covariance[(j, k)] - covariance[(j, k)]).abs() <= 1e-12 * scale.max(1.0));
                }
            }
            prop_assume!(landmark.mean.y > 0.5);
        }
    }

    /// Readings one after the other are all at once: errors and landmarks stacked in one dense state, whose landmarks are then left out.
    #[test]
    fn the_proposal_is_the_joint_posterior(
        by in prop::collection::vec(prop::array::uniform6(-1.0f64..1.0), 1..5), off in prop::collection::vec(prop::array::uniform2(-1.0f64..1.0), 5),
    ) {
        let camera = camera();
        let candidate = Candidate::of(0, &landmark(Pose::default(), 0.1, 6.0), &camera, pose(0.1, 0.0, 0.05)).expect("in front");
        let n = by.len();
        let scale = Matrix2::new(0.01, 0.0, 0.0, 0.5);
        let h: Vec<Matrix2x3<f64>> = by.iter().map(|row| scale * Matrix2x3::from_row_slice(row)).collect();
        let z: Vec<Vector2<f64>> = off[..n].iter().map(|z| scale * Vector2::new(z[0], z[1])).collect();
        let mut belief = Belief::ODOMETRY;
        for (h, z) in h.iter().zip(&z) {
            // What is left of the reading beside where the ones before have put the errors.
            belief.take(&candidate, h, z - h * belief.mean);
        }
        let size = 3 + 2 * n;
        let mut prior = DMatrix::<f64>::identity(size, size);
        let mut by_all = DMatrix::<f64>::zeros(2 * n, size);
        let mut r = DMatrix::<f64>::zeros(2 * n, 2 * n);
        let mut all = DVector::<f64>::zeros(2 * n);
        for k in 0..n {
            prior.view_mut((3 + 2 * k, 3 + 2 * k), (2, 2)).copy_from(&candidate.landmark.covariance);
            by_all.view_mut((2 * k, 0), (2, 3)).copy_from(&h[k]);
            by_all.view_mut((2 * k, 3 + 2 * k), (2, 2)).copy_from(&candidate.expected.by_landmark);
            r.view_mut((2 * k, 2 * k), (2, 2)).copy_from(&noise(&camera));
            all.rows_mut(2 * k, 2).copy_from(&z[k]);
        }
        let s = &by_all * &prior * by_all.transpose() + r;
        let gain = &prior * by_all.transpose() * s.lu().try_inverse().expect("positive");
        let mean = &gain * all;
        let covariance = (DMatrix::identity(size, size) - &gain * &by_all) * &prior;
        for k in 0..3 {
            prop_assert!((belief.mean[k] - mean[k]).abs() < 1e-10, "{} {mean}", belief.mean);
            for j in 0..3 {
                prop_assert!((belief.covariance[(j, k)] - covariance[(j, k)]).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn the_errors_lead_to_the_motion_models_poses(step in prop::array::uniform3(-0.5f64..0.5), e in prop::array::uniform3(-2.0f64..2.0)) {
        let (last, noise) = (pose(1.0, -2.0, 0.7), OdometryNoise::STANDARD);
        let step = Step { first_turn_rad: step[0], distance_m: step[1], second_turn_rad: step[2] };
        let (measured, e) = (Measured::new(step, &noise), Vector3::from(e));
        let sigmas = noise.sigmas(&step);
        let driven = Step {
            first_turn_rad: step.first_turn_rad + sigmas[0] * e.x,
            distance_m: step.distance_m + sigmas[1] * e.y,
            second_turn_rad: step.second_turn_rad + sigmas[2] * e.z,
        };
        prop_assert_eq!(measured.pose(last, e), driven.end(last));
        let found = measured.derivative(last, e);
        for k in 0..3 {
            let at = |by: f64| { let mut e = e; e[k] += by; measured.pose(last, e) };
            let (a, b) = (at(-1e-5), at(1e-5));
            let difference = Vector3::new(b.x_m - a.x_m, b.y_m - a.y_m, wrapped_rad(b.theta_rad - a.theta_rad)) / 2e-5;
            prop_assert!((found.column(k) - difference).norm() < 1e-8, "{k} {found} {difference}");
        }
    }

    #[test]
    fn a_draw_is_weighed_by_the_motion_model_over_the_proposal(a in prop::array::uniform6(-0.6f64..0.6), seed in 0u64..1000) {
        let factor = Matrix3::new(0.5, 0.0, 0.0, a[0], 0.7, 0.0, a[1], a[2], 0.4);
        let belief = Belief { mean: Vector3::new(a[3], a[4], a[5]), covariance: factor * factor.transpose() };
        let (drawn, log_ratio) = belief.draw(&mut stream(seed, 0, 0));
        let off = drawn - belief.mean;
        let inverse = belief.covariance.try_inverse().expect("positive");
        let log_q = -0.5 * (off.transpose() * inverse * off)[0] - 0.5 * belief.covariance.determinant().ln();
        prop_assert!((log_ratio - (-0.5 * drawn.norm_squared() - log_q)).abs() < 1e-9);
    }
}

/// One landmark, seen from poses that are known: its posterior by a sum over a fine lattice, without any linearisation.
#[test]
fn one_landmark_from_known_poses_is_the_exact_posterior() {
    let camera = camera();
    let truth = [6.0, 0.7];
    let mut random = stream(5, 0, 0);
    let mut map = Map::default();
    let mut looks: Vec<(Pose, [f64; 2])> = Vec::new();
    for k in 0..25 {
        let from = pose(0.1 * f64::from(k), 0.02 * f64::from(k), 0.01 * f64::from(k));
        let expected = camera.expected(from, truth).expect("in front");
        let mut normal = || rand::RngExt::sample::<f64, _>(&mut random, StandardNormal);
        let seen = [expected[0] + camera.bearing_sigma_rad * normal(), expected[1] + 0.5 * normal()];
        let taken = map.take(&camera, &Association::default(), from, &[reading(seen[0], seen[1])]);
        assert_eq!(taken.landmarks, [if k == 0 { Meant::New(0) } else { Meant::Landmark(0) }]);
        looks.push((from, seen));
    }
    let found = map.landmarks()[0];
    let sigma = [found.covariance[(0, 0)].sqrt(), found.covariance[(1, 1)].sqrt()];
    let (mut sum, mut mean, mut square) = (0.0, Vector2::zeros(), Matrix2::zeros());
    for i in -60..=60 {
        for j in -60..=60 {
            let off = Vector2::new(0.1 * f64::from(i) * sigma[0], 0.1 * f64::from(j) * sigma[1]);
            let mut point = found;
            point.mean += off;
            let log: f64 = looks
                .iter()
                .map(|(from, seen)| {
                    let expected = point.expected(&camera, *from).expect("in front").reading;
                    let [a, b] = [(seen[0] - expected.x) / camera.bearing_sigma_rad, (seen[1] - expected.y) / 0.5];
                    -0.5 * (a * a + b * b)
                })
                .sum();
            let best: f64 = looks.len() as f64;
            let weight = (log + best).exp();
            sum += weight;
            mean += weight * off;
            square += weight * off * off.transpose();
        }
    }
    mean /= sum;
    let covariance = square / sum - mean * mean.transpose();
    for k in 0..2 {
        assert!((mean[k] / sigma[k]).abs() < 0.05, "off by {} standard deviations", mean[k] / sigma[k]);
        assert!((covariance[(k, k)].sqrt() / sigma[k] - 1.0).abs() < 0.03, "{covariance} {}", found.covariance);
    }
}

/// A landmark is doubted where it should have been seen, and nowhere else.
#[test]
fn what_should_have_been_seen_and_was_not_is_deleted() {
    let camera = camera();
    let rules = Association::default();
    let ghost = |map: &mut Map| map.take(&camera, &rules, Pose::default(), &[reading(0.1, 6.0)]);
    let looks = |rules: &Association, from: Pose, readings: &[FeatureReading]| {
        let mut map = Map::default();
        ghost(&mut map);
        for _ in 0..4 {
            map.take(&camera, rules, from, readings);
        }
        map.landmarks().iter().any(|landmark| landmark.number == 0)
    };
    assert!(!looks(&rules, Pose::default(), &[]), "in full view");
    assert!(looks(&Association { negative_evidence: false, ..rules }, Pose::default(), &[]), "not asked");
    assert!(looks(&rules, pose(0.0, 0.0, 1.5), &[]), "out of the field of view");
    assert!(looks(&rules, pose(0.4, 0.0, 0.0), &[]), "from elsewhere, where a wall may hide it");
    assert!(!looks(&Association { vantage_m: f64::INFINITY, ..rules }, pose(0.4, 0.0, 0.0), &[]), "in the open");
    assert!(looks(&rules, Pose::default(), &[reading(0.1, 20.0)]), "behind something");
    assert!(!looks(&rules, Pose::default(), &[reading(0.45, 20.0)]), "beside something");
    assert!(!looks(&rules, Pose::default(), &[reading(0.1, 2.0)]), "before something");
    assert!(looks(&rules, Pose::default(), &[reading(0.1, 6.1)]), "seen again");
}

#[test]
fn a_reading_before_a_known_landmark_is_rather_a_failed_match() {
    let camera = camera();
    let rules = Association::default();
    let mut map = Map::default();
    for _ in 0..5 {
        map.take(&camera, &rules, Pose::default(), &[reading(0.1, 6.0)]);
    }
    map.take(&camera, &rules, Pose::default(), &[reading(0.1, 3.0), reading(-0.2, 3.0)]);
    let odds: Vec<f64> = map.landmarks().iter().map(|landmark| landmark.log_odds).collect();
    assert_eq!(odds.len(), 3);
    assert!(odds[1] < -0.5 && odds[2] > -0.5, "{odds:?}");
    assert!(vector(&reading(0.1, 3.0)).y > 2.0);
}

#[test]
fn what_is_too_far_for_a_depth_makes_no_landmark() {
    let (camera, mut map) = (camera(), Map::default());
    let taken = map.take(&camera, &Association::default(), Pose::default(), &[reading(0.1, 0.9), reading(0.1, 1.1)]);
    assert_eq!(taken.landmarks, [Meant::Nothing, Meant::New(0)]);
}
