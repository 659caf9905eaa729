use std::path::Path;

use super::*;
use crate::drive;

const ROOM: &str = r#"
name = "test"
bounds = { min = [0.0, 0.0], max = [6.0, 4.0] }
waypoints = { A = [1.0, 1.0], B = [3.0, 1.0] }
route.stops = ["A", "B"]
camera = { columns = 40, field_of_view_deg = 90.0 }
[[wall]]
from = [5.0, 0.1]
to = [5.0, 3.0]
thickness = 0.2
[[box]]
center = [4.0, 1.5]
size = [0.4, 0.4]
texture = 1.0
"#;

fn simulated(text: &str, seed: u64) -> (Scene, Simulation) {
    let scene = Scene::parse(text, Path::new("test.toml"), None).expect("a valid scene");
    let drive = drive(&scene).expect("a free way");
    let simulation = simulate(&scene, &World::new(&scene), &drive, seed);
    (scene, simulation)
}

/// Every reading and true range, to the last bit.
fn bits(simulation: &Simulation) -> Vec<Option<u64>> {
    let of_scan = |scan: &SimulatedScan| {
        let numbers = scan.scan.readings.iter().chain(&scan.true_ranges_m);
        numbers.map(|number| number.map(f64::to_bits)).collect::<Vec<_>>()
    };
    simulation.scans.iter().flat_map(of_scan).collect()
}

#[test]
fn one_seed_gives_the_same_readings_on_any_number_of_threads() {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| simulated(ROOM, 7).1)
    };
    let [one, two, seven] = [1, 2, 7].map(on);
    assert_eq!(bits(&one), bits(&two));
    assert_eq!(bits(&one), bits(&seven));
    assert_eq!((&one, &one), (&two, &seven), "poses, times and stages as well");
    assert_ne!(bits(&one), bits(&simulated(ROOM, 8).1));
}

#[test]
fn what_one_ray_draws_shifts_no_other() {
    let (scene, textured) = simulated(ROOM, 7);
    let (_, bare) = simulated(&ROOM.replace("texture = 1.0", "texture = 0.0"), 7);
    let world = World::new(&scene);
    let mut on_box = 0;
    for (with, without) in textured.scans.iter().zip(&bare.scans) {
        for (ray, other) in with.scan.rays().zip(without.scan.rays()) {
            if world
                .cast(ray.origin_m, ray.direction)
                .is_some_and(|hit| scene.obstacles[hit.obstacle].origin.kind == "box")
            {
                on_box += usize::from(ray.reading.is_some());
                assert_eq!(other.reading, None, "a bare surface gives no reading");
            } else {
                assert_eq!(ray.reading, other.reading);
            }
        }
    }
    assert!(on_box > 50, "{on_box}");
}

#[test]
fn rays_that_end_on_nothing_have_no_reading() {
    let (_, simulation) = simulated(ROOM, 7);
    let mut lost = 0;
    for scan in &simulation.scans {
        assert_eq!(scan.scan.readings.len(), 40);
        for (reading, range) in scan.scan.readings.iter().zip(&scan.true_ranges_m) {
            lost += usize::from(range.is_none());
            assert!(range.is_some() || reading.is_none());
        }
    }
    assert!(lost > 100, "the room is open: {lost}");
    assert_eq!(simulation.stages, [Stage { name: "end".to_owned(), scans: simulation.scans.len() }]);
}

#[test]
fn readings_follow_the_true_ranges() {
    let text = ROOM.replace("texture = 1.0", "") + "[sensor]\ndetection_rate = 1.0\ncorrect_match = 1.0\n";
    let (scene, simulation) = simulated(&text, 7);
    let mut errors = Vec::new();
    for scan in &simulation.scans {
        for (ray, range) in scan.scan.rays().zip(&scan.true_ranges_m) {
            let (Some(reading), Some(range)) = (ray.reading, range) else { continue };
            errors.push(reading - scene.matcher.stereo.disparity(*range, ray.bearing_rad));
        }
    }
    let n = errors.len() as f64;
    let mean = errors.iter().sum::<f64>() / n;
    let deviation = (errors.iter().map(|e| e * e).sum::<f64>() / n).sqrt();
    assert!(n > 400.0 && mean.abs() < 4.0 * 0.5 / n.sqrt() && (deviation - 0.5).abs() < 0.05, "{n} {mean} {deviation}");
}

