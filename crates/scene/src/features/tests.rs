use std::path::Path;

use sensor::Matcher;

use super::*;
use crate::{TimedPose, drive};

const FIELD: &str = r#"
name = "test"
bounds = { min = [0.0, 0.0], max = [8.0, 6.0] }
waypoints = { A = [1.0, 3.0], B = [3.0, 3.0] }
route.stops = ["A", { at = "B", wait_s = 4.0 }]
camera = { columns = 200, field_of_view_deg = 80.0 }
sensor = { detection_rate = 0.9 }
[odometry]
[[box]]
center = [6.0, 3.0]
size = [1.0, 1.0]
[[disc]]
center = [4.5, 2.0]
radius = 0.05
[[disc]]
center = [5.0, 5.0]
radius = 0.5
[[polygon]]
points = [[4.0, 4.0], [5.0, 4.0], [5.0, 4.2], [4.2, 4.2], [4.2, 5.0], [4.0, 5.0]]
[[wall]]
from = [0.5, 1.0]
to = [2.5, 1.0]
thickness = 0.2
[[wall]]
from = [2.5, 1.0]
to = [2.5, 0.2]
thickness = 0.2
"#;

fn scene(text: &str) -> Scene {
    Scene::parse(text, Path::new("test.toml"), None).expect("a valid scene")
}

fn camera(scene: &Scene) -> FeatureCamera {
    FeatureCamera::of(&scene.camera, &scene.matcher)
}

fn places(features: &[Feature]) -> Vec<[i32; 2]> {
    features.iter().map(|f| f.at_m.map(|v| (v * 100.0).round() as i32)).collect()
}

#[test]
fn features_are_outer_corners_and_posts() {
    let found = places(&features(&scene(FIELD)));
    for expected in
        [[550, 250], [650, 250], [650, 350], [550, 350], [450, 200], [400, 400], [500, 400], [500, 420], [400, 500]]
    {
        assert!(found.contains(&expected), "{expected:?} of {found:?}");
    }
    assert!(!found.contains(&[420, 420]), "an inner corner");
    assert!(!found.contains(&[500, 500]), "a pillar is no post");
    // The walls: two free corners at the west end, the outer corner, and two at the south end; where they join there is none.
    assert!(found.contains(&[40, 90]) && found.contains(&[40, 110]) && found.contains(&[240, 10]), "{found:?}");
    assert!(!found.contains(&[260, 90]) && !found.contains(&[240, 110]), "{found:?}");
}

/// Whether a feature is in view, by walking along the ray in small steps.
#[test]
fn what_is_in_view_is_what_a_walk_along_the_ray_reaches() {
    let scene = scene(FIELD);
    let (world, camera, found) = (World::new(&scene), camera(&scene), features(&scene));
    let (mut seen, mut hidden) = (0, 0);
    for k in 0..60 {
        let (x, y, theta) = (0.7 + 0.05 * f64::from(k), 2.513 + 0.02 * f64::from(k % 7), 0.5 * f64::from(k % 5) - 1.0);
        let pose = Pose { x_m: x, y_m: y, theta_rad: theta };
        let poses = vec![TimedPose { time_s: 0.0, pose }];
        let drive = Drive { poses, stage_ends: Vec::new(), motion: crate::Motion::default() };
        let views = in_view(&world, &drive, &found, &camera, 0);
        for (number, feature) in found.iter().enumerate() {
            let Some(expected) = camera.expected(pose, feature.at_m).filter(|e| camera.views(*e)) else { continue };
            let blocked = (0..4000).any(|step| {
                let share = f64::from(step) / 4000.0;
                let at = [0, 1].map(|k| [x, y][k] + share * (feature.at_m[k] - [x, y][k]));
                let own = |k: usize| feature.is_post && k == feature.obstacle;
                scene.obstacles.iter().enumerate().any(|(k, o)| !own(k) && o.shape.distance_m(at) <= 0.0)
            });
            let view = views.iter().find(|(other, _)| *other == number);
            assert_eq!(view.is_some(), !blocked, "{number} {:?} from {pose:?}", feature.at_m);
            assert!(view.is_none_or(|(_, e)| e.iter().zip(expected).all(|(a, b)| a.total_cmp(&b).is_eq())));
            if blocked { hidden += 1 } else { seen += 1 }
        }
    }
    assert!(seen > 50 && hidden > 50, "{seen} {hidden}");
}

