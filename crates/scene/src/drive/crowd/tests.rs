use std::path::Path;

use proptest::prelude::*;

use super::*;
use crate::drive::{CLEARANCE_M, drive};
use crate::{Drive, SceneError, ThingKind, gap};

/// A room with two tables and a niche, a robot that drives round it, and scans as often as everything moves.
const ROOM: &str = r#"
name = "room"
bounds = { min = [0.0, 0.0], max = [8.0, 6.0] }
waypoints = { A = [1.0, 1.0], B = [7.0, 1.0], C = [7.0, 5.0], D = [1.0, 5.0] }
camera = { columns = 20 }
robot = { radius = 0.2, speed = 0.5, turn_rate_deg = 60.0, scan_interval = 0.05, patience_s = 30.0 }
wall = [
  { from = [0.05, 0.05], to = [7.95, 0.05], thickness = 0.1 }, { from = [7.95, 0.05], to = [7.95, 5.95], thickness = 0.1 },
  { from = [7.95, 5.95], to = [0.05, 5.95], thickness = 0.1 }, { from = [0.05, 5.95], to = [0.05, 0.05], thickness = 0.1 },
]
box = [{ center = [3.0, 3.0], size = [0.8, 1.4], rotation_deg = 10.0 }, { center = [5.2, 3.2], size = [1.0, 0.8] }]
polygon = [{ points = [[4.0, 5.3], [4.6, 5.3], [4.6, 5.7], [4.3, 5.4], [4.0, 5.7]] }]
"#;

fn scene(more: &str) -> Scene {
    Scene::parse(&format!("{ROOM}{more}"), Path::new("room.toml"), None).expect("a valid scene")
}

const ROUND: &str = "route.stops = [\"A\", \"B\", \"C\", \"D\", \"A\"]\n";

/// The least distance of anything that moves to anything else, at any scan, m, and what it is.
fn least_gap(scene: &Scene, drive: &Drive) -> (f64, String) {
    let names: Vec<String> = drive.motion.names().collect();
    let mut least = (f64::INFINITY, String::new());
    for (scan, timed) in drive.poses.iter().enumerate() {
        let robot = Shape::Disc { center_m: timed.pose.position_m(), radius_m: scene.robot.radius_m };
        let shapes: Vec<&Shape> = drive.motion.shapes_at(scan).map(|(_, shape)| shape).collect();
        for (k, shape) in shapes.iter().enumerate() {
            let mut near = |distance_m: f64, other: &str| {
                if distance_m < least.0 {
                    least = (distance_m, format!("{} and {other} at {} s", names[k], timed.time_s));
                }
            };
            near(gap::between(shape, &robot), "the robot");
            for (other, name) in shapes.iter().zip(&names).skip(k + 1) {
                near(gap::between(shape, other), name);
            }
            for obstacle in &scene.obstacles {
                near(gap::between(shape, &obstacle.shape), &obstacle.origin.to_string());
            }
        }
    }
    least
}

/// Points on the free ways of the room.
const PLACES: [[f64; 2]; 6] = [[2.0, 1.6], [4.1, 1.6], [6.0, 1.6], [2.0, 4.6], [4.1, 4.5], [6.3, 4.6]];

