//! `features`: from posts, scenes and tables to landmarks.

use std::fs;
use std::path::Path;

use assert_cmd::Command;

use crate::checked::checked;

fn run(folder: &Path, code: i32, args: &[&str]) -> (String, String) {
    let args = [&["features"], args].concat();
    let mut program = Command::cargo_bin("experiments").expect("built");
    checked(code, &args, &program.current_dir(folder).args(&args).output().expect("runs"))
}

/// The value of a metric in the CSV that is printed.
fn mean(out: &str, filter: &str, metric: &str) -> f64 {
    let line = out.lines().find(|line| line.starts_with(&format!("{filter},{metric},")));
    let line = line.unwrap_or_else(|| panic!("{filter} {metric} in {out}"));
    let mut fields = csv::ReaderBuilder::new().has_headers(false).from_reader(line.as_bytes());
    let record = fields.records().next().expect("a line").expect("fields");
    record[4].parse().expect("a number")
}

#[test]
fn posts_are_mapped_and_what_is_left_can_be_read_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path();
    let filters = "fastslam2,fastslam1,known-poses";
    let (out, err) =
        run(path, 0, &["--posts", "25", "--filter", filters, "--particles", "12", "--format", "csv", "--out", "a"]);
    assert_eq!(err, "", "silence means that all is well");
    assert_eq!(out.lines().next(), Some("filter,metric,unit,runs,mean,low,high"));
    assert!(mean(&out, "known-poses", "landmark_error") < 0.2 && mean(&out, "known-poses", "missed_landmarks") < 4.0);
    assert!(mean(&out, "fastslam2", "ate") < mean(&out, "odometry", "ate"));
    assert!((0.0..=1.0).contains(&mean(&out, "fastslam2", "within_95")));
    for name in
        ["trajectory.txt", "landmarks.csv", "features.csv", "metrics.csv", "updates.csv", "features.png", "run.json"]
    {
        assert!(path.join("a").join(name).exists(), "{name}");
    }
    let poses = logs::Trajectory::open(&path.join("a/trajectory.txt")).expect("TUM");
    let rows = logs::table::features::open(&path.join("a/features.csv")).expect("a table");
    assert_eq!(poses.poses().len(), rows.len());

    // The same readings as a table, by the same camera: the same way to the byte, on another number of threads.
    let camera: serde_json::Value =
        serde_json::from_slice(&fs::read(path.join("a/run.json")).expect("readable")).expect("JSON");
    let camera = &camera["configuration"]["camera"];
    let sigma = camera["bearing_sigma_rad"].to_string();
    let table =
        ["a/features.csv", "--particles", "12", "--vantage", "inf", "--threads", "1", "--bearing-sigma", &sigma];
    run(path, 0, &[&table[..], &["--out", "b"]].concat());
    for name in ["trajectory.txt", "landmarks.csv", "features.csv", "updates.csv"] {
        let [a, b] = ["a", "b"].map(|out| fs::read(path.join(out).join(name)).expect("readable"));
        assert!(a == b, "{name}");
    }
    let (known, _) =
        run(path, 0, &["a/features.csv", "--identity", "known", "--particles", "12", "--format", "csv", "--out", "c"]);
    assert!(mean(&known, "fastslam2", "wrong_associations").abs() < 1e-9);
}

#[test]
fn the_terminal_says_what_was_done_and_which_filter_is_better() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let args = ["--posts", "6", "--filter", "fastslam2,fastslam1", "--particles", "3", "--runs", "6", "--out", "a"];
    let (out, err) = run(folder.path(), 0, &args);
    let mut lines = out.lines();
    assert_eq!(lines.next(), Some("features of field of 6 posts"));
    let second = lines.next().unwrap_or_default();
    assert!(second.ends_with("readings in the first of 6 runs; 3 particles"), "{second}");
    assert!(out.contains("\nATE of fastslam2 less that of fastslam1: "), "{out}");
    assert!(err.starts_with("a in ") && err.contains("ms a scan"), "{err}");
    let runs = fs::read_to_string(folder.path().join("a/metrics.csv")).expect("readable");
    assert_eq!(runs.lines().filter(|line| line.starts_with("fastslam1,") && line.contains(",ate,")).count(), 6);
}

const CORNER: &str = r#"
name = "corner"
bounds = { min = [0.0, 0.0], max = [6.0, 4.0] }
waypoints = { A = [1.0, 1.0], B = [3.0, 1.0] }
route.stops = ["A", "B"]
"#;

