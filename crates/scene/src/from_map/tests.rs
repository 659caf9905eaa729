use std::fs;

use super::*;
use crate::geometry::distance;
use proptest::prelude::*;

const YAML: &str =
    "image: m.pgm\nresolution: 0.2\norigin: [-1, 2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

/// Two rooms with a door, in a corner of what is unknown.
const ROOMS: [&str; 9] = [
    "??????????????????????????????",
    "####################??????????",
    "#........#.........#??????????",
    "#........#.........#??????????",
    "#..................?????.?????",
    "#..................#??????????",
    "#........#.........#??????????",
    "#........#.........#??????????",
    "####################??????????",
];

/// Writes a map and makes a scene of it in another folder.
fn made(lines: &[String], options: &SurveyOptions) -> (tempfile::TempDir, PathBuf, Result<MadeScene, MakeError>) {
    made_with(YAML, lines, options)
}

fn made_with(
    yaml: &str,
    lines: &[String],
    options: &SurveyOptions,
) -> (tempfile::TempDir, PathBuf, Result<MadeScene, MakeError>) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name);
    for made in ["maps", "scenes"] {
        fs::create_dir(at(made)).expect("made");
    }
    let mut pgm = format!("P5\n{} {}\n255\n", lines[0].len(), lines.len()).into_bytes();
    pgm.extend(lines.iter().flat_map(|line| line.chars()).map(|c| match c {
        '#' => 0u8,
        '.' => 254,
        _ => 205,
    }));
    fs::write(at("maps/m.pgm"), pgm).expect("written");
    fs::write(at("maps/m.yaml"), yaml).expect("written");
    let scene = at("scenes/m.toml");
    let made = from_map(&at("maps/m.yaml"), &scene, options, &|_| {});
    (folder, scene, made)
}

fn rooms() -> Vec<String> {
    ROOMS.iter().map(|line| (*line).to_owned()).collect()
}

#[test]
fn a_map_becomes_a_scene_that_is_driven() {
    let (folder, path, made) = made(&rooms(), &SurveyOptions::default());
    let made = made.expect("a scene");
    fs::write(&path, &made.text).expect("written");
    assert!(made.text.contains("file = \"../maps/m.yaml\""), "{}", made.text);
    let scene = Scene::load(&path, None).expect("valid");
    assert_eq!(scene.name, "m");
    let stops: Vec<[f64; 2]> = (0..scene.stops.len()).map(|stop| scene.waypoint_of(stop).at_m).collect();
    assert_eq!(stops, made.survey.stops_m);
    assert!(scene.stages.len() > 1 && scene.stages.iter().zip(["a", "b", "c"]).all(|(stage, name)| stage.name == name));
    assert_eq!(drive(&scene).expect("a free way").poses.len(), made.scans);
    assert!(made.survey.seen > 0.95, "{}", made.survey.seen);
    // What is far from the floor is left out, and the rest is what the map says, cell by cell.
    let map = ros_map::read(&folder.path().join("maps/m.yaml")).expect("a map");
    assert!(scene.grid.width < map.spec.width && scene.grid.height == map.spec.height, "{:?}", scene.grid);
    let truth = crate::truth(&scene);
    for cell in 0..scene.grid.cells() {
        let there = map.spec.locate(scene.grid.centre(cell)).expect("inside");
        assert_eq!(truth[cell], map.cells()[there], "unknown cells are not scored");
    }
    assert!(truth.values().contains(&None));
}

#[test]
fn every_leg_keeps_its_distance_from_every_box() {
    let options = SurveyOptions::default();
    let (folder, path, made) = made(&rooms(), &options);
    let scene = Scene::parse(&made.expect("a scene").text, &path, None).expect("valid");
    for stop in 1..scene.stops.len() {
        let (from, to) = (scene.waypoint_of(stop - 1).at_m, scene.waypoint_of(stop).at_m);
        let samples = (distance(from, to) / 0.001).ceil() as usize;
        for k in 0..=samples {
            let at = [0, 1].map(|a| from[a] + k as f64 / samples as f64 * (to[a] - from[a]));
            let nearest = scene.obstacles.iter().map(|o| o.shape.distance_m(at)).fold(f64::INFINITY, f64::min);
            assert!(nearest > options.robot.radius_m + options.clearance_m - 1e-3, "{at:?}: {nearest}");
        }
    }
    drop(folder);
}

