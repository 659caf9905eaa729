use super::*;
use crate::model::Sensors;
use grid::GridSpec;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use sensor::{Laser, Stereo};
use std::sync::Arc;

fn news(repeats: Repeats) -> News {
    News { repeats, views: vec![View::default(); 2] }
}

/// Which of the readings are shown, scan after scan from the given poses.
fn shown(news: &mut News, sensor: &dyn SensorModel, scans: &[(Pose, f64)]) -> String {
    let take = |(pose, reading): &(Pose, f64)| {
        let scan = Scan { pose: *pose, bearings_rad: vec![0.1], readings: vec![Some(*reading)], ..Scan::default() };
        let mut readings = Vec::new();
        news.choose(sensor, &scan, &mut readings);
        if readings[0].is_some() { 'x' } else { '.' }
    };
    scans.iter().map(take).collect()
}

fn still(readings: &[f64]) -> Vec<(Pose, f64)> {
    readings.iter().map(|reading| (Pose::default(), *reading)).collect()
}

#[test]
fn a_run_counts_thrice_and_whatever_ends_it_is_news() {
    let stereo = Stereo::default();
    for (readings, expected, why) in [
        (&[5.0, 5.1, 4.8, 5.2, 5.0][..], "xxx..", "the same surface"),
        (&[5.0, 5.0, 5.0, 5.0, 20.0, 20.2, 5.0, 5.1], "xxx.xxxx", "somebody passes"),
        (&[0.0, 0.0, 0.0, 0.0, 8.0], "xxx.x", "no parallax, then something"),
        (&[5.0, 5.0, 5.0, 33.0, 5.0, 12.0, 5.0], "xxxxxxx", "false matches that are drawn afresh"),
    ] {
        assert_eq!(shown(&mut news(Repeats::CHOSEN), &stereo, &still(readings)), expected, "{why}");
    }
    let laser = Laser::default();
    for (readings, expected, why) in [
        (&[5.0, 5.02, 4.98, 5.01][..], "xxx.", "the same wall"),
        (&[5.0, 5.0, 5.0, 2.0, 5.0], "xxxxx", "somebody in front"),
        (&[5.0, 5.0, 5.0, 7.0, 7.0], "xxxxx", "a door opens"),
        (&[f64::INFINITY; 5], "xxx..", "nothing comes back, again and again"),
        (&[f64::INFINITY, f64::INFINITY, f64::INFINITY, 9.0, f64::INFINITY], "xxxxx", "something comes and goes"),
    ] {
        assert_eq!(shown(&mut news(Repeats::CHOSEN), &laser, &still(readings)), expected, "{why}");
    }
}

#[test]
fn a_view_ends_by_way_or_turn_and_not_by_jitter() {
    let (stereo, jitter) = (Stereo::default(), 0.1f64.to_radians());
    let at = |x_m: f64, theta_rad: f64| (Pose { x_m, y_m: 0.0, theta_rad }, 5.0);
    let standing: Vec<_> = (0..9).map(|k| at(0.002 * f64::from(k % 3 - 1), jitter * f64::from(k % 2))).collect();
    assert_eq!(shown(&mut news(Repeats::CHOSEN), &stereo, &standing), "xxx......");
    let driving: Vec<_> = (0..9).map(|k| at(0.05 * f64::from(k), 0.0)).collect();
    assert_eq!(shown(&mut news(Repeats::CHOSEN), &stereo, &driving), "xxxxxxxxx");
    let turning: Vec<_> = (0..9).map(|k| at(0.0, 0.03 * f64::from(k))).collect();
    assert_eq!(shown(&mut news(Repeats::CHOSEN), &stereo, &turning), "xxxxxxxxx");
    // A full turn is none.
    let round = [at(0.0, 0.0), at(0.0, 0.0), at(0.0, 0.0), at(0.0, std::f64::consts::TAU)];
    assert_eq!(shown(&mut news(Repeats::CHOSEN), &stereo, &round), "xxx.");
}

/// Noise alone hardly ever ends a run.
#[test]
fn fresh_noise_is_no_news() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut gaussian = || (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0;
    let stereo = Stereo::default();
    let readings: Vec<f64> = (0..5000).map(|_| 6.0 + stereo.disparity_sigma * gaussian()).collect();
    let taken = shown(&mut news(Repeats::CHOSEN), &stereo, &still(&readings)).matches('x').count();
    assert!((3..60).contains(&taken), "{taken}");
    let laser = Laser::default();
    let readings: Vec<f64> = (0..5000).map(|_| 6.0 + laser.range_sigma_m * gaussian()).collect();
    let taken = shown(&mut news(Repeats::CHOSEN), &laser, &still(&readings)).matches('x').count();
    assert!((3..60).contains(&taken), "{taken}");
}

#[test]
fn every_sensor_has_a_view_of_its_own_and_other_bearings_are_another_view() {
    let grid = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: 30, height: 20 };
    let sensors: Vec<Arc<dyn SensorModel>> = vec![Arc::new(Stereo::default()), Arc::new(Laser::default())];
    let model = Model { sensors: Sensors::new(sensors), ..Model::new(grid, Arc::new(Stereo::default())) };
    let mut news = news(Repeats::CHOSEN);
    let mut take = |sensor: usize, bearing: f64| {
        let scan = Scan { sensor, bearings_rad: vec![bearing], readings: vec![Some(2.0)], ..Scan::default() };
        let mut readings = Vec::new();
        news.choose(&**model.sensors.of(&scan), &scan, &mut readings);
        readings[0].is_some()
    };
    let taken: Vec<bool> = (0..4).flat_map(|_| [0, 1]).map(|sensor| take(sensor, 0.0)).collect();
    assert_eq!(taken, [true, true, true, true, true, true, false, false]);
    assert!(take(0, 0.2) && !take(1, 0.0));
}
