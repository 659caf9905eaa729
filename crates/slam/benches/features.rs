//! What a scan costs one particle, against the number of its landmarks.
//!
//! `cargo bench -p slam --bench features`. Fields of points with as much room for each, mapped from known poses by a robot that drives all
//! of it, so that the landmarks are those of a whole drive; then the same look is taken over and over from the middle, each time by a copy, which
//! copies what it changes. `in view` is the share of the look that the landmarks near it cost, the same in all fields; what grows is the tree.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use sensor::{Camera, FeatureCamera, FeatureReading, Matcher, Pose};
use slam::features::{Association, LandmarkMap};

/// Points of the fields.
const POINTS: [usize; 5] = [25, 100, 400, 1_600, 6_400];

/// Room for a point: the side of a square, m.
const ROOM_M: f64 = 2.0;

fn camera() -> FeatureCamera {
    let matcher = Matcher { detection_rate: 1.0, ..Matcher::default() };
    FeatureCamera::of(&Camera { columns: 200, field_of_view_rad: 1.2 }, &matcher)
}

/// A point in each square, shifted in its own way.
fn field(points: usize) -> Vec<[f64; 2]> {
    let across = (points as f64).sqrt().ceil() as usize;
    let share = |k: usize, step: f64| (step * k as f64).fract();
    let point = |k: usize| {
        let [column, row] = [k % across, k / across].map(|v| v as f64);
        [ROOM_M * (column + share(k, 0.618_034)), ROOM_M * (row + share(k, 0.754_878))]
    };
    (0..points).map(point).collect()
}

/// Noise-free readings of all points in view.
fn look(camera: &FeatureCamera, points: &[[f64; 2]], pose: Pose) -> Vec<FeatureReading> {
    let seen = points.iter().filter_map(|point| camera.expected(pose, *point)).filter(|seen| camera.views(*seen));
    seen.map(|[bearing_rad, disparity_px]| FeatureReading { bearing_rad, disparity_px, identity: None }).collect()
}

/// The map of a field after looks from all over it.
fn mapped(camera: &FeatureCamera, points: &[[f64; 2]]) -> LandmarkMap {
    let side = ROOM_M * (points.len() as f64).sqrt();
    let rules = Association { negative_evidence: false, ..Association::default() };
    let mut map = LandmarkMap::new(*camera, rules).expect("valid");
    let steps = (side / 2.0).ceil() as usize;
    for row in 0..=steps {
        for k in 0..=4 * steps {
            let pose = Pose { x_m: 0.5 * k as f64 - 2.0, y_m: 2.0 * row as f64, theta_rad: 0.0 };
            map.take(pose, &look(camera, points, pose));
        }
    }
    map
}

fn scans(criterion: &mut Criterion) {
    let camera = camera();
    let mut group = criterion.benchmark_group("scan");
    for count in POINTS {
        let points = field(count);
        let map = mapped(&camera, &points);
        let middle = 0.5 * ROOM_M * (count as f64).sqrt();
        let pose = Pose { x_m: middle - 4.0, y_m: middle, theta_rad: 0.0 };
        let readings: Vec<FeatureReading> = look(&camera, &points, pose).into_iter().take(8).collect();
        assert_eq!(readings.len(), 8, "each field gives as many readings");
        let landmarks = map.landmarks().len();
        assert!(landmarks >= count * 9 / 10, "{landmarks} landmarks of {count} points");
        group.bench_with_input(BenchmarkId::from_parameter(landmarks), &map, |bencher, map| {
            bencher.iter(|| black_box(map.clone().take(black_box(pose), &readings)));
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(50);
    targets = scans
}
criterion_main!(benches);
