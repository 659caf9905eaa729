use super::*;
use crate::belief::prior::Prior;
use crate::catalogue::{Kind, MAPPERS};
use crate::model::Sensors;
use crate::rules::conventional::{Conventional, ConventionalRule};
use grid::GridSpec;
use proptest::prelude::*;
use sensor::{Laser, Pose, Stereo};
use std::sync::Arc;

const PRIOR: f64 = 0.1;

fn model(sensors: Vec<Arc<dyn SensorModel>>) -> Model {
    let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 60, height: 40 };
    let prior = Prior { occupancy: PRIOR, ..Prior::default() };
    Model { prior, sensors: Sensors::new(sensors), ..Model::new(grid, Arc::new(Stereo::default())) }
}

fn both() -> Model {
    model(vec![Arc::new(Stereo::default()), Arc::new(Laser { max_range_m: 8.0, ..Laser::default() })])
}

fn scan(sensor: usize, x_m: f64, theta_rad: f64, ranges_m: &[f64]) -> Scan {
    let bearings_rad: Vec<f64> = (0..ranges_m.len()).map(|k| 0.1 * k as f64 - 0.2).collect();
    let stereo = Stereo::default();
    let read = |(range, bearing): (&f64, &f64)| if sensor == 0 { stereo.disparity(*range, *bearing) } else { *range };
    let readings = ranges_m.iter().zip(&bearings_rad).map(|pair| Some(read(pair))).collect();
    Scan { sensor, time_s: 0.0, pose: Pose { x_m, y_m: 1.0, theta_rad }, bearings_rad, readings }
}

fn scans() -> impl Strategy<Value = Vec<Scan>> {
    let one = (0usize..2, 0.3f64..2.5, -3.0f64..3.0, prop::collection::vec(0.3f64..2.5, 1..6));
    prop::collection::vec(
        one.prop_map(|(sensor, x_m, theta_rad, ranges_m)| scan(sensor, x_m, theta_rad, &ranges_m)),
        0..12,
    )
}

/// `p / (1 - p)` of every rule by hand.
#[test]
fn cells_by_hand() {
    let odds = |p: f64| p / (1.0 - p);
    let pooled = odds(0.6) * odds(0.3) / odds(PRIOR);
    assert!((pool(PRIOR, &[0.6, 0.3]) - pooled / (1.0 + pooled)).abs() < 1e-12);
    assert!((pool(PRIOR, &[PRIOR, 0.3]) - 0.3).abs() < 1e-12, "who knows nothing changes nothing");
    let is = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-15, "{found} and {expected}");
    is(maximum(PRIOR, &[0.02, 0.3]), 0.3);
    is(maximum(PRIOR, &[0.02, PRIOR]), 0.02);
    is(maximum(PRIOR, &[PRIOR, PRIOR]), PRIOR);
    let [camera, laser] = [false, true];
    is(of_miura(PRIOR, &[0.7, 0.01], &[camera, laser]), 0.7);
    is(of_miura(PRIOR, &[0.01, 0.7], &[camera, laser]), 0.7);
    is(of_miura(PRIOR, &[0.4, 0.01], &[camera, laser]), 0.01);
    is(of_miura(PRIOR, &[0.01, 0.4], &[camera, laser]), pool(PRIOR, &[0.01, 0.4]));
    is(of_miura(PRIOR, &[0.01, 0.05], &[camera, camera]), pool(PRIOR, &[0.01, 0.05]));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    /// Cells that are judged each by itself lose nothing by maps of their own: Bayes' rule multiplies the same likelihoods. What a second sensor costs the
    /// conventional rule is therefore the rule's, not that of how sensors are put together.
    #[test]
    fn the_conventional_map_is_the_pool_of_the_maps_of_its_sensors(scans in scans()) {
        let model = both();
        let loose = ConventionalRule { half_width: 0.5, ..ConventionalRule::default() };
        let mut one = Conventional::for_sensors(&model, loose);
        let build = |model: &Model| Box::new(Conventional::for_sensors(model, loose)) as Box<dyn Mapper>;
        let mut apart = PerSensor::new(&model, Fusion::Pool, &build);
        let within = |map: &Raster<f64>| map.values().iter().all(|p| (1e-5..1.0 - 1e-5).contains(p));
        for scan in &scans {
            one.integrate(scan);
            apart.integrate(scan);
            // Clamps are no part of Bayes' rule.
            prop_assume!(within(one.occupancy()) && within(apart.maps[scan.sensor].occupancy()));
        }
        for (cell, p) in one.occupancy().values().iter().enumerate() {
            prop_assert!((log_odds(*p) - log_odds(apart.occupancy()[cell])).abs() < 1e-6, "{cell}");
        }
    }

    /// The order of sensors does not matter, one sensor is its own map, and cells are the same one by one.
    #[test]
    fn fusion_is_of_sensors_in_any_order(scans in scans()) {
        let mut sensors: Vec<_> = both().sensors.iter().cloned().collect();
        sensors.reverse();
        let swapped = model(sensors);
        for fusion in [Fusion::Pool, Fusion::Maximum, Fusion::Miura] {
            let build = |model: &Model| Box::new(Conventional::new(model)) as Box<dyn Mapper>;
            let (mut there, mut back) = (PerSensor::new(&both(), fusion, &build), PerSensor::new(&swapped, fusion, &build));
            let mut alone = PerSensor::new(&model(vec![Arc::new(Stereo::default())]), fusion, &build);
            let mut plain = Conventional::new(&both());
            for scan in &scans {
                there.integrate(scan);
                back.integrate(&Scan { sensor: 1 - scan.sensor, ..scan.clone() });
                if scan.sensor == 0 {
                    alone.integrate(scan);
                    plain.integrate(scan);
                }
            }
            for cell in 0..there.occupancy().values().len() {
                let p = there.occupancy()[cell];
                prop_assert!((p - back.occupancy()[cell]).abs() < 1e-12);
                prop_assert_eq!(p.to_bits(), there.occupied(cell).to_bits());
            }
            prop_assert_eq!(alone.occupancy(), plain.occupancy());
        }
    }
}

/// Each sensor is mapped by itself: what is in the catalogue says so of all that keep maps apart.
#[test]
fn a_sensor_that_reads_nothing_changes_nothing() {
    let names = ["visibility-pool", "visibility-maximum", "octomap-maximum", "miura-2002"];
    for entry in MAPPERS.iter().filter(|entry| names.contains(&entry.name)) {
        assert_eq!(entry.kind, Kind::Online);
        let (mut one, mut two) = ((entry.build)(&model(vec![Arc::new(Stereo::default())])), (entry.build)(&both()));
        for scan in [scan(0, 0.5, 0.1, &[1.0, 1.1, 0.8]), scan(0, 0.9, 0.3, &[1.0, 0.9])] {
            one.integrate(&scan);
            two.integrate(&scan);
        }
        let cells = one.occupancy().values().iter().zip(two.occupancy().values());
        let most = cells.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(most < 1e-6, "{}: {most}", entry.name);
    }
    assert_eq!(MAPPERS.iter().filter(|entry| names.contains(&entry.name)).count(), names.len());
}
