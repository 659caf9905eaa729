//! Copies of a mapper share what neither has written since, go on like mappers of their own, and predict readings.

use std::sync::Arc;

use grid::GridSpec;
use mapper::ConstantIncrements;
use mapper::{Belief, FastVisibility, HitCount, HitCounter, LogOdds, Mapper, Model, PairwiseGrid, Predictive};
use sensor::{Laser, Pose, Scan};

use crate::quick::quick;

/// A room of `side` m from a place in it, with walls half a metre from the border of the grid; `number` tells scans apart.
fn scan(side: f64, at: [f64; 2], number: usize) -> Scan {
    let pose = Pose { x_m: at[0], y_m: at[1], theta_rad: 0.4 * number as f64 };
    let bearings_rad: Vec<f64> = (0..90).map(|k| (4.0 * f64::from(k) - 180.0).to_radians()).collect();
    let until = |at: f64, along: f64| if along > 0.0 { (side - 0.5 - at) / along } else { (0.5 - at) / along };
    let reading = |(k, bearing): (usize, &f64)| {
        let [x, y] = pose.direction(*bearing);
        let range = until(at[0], x).min(until(at[1], y)) + 0.03 * (k as f64 * 2.4 + number as f64).sin();
        match (k + number) % 17 {
            0 => Some(f64::INFINITY),
            1 => Some(0.4 * range),
            2 => None,
            _ => Some(range),
        }
    };
    let readings = bearings_rad.iter().enumerate().map(reading).collect();
    Scan { sensor: 0, time_s: number as f64, pose, bearings_rad, readings }
}

fn model(side: f64) -> Model {
    let cells = (side / 0.1).round() as usize;
    Model::new(GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: cells, height: cells }, Arc::new(Laser::default()))
}

fn bits(mapper: &dyn Mapper) -> (Vec<u64>, Option<PairwiseGrid>) {
    (mapper.occupancy().values().iter().map(|p| p.to_bits()).collect(), mapper.pairwise())
}

#[test]
fn a_copy_that_is_written_to_is_a_full_copy_to_the_bit_and_leaves_the_first_alone() {
    let setup = model(6.0);
    let first: Vec<Scan> = (0..3).map(|k| scan(6.0, [2.0 + 0.2 * k as f64, 2.5], k)).collect();
    let ways = [4.0, 1.2].map(|x| (0..3).map(|k| scan(6.0, [x, 3.0 + 0.3 * k as f64], 5 + k)).collect::<Vec<_>>());
    let mut copied = 0;
    for entry in quick() {
        let mut trunk = entry.mapper(&setup);
        first.iter().for_each(|scan| trunk.integrate(scan));
        let Some(mut branch) = trunk.fork() else { continue };
        copied += 1;
        let mut alone = [entry.mapper(&setup), entry.mapper(&setup)];
        for (mapper, way) in alone.iter_mut().zip(&ways) {
            first.iter().chain(way).for_each(|scan| mapper.integrate(scan));
        }
        // In turns, so that one writes where the other reads.
        for (left, right) in ways[0].iter().zip(&ways[1]) {
            trunk.integrate(left);
            branch.integrate(right);
        }
        for (mapper, alone) in [&mut trunk, &mut branch].into_iter().zip(&mut alone) {
            mapper.settle();
            alone.settle();
            assert!(bits(&**mapper) == bits(&**alone), "{}", entry.name);
        }
        assert!(bits(&*trunk) != bits(&*branch) || entry.name == "prior", "{}", entry.name);
    }
    assert!(copied > 20, "{copied}");
}

