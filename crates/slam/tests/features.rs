//! FastSLAM in an open field of points.

use std::f64::consts::TAU;
use std::sync::Arc;

use grid::GridSpec;
use mapper::{HitCount, HitCounter, Model};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use sensor::{Camera, FeatureCamera, FeatureReading, FeatureScan, Laser, Matcher, OdometryNoise, Pose, Scan, Step};
use slam::features::{
    Association, FastSlam, FeatureOptions, FeatureOutcome, FeatureProposal, Identity, LandmarkMap, Meant,
};
use slam::{Options, Slam, Weight};

fn camera() -> FeatureCamera {
    let matcher = Matcher { detection_rate: 0.9, ..Matcher::default() };
    FeatureCamera::of(&Camera { columns: 200, field_of_view_rad: 1.2 }, &matcher)
}

/// Points of a field of 20 m x 20 m, no two within half a metre.
fn field(count: usize, seed: u64) -> Vec<[f64; 2]> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut points: Vec<[f64; 2]> = Vec::new();
    while points.len() < count {
        let at = [0, 1].map(|_| 20.0 * random.random::<f64>() - 10.0);
        if points.iter().all(|other| (other[0] - at[0]).hypot(other[1] - at[1]) > 0.5) {
            points.push(at);
        }
    }
    points
}

/// Twice round a circle of 5 m in steps of 0.2 m.
fn way(scans: usize) -> Vec<Pose> {
    let turn = 0.2 / 5.0;
    (0..scans)
        .map(|k| {
            let at = turn * k as f64;
            Pose { x_m: 5.0 * at.cos(), y_m: 5.0 * at.sin(), theta_rad: at + 0.25 * TAU }
        })
        .collect()
}

/// What is seen along a way with odometry of the standard noise; which point each reading is of, none where the match failed.
struct Drive {
    way: Vec<Pose>,
    scans: Vec<FeatureScan>,
    odometry: Vec<Pose>,
    truth: Vec<Vec<Option<usize>>>,
}

fn drive(points: &[[f64; 2]], scans: usize, camera: &FeatureCamera, seed: u64) -> Drive {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut other = ChaCha8Rng::seed_from_u64(seed + 1_000_000);
    let way = way(scans);
    let mut odometry = vec![way[0]];
    for pair in way.windows(2) {
        let step = OdometryNoise::STANDARD.sample(&Step::between(pair[0], pair[1]), &mut random);
        odometry.push(step.end(odometry[odometry.len() - 1]));
    }
    let (mut all, mut truth) = (Vec::new(), Vec::new());
    for (k, pose) in way.iter().enumerate() {
        let (mut readings, mut of) = (Vec::new(), Vec::new());
        for (number, point) in points.iter().enumerate() {
            let Some(expected) = camera.expected(*pose, *point).filter(|e| camera.views(*e)) else { continue };
            let Some((reading, matched)) = camera.sample(expected, 1.0, &mut random, &mut other) else { continue };
            readings.push(FeatureReading { identity: Some(number as u32), ..reading });
            of.push(matched.then_some(number));
        }
        all.push(FeatureScan { time_s: k as f64, pose: None, odometry: Some(odometry[k]), readings });
        truth.push(of);
    }
    Drive { way, scans: all, odometry, truth }
}

fn run(camera: &FeatureCamera, options: FeatureOptions, drive: &Drive) -> FeatureOutcome {
    let mut filter = FastSlam::new(*camera, OdometryNoise::STANDARD, options).expect("valid");
    for (scan, odometry) in drive.scans.iter().zip(&drive.odometry) {
        filter.take(scan, *odometry);
    }
    filter.finish()
}

fn rmse_m(found: &[Pose], way: &[Pose]) -> f64 {
    let squares = found.iter().zip(way).map(|(a, b)| (a.x_m - b.x_m).powi(2) + (a.y_m - b.y_m).powi(2));
    (squares.sum::<f64>() / way.len() as f64).sqrt()
}

fn options(particles: usize, proposal: FeatureProposal, association: Association) -> FeatureOptions {
    FeatureOptions { particles, proposal, association, ..FeatureOptions::default() }
}

/// Points no two of which can be taken for each other from near.
fn apart() -> Vec<[f64; 2]> {
    let grid = |k: usize| [2.2 * (k % 9) as f64 - 9.0, 2.4 * (k / 9) as f64 - 9.0];
    (0..72).map(grid).collect()
}