#[test]
fn clustered_mismatches_reach_the_readings_and_do_not_depend_on_threads() {
    let clustered = ROOM.to_owned() + "[sensor]\nmismatches = \"clustered\"\ncorrect_match = 0.6\n";
    let independent = ROOM.to_owned() + "[sensor]\ncorrect_match = 0.6\n";
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| simulated(&clustered, 7))
    };
    let (scene, simulation) = on(1);
    for threads in [2, 7] {
        assert_eq!(bits(&simulation), bits(&on(threads).1), "{threads} threads");
    }
    // Wrong readings, more than 2 px off, follow each other more often than without clusters.
    let repeats = |simulation: &Simulation| {
        let (mut after_wrong, mut wrong_again) = (0, 0);
        for scan in &simulation.scans {
            let mut before = false;
            for (ray, range) in scan.scan.rays().zip(&scan.true_ranges_m) {
                let (Some(reading), Some(range)) = (ray.reading, range) else { continue };
                let wrong = (reading - scene.matcher.stereo.disparity(*range, ray.bearing_rad)).abs() > 2.0;
                after_wrong += usize::from(before);
                wrong_again += usize::from(before && wrong);
                before = wrong;
            }
        }
        wrong_again as f64 / after_wrong as f64
    };
    let [apart, together] = [repeats(&simulated(&independent, 7).1), repeats(&simulation)];
    assert!(together > apart + 0.1, "{together} {apart}");
}

/// The room with somebody who walks to and fro, a door, and a chair that is put elsewhere.
const BUSY: &str = r#"
[[mover]]
radius = 0.2
route = [[2.0, 2.5], [4.3, 2.5]]
repeat = "back_and_forth"
texture = 0.5
[[mover]]
points = [[-0.2, -0.1], [0.2, -0.1], [0.2, 0.1], [0.0, 0.0], [-0.2, 0.1]]
route = [[2.0, 3.3], [4.3, 3.3]]
[[door]]
hinge = [4.3, 0.7]
length = 0.5
closed_deg = 180.0
open_deg = 270.0
open_s = [[1.0, 3.0]]
[[chair]]
center = [3.0, 1.8]
radius = 0.15
moves = [{ at_s = 2.0, to_m = [2.2, 1.8] }]
"#;

/// Range at which a ray meets a shape, by school algebra: m, none where it misses.
fn met(shape: &crate::Shape, origin: [f64; 2], direction: [f64; 2]) -> Option<f64> {
    use crate::geometry::{cross, dot, minus, sides};
    if let crate::Shape::Disc { center_m, radius_m } = shape {
        let to = minus(*center_m, origin);
        let (along, off) = (dot(to, direction), cross(direction, to));
        let half = radius_m * radius_m - off * off;
        return (half >= 0.0).then(|| along - half.sqrt()).filter(|range| *range >= 0.0);
    }
    let corners = shape.corners_m();
    let hits = sides(&corners).filter_map(|(a, b)| {
        let (side, from) = (minus(b, a), minus(a, origin));
        let turn = cross(direction, side);
        let (range, part) = (cross(from, side) / turn, cross(from, direction) / turn);
        (turn.abs() > 1e-12 && range >= 0.0 && (0.0..=1.0).contains(&part)).then_some(range)
    });
    hits.reduce(f64::min)
}