#[test]
fn what_is_missing_is_said_in_one_line_with_what_to_do() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path();
    let write = |name: &str, text: &str| fs::write(path.join(name), text).expect("writable");
    write("bare.toml", CORNER);
    write("box.toml", &format!("{CORNER}[[box]]\ncenter = [5.0, 2.0]\nsize = [0.4, 2.0]\n"));
    write("plain.csv", "scan,time_s,bearing_rad,disparity_px\n0,0,0.1,9\n1,1,0.1,9.5\n");
    write(
        "odometry.csv",
        "scan,time_s,bearing_rad,disparity_px,odom_x_m,odom_y_m,odom_theta_rad\n0,0,0.1,9,0,0,0\n1,1,,,0.1,0,0\n",
    );
    write("degrees.csv", "scan,time_s,bearing_rad,disparity_px\n0,0,20,9\n");
    for (args, message) in [
        (&["bare.toml"][..], "the scene has no vertical edge"),
        (&["box.toml"], "scan 1 of box.toml has no pose by odometry, which --filter fastslam2 needs of every scan"),
        (
            &["plain.csv", "--filter", "known-poses"],
            "scan 1 of plain.csv has no pose, which --filter known-poses needs",
        ),
        (&["odometry.csv", "--identity", "known"], "scan 1 of odometry.csv has a reading without a feature"),
        (
            &["degrees.csv"],
            "degrees.csv:2: column bearing_rad: \"20\" must be between -pi/2 and pi/2 rad: is it in degrees?",
        ),
        (&["nowhere.csv"], "nowhere.csv: cannot be opened"),
        (&["box.toml", "--posts", "5"], "cannot be used with"),
        (&[], "required"),
        (&["--posts", "0"], "0 is not in 1..=2000"),
        (&["--posts", "5", "--vantage", "0"], "must be a number above 0, or inf"),
        (&["--posts", "5", "--noise", "1,2"], "must be four numbers"),
        (&["--posts", "5", "--filter", "fastslam3"], "fastslam2"),
        (
            &["plain.csv", "--filter", "fastslam2", "--drives"],
            "--drives: a table does not say what stands in the world",
        ),
        (&["--posts", "5", "--at-most", "false=1"], "metrics are ate, "),
    ] {
        let (out, err) = run(path, 2, args);
        assert!(out.is_empty() && err.contains(message), "{args:?}: {err}");
        assert!(!path.join("results").exists(), "{args:?} leaves nothing behind");
    }
    let (_, err) =
        run(path, 0, &["box.toml", "--filter", "known-poses", "--particles", "7", "--fov", "60", "--out", "a"]);
    assert!(err.contains("warning: --fov: has no effect on box.toml, which has a camera of its own"), "{err}");
    assert!(err.contains("warning: --particles: has no effect on box.toml, from known poses"), "{err}");
    let landmarks = fs::read_to_string(path.join("a/landmarks.csv")).expect("readable");
    assert!(landmarks.lines().count() > 1, "the corners of the box: {landmarks}");
    run(path, 0, &["odometry.csv", "--particles", "3", "--out", "b"]);
}

/// A planner takes walls between two corners for free where it has nothing but landmarks, and the grid of the same drive has them.
#[test]
fn drives_on_landmarks_lead_into_walls_and_bounds_fail_the_build() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let args = ["room", "--filter", "known-poses", "--drives", "--format", "csv"];
    let most = |code: i32, bounds: &[&str], out: &str| {
        run(folder.path(), code, &[&args[..], bounds, &["--out", out]].concat())
    };
    let (out, _) = most(0, &["--at-most", "grid_colliding=0.2"], "a");
    let of = |metric: &str| mean(&out, "known-poses", metric);
    assert!(of("grid_reached") > of("reached") && of("colliding") > of("grid_colliding"), "{out}");
    assert!((of("reached") + of("colliding")) <= 1.0 + 1e-9, "{out}");
    let (_, err) = most(3, &["--at-most", "colliding=0.01"], "b");
    assert!(err.contains("colliding is ") && err.contains("above 0.01"), "{err}");
    assert!(folder.path().join("b/landmarks.csv").exists(), "what is to be looked into is there");
    let (_, err) = most(2, &["--at-most", "ate=1"], "c");
    assert!(err.contains("there is no ate here, which needs true poses, and a filter that finds the way"), "{err}");
}
