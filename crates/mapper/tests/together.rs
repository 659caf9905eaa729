//! Readings of several sensors at one time are one scan.

use std::sync::Arc;

use grid::GridSpec;
use mapper::{Dynamic, FastVisibility, Mapper, Model, PairwiseGrid, Renewal, Sensors, Visibility, moments};
use proptest::prelude::*;
use sensor::{Laser, Pose, Scan, SensorModel, Stereo};

fn grid() -> GridSpec {
    GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 90, height: 70 }
}

fn model(sensors: Vec<Arc<dyn SensorModel>>) -> Model {
    Model { sensors: Sensors::new(sensors), ..Model::new(grid(), Arc::new(Stereo::default())) }
}

/// Numbers from 0 to 1, the same for the same seed.
fn numbers(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Readings up to `most` of a fan of rays from somewhere on the map.
fn scan(sensor: usize, time_s: f64, most: f64, value: &mut impl FnMut() -> f64) -> Scan {
    let pose = Pose { x_m: 4.4 * value(), y_m: 3.4 * value(), theta_rad: 7.0 * value() };
    let bearings_rad: Vec<f64> = (0..30).map(|k| 0.03 * (f64::from(k) - 14.5)).collect();
    let readings = (0..30).map(|_| Some(most * value()).filter(|_| value() > 0.1)).collect();
    Scan { sensor, time_s, pose, bearings_rad, readings }
}

/// Every second ray of a scan, as another sensor's.
fn dealt(scan: &Scan) -> [Scan; 2] {
    [0, 1].map(|sensor| {
        let every_second = |values: &[f64]| values.iter().skip(sensor).step_by(2).copied().collect();
        let readings = scan.readings.iter().skip(sensor).step_by(2).copied().collect();
        Scan { sensor, bearings_rad: every_second(&scan.bearings_rad), readings, ..scan.clone() }
    })
}

fn difference(a: &PairwiseGrid, b: &PairwiseGrid) -> f64 {
    let spec = *a.spec();
    let joints = (0..spec.cells()).flat_map(|cell| spec.neighbours(cell).map(move |n| (cell, n.cell)));
    let joints = joints.map(|(low, high)| (a.joint(low, high).ee - b.joint(low, high).ee).abs());
    let cells = (0..spec.cells()).map(|cell| (a.marginals()[cell] - b.marginals()[cell]).abs());
    cells.chain(joints).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(30))]

    #[test]
    fn odd_and_even_beams_as_two_sensors_are_the_sensor(seed: u64) {
        let stereo = || Arc::new(Stereo::default()) as Arc<dyn SensorModel>;
        let (one, two) = (model(vec![stereo()]), model(vec![stereo(), stereo()]));
        let references: [fn(&Model) -> Visibility; 2] = [Visibility::exact, Visibility::independent];
        for kind in references {
            let (mut whole, mut parts) = (kind(&one), kind(&two));
            let mut value = numbers(seed);
            for number in 0..3 {
                let scan = scan(0, f64::from(number), 30.0, &mut value);
                whole.integrate(&scan);
                parts.integrate_together(&dealt(&scan));
                let found = difference(whole.pairs(), parts.pairs());
                prop_assert!(found < 1e-12, "{found}");
                parts.set_pairs(whole.pairs().clone());
            }
        }
        // Which rays are followed in lockstep decides where they are cut.
        let dynamic = |model: &Model| FastVisibility::dynamic(model, Renewal::CHOSEN);
        let fast: [&dyn Fn(&Model) -> FastVisibility; 3] =
            [&FastVisibility::visibility, &FastVisibility::independent, &dynamic];
        for kind in fast {
            let (mut whole, mut parts, mut threaded) = (kind(&one), kind(&two), kind(&two));
            let scan = scan(0, 0.0, 30.0, &mut numbers(seed));
            whole.integrate_on(&scan, 1);
            parts.integrate_together_on(&dealt(&scan), 1);
            threaded.integrate_together_on(&dealt(&scan), 3);
            let found = difference(&whole.pairs(), &parts.pairs());
            prop_assert!(found < 1e-5, "{found}");
            prop_assert!(parts.pairs() == threaded.pairs(), "to the bit, whatever the threads");
        }
    }

    /// A camera and a laser that stand in different places.
    #[test]
    fn sensors_apart_are_reconciled_as_the_reference_does(seed: u64, threads in 1usize..4) {
        let model = model(vec![Arc::new(Stereo::default()), Arc::new(Laser { max_range_m: 6.0, ..Laser::default() })]);
        let (mut fast, mut reference) = (FastVisibility::visibility(&model), Visibility::exact(&model));
        let renewal = Renewal::CHOSEN;
        let (mut moving, mut eager) = (FastVisibility::dynamic(&model, renewal), Dynamic::new(&model, renewal));
        let mut value = numbers(seed);
        let scans = [scan(0, 0.0, 30.0, &mut value), scan(1, 0.0, 5.0, &mut value)];
        fast.integrate_together_on(&scans, threads);
        reference.integrate_together(&scans);
        let found = difference(&fast.pairs(), reference.pairs());
        prop_assert!(found < 1e-5, "{found}");
        moving.integrate_together_on(&scans, threads);
        eager.integrate_together(&scans);
        let found = difference(&moving.pairs(), eager.pairs());
        prop_assert!(found < 1e-5, "{found}");
    }
}

#[test]
fn moments_are_scans_of_several_sensors_at_one_time() {
    let scan = |&(sensor, time_s): &(usize, f64)| Scan { sensor, time_s, ..Scan::default() };
    let lengths = |of: &[(usize, f64)]| {
        let scans: Vec<Scan> = of.iter().map(scan).collect();
        moments(&scans).map(<[Scan]>::len).collect::<Vec<_>>()
    };
    assert_eq!(lengths(&[(0, 1.0), (1, 1.0), (0, 2.0), (1, 2.5)]), [2, 1, 1]);
    assert_eq!(lengths(&[(0, 1.0), (0, 1.0), (1, 1.0)]), [1, 2], "a sensor reads one thing at a time");
    assert_eq!(lengths(&[(1, 1.0), (0, 1.0), (2, 1.0)]), [1, 2]);
    assert_eq!(lengths(&[]), [0; 0]);
}

/// Rays of a scan are averaged, scans multiply: what two sensors see at one time is no news twice.
#[test]
fn one_after_the_other_counts_more_than_together() {
    let stereo = || Arc::new(Stereo::default()) as Arc<dyn SensorModel>;
    let two = model(vec![stereo(), stereo()]);
    let look = Scan {
        pose: Pose { x_m: 0.5, y_m: 1.0, theta_rad: 0.0 },
        bearings_rad: vec![0.0],
        readings: vec![Some(20.0)],
        ..Scan::default()
    };
    let scans = [look.clone(), Scan { sensor: 1, ..look.clone() }];
    let (mut once, mut together, mut in_turn) =
        (FastVisibility::visibility(&two), FastVisibility::visibility(&two), FastVisibility::visibility(&two));
    once.integrate(&look);
    together.integrate_together(&scans);
    scans.iter().for_each(|scan| in_turn.integrate(scan));
    let free = grid().locate([0.9, 1.0]).expect("inside");
    let [once, together, in_turn] = [&once, &together, &in_turn].map(|mapper| mapper.occupancy()[free]);
    // Not the same as once: with two rays the least squares ask less of the edges beside them.
    assert!(once - together < 0.4 * (once - in_turn) && in_turn < together, "{once} {together} {in_turn}");
}