/// Who walks from one of these places to the next ones, in this order.
fn people() -> impl Strategy<Value = String> {
    let one = (0.3f64..2.0, 0.0f64..3.0, 0usize..5, 0.12f64..0.3);
    (prop::collection::vec(one, 2..6), 0u64..1000, 0.0f64..1.0).prop_map(|(people, seed, chance)| {
        let mut text = format!(
            "motion_seed = {seed}\n{ROUND}{DOOR}period_s = 6.0\nopen_chance = {chance:?}\n\
             [[chair]]\ncenter = [4.1, 3.0]\nsize = [0.3, 0.3]\nmoves = [{{ at_s = 9.0, to_m = [4.1, 1.6] }}, {{ at_s = 25.0, to_m = [6.6, 3.4], turn_deg = 20.0 }}]\n"
        );
        for (k, (speed, pause, kind, radius)) in people.into_iter().enumerate() {
            let at = |k: usize| format!("{:?}", PLACES[k % 6]);
            let (a, b) = (at(k), at(k / 3 * 3 + (k + 1) % 3));
            let goes = match kind {
                0 => format!("route = [{a}]\nbehaviour = \"follower\"\ndistance_m = 0.8\n"),
                1 => format!("route = [{a}]\nbehaviour = \"loiterer\"\nwithin_m = 1.5\npause_s = {pause:?}\n"),
                2 => format!("route = [{a}, {b}]\nrepeat = \"back_and_forth\"\npause_s = {pause:?}\n"),
                3 => format!("route = [{a}, {b}]\nrepeat = \"once\"\nstart_s = {pause:?}\n"),
                _ => format!("route = [{a}, {b}]\npause_s = [{pause:?}, 0.0]\n"),
            };
            let body = match kind {
                4 => format!("points = [[-{radius:?}, -0.1], [{radius:?}, -0.1], [0.0, {radius:?}]]"),
                _ => format!("radius = {radius:?}"),
            };
            text += &format!("[[mover]]\n{body}\nspeed_m_s = {speed:?}\n{goes}");
        }
        text
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn nobody_walks_through_anything(text in people()) {
        let scene = scene(&text);
        let drive = drive(&scene).map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
        let (least_m, what) = least_gap(&scene, &drive);
        prop_assert!(least_m > 0.5 * CLEARANCE_M, "{least_m} m between {what}\n{text}");
        prop_assert_eq!(&drive, &super::super::drive(&scene).expect("as before"));
        // Nobody is carried about: a step is as long as the speed allows.
        for scan in 1..drive.poses.len() {
            let time_s = drive.poses[scan].time_s - drive.poses[scan - 1].time_s;
            for ((k, now), (_, then)) in drive.motion.shapes_at(scan).zip(drive.motion.shapes_at(scan - 1)) {
                let gone_m = distance(now.extent_m()[0], then.extent_m()[0]);
                let most_m = scene.movers.get(k).map_or(f64::INFINITY, |mover| mover.speed_m_s * time_s);
                prop_assert!(gone_m <= most_m + 1e-9, "mover {} went {gone_m} m", k + 1);
            }
        }
    }
}

/// Where a thing was at each scan, m: the middle of its extent.
fn course_of(drive: &Drive, thing: usize) -> Vec<[f64; 2]> {
    let middle = |scan| {
        let shapes: Vec<_> = drive.motion.shapes_at(scan).collect();
        let [low, high] = shapes[thing].1.extent_m();
        [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])]
    };
    (0..drive.poses.len()).map(middle).collect()
}

#[test]
fn routes_are_walked_at_their_speed_with_their_pauses() {
    let text = format!(
        "{ROUND}[[mover]]\nradius = 0.2\nroute = [[2.0, 1.8], [5.0, 1.8]]\nspeed_m_s = 1.0\nstart_s = 1.0\npause_s = [0.0, 2.0]\nrepeat = \"back_and_forth\"\n"
    );
    let scene = scene(&text);
    let drive = drive(&scene).expect("a free way");
    let course = course_of(&drive, 0);
    for (timed, at) in drive.poses.iter().zip(&course) {
        // Off for a second, 3 m in 3 s, 2 s there, back in 3 s.
        let expected = match timed.time_s {
            t if t <= 1.0 => 2.0,
            t if t <= 4.0 => 1.0 + t,
            t if t <= 6.0 => 5.0,
            t if t <= 9.0 => 11.0 - t,
            _ => break,
        };
        assert!((at[0] - expected).abs() < 0.25 && (at[1] - 1.8).abs() < 0.05, "{} s: {at:?} {expected}", timed.time_s);
    }
    assert_eq!((drive.motion.kind(0), drive.motion.len()), (ThingKind::Person, 1));
}

#[test]
fn a_follower_stays_behind_and_a_loiterer_near() {
    let text = format!(
        "{ROUND}[[mover]]\nradius = 0.2\nroute = [[1.0, 2.0]]\nbehaviour = \"follower\"\ndistance_m = 1.2\n\
         [[mover]]\nradius = 0.2\nroute = [[4.1, 2.0]]\nbehaviour = \"loiterer\"\nwithin_m = 0.6\npause_s = 1.0\n"
    );
    let scene = scene(&text);
    let drive = drive(&scene).expect("a free way");
    let [follower, loiterer] = [0, 1].map(|thing| course_of(&drive, thing));
    let robot: Vec<[f64; 2]> = drive.poses.iter().map(|timed| timed.pose.position_m()).collect();
    let late = robot.len() / 4;
    for scan in late..robot.len() {
        let apart_m = distance(follower[scan], robot[scan]);
        assert!((0.4..1.9).contains(&apart_m), "{apart_m} m behind at {} s", drive.poses[scan].time_s);
    }
    assert!(loiterer.iter().all(|at| distance(*at, [4.1, 2.0]) < 1.0), "it gives way, and comes back");
    let walked_m: f64 = loiterer.windows(2).map(|pair| distance(pair[0], pair[1])).sum();
    assert!(walked_m > 3.0, "{walked_m} m in all");
}

