//! A drive round a room with odometry that drifts.

use std::sync::Arc;

use crate::worlds::{Exact, FEW, room, seen, way};
use mapper::{FastVisibility, HitCount, HitCounter, Mapper};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use sensor::{OdometryNoise, Pose, Scan, Step};
use slam::{Options, Outcome, Slam, SlamError, Update, Weight};

/// What the odometry measures of a way, with half as much again of the standard noise.
fn measured(way: &[Pose], seed: u64) -> Vec<Pose> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut odometry = vec![way[0]];
    for pair in way.windows(2) {
        let step = OdometryNoise::STANDARD.scaled(1.5).sample(&Step::between(pair[0], pair[1]), &mut random);
        odometry.push(step.end(odometry[odometry.len() - 1]));
    }
    odometry
}

fn filter(mapper: Box<dyn Mapper>, options: Options) -> Slam {
    Slam::new(mapper, &room(), Arc::new(OdometryNoise::STANDARD), options).expect("valid")
}

fn visibility() -> Box<dyn Mapper> {
    Box::new(FastVisibility::visibility(&room()))
}

fn driven(mut filter: Slam, way: &[Pose], odometry: &[Pose]) -> (Outcome, Vec<usize>) {
    for (k, (pose, odometry)) in way.iter().zip(odometry).enumerate() {
        filter.take(&seen(*pose, k), *odometry);
    }
    let bytes = filter.bytes();
    (filter.finish(), bytes)
}

fn worst_m(found: impl IntoIterator<Item = Pose>, way: &[Pose]) -> f64 {
    found.into_iter().zip(way).map(|(a, b)| (a.x_m - b.x_m).hypot(a.y_m - b.y_m)).fold(0.0, f64::max)
}

