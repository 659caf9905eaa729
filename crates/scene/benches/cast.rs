//! Rays per second of the simulator, in fields of 16, 256 and 4,096 shapes with as much room for each.
//!
//! `cargo bench -p scene --bench cast`. The throughput column is rays per second: `tree` casts them by parry's tree on one
//! thread, `all` tries every shape, and `simulate` makes the readings of whole drives on one thread and on two. The last
//! line of a field says how much more two threads do than one; their runs take turns, since machines are busy.

use std::fmt::Write as _;
use std::hint::black_box;
use std::io::Write as _;
use std::path::Path;
use std::time::Instant;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use rayon::{ThreadPool, ThreadPoolBuilder};
use scene::{Drive, Scene, Shape, TimedPose, World};

/// Shapes of the fields: four walls, the others boxes.
const SHAPES: [usize; 3] = [16, 256, 4_096];

/// Beyond this many shapes, trying them all says nothing new.
const MOST_TRIED: usize = 256;

/// Turns of one thread and of two.
const TURNS: usize = 9;

/// Ranges by the tree and by trying everything may differ by this much, m: boxes are cast 1 nm larger all round, which
/// grows along rays that graze a side.
const AGREE_M: f64 = 1e-5;

/// A ray: origin, m, and unit vector.
type Beam = [[f64; 2]; 2];

/// A walled field with a box of about 0.4 m in every square of 1 m, each turned and shifted in its own way, and a drive
/// through the free lane in its middle.
fn field(shapes: usize) -> Scene {
    let boxes = shapes - 4;
    let across = (1..).find(|n| n * n >= boxes).expect("some square holds them");
    let [half, side] = [across.div_ceil(2) as f64, across as f64];
    let [east, north] = [side + 0.9, side + 1.9];
    let mut text = format!(
        "name = \"field\"\nbounds = {{ min = [-1.0, -1.0], max = [{:.1}, {:.1}] }}\n\
         waypoints = {{ A = [0.0, {lane:.1}], B = [{side:.1}, {lane:.1}] }}\nroute.stops = [\"A\", \"B\", \"A\"]\n\
         grid.cell = 0.1\ncamera = {{ columns = 640, field_of_view_deg = 90.0 }}\n",
        east + 0.1,
        north + 0.1,
        lane = half + 0.5,
    );
    let corners = [[-0.9, -0.9], [east, -0.9], [east, north], [-0.9, north]];
    for (k, [x, y]) in corners.into_iter().enumerate() {
        let [to_x, to_y] = corners[(k + 1) % 4];
        let _ = writeln!(text, "[[wall]]\nfrom = [{x:.1}, {y:.1}]\nto = [{to_x:.1}, {to_y:.1}]\nthickness = 0.1");
    }
    // Multiples of these fill the unit interval evenly.
    let share = |k: usize, step: f64| (step * k as f64).fract();
    for k in 0..boxes {
        let [column, row] = [k % across, k / across].map(|v| v as f64);
        let x = column + 0.35 + 0.3 * share(k, 0.618_034);
        let y = row + 0.35 + 0.3 * share(k, 0.754_878) + if row < half { 0.0 } else { 1.0 };
        let [width, height] = [0.569_840, 0.414_214].map(|step| 0.3 + 0.2 * share(k, step));
        let turn_deg = 90.0 * share(k, 0.732_051);
        let _ = writeln!(
            text,
            "[[box]]\ncenter = [{x:.3}, {y:.3}]\nsize = [{width:.3}, {height:.3}]\nrotation_deg = {turn_deg:.1}"
        );
    }
    Scene::parse(&text, Path::new("field.toml"), None).expect("a valid field")
}

/// The rays of at most 40 scans, spread over a drive.
fn beams(scene: &Scene, drive: &Drive) -> Vec<Beam> {
    let bearings_rad = scene.camera.bearings_rad();
    let of_scan = |at: &TimedPose| -> Vec<Beam> {
        bearings_rad.iter().map(|&bearing| [at.pose.position_m(), at.pose.direction(bearing)]).collect()
    };
    drive.poses.iter().step_by(drive.poses.len().div_ceil(40)).flat_map(of_scan).collect()
}

/// Range of the first shape on a ray, m, by trying them all.
fn nearest_m(scene: &Scene, [origin, direction]: Beam) -> Option<f64> {
    scene.obstacles.iter().filter_map(|o| box_range_m(&o.shape, origin, direction)).min_by(f64::total_cmp)
}

