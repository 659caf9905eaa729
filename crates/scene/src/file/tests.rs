use std::fs;

use super::*;
use crate::{Area, ErrorKind, World, drive, truth};

/// The smallest scene there is.
const SMALL: &str = r#"name = "small"
[bounds]
min = [0.0, 0.0]
max = [4.0, 3.0]
[waypoints]
A = [1.0, 1.0]
B = [3.0, 1.0]
[route]
stops = ["A", "B"]
"#;

fn parsed(text: &str) -> Result<Scene, SceneError> {
    Scene::parse(text, Path::new("s.toml"), None)
}

fn refusal(text: &str) -> String {
    let error = parsed(text).map(|_| ()).expect_err(text);
    assert_eq!(error.kind(), ErrorKind::BadInput);
    let message = error.to_string();
    assert!(!message.contains('\n'), "one line: {message}");
    message
}

#[test]
fn the_smallest_scene_has_the_documented_defaults() {
    let scene = parsed(SMALL).expect("valid");
    assert_eq!((scene.grid.width, scene.grid.height), (80, 60));
    assert_eq!(scene.camera.columns, 140);
    assert!((scene.camera.field_of_view_rad - 80f64.to_radians()).abs() < 1e-15);
    assert_eq!(scene.matcher.stereo, sensor::Stereo::default());
    assert_eq!((scene.matcher.detection_rate, scene.matcher.quantisation), (0.6, 0.0));
    assert_eq!((scene.stages[0].name.as_str(), scene.stages[0].stops), ("end", 2));
    assert_eq!((scene.robot.radius_m, scene.robot.speed_m_s, scene.robot.scan_interval_s), (0.2, 0.5, 0.2));
    assert!(scene.obstacles.is_empty() && scene.regions.is_empty() && scene.known.is_none());
}

#[test]
fn every_refusal_says_where_what_and_what_to_do() {
    let golden = include_str!("refusals.txt");
    let mut renewed = String::new();
    for block in golden.trim_end().split("\n\n") {
        let lines = |mark: char| block.lines().filter_map(move |l| l.strip_prefix(mark)).collect::<Vec<_>>();
        let (out, put) = (lines('-').join("\n"), lines('+').join("\n"));
        let kept: Vec<&str> = block.lines().filter(|l| !l.starts_with('>')).collect();
        renewed += &kept.join("\n");
        if !block.starts_with('#') {
            assert!(SMALL.contains(&out), "no such lines: {out}");
            let text = if out.is_empty() { format!("{SMALL}{put}\n") } else { SMALL.replacen(&out, &put, 1) };
            renewed += &format!("\n> {}", refusal(&text));
        }
        renewed += "\n\n";
    }
    let renewed = format!("{}\n", renewed.trim_end());
    if std::env::var_os("RENEW").is_some() {
        fs::write("src/file/refusals.txt", &renewed).expect("w");
    }
    for (now, then) in renewed.lines().zip(golden.lines()) {
        assert_eq!(now, then);
    }
    assert_eq!(renewed, golden);
}

#[test]
fn more_cells_than_memory_are_counted_out() {
    let message = refusal(&SMALL.replace("max = [4.0, 3.0]", "max = [2000.0, 1000.0]\n[grid]\ncell = 0.04"));
    assert!(
        message.starts_with(
            "s.toml:6:8: [grid]: cell = 0.04 m makes 50000 x 25000 = 1250000000 cells, about 256.1 GiB: must fit the "
        ),
        "{message}"
    );
    assert!(message.ends_with(" that are free; use larger cells or smaller [bounds]"), "{message}");
}

#[test]
fn the_callers_cell_size_takes_the_place_of_the_files() {
    let text = format!("{SMALL}[grid]\ncell = 0.1\n");
    let with = |cell_m| Scene::parse(&text, Path::new("s.toml"), Some(cell_m));
    assert_eq!(with(0.25).expect("valid").grid.width, 16);
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-12] {
        let message = with(bad).map(|_| ()).expect_err("refused").to_string();
        let expected = format!(
            "the cell size asked for in place of the file's: cell = {bad}: must be a cell size in m, 0.0001 to 1000; give the side of a cell, such as 0.05"
        );
        assert_eq!(message, format!("s.toml:11:8: {expected}"));
    }
}

#[test]
fn windows_line_ends_and_a_byte_order_mark_change_nothing() {
    let windows = format!("\u{feff}{}", SMALL.replace('\n', "\r\n"));
    assert_eq!(parsed(&windows).expect("valid").waypoints, parsed(SMALL).expect("valid").waypoints);
    assert!(refusal(&windows.replace("4.0, 3.0", "4.0, x")).starts_with("s.toml:4:13: no valid TOML: "));
    assert_eq!(
        refusal(&windows.replace("\"small\"", "7")).split_once(": the"),
        refusal("name = 7").split_once(": the")
    );
}