#[test]
fn the_way_is_found_where_odometry_loses_it_by_either_weight_and_any_map() {
    let way = way(160);
    let odometry = measured(&way, 5);
    let lost_m = worst_m(odometry.iter().copied(), &way);
    assert!(lost_m > 0.35, "the odometry drifts: {lost_m}");
    let counting = || Box::new(HitCounter::new(&room(), HitCount::GMAPPING)) as Box<dyn Mapper>;
    for (mapper, weight) in
        [(visibility(), Weight::FIELD), (visibility(), Weight::EVIDENCE), (counting(), Weight::FIELD)]
    {
        let (outcome, _) = driven(filter(mapper, Options { weight, ..FEW }), &way, &odometry);
        assert_eq!(outcome.trajectory.len(), way.len());
        let off_m = worst_m(outcome.trajectory.iter().map(|(_, pose)| *pose), &way);
        assert!(off_m < 0.1, "{weight:?}: {off_m} m, the odometry {lost_m} m");
        assert!(outcome.updates.iter().all(|update| !update.carried_away));
        let occupied = |at: [f64; 2]| outcome.map.occupied(room().grid.locate(at).expect("on the map"));
        // The face of the pillar lies on the border of two cells.
        let face = [3.925, 3.975, 4.025, 4.075].map(|x| occupied([x, 3.5])).into_iter().fold(0.0, f64::max);
        assert!(face > 0.4 && occupied([2.0, 2.0]) < 0.1, "{weight:?} {face}");
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_on_any_number_of_threads() {
    let way = way(60);
    let odometry = measured(&way, 9);
    let on = |threads: usize, seed: u64, weight: Weight| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let options = Options { seed, weight, ..FEW };
        let (outcome, _) = pool.install(|| driven(filter(visibility(), options), &way, &odometry));
        let bits = |pose: &Pose| [pose.x_m, pose.y_m, pose.theta_rad].map(f64::to_bits);
        let map: Vec<u64> = outcome.map.occupancy().values().iter().map(|p| p.to_bits()).collect();
        (outcome.trajectory.iter().map(|(_, pose)| bits(pose)).collect::<Vec<_>>(), map)
    };
    for weight in [Weight::FIELD, Weight::EVIDENCE] {
        let one = on(1, 3, weight);
        assert!(one == on(3, 3, weight));
        assert!(one != on(1, 4, weight), "the seed matters");
    }
}

#[test]
fn particles_share_what_they_have_not_written_apart() {
    let way = way(160);
    let odometry = measured(&way, 5);
    let weight = Weight::Field { power: 0.02 };
    let bytes = |particles| driven(filter(visibility(), Options { particles, weight, ..FEW }), &way, &odometry).1;
    let (one, several) = (bytes(1)[0], bytes(6));
    assert!(several.iter().all(|bytes| *bytes < one), "{one} {several:?}");
    let copies = several.iter().sum::<usize>() as f64 / one as f64;
    assert!(copies < 5.0, "resampling leaves common parts: {copies}");
}

#[test]
fn a_robot_that_is_carried_away_is_noticed_once() {
    let way = way(110);
    let odometry = measured(&way, 5);
    let mut filter = filter(visibility(), FEW);
    let mut said: Vec<(usize, Update)> = Vec::new();
    for (k, (pose, odometry)) in way.iter().zip(&odometry).enumerate() {
        // From scan 70 on it stands elsewhere, and its odometry knows nothing of that.
        let there = Pose { x_m: 10.5, y_m: 0.15 + 0.05 * k as f64, theta_rad: pose.theta_rad + 2.0 };
        let update = filter.take(&seen(if k < 70 { *pose } else { there }, k), *odometry);
        said.extend(update.filter(|update| update.carried_away).map(|update| (k, update)));
    }
    assert_eq!(said.len(), 1, "{said:?}");
    assert!((70..100).contains(&said[0].0) && said[0].1.gain.is_some_and(|gain| gain < 0.0), "{said:?}");
}

#[test]
fn a_scan_whose_odometry_is_late_is_passed_over() {
    let way = way(110);
    let odometry = measured(&way, 5);
    let found = |late: &[usize]| {
        let mut filter = filter(visibility(), FEW);
        let mut updated = Vec::new();
        for (k, (pose, odometry)) in way.iter().zip(&odometry).enumerate() {
            // The sensor looks a radian aside, of which the odometry does not know yet.
            let turn_rad = if late.contains(&k) { 1.0 } else { 0.0 };
            let seen = seen(Pose { theta_rad: pose.theta_rad + turn_rad, ..*pose }, k);
            updated.extend(filter.take(&seen, *odometry).map(|update| (k, update.carried_away)));
        }
        let slam::Outcome { trajectory, passed_over, .. } = filter.finish();
        (trajectory, updated, passed_over)
    };
    let (_, updated, none) = found(&[]);
    assert!(none.is_empty(), "{none:?}");
    let late: Vec<usize> =
        updated.iter().map(|(k, _)| *k).filter(|k| [30..35, 60..65, 90..95].iter().any(|r| r.contains(k))).collect();
    assert!(late.len() >= 3, "{late:?}");
    let (trajectory, updated, passed_over) = found(&late);
    // Those of them that came to be matched: one that follows is close to the one that was mapped before it.
    let was_late = |time_s: &f64| late.iter().any(|k| (0.2 * *k as f64 - time_s).abs() < 1e-9);
    assert!(passed_over.len() >= 3 && passed_over.iter().all(was_late), "{late:?}: {passed_over:?}");
    assert!(updated.iter().all(|(k, away)| !late.contains(k) && !away), "{late:?}: {updated:?}");
    let off_m = worst_m(trajectory.iter().map(|(_, pose)| *pose), &way);
    assert!(off_m < 0.1, "{off_m} m");
}

#[test]
fn what_cannot_work_is_refused() {
    let refused = |mapper: Box<dyn Mapper>, options: Options| {
        Slam::new(mapper, &room(), Arc::new(OdometryNoise::STANDARD), options).err()
    };
    /// A mapper that neither predicts nor can be copied.
    struct Bare(grid::Raster<f64>);
    impl Mapper for Bare {
        fn integrate(&mut self, _scan: &Scan) {}
        fn occupancy(&self) -> &grid::Raster<f64> {
            &self.0
        }
    }
    assert_eq!(refused(Box::new(Bare(grid::Raster::filled(room().grid, 0.1))), FEW), Some(SlamError::NoCopies));
    let unseen = || Box::new(mapper::Unseen::new(&room())) as Box<dyn Mapper>;
    assert_eq!(refused(unseen(), Options { weight: Weight::EVIDENCE, ..FEW }), Some(SlamError::NoEvidence));
    assert!(matches!(refused(visibility(), Options { particles: 0, ..FEW }), Some(SlamError::Option(_))));
    assert_eq!(refused(Box::new(Exact::new()), FEW), None);
}