#[test]
fn rays_end_on_what_is_nearest_at_the_time_of_the_scan() {
    let (scene, simulation) = simulated(&format!("{ROOM}{BUSY}"), 3);
    let drive = drive(&scene).expect("a free way");
    let (mut on_things, mut rays, mut grazing) = (vec![0; drive.motion.len()], 0, 0);
    for (k, scan) in simulation.scans.iter().enumerate() {
        for (ray, range) in scan.scan.rays().zip(&scan.true_ranges_m) {
            let fixed = scene.obstacles.iter().map(|o| (None, met(&o.shape, ray.origin_m, ray.direction)));
            let moving = drive.motion.shapes_at(k).map(|(n, s)| (Some(n), met(s, ray.origin_m, ray.direction)));
            let ends = fixed.chain(moving).filter_map(|(n, range)| Some((n, range?)));
            let nearest = ends.min_by(|(_, a), (_, b)| a.total_cmp(b));
            let same = match (nearest, range) {
                (Some((_, expected)), Some(range)) => (expected - range).abs() < 1e-6,
                (None, None) => true,
                _ => false,
            };
            rays += 1;
            // A ray through a corner may miss what is a hair smaller here.
            grazing += usize::from(!same);
            if let Some((Some(thing), _)) = nearest.filter(|_| same) {
                on_things[thing] += 1;
            }
        }
    }
    assert!(grazing <= 2, "{grazing}");
    assert!(rays > 500 && on_things.iter().all(|on| *on > 3), "{on_things:?} of {rays}");
}

#[test]
fn the_truth_of_the_moment_is_what_stands_and_what_is_covered() {
    let (scene, _) = simulated(&format!("{ROOM}{BUSY}"), 3);
    let drive = drive(&scene).expect("a free way");
    for scan in [0, 7, drive.poses.len() - 1] {
        let covered = crate::covered_at(&scene, &drive, scan);
        let mut obstacles = scene.clone();
        obstacles.obstacles.clear();
        let mut add = |shape: &crate::Shape| {
            let origin = crate::Origin { kind: "disc", number: 1, line: 1 };
            obstacles.obstacles.push(crate::Obstacle {
                shape: shape.clone(),
                texture: 1.0,
                seen_by: crate::SeenBy::ALL,
                origin,
            });
        };
        drive.motion.shapes_at(scan).for_each(|(_, shape)| add(shape));
        let alone = crate::truth(&obstacles);
        assert!((0..scene.grid.cells()).all(|cell| alone[cell] == Some(covered[cell])));
        assert!((100..400).contains(&covered.values().iter().filter(|&&c| c).count()));
    }
    assert_eq!(crate::truth(&scene), crate::truth(&simulated(ROOM, 3).0), "what stands is what stood");
}

#[test]
fn the_seed_of_the_readings_moves_nobody_and_threads_change_nothing() {
    let busy = format!("{ROOM}{BUSY}");
    let on = |threads, seed| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| simulated(&busy, seed).1)
    };
    assert_eq!(bits(&on(1, 7)), bits(&on(5, 7)));
    let ranges = |simulation: Simulation| -> Vec<_> { simulation.scans.into_iter().map(|s| s.true_ranges_m).collect() };
    assert_eq!(ranges(on(1, 7)), ranges(on(2, 8)));
}

/// A robot that stands before a flat wall for 200 scans, and drives off.
fn standing(more: &str, robot: &str) -> (Scene, Simulation) {
    let text = ROOM
        .replace("route.stops = [\"A\", \"B\"]", "route.stops = [{ at = \"A\", wait_s = 39.9 }, \"B\"]")
        .replace("waypoints = { A = [1.0, 1.0]", "waypoints = { A = [1.0, 2.5]")
        .replace("columns = 40", "columns = 400")
        .replace("from = [5.0, 0.1]\nto = [5.0, 3.0]", "from = [5.0, 0.2]\nto = [5.0, 3.8]");
    simulated(&format!("{text}[robot]\n{robot}\n{more}"), 11)
}

