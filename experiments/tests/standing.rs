//! A robot that stands, and somebody who walks by.

use std::path::Path;

use mapper::catalogue::find;
use mapper::{Model, Sensors};
use scene::{Scene, World};
use std::sync::Arc;

/// A room in which somebody crosses from wall to wall, 1.2 m in front of a robot that has stood for 12 s.
const ROOM: &str = r#"
name = "hallway"
[bounds]
min = [0.0, 0.0]
max = [5.0, 4.0]
[grid]
cell = 0.05
[[wall]]
from = [0.05, 0.05]
to = [4.95, 0.05]
thickness = 0.1
[[wall]]
from = [4.95, 0.05]
to = [4.95, 3.95]
thickness = 0.1
[[wall]]
from = [4.95, 3.95]
to = [0.05, 3.95]
thickness = 0.1
[[wall]]
from = [0.05, 3.95]
to = [0.05, 0.05]
thickness = 0.1
[[mover]]
radius = 0.2
route = [[2.1, 3.6], [2.1, 0.4]]
repeat = "once"
speed_m_s = 1.0
start_s = 12.0
[waypoints]
A = [0.6, 2.0]
B = [0.9, 2.0]
[route]
stops = ["A", { at = "B", wait_s = 30.0 }]
[[stage]]
name = "end"
after = ["A", "B"]
[camera]
columns = 110
field_of_view_deg = 90.0
[sensor]
focal_baseline = 15.0
disparity_sigma = 0.5
correct_match = 0.8
max_disparity = 60.0
[robot]
radius = 0.2
speed = 0.4
turn_rate_deg = 45.0
scan_interval = 0.2
jitter_m = 0.002
jitter_deg = 0.1
"#;

/// Looks at most until whoever stands there, or has left, is in the map.
const LOOKS: usize = 3;

/// Cells at most that are then held occupied and were not before, of the fifty that somebody covers: what false matches that stay had
/// held at nearly one half.
const GHOSTS: usize = 4;

#[test]
fn somebody_who_walks_by_is_there_and_gone_within_three_looks() {
    let scene = Scene::parse(ROOM, Path::new("hallway.toml"), None).expect("a scene");
    let drive = scene::drive(&scene).expect("a way");
    let model = Model {
        sensors: Sensors::one(Arc::new(scene.matcher.stereo)),
        ..Model::new(scene.grid, Arc::new(scene.matcher.stereo))
    };
    for seed in 1..=5 {
        let simulation = scene::simulate(&scene, &World::new(&scene), &drive, seed);
        let mut mapper = find("visibility-dynamic").expect("it is in the catalogue").mapper(&model);
        // Scans since somebody came into the middle of the view, and since they left it.
        let (mut came, mut left, mut seen, mut ghosts, mut before) = (None, None, None, 0, Vec::new());
        for (number, simulated) in simulation.scans.iter().enumerate() {
            mapper.integrate(&simulated.scan);
            let at = drive.motion.shapes_at(number).next().map(|(_, shape)| shape.extent_m()).expect("somebody");
            let middle = [0, 1].map(|k| 0.5 * (at[0][k] + at[1][k]));
            let in_view = (middle[1] - 2.0).abs() < 0.4;
            let map = mapper.occupancy();
            // A stereo camera is off by two cells at this range.
            let held = |near: [f64; 2], within_m: f64| -> Vec<usize> {
                let close = |cell: usize| {
                    let centre = scene.grid.centre(cell);
                    (0..2).all(|k| (centre[k] - near[k]).abs() <= within_m)
                };
                (0..scene.grid.cells()).filter(|cell| close(*cell) && map[*cell] > 0.5).collect()
            };
            if in_view && came.is_none() {
                came = Some(number);
            }
            // False matches that stay put something there too, and do so whether somebody passes or not.
            if came.is_none() {
                before = held([2.1, 2.0], 0.5);
            }
            if in_view && seen.is_none() && !held(middle, 0.35).is_empty() {
                seen = Some(number);
            }
            if came.is_some() && left.is_none() && middle[1] < 1.2 {
                left = Some(number);
            }
            if left.is_some_and(|left| number >= left + LOOKS) {
                let left_over = held([2.1, 2.0], 0.5).iter().filter(|cell| !before.contains(cell)).count();
                ghosts = ghosts.max(left_over);
            }
        }
        let (came, seen) = (came.expect("they cross the view"), seen.expect("they are seen"));
        assert!(seen < came + LOOKS, "seed {seed}: they came at scan {came} and are in the map at {seen}");
        assert!(left.is_some() && ghosts <= GHOSTS, "seed {seed}: they have left, and {ghosts} cells stand in the map");
    }
}