/// Range of a box on a ray, m: where the ray is between both pairs of its sides.
fn box_range_m(shape: &Shape, origin: [f64; 2], direction: [f64; 2]) -> Option<f64> {
    let Shape::Box { center_m, half_m, axis: [c, s] } = shape else { unreachable!("fields are made of boxes") };
    let turned = |[x, y]: [f64; 2]| [c * x + s * y, c * y - s * x];
    let [from, along] = [turned([origin[0] - center_m[0], origin[1] - center_m[1]]), turned(direction)];
    let [mut enter, mut exit] = [0.0f64, f64::INFINITY];
    for k in 0..2 {
        let [a, b] = [-half_m[k], half_m[k]].map(|side| (side - from[k]) / along[k]);
        enter = enter.max(a.min(b));
        exit = exit.min(a.max(b));
    }
    (enter <= exit).then_some(enter)
}

/// Whether the tree finds on a ray what trying everything does.
fn agrees(scene: &Scene, world: &World, beam: Beam) -> bool {
    match (world.cast(beam[0], beam[1]), nearest_m(scene, beam)) {
        (Some(hit), Some(range_m)) => (hit.range_m - range_m).abs() < AGREE_M,
        (hit, range_m) => hit.is_none() && range_m.is_none(),
    }
}

fn rays(criterion: &mut Criterion) {
    for shapes in SHAPES {
        let scene = field(shapes);
        assert_eq!(scene.obstacles.len(), shapes);
        let world = World::new(&scene);
        let drive = scene::drive(&scene).expect("a free lane");
        casts(criterion, &scene, &world, &beams(&scene, &drive));
        drives(criterion, &scene, &world, &drive);
    }
}

/// Single rays, by the tree and by trying everything.
fn casts(criterion: &mut Criterion, scene: &Scene, world: &World, beams: &[Beam]) {
    let shapes = scene.obstacles.len();
    let mut group = criterion.benchmark_group("cast");
    group.throughput(Throughput::Elements(beams.len() as u64));
    group.bench_function(BenchmarkId::new("tree", shapes), |bencher| {
        bencher.iter(|| beams.iter().filter(|beam| world.cast(beam[0], beam[1]).is_some()).count());
    });
    if shapes <= MOST_TRIED {
        // A ray through a corner, to the nanometre, may hit with the hair and miss without.
        let differ = beams.iter().filter(|beam| !agrees(scene, world, **beam)).count();
        assert!(differ <= beams.len() / 10_000, "{differ} of {} rays", beams.len());
        group.bench_function(BenchmarkId::new("all", shapes), |bencher| {
            bencher.iter(|| beams.iter().filter(|beam| nearest_m(scene, **beam).is_some()).count());
        });
    }
    group.finish();
}

/// Whole drives, on one thread and on two.
fn drives(criterion: &mut Criterion, scene: &Scene, world: &World, drive: &Drive) {
    let shapes = scene.obstacles.len();
    let mut group = criterion.benchmark_group("simulate");
    group.throughput(Throughput::Elements((drive.poses.len() * scene.camera.columns) as u64)).sample_size(20);
    let pools = [1, 2].map(|threads| ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool"));
    for pool in &pools {
        let name = BenchmarkId::new(format!("threads-{}", pool.current_num_threads()), shapes);
        group.bench_function(name, |bencher| {
            bencher.iter(|| pool.install(|| scene::simulate(scene, world, drive, 1)));
        });
    }
    group.finish();
    let mut ratios: Vec<f64> = (0..TURNS).map(|_| ratio(&pools, scene, world, drive)).collect();
    ratios.sort_by(f64::total_cmp);
    let [low, middle, high] = [ratios[0], ratios[TURNS / 2], ratios[TURNS - 1]];
    let _ = writeln!(
        std::io::stdout(),
        "simulate/{shapes}: two threads do {middle:.2} times the work of one ({low:.2} to {high:.2} in {TURNS} turns)\n"
    );
}

/// Time of the first pool against that of the second.
fn ratio(pools: &[ThreadPool; 2], scene: &Scene, world: &World, drive: &Drive) -> f64 {
    let [one, two] = pools.each_ref().map(|pool| {
        let start = Instant::now();
        black_box(pool.install(|| scene::simulate(scene, world, drive, 1)));
        start.elapsed().as_secs_f64()
    });
    one / two
}

criterion_group!(benches, rays);
criterion_main!(benches);