#[test]
fn known_association_is_recovered_where_no_match_fails() {
    let mut camera = camera();
    camera.stereo.correct_match = 1.0;
    camera.stereo.disparity_sigma = 0.03;
    let drive = drive(&apart(), 160, &camera, 4);
    // Of a thousand right readings one lies outside of the usual gate, and one of ten points that are new is missed at the next look.
    let rules = Association { gate: 40.0, negative_evidence: false, ..Association::default() };
    let mut map = LandmarkMap::new(camera, rules).expect("valid");
    let mut number_of = vec![None; apart().len()];
    let mut readings = 0;
    for ((scan, pose), truth) in drive.scans.iter().zip(&drive.way).zip(&drive.truth) {
        let hidden: Vec<FeatureReading> =
            scan.readings.iter().map(|r| FeatureReading { identity: None, ..*r }).collect();
        for (meant, truth) in map.take(*pose, &hidden).into_iter().zip(truth) {
            let point = truth.expect("no match fails");
            match (meant, number_of[point]) {
                (Meant::New(number), None) => number_of[point] = Some(number),
                (Meant::Landmark(number), Some(own)) => assert_eq!(number, own, "point {point}"),
                other => panic!("point {point}: {other:?}"),
            }
            readings += 1;
        }
    }
    assert!(readings > 1000 && map.landmarks().len() == number_of.iter().flatten().count());
    for landmark in map.confirmed() {
        let point = number_of.iter().position(|n| *n == Some(landmark.number)).expect("of a point");
        let ([x, y], covariance) = landmark.place(&camera);
        let off = (x - apart()[point][0]).hypot(y - apart()[point][1]);
        assert!(off < 5.0 * (covariance[0][0] + covariance[1][1]).sqrt(), "{off}");
    }
}