#[test]
fn mismatches_repeat_while_the_robot_stands_and_noise_does_not() {
    for mismatches in ["independent", "clustered"] {
        let (scene, simulation) = standing(&format!("[sensor]\nmismatches = \"{mismatches}\"\n"), "");
        let scans = &simulation.scans[..200];
        assert!(scans.iter().all(|scan| scan.scan.pose == scans[0].scan.pose));
        assert!(scans.windows(2).all(|pair| pair[1].scan.time_s > pair[0].scan.time_s));
        assert_ne!(simulation.scans[200].scan.pose, scans[0].scan.pose);
        let (mut failed, mut matched) = (0, 0);
        for ray in 0..400 {
            let readings: Vec<f64> = scans.iter().filter_map(|scan| scan.scan.readings[ray]).collect();
            let Some(range) = scans[0].true_ranges_m[ray] else { continue };
            if readings.is_empty() {
                continue;
            }
            let n = readings.len() as f64;
            assert!(readings.len() > 190, "an edge is there at every scan");
            let mean = readings.iter().sum::<f64>() / n;
            let deviation = (readings.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / n).sqrt();
            let true_px = scene.matcher.stereo.disparity(range, scans[0].scan.bearings_rad[ray]);
            if deviation < 1e-9 {
                failed += 1;
                continue;
            }
            assert!((deviation - 0.5).abs() < 0.1, "noise is fresh: {deviation}");
            matched += usize::from((mean - true_px).abs() < 0.2);
        }
        assert!((8..60).contains(&failed) && matched >= 60, "{mismatches}: {failed} {matched}");
    }
}

#[test]
fn what_a_ray_saw_before_somebody_crossed_it_sees_again() {
    let crossing =
        "[[mover]]\nradius = 0.2\nroute = [[3.0, 3.6], [3.0, 0.3], [1.0, 0.3]]\nrepeat = \"once\"\nstart_s = 10.0\n";
    let sharp = "[sensor]\ndisparity_sigma = 0.001\n";
    let (_, simulation) = standing(&format!("{sharp}{crossing}"), "");
    let (_, empty) = standing(sharp, "");
    // Of the rays that see past where somebody stands at first: readings that are none of the empty room's.
    let past = |ray: &usize| simulation.scans[0].true_ranges_m[*ray] == empty.scans[0].true_ranges_m[*ray];
    let differ = |scan: usize| {
        let reading = |of: &Simulation, ray: usize| of.scans[scan].scan.readings[ray];
        let pairs = (0..400).filter(past).map(|ray| (reading(&simulation, ray), reading(&empty, ray)));
        pairs.filter(|(a, b)| a.map_or(b.is_some(), |a| b.is_none_or(|b| (a - b).abs() > 0.01))).count()
    };
    assert_eq!((differ(3), differ(40), differ(199)), (0, 0, 0));
    assert!((52..70).map(differ).any(|rays| rays > 10), "somebody crosses");
}

#[test]
fn the_recorded_pose_jitters_about_the_true_one() {
    let (_, simulation) = standing("", "jitter_m = 0.002\njitter_deg = 0.1");
    let (_, still) = standing("", "");
    let (mut sum, mut turn) = ([0.0; 2], 0.0);
    for (scan, true_one) in simulation.scans[..200].iter().zip(&still.scans) {
        let [a, b] = [scan.scan.pose, true_one.scan.pose];
        sum = [sum[0] + (a.x_m - b.x_m).powi(2), sum[1] + (a.y_m - b.y_m).powi(2)];
        turn += (a.theta_rad - b.theta_rad).to_degrees().powi(2);
        assert_eq!((&scan.scan.readings, &scan.true_ranges_m), (&true_one.scan.readings, &true_one.true_ranges_m));
    }
    let [x, y, turn] = [sum[0], sum[1], turn].map(|sum| (sum / 200.0).sqrt());
    assert!((x - 0.002).abs() < 4e-4 && (y - 0.002).abs() < 4e-4 && (turn - 0.1).abs() < 0.02, "{x} {y} {turn}");
    for (scan, true_one) in simulation.scans[200..].iter().zip(&still.scans[200..]) {
        assert_eq!(scan.scan.pose, true_one.scan.pose, "under way it does not");
    }
}