/// A corridor so narrow that nobody passes the robot, with a niche at its end or without.
fn corridor(patience_s: f64, mover: &str) -> Result<Drive, SceneError> {
    let text = format!(
        "name = \"corridor\"\nbounds = {{ min = [0.0, 0.0], max = [8.0, 2.0] }}\nwaypoints = {{ A = [1.0, 0.5], B = [6.0, 0.5] }}\n\
         route.stops = [\"A\", \"B\"]\ncamera.columns = 8\nrobot.patience_s = {patience_s:?}\n\
         wall = [{{ from = [0.05, 0.15], to = [7.95, 0.15], thickness = 0.1 }}, {{ from = [0.05, 0.85], to = [7.95, 0.85], thickness = 0.1 }},\n\
         {{ from = [7.95, 0.15], to = [7.95, 0.85], thickness = 0.1 }}]\n{mover}"
    );
    drive(&Scene::parse(&text, Path::new("corridor.toml"), None).expect("a valid scene"))
}

#[test]
fn a_robot_that_cannot_pass_says_whom() {
    // It goes on ahead of the robot, as far as the corridor goes.
    let ahead = corridor(5.0, "[[mover]]\nradius = 0.25\nroute = [[4.0, 0.5]]\n").expect("it gives way");
    assert!(distance(course_of(&ahead, 0)[ahead.poses.len() - 1], [6.0, 0.5]) > 0.45);
    let message = corridor(
        5.0,
        "[[chair]]\ncenter = [4.0, 0.5]\nsize = [0.4, 0.4]\nmoves = [{ at_s = 100.0, to_m = [7.0, 0.5] }]\n",
    )
    .expect_err("blocked")
    .to_string();
    let expected = "corridor.toml:4:21: [route]: the way A -> B is blocked at [3.599, 0.5] by chair 1 (line 9), for 5 s: must be free within patience_s = 5; send it elsewhere, or give [robot] more patience";
    assert_eq!(message, expected);
    let patient = corridor(
        200.0,
        "[[chair]]\ncenter = [4.0, 0.5]\nsize = [0.4, 0.4]\nmoves = [{ at_s = 100.0, to_m = [7.0, 0.5] }]\n",
    );
    let waited = patient.expect("the chair goes").poses;
    assert!(waited.last().is_some_and(|last| last.time_s > 100.0 && last.time_s < 108.0));
}

const DOOR: &str = "[[door]]\nhinge = [1.5, 2.5]\nlength = 0.9\nclosed_deg = 0.0\nopen_deg = 90.0\nswing_s = 1.0\n";

fn angles(drive: &Drive, thing: usize) -> Vec<f64> {
    let angle = |scan| {
        let shapes: Vec<_> = drive.motion.shapes_at(scan).collect();
        let Shape::Box { axis, .. } = shapes[thing].1 else { panic!("a leaf is a box") };
        axis[1].atan2(axis[0]).to_degrees()
    };
    (0..drive.poses.len()).map(angle).collect()
}

#[test]
fn a_door_opens_and_shuts_when_it_is_to() {
    let scene = scene(&format!("{ROUND}{DOOR}open_s = [[5.0, 10.0]]\n"));
    let drive = drive(&scene).expect("a free way");
    for (timed, angle) in drive.poses.iter().zip(angles(&drive, 0)) {
        let expected = match timed.time_s {
            t if t < 5.0 => 0.0,
            t if t < 6.0 => 90.0 * (t - 5.0),
            t if t < 10.0 => 90.0,
            t if t < 11.0 => 90.0 * (11.0 - t),
            _ => 0.0,
        };
        assert!((angle - expected).abs() < 10.0, "{} s: {angle} {expected}", timed.time_s);
        assert!((timed.time_s - 7.0).abs() > 0.9 || (angle - 90.0).abs() < 1e-12, "{angle} is open to the last bit");
    }
}

#[test]
fn a_door_crushes_nobody() {
    let still = "[[mover]]\nradius = 0.2\nroute = [[2.0, 3.0]]\nspeed_m_s = 0.01\n";
    let scene = scene(&format!("{ROUND}{DOOR}open_s = [[5.0, 10.0]]\n{still}"));
    let drive = drive(&scene).expect("a free way");
    assert!(least_gap(&scene, &drive).0 > 0.5 * CLEARANCE_M);
    let widest = angles(&drive, 1).into_iter().fold(0.0, f64::max);
    assert!((10.0..45.0).contains(&widest), "it waits before the person: {widest}");
}