#[test]
fn the_robots_own_map_in_the_repository_is_driven() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let made =
        from_map(&root.join("maps/UMA_236_237.yaml"), &root.join("new.toml"), &SurveyOptions::default(), &|_| {});
    let made = made.expect("a scene");
    assert!(made.text.contains("file = \"maps/UMA_236_237.yaml\""), "{}", made.text);
    assert!(made.scans > 100 && made.survey.seen > 0.97);
}

#[test]
fn a_floor_plan_becomes_a_scene_that_is_driven() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let plan = folder.path().join("flat.json");
    // Two rooms, a wall of 0.12 m between them, a door of 0.8 m in it.
    let verts = "[[0, 0], [4, 0], [4, 2], [4.12, 2], [4.12, 0], [8, 0], [8, 5], [4.12, 5], [4.12, 2.8], [4, 2.8], [4, 5], [0, 5]]";
    fs::write(&plan, format!("{{\"id\": \"flat\", \"verts\": {verts}}}")).expect("written");
    let path = folder.path().join("flat.toml");
    let made = from_plan(&plan, &path, &SurveyOptions::default(), &|_| {}).expect("a scene");
    assert!(made.survey.seen > 0.95, "{}", made.survey.seen);
    let scene = Scene::parse(&made.text, &path, None).expect("valid");
    let side = |left: bool| made.survey.stops_m.iter().any(|s| (s[0] < 4.0) == left);
    assert!(side(true) && side(false), "both rooms: {:?}", made.survey.stops_m);
    let truth = crate::truth(&scene);
    let within_wall = scene.grid.locate([4.06, 1.0]).expect("inside");
    assert_ne!(truth[within_wall], Some(false), "the inside of a wall is no free space");
    let wide = SurveyOptions { clearance_m: 0.25, ..SurveyOptions::default() };
    let alone = from_plan(&plan, &path, &wide, &|_| {}).expect("a scene");
    let left = alone.survey.stops_m.iter().filter(|s| s[0] < 4.06).count();
    assert!(left == 0 || left == alone.survey.stops_m.len(), "0.9 m do not fit the door: {:?}", alone.survey.stops_m);
}

#[test]
fn what_makes_no_scene_says_which_file_and_why() {
    let refusal = |lines: &[&str]| {
        let lines: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
        let (_folder, _, made) = made(&lines, &SurveyOptions::default());
        let error = made.expect_err("refused");
        assert_eq!(error.kind(), ErrorKind::BadInput);
        error.to_string()
    };
    assert!(refusal(&["???", "???"]).contains("m.yaml: none of its 6 cells is free (0 are occupied, 6 unknown)"));
    let open = refusal(&["....", "...?"]);
    assert!(open.contains("m.yaml: none of its 8 cells is occupied (7 are free, 1 unknown)"), "{open}");
    assert!(
        refusal(&["###", "#.#", "###"]).contains("m.yaml: a robot of radius 0.2 m with 0.05 m to spare fits nowhere")
    );
    let missing =
        from_map(Path::new("no/m.yaml"), Path::new("s.toml"), &SurveyOptions::default(), &|_| {}).expect_err("missing");
    assert!(missing.to_string().contains("no/m.yaml"), "{missing}");
    let missing = from_plan(Path::new("no/p.json"), Path::new("s.toml"), &SurveyOptions::default(), &|_| {})
        .expect_err("missing");
    assert!(missing.to_string().starts_with("no/p.json: cannot be read"), "{missing}");
}

#[test]
fn a_turned_map_is_refused_before_anything_is_planned() {
    let yaml = YAML.replace("2, 0]", "2, 1.56]");
    let (folder, _, made) = made_with(&yaml, &rooms(), &SurveyOptions::default());
    let message = made.expect_err("turned").to_string().replace(&format!("{}/", folder.path().display()), "");
    let expected = "maps/m.yaml:3:17: origin angle = 1.56: must be 0, since cells lie along x and y; `convert maps/m.yaml STRAIGHT.yaml --origin -1,2,0` keeps its cells and lays its rows along x";
    assert_eq!(message, expected);
}

