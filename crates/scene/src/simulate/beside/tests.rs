use std::path::Path;

use super::*;
use crate::{Scene, Simulation, World, drive, simulate};

/// A room with a wall across and a post; a camera.
const ROOM: &str = r#"
name = "test"
bounds = { min = [0.0, 0.0], max = [8.0, 4.0] }
waypoints = { A = [1.0, 1.0], B = [3.0, 1.0] }
route.stops = ["A", "B"]
[camera]
columns = 40
field_of_view_deg = 90.0
[[wall]]
from = [5.0, 0.1]
to = [5.0, 3.9]
thickness = 0.2
[[wall]]
from = [7.0, 0.1]
to = [7.0, 3.9]
thickness = 0.2
[[disc]]
center = [4.0, 1.6]
radius = 0.03
"#;

fn simulated(text: &str, seed: u64) -> (Scene, Simulation) {
    let scene = Scene::parse(text, Path::new("test.toml"), None).unwrap_or_else(|error| panic!("{error}"));
    let drive = drive(&scene).expect("a free way");
    let simulation = simulate(&scene, &World::new(&scene), &drive, seed);
    (scene, simulation)
}

const SENSORS: &str = r#"
[[sensor]]
kind = "laser"
name = "front"
x = 0.1
y = 0.05
yaw_deg = 30.0
beams = 90
field_of_view_deg = 360.0
[[sensor]]
kind = "sonar"
cones = 4
field_of_view_deg = 120.0
every = 3
[[sensor]]
kind = "stereo"
columns = 30
field_of_view_deg = 360.0
[[sensor]]
kind = "depth"
columns = 30
"#;

