use std::path::Path;

use super::*;
use crate::{ErrorKind, World, truth};

const ROOM: &str = r#"
name = "test"
bounds = { min = [0.0, 0.0], max = [6.0, 4.0] }
waypoints = { A = [1.0, 1.0], B = [4.0, 1.0], C = [4.0, 3.0] }
camera = { columns = 8 }
robot = { radius = 0.2, speed = 0.5, turn_rate_deg = 30.0, scan_interval = 0.25 }
"#;

fn scene(more: &str) -> Scene {
    Scene::parse(&format!("{ROOM}{more}"), Path::new("test.toml"), None).expect("a valid scene")
}

const ROUTE: &str = r#"
route.stops = ["A", "B", "C", "A"]
[[stage]]
name = "corner"
after = ["A", "B"]
[[stage]]
name = "end"
after = ["A", "B", "C", "A"]
"#;

#[test]
fn turns_and_straights_take_their_time() {
    let drive = drive(&scene(ROUTE)).expect("a free way");
    // 3 m, a quarter turn, 2 m, atan2(-2, -3) from straight up the short way, sqrt(13) m.
    let turn = std::f64::consts::FRAC_PI_2 + (2.0f64 / 3.0).atan();
    let expected = 3.0 / 0.5 + 90.0 / 30.0 + 2.0 / 0.5 + turn.to_degrees() / 30.0 + 13f64.sqrt() / 0.5;
    let last = drive.poses.last().expect("scans");
    assert!((last.time_s - expected).abs() < 1e-9, "{} {expected}", last.time_s);
    assert!((last.pose.x_m - 1.0).abs() < 1e-4 && (last.pose.y_m - 1.0).abs() < 1e-4);
    assert_eq!(drive.poses[0].pose, Pose { x_m: 1.0, y_m: 1.0, theta_rad: 0.0 });
    assert_eq!(drive.stage_ends, [("corner".to_owned(), 25), ("end".to_owned(), drive.poses.len())]);
    for pair in drive.poses.windows(2) {
        let gone = distance(pair[0].pose.position_m(), pair[1].pose.position_m());
        let turned = course::turn_between(pair[0].pose.theta_rad, pair[1].pose.theta_rad).abs();
        let time = pair[1].time_s - pair[0].time_s;
        assert!(time > 1e-6 && time <= 0.25 + 1e-9, "{time}");
        assert!(gone <= 0.5 * 0.25 + 2e-5 && turned <= 30f64.to_radians() * 0.25 + 1e-9, "{gone} {turned}");
    }
}

#[test]
fn scans_are_evenly_spaced_between_stages() {
    let drive = drive(&scene(ROUTE)).expect("a free way");
    for (k, pose) in drive.poses[..25].iter().enumerate() {
        assert!((pose.time_s - 0.25 * k as f64).abs() < 1e-12);
    }
}

fn refusal(more: &str) -> String {
    let error = drive(&scene(more)).expect_err("blocked");
    assert_eq!(error.kind(), ErrorKind::BadInput);
    error.to_string()
}

/// Each stands in the way from A to B and leaves no room; with the x at which the robot, a disc of
/// 0.201 m with its clearance, touches it.
const IN_THE_WAY: [(&str, f64); 4] = [
    ("[[box]]\ncenter = [2.5, 1.3]\nsize = [0.4, 0.4]\n", 2.126), // its corner, sqrt(0.201^2 - 0.1^2) before 2.3
    ("[[disc]]\ncenter = [2.5, 1.0]\nradius = 0.3\n", 1.999),
    ("[[wall]]\nfrom = [2.5, 0.1]\nto = [2.5, 3.0]\nthickness = 0.1\n", 2.249),
    // A mouth of 90 degrees, open towards the robot: sqrt(2) * 0.201 before its end.
    ("[[polygon]]\npoints = [[2.4, 0.5], [3.2, 0.5], [3.2, 1.5], [2.4, 1.5], [2.9, 1.0]]\n", 2.616),
];

#[test]
fn whatever_stands_in_the_way_is_found_by_contact() {
    for (obstacle, x) in IN_THE_WAY {
        let kind = obstacle.split("]]").next().expect("a kind").trim_start_matches("[[");
        let expected = format!(
            "test.toml:8:21: [route]: the way A -> B is blocked at [{x}, 1] by {kind} 1 (line 15): must leave 0.201 m on \
             either side (the robot's radius and 0.001 m to spare); move a waypoint or the obstacle, or add a stop that \
             leads round it"
        );
        assert_eq!(refusal(&format!("{ROUTE}{obstacle}")), expected);
    }
}

#[test]
fn a_way_just_wide_enough_is_free_and_a_millimetre_less_is_not() {
    let gap = |half: f64| {
        let [low, high] = [1.0 - half, 1.0 + half];
        format!(
            "{ROUTE}[[box]]\ncenter = [2.5, {}]\nsize = [0.4, 0.4]\n[[box]]\ncenter = [2.5, {}]\nsize = [0.4, 0.4]\n",
            low - 0.2,
            high + 0.2
        )
    };
    assert!(drive(&scene(&gap(0.2 + 1.1 * CLEARANCE_M))).is_ok());
    assert!(drive(&scene(&gap(0.2 + 0.9 * CLEARANCE_M))).is_err());
}

#[test]
fn a_slow_robot_is_stopped_too() {
    // Every move is shorter than what the controller takes for standing still.
    let slow = "route.stops = [\"A\", \"B\"]\n[[disc]]\ncenter = [1.41, 1.0]\nradius = 0.2\n";
    let text = format!("{ROOM}{slow}")
        .replace("speed = 0.5", "speed = 0.001")
        .replace("scan_interval = 0.25", "scan_interval = 0.005");
    let scene = Scene::parse(&text, Path::new("test.toml"), None).expect("a valid scene");
    assert!(drive(&scene).expect_err("blocked").to_string().contains("blocked at [1.00"), "near the disc");
}