#[test]
fn doors_are_open_by_stage_and_by_chance() {
    let stages = "route.stops = [\"A\", \"B\", \"C\"]\n[[stage]]\nname = \"one\"\nafter = [\"A\", \"B\"]\n[[stage]]\nname = \"two\"\nafter = [\"A\", \"B\", \"C\"]\n";
    let scene = scene(&format!("{stages}{DOOR}open_during = [\"two\"]\n"));
    let drive = drive(&scene).expect("a free way");
    let (angles, first) = (angles(&drive, 0), drive.stage_ends[0].1);
    assert!(angles[..first].iter().all(|angle| angle.abs() < 1e-9) && (angles[angles.len() - 1] - 90.0).abs() < 1e-9);
    let opening = crate::Opening::Chance { period_s: 10.0, chance: 0.3 };
    let open = |seed| (0..2000).filter(|k| opening.wants_open(10.0 * f64::from(*k) + 1.0, 0, seed, 0)).count();
    assert!((500..700).contains(&open(1)), "{} of 2000", open(1));
    let course = |seed| (0..64).map(|k| opening.wants_open(10.0 * f64::from(k), 0, seed, 1)).collect::<Vec<_>>();
    assert_eq!(course(4), course(4));
    assert_ne!(course(4), course(5));
}

#[test]
fn chairs_move_at_once_or_when_their_place_is_free() {
    let chair = "[[chair]]\ncenter = [2.0, 2.0]\nsize = [0.4, 0.4]\nmoves = [{ at_s = 3.0, to_m = [2.0, 2.6], turn_deg = 45.0 }, { at_s = 6.0, to_m = [3.0, 1.0] }]\n";
    let scene = scene(&format!("{ROUND}{chair}"));
    let drive = drive(&scene).expect("a free way").motion_of(0);
    for (time_s, shape) in &drive {
        let Shape::Box { center_m, axis, .. } = shape else { panic!("a box") };
        // At 6 s the robot is near [3, 1]: it has passed at 3 + 0.2 + 0.2 m, after 4.9 s.
        let expected = if *time_s < 2.99 {
            [2.0, 2.0]
        } else if *time_s < 5.99 {
            [2.0, 2.6]
        } else {
            [3.0, 1.0]
        };
        assert!(distance(*center_m, expected) < 1e-12, "{time_s} s: {center_m:?}");
        assert!((axis[1] - if *time_s < 2.99 { 0.0 } else { 0.5f64.sqrt() }).abs() < 1e-12);
    }
    assert!(drive.len() > 300);
}

impl Drive {
    /// Time (s) and shape of a thing at every scan.
    fn motion_of(&self, thing: usize) -> Vec<(f64, Shape)> {
        let shape = |(scan, timed): (usize, &crate::TimedPose)| {
            let found = self.motion.shapes_at(scan).find(|(k, _)| *k == thing);
            (timed.time_s, found.expect("a thing").1.clone())
        };
        self.poses.iter().enumerate().map(shape).collect()
    }
}

fn shipped(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scenes/{name}.toml"));
    Scene::load(&path, None).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn people_pass_in_the_shipped_corridor() {
    let scene = shipped("corridor-people");
    let drive = drive(&scene).unwrap_or_else(|error| panic!("{error}"));
    assert!(least_gap(&scene, &drive).0 > 0.5 * CLEARANCE_M);
    // Everybody gets about, in front of the camera, for a good part of the drive.
    for thing in 0..drive.motion.len() {
        let walked_m: f64 = course_of(&drive, thing).windows(2).map(|pair| distance(pair[0], pair[1])).sum();
        assert!(walked_m > 2.5, "mover {} walked {walked_m} m", thing + 1);
    }
    assert!((300..700).contains(&drive.poses.len()), "{} scans", drive.poses.len());
}

#[test]
fn the_shipped_office_changes_between_visits() {
    let scene = shipped("office-visits");
    let drive = drive(&scene).unwrap_or_else(|error| panic!("{error}"));
    assert!(least_gap(&scene, &drive).0 > 0.5 * CLEARANCE_M);
    let ends: Vec<usize> = drive.stage_ends.iter().map(|(_, scans)| scans - 1).collect();
    let at = |scan: usize| -> Vec<&Shape> { drive.motion.shapes_at(scan).map(|(_, shape)| shape).collect() };
    // Every thing changes at least once, and nothing else moves while the robot is in the office.
    for thing in 0..drive.motion.len() {
        let visits: Vec<&Shape> = ends.iter().map(|&end| at(end)[thing]).collect();
        assert!(visits.windows(2).any(|pair| pair[0] != pair[1]), "thing {thing}");
        for (visit, end) in ends.iter().enumerate() {
            let settled = if visit == 0 { 0 } else { ends[visit - 1] + 12 };
            assert!((settled..=*end).all(|scan| at(scan)[thing] == at(*end)[thing]), "thing {thing}, visit {visit}");
        }
    }
    assert!((500..800).contains(&drive.poses.len()), "{} scans", drive.poses.len());
}
