//! The conventional rule by many clamps at once.

use grid::{DigitalLine, Raster};
use mapper::{Conventional, ConventionalRule, Mapper as _, Model};
use sensor::Scan;

/// The maps of [`Conventional::for_sensors`] by rules that differ in their clamps alone, bit by bit. What a reading says of a
/// cell, which costs two error functions, does not depend on the clamps and is worked out once.
///
/// # Panics
/// If the bins differ.
pub fn maps<'a>(
    setup: &Model,
    rules: &[ConventionalRule],
    scans: impl IntoIterator<Item = &'a Scan>,
) -> Vec<Raster<f64>> {
    let Some(any) = rules.first() else { return Vec::new() };
    let bin = any.half_width.to_bits();
    assert!(rules.iter().all(|rule| rule.half_width.to_bits() == bin), "rules with one bin");
    let unseen = Conventional::with(setup, *any);
    // Cell by cell, the maps within.
    let mut occupancy: Vec<f64> =
        unseen.occupancy().values().iter().flat_map(|p| std::iter::repeat_n(*p, rules.len())).collect();
    let mut line = DigitalLine::default();
    let of_sensors: Vec<ConventionalRule> =
        setup.sensors.iter().map(|sensor| any.for_sensor(&**sensor, setup.grid.cell_m)).collect();
    let rays = scans.into_iter().flat_map(|scan| scan.rays().map(move |ray| (scan, ray)));
    for (scan, ray) in rays {
        let Some(reading) = ray.reading else { continue };
        let (sensor, any) = (setup.sensors.of(scan), &of_sensors[scan.sensor]);
        line.trace(&setup.grid, ray.origin_m, ray.direction, f64::INFINITY);
        for (k, &cell) in line.cells().iter().enumerate() {
            let (enter, exit) = (line.ranges()[k], line.ranges()[k + 1]);
            let likelihoods = any.likelihoods(&**sensor, reading, ray.bearing_rad, enter, exit);
            let Some(likelihoods) = likelihoods else { break };
            let maps = &mut occupancy[cell * rules.len()..][..rules.len()];
            maps.iter_mut().zip(rules).for_each(|(p, rule)| *p = rule.update(*p, likelihoods));
        }
    }
    let map = |number| Raster::new(setup.grid, occupancy.iter().skip(number).step_by(rules.len()).copied().collect());
    (0..rules.len()).map(map).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use grid::GridSpec;
    use mapper::{EPSILON, Sensors};
    use sensor::{Laser, Pose, SensorModel, Stereo};

    use super::*;

    #[test]
    fn maps_are_those_of_the_mapper_bit_by_bit() {
        let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 60, height: 40 };
        let setup = Model::new(grid, Arc::new(Stereo::default()));
        let scan = |k: i32| Scan {
            sensor: 0,
            time_s: 0.0,
            pose: Pose { x_m: 0.1 * f64::from(k), y_m: 1.0, theta_rad: 0.05 * f64::from(k) },
            bearings_rad: (-9..=9).map(|b| 0.08 * f64::from(b)).collect(),
            readings: (-9..=9).map(|b| (b != 3).then(|| 9.0 + 0.7 * f64::from((b * b + k) % 11))).collect(),
        };
        let scans: Vec<Scan> = (0..12).map(scan).collect();
        let clamps = [[EPSILON, 1.0 - EPSILON], [0.05, 0.5], [0.2, 0.97]];
        for half_width in [0.2, 1.0] {
            let rules = clamps.map(|clamp| ConventionalRule { half_width, clamp });
            for (map, rule) in maps(&setup, &rules, &scans).iter().zip(rules) {
                let mut mapper = Conventional::with(&setup, rule);
                scans.iter().for_each(|scan| mapper.integrate(scan));
                let bits = |map: &Raster<f64>| map.values().iter().map(|p| p.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(map), bits(mapper.occupancy()), "{rule:?}");
            }
            let maps = maps(&setup, &rules, &scans);
            assert!(maps[0].values() != maps[1].values() && maps[1].values() != maps[2].values(), "clamps are reached");
        }
        assert!(maps(&setup, &[], &scans).is_empty());
    }

    /// A bin of so many pixels is the same share of another sensor's.
    #[test]
    fn every_sensor_has_its_own_bin() {
        let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 60, height: 40 };
        let sensors: Vec<Arc<dyn SensorModel>> = vec![Arc::new(Stereo::default()), Arc::new(Laser::default())];
        let setup = Model { sensors: Sensors::new(sensors), ..Model::new(grid, Arc::new(Stereo::default())) };
        let scan = |k: usize| Scan {
            sensor: k % 2,
            time_s: 0.0,
            pose: Pose { x_m: 0.1 * k as f64, y_m: 1.0, theta_rad: 0.05 * k as f64 },
            bearings_rad: (-9..=9).map(|b| 0.08 * f64::from(b)).collect(),
            readings: vec![Some(if k.is_multiple_of(2) { 9.0 } else { 1.6 }); 19],
        };
        let scans: Vec<Scan> = (0..12).map(scan).collect();
        let rule = ConventionalRule { half_width: 0.2, clamp: [0.01, 0.9] };
        let mut mapper = Conventional::for_sensors(&setup, rule);
        scans.iter().for_each(|scan| mapper.integrate(scan));
        assert_eq!(maps(&setup, &[rule], &scans), [mapper.occupancy().clone()]);
        assert_ne!(Conventional::with(&setup, rule).occupancy(), mapper.occupancy(), "something is seen");
    }
}
