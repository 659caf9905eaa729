//! One scan by `visibility` and by its reference, a large one on one thread and on two, and rays through settled space.
//!
//! `cargo bench -p mapper --bench fast`. The throughput column is rays per second; the last group's two rows are
//! to be compared with each other.

use std::f64::consts::TAU;
use std::sync::Arc;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use grid::GridSpec;
use mapper::{FastVisibility, Mapper as _, Model, Visibility};
use sensor::{Laser, Pose, Scan, Stereo};

/// The middle of a room of 12 m, seen by so many rays, with a false match in five.
fn scan(rays: usize) -> Scan {
    let bearings_rad: Vec<f64> = (0..rays).map(|k| 1.4 * ((k as f64 + 0.5) / rays as f64 - 0.5)).collect();
    let wall = |bearing: f64| 6.0 / libm::cos(bearing);
    let reading = |(k, &bearing): (usize, &f64)| {
        let disparity = Stereo::default().disparity(wall(bearing), bearing);
        Some(if k % 5 == 0 { 60.0 * (0.618 * k as f64).fract() } else { disparity + 0.5 * libm::sin(k as f64 * 2.4) })
    };
    let readings = bearings_rad.iter().enumerate().map(reading).collect();
    Scan { sensor: 0, time_s: 0.0, pose: Pose { x_m: 6.5, y_m: 6.5, theta_rad: 0.1 * TAU }, bearings_rad, readings }
}

/// The same by a laser, with a beam without echo in ten.
fn laser_scan(beams: usize) -> Scan {
    let Scan { pose, bearings_rad, .. } = scan(beams);
    let reading = |(k, &bearing): (usize, &f64)| {
        let wall_m = 6.0 / libm::cos(bearing);
        Some(if k % 10 == 0 { f64::INFINITY } else { wall_m + 0.02 * libm::sin(k as f64 * 2.4) })
    };
    let readings = bearings_rad.iter().enumerate().map(reading).collect();
    Scan { sensor: 0, time_s: 0.0, pose, bearings_rad, readings }
}

fn scans(criterion: &mut Criterion) {
    let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 260, height: 260 };
    let setup = Model::new(grid, Arc::new(Stereo::default()));
    let small = scan(200);
    let mut group = criterion.benchmark_group("scan of 200 rays");
    group.throughput(Throughput::Elements(200));
    let (mut fast, mut reference) = (FastVisibility::visibility(&setup), Visibility::exact(&setup));
    group.bench_function("visibility", |bencher| bencher.iter(|| fast.integrate_on(&small, 1)));
    group.bench_function("visibility-reference", |bencher| bencher.iter(|| reference.integrate(&small)));
    group.finish();
    let setup_laser = Model::new(grid, Arc::new(Laser::default()));
    let beams = laser_scan(200);
    let mut group = criterion.benchmark_group("scan of 200 beams of a laser");
    group.throughput(Throughput::Elements(200));
    let (mut fast, mut reference) = (FastVisibility::visibility(&setup_laser), Visibility::exact(&setup_laser));
    group.bench_function("visibility", |bencher| bencher.iter(|| fast.integrate_on(&beams, 1)));
    group.bench_function("visibility-reference", |bencher| bencher.iter(|| reference.integrate(&beams)));
    group.finish();
    let large = scan(6_400);
    let mut group = criterion.benchmark_group("scan of 6400 rays");
    group.throughput(Throughput::Elements(6_400));
    for threads in [1, 2] {
        let mut mapper = FastVisibility::visibility(&setup);
        group.bench_function(BenchmarkId::new("threads", threads), |bencher| {
            bencher.iter(|| mapper.integrate_on(&large, threads));
        });
    }
    group.finish();
}

/// Rays of so many cells along a hall whose floor is settled, by a laser: what a cell more costs.
fn settled(criterion: &mut Criterion) {
    const RAYS: usize = 64;
    let mut group = criterion.benchmark_group("64 rays in settled space");
    for cells in [1_000, 3_000, 10_000] {
        let length_m = 0.05 * f64::from(cells);
        let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: cells as usize + 40, height: 200 };
        let laser = Laser { max_range_m: 2.0 * length_m, ..Laser::default() };
        let mut mapper = FastVisibility::visibility(&Model::new(grid, Arc::new(laser)));
        let scan = |number: usize| {
            let drawn = (0.618_034 * number as f64).fract();
            let pose = Pose { x_m: 0.52, y_m: 4.0 + 2.0 * drawn, theta_rad: 0.0 };
            let half = 3.0 / length_m;
            let bearings_rad: Vec<f64> =
                (0..RAYS).map(|k| half * (2.0 * (k as f64 + 0.5) / RAYS as f64 - 1.0)).collect();
            let readings =
                bearings_rad.iter().map(|bearing| Some((length_m - pose.x_m) / libm::cos(*bearing))).collect();
            Scan { sensor: 0, time_s: 0.0, pose, bearings_rad, readings }
        };
        (0..300).for_each(|number| mapper.integrate(&scan(number)));
        let last = scan(7);
        group.throughput(Throughput::Elements(RAYS as u64));
        group
            .bench_function(BenchmarkId::new("cells", cells), |bencher| bencher.iter(|| mapper.integrate_on(&last, 1)));
    }
    group.finish();
}

criterion_group!(benches, scans, settled);
criterion_main!(benches);