#[test]
fn a_particle_without_errors_of_odometry_is_the_map_from_known_poses() {
    let camera = camera();
    let mut drive = drive(&field(40, 3), 100, &camera, 1);
    drive.odometry = drive.way.clone();
    let rules = Association::default();
    for proposal in [FeatureProposal::Odometry, FeatureProposal::Latest] {
        let mut filter = FastSlam::new(camera, OdometryNoise::NONE, options(1, proposal, rules)).expect("valid");
        let mut map = LandmarkMap::new(camera, rules).expect("valid");
        let mut meant = Vec::new();
        let (mut pose, mut last) = (drive.way[0], drive.way[0]);
        for (scan, odometry) in drive.scans.iter().zip(&drive.odometry) {
            filter.take(scan, *odometry);
            // The pose as steps put it together, to the last bit.
            pose = Step::between(last, *odometry).end(pose);
            last = *odometry;
            meant.push(map.take(pose, &scan.readings));
        }
        let found = filter.finish();
        assert_eq!((found.meant, found.landmarks), (meant, map.confirmed()));
        assert!(rmse_m(&found.way, &drive.way) < 1e-9);
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_on_any_number_of_threads() {
    let camera = camera();
    let drive = drive(&field(60, 3), 60, &camera, 1);
    let run_on = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let rules = FeatureOptions { particles: 12, seed, ..FeatureOptions::default() };
        pool.install(|| run(&camera, rules, &drive))
    };
    assert_eq!(run_on(1, 3), run_on(3, 3));
    assert_ne!(run_on(1, 3), run_on(1, 4));
}

/// After one step, with landmarks that many looks have placed: many particles of the odometry, and few that look first, have the same
/// posterior.
#[test]
fn both_proposals_weigh_to_the_same_posterior() {
    let camera = camera();
    let drive = drive(&field(60, 3), 2, &camera, 11);
    let looks = |filter: &mut FastSlam| {
        // The robot stands: its odometry measures nothing, and landmarks settle.
        (0..20).for_each(|_| filter.take(&drive.scans[0], drive.odometry[0]));
        filter.take(&drive.scans[1], drive.odometry[1]);
    };
    let rules = Association { identity: Identity::Known, ..Association::default() };
    let belief = |particles: usize, proposal: FeatureProposal| {
        let mut filter =
            FastSlam::new(camera, OdometryNoise::STANDARD, options(particles, proposal, rules)).expect("valid");
        looks(&mut filter);
        *filter.belief().expect("scans")
    };
    let (many, few) = (belief(40_000, FeatureProposal::Odometry), belief(4_000, FeatureProposal::Latest));
    assert!(few.effective / 4_000.0 > 5.0 * many.effective / 40_000.0, "{} {}", few.effective, many.effective);
    let sigma = |k: usize| many.covariance[k][k].sqrt();
    for (k, off) in
        [few.mean.x_m - many.mean.x_m, few.mean.y_m - many.mean.y_m, few.mean.theta_rad - many.mean.theta_rad]
            .into_iter()
            .enumerate()
    {
        assert!(off.abs() < 0.15 * sigma(k), "{k}: {off} {}", sigma(k));
        let ratio = few.covariance[k][k].sqrt() / sigma(k);
        assert!((ratio - 1.0).abs() < 0.15, "{k}: {ratio}");
    }
}

#[test]
fn the_latest_readings_make_better_particles_and_both_beat_the_odometry() {
    let camera = camera();
    let rules = Association { identity: Identity::Known, vantage_m: f64::INFINITY, ..Association::default() };
    let mut sums = [0.0; 3];
    for seed in 0..5 {
        let drive = drive(&field(200, 3), 320, &camera, 50 + seed);
        let off = |proposal| rmse_m(&run(&camera, options(15, proposal, rules), &drive).way, &drive.way);
        sums[0] += off(FeatureProposal::Latest);
        sums[1] += off(FeatureProposal::Odometry);
        sums[2] += rmse_m(&drive.odometry, &drive.way);
    }
    assert!(sums[0] < 0.6 * sums[1] && sums[1] < 0.6 * sums[2], "{sums:?}");
}

#[test]
fn negative_evidence_keeps_landmarks_few() {
    let camera = camera();
    let drive = drive(&field(60, 3), 200, &camera, 8);
    let landmarks = |negative_evidence: bool| {
        let rules = Association { negative_evidence, vantage_m: f64::INFINITY, ..Association::default() };
        let mut map = LandmarkMap::new(camera, rules).expect("valid");
        for (scan, pose) in drive.scans.iter().zip(&drive.way) {
            map.take(*pose, &scan.readings);
        }
        map.landmarks().len()
    };
    let (with, without) = (landmarks(true), landmarks(false));
    assert!(with + 50 < without, "{with} {without}");
}

#[test]
fn what_is_out_of_bounds_is_refused_by_its_name() {
    let refused = |options: FeatureOptions| {
        FastSlam::new(camera(), OdometryNoise::STANDARD, options).expect_err("out of bounds").to_string()
    };
    let fine = FeatureOptions::default();
    assert!(refused(FeatureOptions { particles: 0, ..fine }).starts_with("particles is 0; must be 1 to 100000"));
    let rules = Association { gate: f64::NAN, ..fine.association };
    assert!(refused(FeatureOptions { association: rules, ..fine }).starts_with("gate is NaN; must be above 0"));
    let noise = OdometryNoise { m_per_m: -1.0, ..OdometryNoise::STANDARD };
    assert!(FastSlam::new(camera(), noise, fine).expect_err("below 0").to_string().starts_with("m_per_m is -1"));
    let mut blind = camera();
    blind.detection = 0.0;
    assert!(LandmarkMap::new(blind, Association::default()).is_err());
}

#[test]
fn no_scan_is_no_way() {
    let filter = FastSlam::new(camera(), OdometryNoise::STANDARD, FeatureOptions::default()).expect("valid");
    assert!(filter.finish().way.is_empty());
}

/// A grid that has seen no scan says nothing of a way, so that landmarks beside it are those from the odometry's poses, which are exact.
#[test]
fn landmarks_beside_a_grid_are_those_of_its_poses() {
    let camera = camera();
    let points = field(80, 5);
    let drive = drive(&points, 120, &camera, 5);
    let mut filter = beside(1, 0.0, OdometryNoise::NONE, &camera);
    let mut alone = LandmarkMap::new(camera, Association::default()).expect("fine");
    for (pose, features) in drive.way.iter().zip(&drive.scans) {
        filter.take_with(&Scan { time_s: features.time_s, ..Scan::default() }, &features.readings, *pose);
        alone.take(*pose, &features.readings);
    }
    let landmarks = filter.finish().landmarks;
    assert!(landmarks.len() > 20);
    assert_eq!(landmarks, alone.confirmed());
}

/// Where scans say nothing, landmarks beside a grid keep the way that FastSLAM 1.0 keeps, which draws from the odometry as well.
#[test]
fn landmarks_beside_a_grid_hold_the_way() {
    let camera = camera();
    let points = field(80, 6);
    let drive = drive(&points, 250, &camera, 6);
    let mut filter = beside(100, 0.0, OdometryNoise::STANDARD, &camera);
    for (odometry, features) in drive.odometry.iter().zip(&drive.scans) {
        filter.take_with(&Scan { time_s: features.time_s, ..Scan::default() }, &features.readings, *odometry);
    }
    let found: Vec<Pose> = filter.finish().trajectory.iter().map(|(_, pose)| *pose).collect();
    let off = |poses: &[Pose]| {
        let squares = poses.iter().zip(&drive.way).map(|(a, b)| (a.x_m - b.x_m).powi(2) + (a.y_m - b.y_m).powi(2));
        (squares.sum::<f64>() / poses.len() as f64).sqrt()
    };
    let (found, odometry) = (off(&found), off(&drive.odometry));
    assert!(found < 0.6 * odometry, "{found} {odometry}");
}

/// A filter with an empty grid and landmarks.
fn beside(particles: usize, update_move_m: f64, noise: OdometryNoise, camera: &FeatureCamera) -> Slam {
    let grid = GridSpec { cell_m: 0.5, origin_m: [-10.0; 2], width: 40, height: 40 };
    let model = Model::new(grid, Arc::new(Laser::default()));
    let options = Options { particles, seed: 1, weight: Weight::FIELD, update_move_m, ..Options::default() };
    let mapper = Box::new(HitCounter::new(&model, HitCount::GMAPPING));
    let filter = Slam::new(mapper, &model, Arc::new(noise), options).expect("fine");
    filter.beside(*camera, Association::default()).expect("fine")
}