#[test]
fn a_seed_fixes_what_is_observed_on_any_number_of_threads() {
    let scene = scene(FIELD);
    let (world, drive) = (World::new(&scene), drive(&scene).expect("free"));
    let (camera, found) = (camera(&scene), features(&scene));
    let observed = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| observe(&scene, &world, &drive, &found, &camera, seed))
    };
    assert_eq!(observed(1, 4), observed(3, 4));
    assert_ne!(observed(1, 4), observed(1, 5));
}

#[test]
fn readings_say_what_is_true_of_them_and_hide_it() {
    let scene = scene(
        &FIELD.replace("wait_s = 4.0", "wait_s = 0.0").replace("[odometry]", "robot.scan_interval = 0.02\n[odometry]"),
    );
    let (world, drive) = (World::new(&scene), drive(&scene).expect("free"));
    let (camera, found) = (camera(&scene), features(&scene));
    let all = observe(&scene, &world, &drive, &found, &camera, 3);
    assert_eq!(all.len(), drive.poses.len());
    let simulated = crate::simulate(&scene, &world, &drive, 3).scans;
    let (mut right, mut wrong, mut in_views) = (0, 0, 0);
    for (k, observed) in all.iter().enumerate() {
        assert_eq!(observed.scan.odometry, simulated[k].odometry, "one robot");
        assert!(observed.scan.readings.is_sorted_by(|a, b| a.bearing_rad >= b.bearing_rad));
        let views = in_view(&world, &drive, &found, &camera, k);
        in_views += views.len();
        for (reading, truth) in observed.scan.readings.iter().zip(&observed.truth) {
            assert_eq!(reading.identity, None);
            let (_, expected) = views.iter().find(|(number, _)| *number == truth.feature).expect("in view");
            assert!((reading.bearing_rad - expected[0]).abs() < 6.0 * camera.bearing_sigma_rad);
            if truth.matched {
                assert!((reading.disparity_px - expected[1]).abs() < 3.0);
                right += 1;
            } else {
                wrong += 1;
            }
        }
    }
    let (share, mismatched) = (f64::from(right + wrong) / in_views as f64, f64::from(wrong) / f64::from(right + wrong));
    assert!((share - 0.9).abs() < 0.06 && (mismatched - 0.2).abs() < 0.08, "{share} {mismatched}");
}

#[test]
fn a_robot_that_stands_sees_the_same_matches_fail_with_fresh_noise() {
    let scene = scene(FIELD);
    let (world, drive) = (World::new(&scene), drive(&scene).expect("free"));
    let all = observe(&scene, &world, &drive, &features(&scene), &camera(&scene), 3);
    let n = all.len();
    assert_eq!(drive.poses[n - 2].pose, drive.poses[n - 1].pose, "it stands at the end");
    let by_number = |k: usize| {
        let observed: &ObservedFeatures = &all[k];
        let mut truth = observed.truth.clone();
        truth.sort_by_key(|truth| truth.feature);
        truth
    };
    assert_eq!(by_number(n - 1), by_number(n - 2));
    assert_ne!(all[n - 1].scan.readings, all[n - 2].scan.readings);
}

#[test]
fn what_moves_hides_features() {
    let text = FIELD.replace("[odometry]", "[[mover]]\nradius = 0.3\nroute = [[4.0, 2.3], [4.0, 1.5]]\n[odometry]");
    let scene = scene(&text);
    let (world, drive) = (World::new(&scene), drive(&scene).expect("free"));
    let (camera, found) = (camera(&scene), features(&scene));
    let post = found.iter().position(|feature| feature.is_post).expect("one");
    let seen = |scan: usize| in_view(&world, &drive, &found, &camera, scan).iter().any(|(k, _)| *k == post);
    let views: Vec<bool> = (0..drive.poses.len()).map(seen).collect();
    assert!(views.contains(&true) && views.contains(&false), "somebody walks to and fro before it");
}

#[test]
fn a_default_camera_is_valid() {
    let scene = scene(FIELD);
    assert_eq!(FeatureCamera::of(&scene.camera, &Matcher::default()).check(), Ok(()));
}
