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