#[test]
fn a_map_in_projected_coordinates_gets_an_origin_of_its_own() {
    let (_near_folder, near_path, near) = made(&rooms(), &SurveyOptions::default());
    let near = near.expect("a scene");
    let yaml = YAML.replace("[-1, 2, 0]", "[500012.35, 4649776.22, 0]");
    let far = SurveyOptions { start_m: Some([500_013.5, 4_649_777.0]), ..SurveyOptions::default() };
    let refusal = made_with(&yaml, &rooms(), &far).2.expect_err("beside the floor").to_string();
    assert!(
        refusal.contains("start 500013.5,4649777: ") && refusal.ends_with("there is 500014.650,4649776.920"),
        "{refusal}"
    );
    let start_m = Some([500_014.65, 4_649_776.92]);
    let (_folder, path, made) = made_with(&yaml, &rooms(), &SurveyOptions { start_m, ..SurveyOptions::default() });
    let made = made.expect("a scene");
    assert!(made.text.contains("origin = [0.0, 0.0]"), "{}", made.text);
    let [warning] = made.warnings.as_slice() else { panic!("{:?}", made.warnings) };
    assert!(
        warning.to_string().contains("m.yaml:3:10: origin = [500012.35, 4649776.22]: more than 1000000 m away"),
        "{warning}"
    );
    assert!(distance(made.survey.stops_m[0], [2.3, 0.7]) < 0.01, "{:?}", made.survey.stops_m);
    fs::write(&path, &made.text).expect("written");
    let occupied = |scene: &Scene| crate::truth(scene).values().iter().filter(|&&v| v == Some(true)).count();
    let other = Scene::load(&path, None).expect("valid");
    fs::write(&near_path, &near.text).expect("written");
    let home = Scene::load(&near_path, None).expect("valid");
    assert_eq!((made.cells, occupied(&other)), (near.cells, occupied(&home)));
    assert!(occupied(&home) > 20);
}

#[test]
fn a_drive_outside_the_walls_is_told_of() {
    let closed = made(&rooms(), &SurveyOptions::default()).2.expect("a scene");
    assert!(closed.warnings.is_empty() && closed.enclosure.on_nothing < 0.1, "{:?}", closed.enclosure);
    assert!(closed.enclosure.inside_m > 0.9 * closed.enclosure.length_m, "{:?}", closed.enclosure);
    // The same building, but the outside is free and the door open.
    let mut leaky: Vec<String> = rooms().iter().map(|line| line.replace('?', ".")).collect();
    leaky.extend(vec![".".repeat(30); 20]);
    let leaky = made(&leaky, &SurveyOptions::default()).2.expect("a scene");
    let Enclosure { length_m, inside_m, .. } = leaky.enclosure;
    assert!(inside_m < 0.5 * length_m, "{:?}", leaky.enclosure);
    let warning = leaky.warnings.iter().map(ToString::to_string).next().expect("a warning");
    assert!(
        warning.contains("m.yaml: ") && warning.contains("does the robot drive outside the building?"),
        "{warning}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn any_map_is_refused_or_driven(width in 3usize..25, height in 3usize..25, cells in prop::collection::vec(0u32..40, 625), radius in 0.05f64..0.4) {
        let lines: Vec<String> = cells.chunks(width).take(height).map(|row| row.iter().map(|&c| match c {
            0 => '#',
            1 => '?',
            _ => '.',
        }).chain(std::iter::repeat('#')).take(width).collect()).collect();
        let mut options = SurveyOptions::default();
        options.robot.radius_m = radius;
        options.camera.columns = 20;
        let (_folder, _, made) = made(&lines, &options);
        match made {
            Ok(made) => prop_assert!(made.scans > 1),
            Err(error) => prop_assert!(matches!(error, MakeError::Survey { .. }), "{}", error),
        }
    }
}