#[test]
fn an_endless_drive_is_refused() {
    let text = format!("{ROOM}{ROUTE}")
        .replace("speed = 0.5", "speed = 0.001")
        .replace("interval = 0.25", "interval = 0.0001");
    let scene = Scene::parse(&text, Path::new("test.toml"), None).expect("a valid scene");
    let message = drive(&scene).expect_err("endless").to_string();
    assert!(message.starts_with("test.toml:8:16: [route]: about 8.6"), "{message}");
    assert!(message.contains("must be at most 1000000 scans"), "{message}");
}

#[test]
fn the_robot_never_stands_in_an_occupied_cell() {
    let scene = scene(&format!("{ROUTE}[[box]]\ncenter = [2.5, 0.5]\nsize = [0.4, 0.4]\n"));
    let (truth, world) = (truth(&scene), World::new(&scene));
    for TimedPose { pose, .. } in drive(&scene).expect("a free way").poses {
        let cell = scene.grid.locate(pose.position_m()).expect("inside");
        assert_eq!(truth[cell], Some(false));
        for k in 0..64 {
            let hit = world.cast(pose.position_m(), pose.direction(f64::from(k) * 0.1));
            assert!(hit.is_none_or(|hit| hit.range_m > scene.robot.radius_m), "{pose:?} {hit:?}");
        }
    }
}

#[test]
fn the_robot_stands_where_a_stop_says_so_and_scans() {
    let standing = ROUTE.replace(
        "[\"A\", \"B\", \"C\", \"A\"]\n[[stage]]\nname = \"corner\"",
        "[{ at = \"A\", wait_s = 1.1 }, { at = \"B\", wait_s = 10.0 }, \"C\", \"A\"]\n[[stage]]\nname = \"corner\"",
    );
    let (still, moving) = (drive(&scene(&standing)).expect("free"), drive(&scene(ROUTE)).expect("free"));
    let at =
        |drive: &Drive, at: [f64; 2]| drive.poses.iter().filter(|p| distance(p.pose.position_m(), at) < 1e-9).count();
    // At A at 0, 0.25 .. 1 s, and when it comes back; at B, after 6 s, from 7.25 s on and 16.9 s at the latest, when the stage ends.
    assert_eq!((at(&moving, [1.0, 1.0]), at(&still, [1.0, 1.0])), (2, 6));
    let corner = still.stage_ends[0].1;
    assert!((still.poses[corner - 1].time_s - 17.1).abs() < 1e-9, "the stage ends when it has stood there");
    assert_eq!(still.poses[corner - 1].pose, still.poses[corner - 20].pose);
    let [last, other] = [&still, &moving].map(|drive| drive.poses[drive.poses.len() - 1].time_s);
    assert!((last - other - 11.1).abs() < 1e-9, "{last} {other}");
}

#[test]
fn a_drive_among_people_ends_within_hours() {
    let walker = "[[mover]]\nradius = 0.2\nroute = [[2.0, 2.5]]\n[robot]\nscan_interval = 30.0\n";
    let text = format!("{ROOM}{ROUTE}{walker}")
        .replace(
            "[\"A\", \"B\", \"C\", \"A\"]\n[[stage]]\nname = \"corner\"",
            "[{ at = \"A\", wait_s = 36000.0 }, \"B\", \"C\", \"A\"]\n[[stage]]\nname = \"corner\"",
        )
        .replace("robot = { radius = 0.2, speed = 0.5, turn_rate_deg = 30.0, scan_interval = 0.25 }\n", "");
    let scene = Scene::parse(&text, Path::new("test.toml"), None).expect("a valid scene");
    let expected = "[route]: the drive takes more than 36000 s: must be at most that where something moves; drive faster, or wait for less long";
    let message = drive(&scene).expect_err("too long").to_string();
    assert!(message.ends_with(expected), "{message}");
}

/// A chair in a corner, far from everybody's way.
const FAR_CHAIR: &str = "[[chair]]\ncenter = [0.3, 3.7]\nradius = 0.1\nmoves = [{ at_s = 5.0, to_m = [0.3, 3.4] }]\n";

#[test]
fn what_moves_far_away_changes_no_drive() {
    let alone = drive(&scene(ROUTE)).expect("a free way");
    let among = drive(&scene(&format!("{ROUTE}{FAR_CHAIR}"))).expect("a free way");
    assert_eq!((alone.poses.len(), &alone.stage_ends), (among.poses.len(), &among.stage_ends));
    for (a, b) in alone.poses.iter().zip(&among.poses) {
        assert!((a.time_s - b.time_s).abs() < 1e-6, "{} {}", a.time_s, b.time_s);
        assert!(distance(a.pose.position_m(), b.pose.position_m()) < 1e-4, "{a:?} {b:?}");
        assert!((a.pose.theta_rad - b.pose.theta_rad).abs() < 1e-6, "{a:?} {b:?}");
    }
    assert!(alone.motion.is_empty() && alone.motion.shapes_at(0).next().is_none());
    assert_eq!((among.motion.len(), among.motion.names().next()), (1, Some("chair 1 (line 15)".to_owned())));
}

#[test]
fn obstacles_block_a_drive_among_things_as_they_block_any() {
    for (obstacle, _) in IN_THE_WAY {
        let alone = refusal(&format!("{ROUTE}{obstacle}"));
        assert_eq!(alone, refusal(&format!("{ROUTE}{obstacle}{FAR_CHAIR}")));
    }
}
