use super::*;
use proptest::prelude::*;
use sensor::{Laser, Pose, Sonar};
use std::sync::Arc;

fn grid() -> GridSpec {
    GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 80, height: 80 }
}

fn scan(sensor: usize, theta_rad: f64, readings: &[f64]) -> Scan {
    let bearings_rad = (0..readings.len()).map(|k| 0.7 * k as f64).collect();
    let pose = Pose { x_m: 1.52, y_m: 1.77, theta_rad };
    Scan { sensor, time_s: 0.0, pose, bearings_rad, readings: readings.iter().map(|r| Some(*r)).collect() }
}

fn sonar(width_rad: f64) -> (Model, Sonar) {
    let sonar = Sonar { width_rad, ..Sonar::default() };
    (Model::new(grid(), Arc::new(sonar)), sonar)
}

/// Every cell of the map asked about by itself, with probabilities in the place of log odds.
fn cell_by_cell(map: &mut [f64], scan: &Scan, sonar: &Sonar) {
    let spec = grid();
    for ray in scan.rays() {
        let Some(range_m) = ray.reading.filter(|range| range.is_finite()) else { continue };
        let error_m = (2.0 * sonar.range_sigma_m).max(0.05 / std::f64::consts::SQRT_2);
        let polar = |cell: usize| {
            let middle = spec.centre(cell);
            let [x, y] = [middle[0] - ray.origin_m[0], middle[1] - ray.origin_m[1]];
            let range = (x * x + y * y).sqrt();
            let angle = ((x * ray.direction[0] + y * ray.direction[1]) / range).clamp(-1.0, 1.0).acos();
            (range, angle, 1.0 - (2.0 * angle / sonar.width_rad).powi(2))
        };
        let inside = |cell: &usize| polar(*cell).1 <= 0.5 * sonar.width_rad;
        let near_m = range_m - error_m;
        for cell in (0..spec.cells()).filter(inside).filter(|cell| polar(*cell).0 < near_m) {
            let (range, _, across) = polar(cell);
            let empty = sonar.hit * (1.0 - (range / near_m).powi(2)) * across;
            let odds = map[cell] / (1.0 - map[cell]) * (1.0 - empty) / (1.0 + empty);
            map[cell] = odds / (1.0 + odds);
        }
        let arc: Vec<usize> = (0..spec.cells())
            .filter(inside)
            .filter(|cell| (near_m..=range_m + error_m).contains(&polar(*cell).0))
            .collect();
        let share = |cell: &usize| {
            let (range, _, across) = polar(*cell);
            (1.0 - ((range - range_m) / error_m).powi(2)) * across * (2.0 * map[*cell]).min(1.0)
        };
        let shares: Vec<f64> = arc.iter().map(share).collect();
        let all: f64 = shares.iter().sum();
        for (cell, share) in arc.into_iter().zip(shares) {
            let occupied = if all > 0.0 { sonar.hit * share / all } else { 0.0 };
            let odds = map[cell] / (1.0 - map[cell]) * (1.0 + occupied) / (1.0 - occupied);
            map[cell] = odds / (1.0 + odds);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn it_is_the_profile_cell_by_cell(
        width_rad in 0.2f64..2.5, turns in prop::collection::vec(0.0f64..6.3, 1..4),
        readings in prop::collection::vec(prop_oneof![8 => 0.05f64..4.0, 1 => Just(f64::INFINITY)], 1..4),
    ) {
        let (model, sonar) = sonar(width_rad);
        let mut mapper = SonarProfiles::new(&model);
        let mut expected = vec![0.5; grid().cells()];
        for turn in turns {
            let scan = scan(0, turn, &readings);
            mapper.integrate(&scan);
            cell_by_cell(&mut expected, &scan, &sonar);
        }
        for (cell, (found, expected)) in mapper.occupancy().values().iter().zip(&expected).enumerate() {
            // What nothing has reached is the prior, and even odds by the profile.
            let reached = (expected - 0.5).abs() > 1e-9;
            prop_assert!(!reached || (found - expected.clamp(EPSILON, 1.0 - EPSILON)).abs() < 1e-6, "{cell}: {found} {expected}");
        }
    }
}

/// One reading: free before it and freest on the axis, an arc that is somewhere occupied and nowhere surely, and nothing behind.
#[test]
fn an_arc_is_somewhere_occupied() {
    let (model, sonar) = sonar(0.5);
    let mut mapper = SonarProfiles::new(&model);
    mapper.integrate(&scan(0, 0.0, &[1.5]));
    let at = |x: f64, y: f64| mapper.occupancy()[grid().locate([1.52 + x, 1.77 + y]).expect("inside")];
    assert!(at(0.5, 0.0) < 0.25 && at(0.5, 0.0) < at(0.5, 0.1), "{} {}", at(0.5, 0.0), at(0.5, 0.1));
    assert!(at(0.5, 0.0) < at(1.2, 0.0) && at(1.2, 0.0) < 0.5);
    assert!(at(1.5, 0.0) > 0.5 && at(1.5, 0.0) < 0.6, "{}", at(1.5, 0.0));
    assert!((at(1.7, 0.0) - model.prior.marginal()).abs() < 1e-12, "behind the arc");
    let of_arc: f64 = mapper.occupancy().values().iter().filter(|p| **p > 0.5).map(|p| 2.0 * p - 1.0).sum();
    assert!((of_arc - sonar.hit).abs() < 1e-9, "the parts of the arc add up to P(T): {of_arc}");
}

/// No echo is left out, and a sensor outside the map changes nothing.
#[test]
fn what_says_nothing_changes_nothing() {
    let (model, _) = sonar(0.5);
    let mut mapper = SonarProfiles::new(&model);
    mapper.integrate(&scan(0, 0.0, &[f64::INFINITY]));
    mapper.integrate(&Scan { pose: Pose { x_m: -0.1, y_m: 1.0, theta_rad: 0.0 }, ..scan(0, 0.0, &[1.0]) });
    assert!(mapper.occupancy().values().iter().all(|p| (p - model.prior.marginal()).abs() < 1e-15));
    assert_eq!(mapper.work().cells, 0);
}

/// A beam is the axis of a cone.
#[test]
fn a_beam_clears_its_cells_and_marks_the_last() {
    let mut mapper = SonarProfiles::new(&Model::new(grid(), Arc::new(Laser::default())));
    mapper.integrate(&scan(0, 0.0, &[1.0]));
    let p = |x: f64| mapper.occupancy()[grid().locate([1.52 + x, 1.77]).expect("inside")];
    assert!(p(0.3) < 0.2 && p(1.0) > 0.6 && (p(1.2) - 0.1).abs() < 1e-12, "{} {}", p(0.3), p(1.0));
}