#[test]
fn sensors_beside_the_camera_move_none_of_its_readings() {
    let (alone, with) = (simulated(ROOM, 3).1, simulated(&format!("{ROOM}{SENSORS}"), 3).1);
    assert_eq!(alone.scans.len(), with.scans.len());
    for (alone, with) in alone.scans.iter().zip(&with.scans) {
        assert_eq!((&alone.scan, &alone.true_ranges_m), (&with.scan, &with.true_ranges_m));
        assert!(alone.beside.is_empty() && !with.beside.is_empty());
    }
    // Nor do they move each other's: a laser reads the same beside other sensors.
    let laser = &SENSORS[..SENSORS.find("[[sensor]]\nkind = \"sonar\"").expect("there")];
    let (_, single) = simulated(&format!("{ROOM}{laser}"), 3);
    for (single, with) in single.scans.iter().zip(&with.scans) {
        assert_eq!(single.beside[0], with.beside[0]);
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("a pool");
    assert_eq!(pool.install(|| simulated(&format!("{ROOM}{SENSORS}"), 3).1), with, "whatever the threads");
}

#[test]
fn sensors_stand_where_they_are_mounted_and_read_when_they_do() {
    let (scene, simulation) = simulated(&format!("{ROOM}{SENSORS}"), 3);
    let names: Vec<&str> = scene.sensors.iter().map(|sensor| sensor.name.as_str()).collect();
    assert_eq!(names, ["front", "sonar-1", "stereo-1", "depth-1"]);
    assert!(matches!(scene.sensors[2].device, Device::Omnidirectional(_)), "all round");
    for (number, scan) in simulation.scans.iter().enumerate() {
        let numbers: Vec<usize> = scan.beside.iter().map(|beside| beside.scan.sensor).collect();
        assert_eq!(numbers, if number % 3 == 0 { vec![1, 2, 3, 4] } else { vec![1, 3, 4] });
        assert_eq!(scan.together().len(), 1 + numbers.len());
        let (robot, laser) = (scan.scan.pose, scan.beside[0].scan.pose);
        let (sin, cos) = robot.theta_rad.sin_cos();
        assert!((laser.x_m - robot.x_m - (0.1 * cos - 0.05 * sin)).abs() < 1e-12);
        assert!((laser.y_m - robot.y_m - (0.1 * sin + 0.05 * cos)).abs() < 1e-12);
        assert!((laser.theta_rad - robot.theta_rad - 30f64.to_radians()).abs() < 1e-12);
        let mut moved = scan.clone();
        moved.move_to(Pose { x_m: 9.0, y_m: 9.0, theta_rad: 0.0 });
        assert!((moved.beside[0].scan.pose.x_m - 9.1).abs() < 1e-12);
        assert_eq!(moved.beside[0].scan.readings, scan.beside[0].scan.readings);
    }
    let bearings = &scene.sensors[0].bearings_rad;
    assert!((bearings[1] - bearings[0] - 4f64.to_radians()).abs() < 1e-12, "evenly, no beam twice");
    assert!((bearings[0] + 178f64.to_radians()).abs() < 1e-12);
}

/// The nearest of a thousand rays in each cone; what is heard lies about it.
#[test]
fn a_sonar_hears_the_nearest_thing_in_its_cone() {
    let (scene, simulation) = simulated(&format!("{ROOM}{SENSORS}").replace("every = 3\n", ""), 3);
    let world = World::new(&scene);
    let (mut near, mut heard, mut on_the_post) = (0usize, 0usize, 0usize);
    for scan in &simulation.scans {
        let Some(beside) = scan.beside.iter().find(|beside| beside.scan.sensor == 2) else { continue };
        for ((ray, true_range), axis) in
            beside.scan.rays().zip(&beside.true_ranges_m).zip(&scene.sensors[1].bearings_rad)
        {
            let at = |k: i32| axis + 30f64.to_radians() * (f64::from(k) / 1000.0 - 0.5);
            let cast = |k: i32| world.cast(ray.origin_m, beside.scan.pose.direction(at(k)));
            let hits: Vec<Hit> = (0..=1000).filter_map(cast).collect();
            let nearest = hits.iter().copied().min_by(|a, b| a.range_m.total_cmp(&b.range_m));
            match (nearest, true_range) {
                (Some(nearest), Some(range)) => {
                    assert!((nearest.range_m - range).abs() < 0.02, "{} {range}", nearest.range_m);
                    on_the_post += usize::from(nearest.obstacle == 2);
                    if nearest.range_m < 4.5
                        && let Some(reading) = ray.reading
                    {
                        near += 1;
                        heard += usize::from((reading - range).abs() < 0.1);
                    }
                }
                (nearest, range) => assert!(nearest.is_none() && range.is_none()),
            }
        }
        assert!(beside.looks.iter().all(|look| look.reach_m <= 5.0));
    }
    assert!(on_the_post > 5, "{on_the_post}");
    let share = heard as f64 / near as f64;
    assert!(near > 30 && (0.6..0.95).contains(&share), "{heard} of {near}");
}

/// Glass: of the beams on it 0.3 end there, and the others on the wall behind; of the camera's all pass, of those that need no draw none.
#[test]
fn readings_pass_through_what_few_of_them_end_on() {
    let text = format!("{ROOM}{SENSORS}").replacen(
        "thickness = 0.2",
        "thickness = 0.2\nseen_by = { laser = 0.3, stereo = 0.0 }",
        1,
    );
    let text = text.replacen("beams = 90", "beams = 90\nhit = 1.0\nno_echo = 0.0\nearly_per_m = 0.0", 1);
    let (scene, simulation) = simulated(&text, 3);
    let (mut on_glass, mut behind, mut others) = (0.0f64, 0.0f64, 0);
    for scan in &simulation.scans {
        let beside = &scan.beside[0];
        for (ray, range) in beside.scan.rays().zip(&beside.true_ranges_m) {
            let hit = World::new(&scene).cast(ray.origin_m, ray.direction);
            assert_eq!(hit.map(|hit| hit.range_m), *range, "what is true is what stands there");
            let (Some(hit), Some(reading)) = (hit.filter(|hit| hit.obstacle == 0), ray.reading) else { continue };
            let past = World::new(&scene).cast_past(ray.origin_m, ray.direction, |obstacle| obstacle != 0);
            let is_at = |range: f64| (reading - range).abs() < 0.12;
            match past {
                _ if is_at(hit.range_m) => on_glass += 1.0,
                Some(past) if is_at(past.range_m) => behind += 1.0,
                None if reading.is_infinite() => behind += 1.0,
                _ => others += 1,
            }
        }
    }
    let share = on_glass / (on_glass + behind);
    assert!(on_glass > 30.0 && (share - 0.3).abs() < 0.08 && others == 0, "{on_glass} {behind} {others}");
    // The camera looks at the wall behind, as if there were no glass.
    let without = format!("{ROOM}{SENSORS}").replacen(
        "from = [5.0, 0.1]\nto = [5.0, 3.9]\nthickness = 0.2\n",
        "from = [7.0, 0.1]\nto = [7.0, 3.9]\nthickness = 0.2\n",
        1,
    );
    for (with, without) in simulation.scans.iter().zip(&simulated(&without, 3).1.scans) {
        assert_eq!(with.scan, without.scan);
        assert_ne!(with.true_ranges_m, without.true_ranges_m);
    }
}

#[test]
fn a_depth_camera_drops_out_where_it_looks_along_a_surface() {
    let wall = "[[wall]]\nfrom = [0.1, 1.3]\nto = [4.5, 1.3]\nthickness = 0.02\n";
    let depth = "[[sensor]]\nkind = \"depth\"\ncolumns = 90\nfield_of_view_deg = 90.0\ngrazing_deg = 20.0\n";
    let (scene, simulation) = simulated(&format!("{ROOM}{wall}{depth}"), 3);
    let world = World::new(&scene);
    let [mut steep, mut flat] = [[0usize; 2]; 2];
    for scan in simulation.scans.iter().filter(|scan| scan.scan.pose.theta_rad.abs() < 1e-9) {
        for ray in scan.beside[0].scan.rays() {
            let Some(hit) = world.cast(ray.origin_m, ray.direction).filter(|hit| hit.obstacle == 2) else { continue };
            let angle_deg = ray.direction[1].asin().to_degrees();
            let counts = if angle_deg > 21.0 { &mut steep } else { &mut flat };
            if angle_deg > 21.0 || angle_deg < 19.0 && hit.range_m < 4.0 {
                counts[usize::from(ray.reading.is_some())] += 1;
            }
        }
    }
    assert!(steep[0] == 0 && steep[1] > 100, "{steep:?}");
    assert!(flat[1] == 0 && flat[0] > 50, "{flat:?}");
}

#[test]
fn a_robot_that_lists_sensors_has_a_camera_if_it_says_so() {
    let without = ROOM.replace("[camera]\ncolumns = 40\nfield_of_view_deg = 90.0\n", "");
    let (scene, simulation) = simulated(&format!("{without}{SENSORS}"), 3);
    assert_eq!(scene.camera.columns, 0);
    let first = simulation.scans[0].together();
    assert_eq!(first.iter().map(|scan| scan.sensor).collect::<Vec<_>>(), [1, 2, 3, 4], "no scan of a camera");
    assert_eq!(simulated(&without, 3).0.camera.columns, 140, "without a list there is the usual one");
    let noisy = ROOM.replace("columns = 40", "columns = 40\ncorrect_match = 0.6");
    assert!((simulated(&format!("{noisy}{SENSORS}"), 3).0.matcher.stereo.correct_match - 0.6).abs() < 1e-15);
}

/// As of the camera: what fails to match fails again, while the noise, and a laser, are fresh.
#[test]
fn images_beside_the_camera_repeat_while_the_robot_stands() {
    let wide = "[[sensor]]\nkind = \"stereo\"\ncolumns = 1000\nfield_of_view_deg = 360.0\nevery = 2\n[[sensor]]\nkind = \"laser\"\nbeams = 50\n";
    let standing = ROOM.replace("[\"A\", \"B\"]", "[{ at = \"A\", wait_s = 10.0 }, \"B\"]");
    let (_, simulation) = simulated(&format!("{standing}{wide}"), 5);
    let [first, second] = [&simulation.scans[0], &simulation.scans[2]];
    assert_eq!(first.scan.pose, second.scan.pose);
    let [a, b] = [first, second].map(|scan| &scan.beside[0].scan);
    let (mut failed, mut fresh) = (0, 0);
    for (ray, (a, b)) in a.readings.iter().zip(&b.readings).enumerate() {
        assert_eq!(a.is_some(), b.is_some(), "column {ray} has its edge as before");
        match a.zip(*b) {
            Some((a, b)) if a.to_bits() == b.to_bits() => failed += 1,
            Some((a, b)) => {
                assert!((a - b).abs() < 4.0, "noise alone: {a} {b}");
                fresh += 1;
            }
            None => {}
        }
    }
    assert!(failed > 5 && fresh > 2 * failed, "a fifth fails: {failed} {fresh}");
    let [a, b] = [first, second].map(|scan| &scan.beside[1].scan.readings);
    assert!(a.iter().zip(b).all(|(a, b)| a != b || *a == Some(f64::INFINITY)), "a laser reads anew");
    // Under way, nothing repeats.
    let far = &simulation.scans[simulation.scans.len() - 3..];
    let moving: Vec<_> = far.iter().flat_map(|scan| &scan.beside).filter(|beside| beside.scan.sensor == 1).collect();
    assert!(moving.windows(2).all(|pair| pair[0].scan.readings != pair[1].scan.readings));
}