#[test]
fn what_is_no_scene_file_at_all() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("s.toml");
    let load = |bytes: &[u8]| {
        fs::write(&path, bytes).expect("written");
        let message = Scene::load(&path, None).map(|_| ()).expect_err("refused").to_string();
        message.strip_prefix(&format!("{}", path.display())).map(str::to_owned).expect("the path comes first")
    };
    assert_eq!(load(b""), ":1:1: the scene: `name` is missing; add `name = \"...\"`");
    assert_eq!(
        load(b"name = \"a\"\nx = \"\xff\"\n"),
        ":2:6: byte 0xff is no UTF-8; must be a TOML text of at most 16 MiB in UTF-8"
    );
    assert_eq!(
        load(b"\x89PNG\r\n\x1a\n\0\0"),
        ":1:1: is a PNG image, not the TOML text that is asked for; give the YAML file that describes the map: \
         `scene from-map MAP.yaml --out SCENE.toml` makes a scene of it"
    );
    assert!(load(b"\0\0\0\0").starts_with(":1:5: no valid TOML: "));
    assert!(load(&vec![b'#'; (16 << 20) + 1]).starts_with(":1:1: more than 16 MiB; "));
    for deep in ["[".repeat(100_000), format!("x = {}", "[".repeat(100_000)), format!("x = {}", "{x=".repeat(50_000))] {
        assert!(load(deep.as_bytes()).contains(": no valid TOML: "));
    }
    assert!(load(format!("{}y = 1", "x.".repeat(100_000)).as_bytes()).starts_with(":1:"), "deep keys");
    for missing in [folder.path().join("none.toml"), folder.path().to_owned(), path.join("s.toml")] {
        let error = Scene::load(&missing, None).map(|_| ()).expect_err("refused");
        assert_eq!(error.kind(), ErrorKind::BadInput, "{error}");
        assert!(error.to_string().contains("cannot be read: "), "{error}");
    }
}

/// A map of 4 m x 3 m: a closed wall of one cell, a stain of unknown cells, a diagonal of cells.
fn map_scene(folder: &Path, more: &str) -> Result<Scene, SceneError> {
    let (width, height) = (40, 30);
    let mut pixels = vec![254u8; width * height];
    for row in 0..height {
        for column in 0..width {
            let border = row == 0 || column == 0 || row == height - 1 || column == width - 1;
            let diagonal = column >= 17 && column - 17 == row.wrapping_sub(3) && row < 9;
            let stain = (25..29).contains(&column) && (20..24).contains(&row);
            // Rows of the picture run down from the top.
            let pixel = &mut pixels[(height - 1 - row) * width + column];
            *pixel = if border || diagonal {
                0
            } else if stain {
                205
            } else {
                254
            };
        }
    }
    let mut pgm = format!("P5\n{width} {height}\n255\n").into_bytes();
    pgm.extend(pixels);
    fs::write(folder.join("m.pgm"), pgm).expect("written");
    let yaml = "image: m.pgm\nresolution: 0.1\norigin: [0.0, 0.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
    fs::write(folder.join("m.yaml"), yaml).expect("written");
    let text = format!(
        "name = \"m\"\nwaypoints = {{ A = [1.0, 2.0], B = [3.0, 2.0] }}\nroute.stops = [\"A\", \"B\"]\n[map]\nfile = \"m.yaml\"\ntexture = 0.5\n{more}"
    );
    Scene::parse(&text, &folder.join("s.toml"), None)
}

#[test]
fn a_map_becomes_watertight_boxes_and_unknown_cells_are_not_scored() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scene = map_scene(folder.path(), "").expect("valid");
    assert_eq!((scene.grid.width, scene.grid.height), (40, 30), "the map's own cells and extent");
    assert_eq!(scene.obstacles.len(), 4 + 6, "four walls, and a diagonal that no rectangle joins");
    let truth = truth(&scene);
    let count = |state| truth.values().iter().filter(|&&v| v == state).count();
    assert_eq!((count(Some(true)), count(None)), (2 * 40 + 2 * 28 + 6, 16));
    assert_eq!(drive(&scene).expect("free").stage_ends[0].0, "end");
    // No ray leaves, and none slips between cells that touch corner to corner.
    let world = World::new(&scene);
    let direction = |angle: f64| [angle.cos(), angle.sin()];
    for k in 0..20_000 {
        assert!(world.cast([1.0, 2.0], direction(f64::from(k) * 1e-3)).is_some());
    }
    let across = std::f64::consts::FRAC_1_SQRT_2;
    for k in 0..5 {
        let seam = [1.8 + 0.1 * f64::from(k), 0.4 + 0.1 * f64::from(k)];
        let hit = world.cast([seam[0] - 0.5 * across, seam[1] + 0.5 * across], [across, -across]).expect("a hit");
        assert!((hit.range_m - 0.5).abs() < 1e-6, "{hit:?}");
        assert!((scene.obstacles[hit.obstacle].texture - 0.5).abs() < 1e-15);
    }
}

#[test]
fn another_cell_size_keeps_what_the_map_does_not_know() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scene =
        map_scene(folder.path(), "[grid]\ncell = 0.05\n[bounds]\nmin = [0.0, 0.0]\nmax = [5.0, 3.0]\n").expect("valid");
    let truth = truth(&scene);
    let unknown = truth.values().iter().filter(|v| v.is_none()).count();
    assert_eq!(unknown, 4 * 16 + 20 * 60, "the stain, and all beyond the map");
    let occupied = truth.values().iter().filter(|&&v| v == Some(true)).count();
    assert_eq!(occupied, 4 * (2 * 40 + 2 * 28 + 6));
}

