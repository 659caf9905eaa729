//! The filter against what can be known exactly.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::worlds::{COARSE, Exact, likelihoods, prior, room, seen, small, way};
use mapper::{FastVisibility, Mapper as _, Model};
use rand::RngExt as _;
use sensor::{OdometryNoise, Pose, Scan, Step};
use slam::{Motion, Options, Proposal, Slam, Weight};

/// Where the odometry measures a step, one of three was driven.
struct OneOfThree;

impl OneOfThree {
    /// How likely each is, and by how much it is off along the way, m, and in its last turn, rad.
    const MOVES: [(f64, f64, f64); 3] = [(0.5, 0.0, 0.0), (0.3, -0.6, 0.0), (0.2, 0.0, 0.7)];

    fn driven(step: &Step, which: usize) -> Step {
        let (_, along_m, turn_rad) = Self::MOVES[which];
        Step { distance_m: step.distance_m + along_m, second_turn_rad: step.second_turn_rad + turn_rad, ..*step }
    }
}

impl Motion for OneOfThree {
    fn draw(&self, measured: &Step, random: &mut rand_chacha::ChaCha8Rng) -> Step {
        let share: f64 = random.random();
        let which = if share < 0.5 {
            0
        } else if share < 0.8 {
            1
        } else {
            2
        };
        Self::driven(measured, which)
    }

    fn sigmas(&self, _measured: &Step) -> [f64; 3] {
        [0.3, 0.1, 0.3]
    }
}

/// Four scans of the small world, and the odometry of each: along its lower row, and up.
fn scans() -> Vec<(Scan, Pose)> {
    let odometry = [(0.4, 0.5, 0.0), (1.1, 0.5, 0.0), (1.8, 0.5, 0.3), (2.3, 0.7, 1.2)];
    let readings = [
        [Some(1.7), Some(2.0), Some(1.0), Some(f64::INFINITY)],
        [Some(1.3), Some(1.1), Some(0.8), Some(2.1)],
        [Some(0.6), Some(1.5), Some(1.1), None],
        [Some(1.4), Some(0.4), Some(1.8), Some(0.9)],
    ];
    let scan = |((x_m, y_m, theta_rad), readings): ((f64, f64, f64), [Option<f64>; 4])| {
        let odometry = Pose { x_m, y_m, theta_rad };
        let bearings_rad = vec![0.0, 0.8, 1.6, 2.4];
        (Scan { sensor: 0, time_s: x_m, pose: odometry, bearings_rad, readings: readings.to_vec() }, odometry)
    };
    odometry.into_iter().zip(readings).map(scan).collect()
}

/// The posterior of all 27 ways: the sum over all worlds of what each way and world make of all scans.
fn exact() -> Vec<f64> {
    let scans = scans();
    let way = |number: usize| {
        let (mut poses, mut p) = (vec![scans[0].1], 1.0);
        for k in 1..scans.len() {
            let which = number / 3usize.pow(k as u32 - 1) % 3;
            let step = Step::between(scans[k - 1].1, scans[k].1);
            p *= OneOfThree::MOVES[which].0;
            poses.push(OneOfThree::driven(&step, which).end(poses[k - 1]));
        }
        let mut worlds: Vec<f64> = (0..512).map(prior).collect();
        for (pose, (scan, _)) in poses.iter().zip(&scans) {
            let likelihoods = likelihoods(&Scan { pose: *pose, ..scan.clone() });
            worlds.iter_mut().zip(likelihoods).for_each(|(p, likelihood)| *p *= likelihood);
        }
        let inside = poses.iter().all(|pose| small().locate(pose.position_m()).is_some());
        if inside { p * worlds.iter().sum::<f64>() } else { 0.0 }
    };
    let ways: Vec<f64> = (0..27).map(way).collect();
    let sum: f64 = ways.iter().sum();
    ways.into_iter().map(|p| p / sum).collect()
}