#[test]
fn a_copy_that_shares_nearly_all_takes_a_small_part_of_a_map() {
    let setup = model(60.0);
    let mut trunk = FastVisibility::visibility(&setup);
    for k in 0..144 {
        let [x, y] = [k % 12, k / 12].map(|k| 4.9 * k as f64);
        let small = Scan { pose: Pose { x_m: x + 3.0, y_m: y + 3.0, theta_rad: 0.0 }, ..scan(6.0, [3.0; 2], 0) };
        trunk.integrate(&small);
    }
    let whole = trunk.work().bytes;
    let mut copies: Vec<_> = (0..29).map(|_| trunk.fork().expect("it can be copied")).collect();
    for (k, copy) in copies.iter_mut().enumerate() {
        let [x, y] = [k % 6, k / 6].map(|k| 9.8 * k as f64);
        copy.integrate(&Scan { pose: Pose { x_m: x + 3.2, y_m: y + 3.0, theta_rad: 0.3 }, ..scan(6.0, [3.0; 2], 1) });
    }
    let shares: Vec<f64> = copies.iter().map(|copy| copy.work().bytes as f64 / whole as f64).collect();
    assert!(shares.iter().all(|share| *share < 0.08), "{shares:?}");
    // What all hold together is one map, and what each has written by itself.
    let all: f64 = shares.iter().sum::<f64>() + trunk.work().bytes as f64 / whole as f64;
    assert!((0.95..2.0).contains(&all), "{all}");
}

#[test]
fn one_cell_is_that_of_the_raster() {
    let setup = model(6.0);
    for entry in quick() {
        let mut mapper = entry.mapper(&setup);
        (0..4).for_each(|k| mapper.integrate(&scan(6.0, [2.0, 2.0 + 0.4 * k as f64], k)));
        mapper.settle();
        for cell in (0..setup.grid.cells()).step_by(7) {
            let (one, all) = (mapper.occupied(cell), mapper.occupancy()[cell]);
            assert_eq!(one.to_bits(), all.to_bits(), "{} {cell}: {one} {all}", entry.name);
        }
    }
}

/// The second definition: the predictive model of maps, ray by ray in double precision.
#[test]
fn evidence_is_what_the_map_predicts_of_every_ray() {
    let setup = model(8.0);
    let onset = setup.prior.onset(0.1);
    let laser = Laser::default();
    let sum = |belief: &dyn Fn(&Predictive) -> f64, scan: &Scan| {
        let mut predictive = Predictive::new(setup.grid, &laser, onset);
        scan.rays().map(|ray| if predictive.take(&ray) { -belief(&predictive) } else { 0.0 }).sum::<f64>()
    };
    let (mut visibility, mut independent) = (FastVisibility::visibility(&setup), FastVisibility::independent(&setup));
    let mut odds = ConstantIncrements::new(&setup, LogOdds::OCTOMAP);
    let mut counts = HitCounter::new(&setup, HitCount::GMAPPING);
    for k in 0..25 {
        // From far away too: rays leap over settled space, and some readings are what no map expects.
        let scan = scan(8.0, [2.0 + 0.17 * k as f64, 5.5 - 0.11 * k as f64], k);
        let chain = |mapper: &FastVisibility| {
            let pairs = mapper.pairs();
            sum(&|predictive| predictive.log_loss(Belief::Chain(&pairs)), &scan)
        };
        for (found, expected) in [
            (visibility.evidence(&scan), chain(&visibility)),
            (independent.evidence(&scan), sum(&|p| p.log_loss(Belief::Cells(independent.occupancy())), &scan)),
            (odds.evidence(&scan), sum(&|p| p.log_loss(Belief::Cells(odds.occupancy())), &scan)),
            (counts.evidence(&scan), sum(&|p| p.log_loss(Belief::Cells(counts.occupancy())), &scan)),
        ] {
            let found = found.expect("they predict");
            assert!((found - expected).abs() < 2e-3, "scan {k}: {found} {expected}");
        }
        let before = bits(&visibility);
        visibility.evidence(&scan);
        assert!(before == bits(&visibility), "asking changes nothing");
        for mapper in [&mut visibility as &mut dyn Mapper, &mut independent, &mut odds, &mut counts] {
            mapper.integrate(&scan);
        }
    }
    let outside = Scan { pose: Pose { x_m: -1.0, y_m: 2.0, theta_rad: 0.0 }, ..scan(8.0, [4.0; 2], 0) };
    assert!(visibility.evidence(&outside).is_none() && odds.evidence(&outside).is_none());
}