#[test]
fn a_turned_map_is_refused_with_what_to_do() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scene = |angle: &str| {
        map_scene(folder.path(), "").expect("valid");
        let yaml = fs::read_to_string(folder.path().join("m.yaml")).expect("there").replace("0.0, 0.0]", angle);
        fs::write(folder.path().join("m.yaml"), yaml).expect("written");
        let scene = "name = \"m\"\nwaypoints = { A = [1.0, 2.0], B = [3.0, 2.0] }\nroute.stops = [\"A\", \"B\"]\nmap.file = \"m.yaml\"\n";
        Scene::parse(scene, &folder.path().join("s.toml"), None)
    };
    let message = scene("0.0, 0.5]").map(|_| ()).expect_err("turned").to_string();
    assert!(
        message.contains("s.toml:4:12: ") && message.contains("must be a map whose origin has the angle 0, not 0.5"),
        "{message}"
    );
    assert!(message.contains("convert MAP.yaml STRAIGHT.yaml --origin X,Y,0"), "{message}");
    scene("0.0, 1e-9]").expect("the noise of a quaternion turns no cell");
}

#[test]
fn a_damaged_map_is_refused_at_its_key() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    map_scene(folder.path(), "").expect("valid");
    for (file, content) in
        [("m.pgm", &b"P5\n40 30\n255\n\0\0"[..]), ("m.yaml", b"image: m.pgm\n"), ("m.yaml", b"\0\x01")]
    {
        let before = fs::read(folder.path().join(file)).expect("there");
        fs::write(folder.path().join(file), content).expect("written");
        let scene = fs::read_to_string(folder.path().join("s.toml")).unwrap_or_else(|_| {
            "name = \"m\"\nwaypoints = { A = [1.0, 2.0], B = [3.0, 2.0] }\nroute.stops = [\"A\", \"B\"]\nmap.file = \"m.yaml\"\n".to_owned()
        });
        let error = Scene::parse(&scene, &folder.path().join("s.toml"), None).map(|_| ()).expect_err("refused");
        assert_eq!(error.kind(), ErrorKind::BadInput);
        let message = error.to_string();
        assert!(message.contains("s.toml:4:12: [map]: ") && message.contains(file), "{message}");
        fs::write(folder.path().join(file), before).expect("written");
    }
}

#[test]
fn the_room_is_the_papers() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/room.toml");
    let scene = Scene::load(&path, None).expect("valid");
    assert_eq!((scene.grid.width, scene.grid.height), (200, 160));
    let route: Vec<&str> = (0..scene.stops.len()).map(|s| scene.waypoint_of(s).name.as_str()).collect();
    assert_eq!(route, ["A", "B", "C", "B", "D", "B"]);
    let drive = drive(&scene).expect("a free way");
    assert!((250..350).contains(&drive.poses.len()), "{} scans", drive.poses.len());
    // X lies open, and was passed nearby only before the robot first came to B.
    let x = scene.regions.iter().find(|r| r.name == "X").expect("a region X");
    let Area::Disc { center_m, .. } = x.area else { panic!("X is a disc") };
    let first_at_b = drive
        .poses
        .iter()
        .position(|p| crate::geometry::distance(p.pose.position_m(), scene.waypoint_of(1).at_m) < 0.06);
    let nearest = |poses: &[crate::TimedPose]| {
        poses.iter().map(|p| crate::geometry::distance(p.pose.position_m(), center_m)).fold(f64::INFINITY, f64::min)
    };
    let (before, after) = drive.poses.split_at(first_at_b.expect("B is reached"));
    assert!(nearest(before) < 1.5 && nearest(after) > 4.5, "{} {}", nearest(before), nearest(after));
}

#[test]
fn what_comes_after_the_end_of_the_drive_is_suspicious() {
    let text = format!(
        "{SMALL}[[mover]]\nradius = 0.2\nroute = [[1.0, 2.0], [3.0, 2.0]]\nstart_s = 10.0\n[[chair]]\ncenter = [2.0, 2.5]\nradius = 0.1\n\
         moves = [{{ at_s = 3.0, to_m = [2.2, 2.5] }}, {{ at_s = 90.0, to_m = [2.0, 2.5] }}]\n[[door]]\nhinge = [0.5, 2.5]\nlength = 0.3\n\
         closed_deg = 0\nopen_deg = 90\nopen_s = [[0.0, 2.0], [3.0, 99.0]]\n"
    );
    let warnings: Vec<String> = parsed(&text).expect("valid").warnings.iter().map(ToString::to_string).collect();
    let end = "s is after the end of the drive, which takes about 4 s: it never happens; give an earlier time, or have the robot wait";
    let expected =
        [format!("s.toml:13:11: mover 1: start_s: 10 {end}"), format!("s.toml:17:9: chair 1: moves: 90 {end}")];
    assert_eq!(warnings, expected);
}