/// What the filter says of the 27 ways.
fn filtered(particles: usize, seed: u64) -> Vec<f64> {
    let model = Model::new(small(), Arc::new(COARSE));
    let options = Options {
        particles,
        seed,
        weight: Weight::Evidence { beams: 4, power: 1.0 },
        proposal: Proposal::Odometry,
        update_move_m: 0.0,
        update_turn_rad: 0.0,
        ..Options::default()
    };
    let mut filter = Slam::new(Box::new(Exact::new()), &model, Arc::new(OneOfThree), options).expect("valid");
    let scans = scans();
    for (scan, odometry) in &scans {
        filter.take(scan, *odometry).expect("each updates");
    }
    let mut ways = vec![0.0; 27];
    for (path, weight) in filter.paths() {
        let number: usize = (1..scans.len())
            .map(|k| {
                let step = Step::between(scans[k - 1].1, scans[k].1);
                let off = |which: &usize| {
                    let end = OneOfThree::driven(&step, *which).end(path[k - 1]);
                    (end.x_m - path[k].x_m).hypot(end.y_m - path[k].y_m) + (end.theta_rad - path[k].theta_rad).abs()
                };
                let which = (0..3).min_by(|a, b| off(a).total_cmp(&off(b))).expect("three");
                which * 3usize.pow(k as u32 - 1)
            })
            .sum();
        ways[number] += weight;
    }
    ways
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    0.5 * a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>()
}

#[test]
fn the_filter_converges_to_the_posterior_of_ways_that_enumeration_gives() {
    let exact = exact();
    let likely = exact.iter().filter(|p| **p > 0.01).count();
    assert!(likely >= 5 && exact.iter().all(|p| *p < 0.8), "there is something to tell apart: {exact:?}");
    let mean = |particles: usize, seeds: u64| {
        (0..seeds).map(|seed| apart(&exact, &filtered(particles, seed))).sum::<f64>() / seeds as f64
    };
    let [few, many] = [mean(20, 20), mean(1500, 3)];
    // Of N draws from n ways the distance is some sqrt(n / 2 pi N); resampling adds to it.
    assert!(many < 0.06, "{many}");
    assert!(few > 2.5 * many, "{few} {many}");
}

#[test]
fn one_particle_with_exact_odometry_is_the_mapper_to_the_bit() {
    let model = room();
    let options = Options {
        particles: 1,
        proposal: Proposal::Odometry,
        update_move_m: 0.0,
        update_turn_rad: 0.0,
        ..Options::default()
    };
    let mut alone = FastVisibility::visibility(&model);
    let unseen = Box::new(FastVisibility::visibility(&model));
    let mut filter = Slam::new(unseen, &model, Arc::new(OdometryNoise::NONE), options).expect("valid");
    let poses = way(40);
    for (k, pose) in poses.iter().enumerate() {
        let scan = seen(*pose, k);
        alone.integrate(&scan);
        filter.take(&Scan { pose: Pose::default(), ..scan }, *pose).expect("each updates");
    }
    let outcome = filter.finish();
    let bits = |map: &grid::Raster<f64>| map.values().iter().map(|p| p.to_bits()).collect::<Vec<_>>();
    assert!(bits(alone.occupancy()) == bits(outcome.map.occupancy()));
    assert_eq!(Some(alone.pairs()), outcome.map.pairwise());
    assert!(outcome.trajectory.iter().map(|(_, pose)| pose).eq(&poses));
}

/// Evidence by the chain rule: ray after ray, each given those before it, is the scan's.
#[test]
fn the_evidence_of_rays_in_turn_is_that_of_the_scan_and_the_product_over_rays_is_not() {
    let mut map = Exact::new();
    let mut off = BTreeMap::new();
    for (number, (scan, _)) in scans().iter().enumerate() {
        let one = |k: usize| Scan {
            bearings_rad: vec![scan.bearings_rad[k]],
            readings: vec![scan.readings[k]],
            ..scan.clone()
        };
        let whole = map.evidence(scan).expect("inside");
        let alone: f64 = (0..4).map(|k| map.evidence(&one(k)).expect("inside")).sum();
        let (mut after, mut in_turn) = (map.clone(), 0.0);
        for k in 0..4 {
            in_turn += after.evidence(&one(k)).expect("inside");
            after.integrate(&one(k));
        }
        assert!((whole - in_turn).abs() < 1e-9, "{whole} {in_turn}");
        off.insert(number, whole - alone);
        map.integrate(scan);
    }
    assert!(off.values().any(|off| off.abs() > 0.01), "rays share cells: {off:?}");
}
