//! `slam`, as it is typed: what it finds, writes and refuses.

use crate::recorded;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;

use experiments::worlds::ground::Ground;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use sensor::{Laser, OdometryNoise, Pose, Scan, Step};

use crate::checked::checked;
use crate::closet::SCENE;

fn run(folder: &Path, code: i32, args: &[&str]) -> (String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
    checked(code, &args, &command.current_dir(folder).args(args).output().expect("runs"))
}

/// A laser's scans of a drive through the room, and the poses by standard odometry.
struct Drive {
    scans: Vec<Scan>,
    odometry: Vec<Pose>,
}

static DRIVE: LazyLock<Drive> = LazyLock::new(|| {
    let room: Ground = recorded::room();
    let laser = Laser { max_range_m: 20.0, ..Laser::default() };
    let scans = recorded::scans(&room, &laser, 4, 120);
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let mut odometry = vec![scans[0].pose];
    for pair in scans.windows(2) {
        let step = OdometryNoise::STANDARD.sample(&Step::between(pair[0].pose, pair[1].pose), &mut rng);
        odometry.push(step.end(odometry[odometry.len() - 1]));
    }
    Drive { scans, odometry }
});

/// The drive as a table of ranges; without odometry where that is not wanted, and with other times.
fn table(with_odometry: bool, time_s: impl Fn(usize, f64) -> f64) -> String {
    let more = if with_odometry { ",odom_x_m,odom_y_m,odom_theta_rad" } else { "" };
    let mut text = format!("scan,time_s,x_m,y_m,theta_rad,bearing_rad,range_m{more}\n");
    for (k, (scan, odometry)) in DRIVE.scans.iter().zip(&DRIVE.odometry).enumerate() {
        let at = |pose: &Pose| format!("{:.5},{:.5},{:.6}", pose.x_m, pose.y_m, pose.theta_rad);
        let more = if with_odometry { format!(",{}", at(odometry)) } else { String::new() };
        for (bearing, reading) in scan.bearings_rad.iter().zip(&scan.readings) {
            let range =
                reading.filter(|range| range.is_finite()).map_or("inf".to_owned(), |range| format!("{range:.4}"));
            let _ = writeln!(text, "{k},{:.3},{},{bearing:.6},{range}{more}", time_s(k, scan.time_s), at(&scan.pose));
        }
    }
    text
}

/// The true way, in TUM form.
fn truth() -> String {
    let row = |scan: &Scan| {
        let (sin, cos) = libm::sincos(0.5 * scan.pose.theta_rad);
        format!("{:.3} {} {} 0 0 0 {sin} {cos}\n", scan.time_s, scan.pose.x_m, scan.pose.y_m)
    };
    DRIVE.scans.iter().map(row).collect()
}

fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("drive.csv"), table(true, |_, time_s| time_s)).expect("writable");
    fs::write(folder.path().join("truth.tum"), truth()).expect("writable");
    folder
}

/// Mean of a metric of a trajectory.
fn mean(folder: &Path, trajectory: &str, metric: &str) -> f64 {
    let mut reader = csv::Reader::from_path(folder.join("metrics.csv")).expect("readable");
    let heads = reader.headers().expect("heads").clone();
    let column = |name: &str| heads.iter().position(|head| head == name).expect("a column");
    let [who, which, mean] = ["trajectory", "metric", "mean"].map(column);
    let rows: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().expect("rows");
    let row = rows.iter().find(|row| &row[who] == trajectory && &row[which] == metric).expect("a row");
    row[mean].parse().expect("a number")
}

#[test]
fn the_way_is_found_and_everything_is_written() {
    let folder = place();
    let path = folder.path();
    let (out, err) = run(
        path,
        0,
        &["slam", "drive.csv", "--truth", "truth.tum", "--particles", "5", "--max-range", "20", "--out", "o"],
    );
    let found = path.join("o");
    let [slam, odometry] = ["slam", "odometry"].map(|name| mean(&found, name, "ate"));
    assert!(odometry > 0.1 && slam < 0.03 && slam < 0.25 * odometry, "{slam} {odometry}\n{out}");
    assert!(out.contains("5 particles of visibility") && out.contains("ate rotation"), "{out}");
    assert!(out.lines().all(|line| line.chars().count() <= 80), "{out}");
    assert!(!err.contains("warning"), "{err}");

    let trajectory = fs::read_to_string(found.join("trajectory.txt")).expect("readable");
    let rows: Vec<Vec<f64>> = trajectory
        .lines()
        .map(|line| line.split(' ').map(|field| field.parse().expect("a number")).collect())
        .collect();
    assert_eq!(rows.len(), DRIVE.scans.len(), "a row for every scan");
    for (row, scan) in rows.iter().zip(&DRIVE.scans) {
        assert_eq!(row.len(), 8);
        assert!((row[0] - scan.time_s).abs() < 2e-3, "the log's own clock");
        assert!((row[6].powi(2) + row[7].powi(2) - 1.0).abs() < 1e-6);
    }
    let updates = csv::Reader::from_path(found.join("updates.csv")).expect("readable").into_records().count();
    assert!(updates > 10 && updates < rows.len(), "{updates}");
    for name in ["map.npy", "map.yaml", "map.pgm", "trajectory.png", "along.png", "run.json"] {
        assert!(fs::metadata(found.join(name)).is_ok_and(|file| file.len() > 0), "{name}");
    }

    let page = fs::read_to_string(found.join("report.html")).expect("readable");
    let data = page.split("id=\"cloud-data\">").nth(1).and_then(|rest| rest.split("</script>").next()).expect("data");
    let data: serde_json::Value = serde_json::from_str(data).expect("JSON");
    let moments = data["moments"].as_array().expect("moments");
    assert_eq!(moments.len(), updates, "every update can be stepped to");
    assert!(moments.iter().all(|moment| moment["particles"].as_array().map(Vec::len) == Some(20)));
    let command = "sightgrid slam drive.csv --particles 5 --truth truth.tum --max-range 20.0";
    assert!(page.contains(command), "what to type stands on the page");
}

#[test]
fn the_same_seed_gives_the_same_bytes_whatever_the_threads() {
    let folder = place();
    let slam = |out: &str, more: &[&str]| {
        let args = ["slam", "drive.csv", "--particles", "3", "--max-range", "20", "--window", "0,25", "--out", out];
        run(folder.path(), 0, &[&args, more].concat());
        let read = |name: &str| fs::read(folder.path().join(out).join(name)).expect("readable");
        ["trajectory.txt", "updates.csv", "map.npy", "report.html"].map(read)
    };
    let one = slam("one", &["--threads", "1"]);
    assert!(one == slam("three", &["--threads", "3"]));
    assert!(one[0] != slam("other", &["--seed", "2"])[0], "another seed is another run");
}

#[test]
fn what_is_written_is_read_again() {
    let folder = place();
    run(
        folder.path(),
        0,
        &["slam", "drive.csv", "--particles", "2", "--max-range", "20", "--window", "0,25", "--out", "o"],
    );
    let replay =
        ["replay", "drive.csv", "--trajectory", "o/trajectory.txt", "--mappers", "visibility", "--max-range", "20"];
    let (out, _) = run(folder.path(), 0, &[&replay[..], &["--window", "0,25", "--out", "r"]].concat());
    assert!(out.contains("visibility"), "{out}");
    run(folder.path(), 0, &["score", "o/map.yaml", "--truth", "o/map.yaml", "--out", "s"]);
}

#[test]
fn bad_input_is_refused_before_any_work() {
    let folder = place();
    let path = folder.path();
    fs::write(path.join("poses.csv"), table(false, |_, time_s| time_s)).expect("writable");
    fs::write(path.join("still.toml"), SCENE).expect("writable");
    fs::write(path.join("none.relations"), "1 2 three 0 0 0 0 0\n").expect("writable");
    fs::write(path.join("empty.csv"), "").expect("writable");
    for (args, said) in [
        (&["poses.csv"][..], &["poses.csv, line 2", "no pose by odometry", "odom_x_m", "replay"][..]),
        (&["still.toml"], &["still.toml", "no odometry", "[odometry]"]),
        (&["drive.csv", "--mapper", "no-such"], &["no-such"]),
        (&["drive.csv", "--weight", "evidence", "--mapper", "conventional"], &["does not predict readings"]),
        (&["drive.csv", "--particles", "0"], &["--particles"]),
        (&["drive.csv", "--window", "5000,6000"], &["drive.csv", "none of its", "--window"]),
        (&["drive.csv", "--truth", "absent.tum"], &["absent.tum"]),
        (&["drive.csv", "--relations", "none.relations"], &["none.relations:1"]),
        (&["drive.csv", "--grid", "0.0001"], &["drive.csv", "--grid"]),
        (&["empty.csv"], &["empty.csv"]),
        (&["absent.log"], &["absent.log"]),
    ] {
        let (out, err) = run(path, 2, &[&["slam"][..], args, &["--out", "o"]].concat());
        assert!(said.iter().all(|said| err.contains(said)), "{args:?}\n{err}");
        assert_eq!(out, "", "{args:?}");
        assert!(!path.join("o").exists(), "{args:?} left something behind");
    }
}

#[test]
fn clocks_that_jump_are_told_of_and_the_rest_is_mapped() {
    let folder = place();
    let jumps = table(true, |k, time_s| if (30..33).contains(&k) { time_s - 20.0 } else { time_s });
    fs::write(folder.path().join("jumps.csv"), jumps).expect("writable");
    let args = ["slam", "jumps.csv", "--particles", "1", "--max-range", "20", "--window=-100,25", "--out", "o"];
    let (_, err) = run(folder.path(), 0, &args);
    assert!(err.contains("warning") && err.contains("clock"), "{err}");
}

#[test]
fn a_robot_that_was_carried_away_is_told_of_with_its_time() {
    let folder = place();
    let path = folder.path();
    // The odometry stands still where somebody carries the robot on by a third of the way.
    let (before, after) = (45, 85);
    let kept: Vec<usize> = (0..before).chain(after..DRIVE.scans.len()).collect();
    let whole = table(true, |_, time_s| time_s);
    let mut lines = whole.lines();
    let mut text = format!("{}\n", lines.next().expect("a head"));
    let rows: Vec<&str> = lines.collect();
    let beams = DRIVE.scans[0].readings.len();
    for (number, k) in kept.iter().enumerate() {
        let shown = DRIVE.odometry[*k];
        let (from, to) = (DRIVE.odometry[after], DRIVE.odometry[before]);
        let pose = if *k < before { shown } else { Step::between(from, shown).end(to) };
        for row in &rows[k * beams..(k + 1) * beams] {
            let fields: Vec<&str> = row.split(',').collect();
            let moved = format!("{:.5},{:.5},{:.6}", pose.x_m, pose.y_m, pose.theta_rad);
            let time = format!("{:.3}", DRIVE.scans[number].time_s);
            let _ = writeln!(text, "{number},{time},{},{moved}", fields[2..7].join(","));
        }
    }
    fs::write(path.join("carried.csv"), text).expect("writable");
    let (_, err) = run(path, 0, &["slam", "carried.csv", "--particles", "3", "--max-range", "20", "--out", "o"]);
    assert!(err.contains("warning: carried.csv: at ") && err.contains("carried away"), "{err}");
    let record: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(path.join("o/run.json")).expect("readable")).expect("JSON");
    let away = record["findings"]["carried_away_s"].as_array().expect("times");
    let moment_s = DRIVE.scans[before].time_s;
    let first = away[0].as_f64().expect("a time");
    assert!((moment_s - 1.0..moment_s + 15.0).contains(&first), "{first}, carried at {moment_s}");
}

#[test]
fn bounds_on_errors_fail_the_build_and_what_was_found_is_kept() {
    let folder = place();
    let slam = |code: i32, bounds: &[&str], out: &str| {
        let args =
            ["slam", "drive.csv", "--truth", "truth.tum", "--particles", "1", "--max-range", "20", "--window", "0,25"];
        run(folder.path(), code, &[&args[..], bounds, &["--out", out]].concat()).1
    };
    slam(0, &["--at-most", "ate=0.2", "--at-most", "rpe_1m=0.2"], "good");
    let err = slam(3, &["--at-most", "ate=0.000001", "--at-most", "ate_rotation=90"], "bad");
    assert!(err.contains("ate is ") && err.contains("above 0.000001") && !err.contains("rotation"), "{err}");
    assert!(folder.path().join("bad/trajectory.txt").exists(), "what is to be looked into is there");
    let err = slam(2, &["--at-most", "relations_loops=0.1"], "none");
    assert!(err.contains("relations_loops") && err.contains("--relations"), "{err}");
}

#[test]
fn a_scene_brings_its_own_truth() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("closet.toml"), format!("{SCENE}[odometry]\n")).expect("writable");
    let (out, _) = run(folder.path(), 0, &["slam", "closet.toml", "--particles", "9", "--out", "o"]);
    assert!(out.contains("odometry") && out.contains("ate"), "{out}");
    assert!(mean(&folder.path().join("o"), "odometry", "ate") > 0.0);
    assert!(mean(&folder.path().join("o"), "slam", "nees") > 0.0, "the frame of a scene is known");
    assert!(!folder.path().join("o/landmarks.csv").exists());
}

#[test]
fn landmarks_stand_beside_the_grid_where_a_scene_has_features() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("closet.toml"), format!("{SCENE}[odometry]\n")).expect("writable");
    let args = ["slam", "closet.toml", "--particles", "3", "--landmarks"];
    let slam = |more: &[&str]| run(folder.path(), 0, &[&args[..], more].concat());
    slam(&["--out", "a", "--threads", "1"]);
    slam(&["--out", "b", "--threads", "3"]);
    for name in ["trajectory.txt", "landmarks.csv"] {
        let [a, b] = ["a", "b"].map(|out| fs::read_to_string(folder.path().join(out).join(name)).expect("readable"));
        assert!(a == b && a.lines().count() > 1, "{name}: {a}");
    }
    fs::write(folder.path().join("log.csv"), table(true, |_, time_s| time_s)).expect("writable");
    let (_, err) = run(folder.path(), 2, &["slam", "log.csv", "--landmarks"]);
    assert!(err.contains("--landmarks: log.csv is a log, whose scans have no features"), "{err}");
}

#[test]
fn worlds_are_scored_by_grid_by_landmarks_and_by_both() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let args = ["slam-worlds", "--families", "clutter", "--seeds", "1", "--sensors", "stereo", "--particles", "3"];
    let weights = ["--weights", "field,field+landmarks,evidence+landmarks,landmarks"];
    let (out, _) = run(folder.path(), 0, &[&args[..], &weights, &["--format", "csv"]].concat());
    let rows: Vec<Vec<&str>> = out.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let weights: Vec<&str> = rows.iter().map(|row| row[3]).collect();
    assert_eq!(weights, ["field", "field+landmarks", "evidence+landmarks", "landmarks"]);
    let ates: Vec<f64> = rows.iter().map(|row| row[5].parse().expect("a number")).collect();
    assert!(ates.iter().all(|ate| (0.0..0.5).contains(ate)), "{ates:?}");
    assert!((ates[0] - ates[1]).abs() > 0.0, "landmarks are looked at");
    assert!(rows[3][4].is_empty(), "landmarks alone have no power");
    let (text, _) = run(folder.path(), 0, &[&args[..], &["--weights", "landmarks"]].concat());
    assert!(text.contains("landmarks"), "{text}");
}

/// The drive as a table of two sensors, to which the beams of the laser are dealt; by the function, which of them each beam is of.
fn dealt(sensor: impl Fn(usize) -> usize) -> String {
    let whole = table(true, |_, time_s| time_s);
    let beams = DRIVE.scans[0].readings.len();
    let mut lines = whole.lines();
    let mut text = format!("{},sensor\n", lines.next().expect("a head"));
    for (number, row) in lines.enumerate() {
        let _ = writeln!(text, "{row},{}", sensor(number % beams));
    }
    text
}

/// Times and places of a trajectory.
fn places(folder: &Path) -> Vec<[f64; 3]> {
    let text = fs::read_to_string(folder.join("trajectory.txt")).expect("readable");
    let row = |line: &str| {
        let fields: Vec<f64> = line.split(' ').map(|field| field.parse().expect("a number")).collect();
        [fields[0], fields[1], fields[2]]
    };
    text.lines().map(row).collect()
}

#[test]
fn beams_that_are_dealt_to_two_sensors_give_the_way_of_the_one() {
    let folder = place();
    let path = folder.path();
    fs::write(path.join("named.csv"), dealt(|_| 7)).expect("writable");
    fs::write(path.join("two.csv"), dealt(|beam| 3 + beam % 2)).expect("writable");
    let slam = |log: &str, out: &str| {
        let args = ["slam", log, "--particles", "5", "--max-range", "20", "--window", "0,25", "--out", out];
        run(path, 0, &args).0
    };
    slam("drive.csv", "one");
    slam("named.csv", "named");
    let text = slam("two.csv", "two");
    let bytes = |out: &str, name: &str| fs::read(path.join(out).join(name)).expect("readable");
    for name in ["trajectory.txt", "updates.csv", "map.npy"] {
        assert!(bytes("one", name) == bytes("named", name), "{name}: a sensor with a number is one sensor");
    }
    let [one, two] = ["one", "two"].map(|out| places(&path.join(out)));
    assert_eq!(one.len(), two.len());
    for (a, b) in one.iter().zip(&two) {
        assert!((a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).hypot(a[2] - b[2]) < 1e-3, "{a:?} {b:?}");
    }
    assert!(text.contains("3 a laser at (0.00, 0.00) m, 0 deg:") && text.contains("4 a laser"), "{text}");
    let record: serde_json::Value = serde_json::from_slice(&bytes("two", "run.json")).expect("JSON");
    assert_eq!(record["configuration"]["mounts"]["4"], serde_json::json!([0.0, 0.0, 0.0]));
    assert!(record["configuration"]["sensors"]["3"]["hit"].is_number());
    let page = String::from_utf8(bytes("two", "report.html")).expect("text");
    assert!(page.contains("Sensors of the robot"));
    let page = String::from_utf8(bytes("one", "report.html")).expect("text");
    assert!(!page.contains("Sensors of the robot"));
}

#[test]
fn a_sensor_of_which_nobody_knows_where_it_stands_is_refused() {
    let folder = place();
    // The second sensor reads when the first does no more.
    let whole = table(true, |_, time_s| time_s);
    let mut lines = whole.lines();
    let mut text = format!("{},sensor\n", lines.next().expect("a head"));
    for row in lines {
        let scan: usize = row.split(',').next().and_then(|scan| scan.parse().ok()).expect("a number");
        if !(50..70).contains(&scan) {
            let _ = writeln!(text, "{row},{}", usize::from(scan >= 70));
        }
    }
    fs::write(folder.path().join("apart.csv"), text).expect("writable");
    let (out, err) = run(folder.path(), 2, &["slam", "apart.csv", "--max-range", "20", "--out", "o"]);
    assert!(err.contains("apart.csv: sensor 1 never reads within 1 s of sensor 0") && out.is_empty(), "{err}");
    assert!(!folder.path().join("o").exists());
}

/// An office with a stereo camera and a laser.
const OFFICE: &str = include_str!("../../scenes/office-glass.toml");

const RING: &str =
    "[[sensor]]\nkind = \"sonar\"\nname = \"ring\"\ncones = 8\nfield_of_view_deg = 360.0\nmax_range = 3.0\nevery = 2\n";

#[test]
fn a_laser_beside_the_camera_finds_the_way_better_and_sonars_do_it_no_harm() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path();
    let (before, rest) = OFFICE.split_once("[[sensor]]").expect("a laser");
    let (laser, after) = rest.split_once("[robot]").expect("a robot");
    let scene = |sensors: &str| format!("{before}{sensors}[robot]{after}\n[odometry]\n");
    let laser = format!("[[sensor]]{laser}");
    fs::write(path.join("camera.toml"), scene("")).expect("writable");
    fs::write(path.join("both.toml"), scene(&laser)).expect("writable");
    fs::write(path.join("all.toml"), scene(&format!("{laser}{RING}"))).expect("writable");
    let found = |scene: &str, weight: &str| {
        let (out, file) = (format!("{scene}-{weight}"), format!("{scene}.toml"));
        let args = ["slam", &file, "--particles", "5", "--weight", weight, "--seed", "2", "--out", &out];
        let (text, err) = run(path, 0, &args);
        assert!(!err.contains("warning"), "{err}");
        let [slam, odometry] = ["slam", "odometry"].map(|name| mean(&path.join(&out), name, "ate"));
        (slam, odometry, text)
    };
    let [camera, both, all] = ["camera", "both", "all"].map(|scene| found(scene, "field"));
    let evidence = found("all", "evidence");
    assert!(both.0 < 0.5 * camera.0, "{} m with a laser, {} m by the camera alone", both.0, camera.0);
    for (with, odometry, _) in [&both, &all, &evidence] {
        assert!(*with < 0.03 && *with < 0.5 * odometry, "{with} m, the odometry {odometry} m");
    }
    assert!(all.2.contains("1 laser at (0.10, 0.00) m, 0 deg:") && all.2.contains("weighs and is mapped"), "{}", all.2);
    let record = fs::read_to_string(path.join("all-field/run.json")).expect("readable");
    let record: serde_json::Value = serde_json::from_str(&record).expect("JSON");
    assert_eq!(record["configuration"]["mounts"]["1"], serde_json::json!([0.1, 0.0, 0.0]));
    let page = fs::read_to_string(path.join("all-field/report.html")).expect("readable");
    assert!(page.contains("Sensors of the robot") && page.contains("ring"));
}

#[test]
fn worlds_are_driven_through_with_both_sensors_too() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let args = ["slam-worlds", "--families", "clutter", "--seeds", "1", "--sensors", "stereo,stereo+laser,own"];
    let more = ["--particles", "3", "--weights", "field", "--format", "csv"];
    let (out, _) = run(folder.path(), 0, &[&args[..], &more].concat());
    let rows: Vec<Vec<&str>> = out.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.iter().map(|row| row[2]).collect::<Vec<_>>(), ["stereo", "stereo+laser", "own"]);
    let ates: Vec<f64> = rows.iter().map(|row| row[5].parse().expect("a number")).collect();
    assert!(ates[1] < ates[0], "a laser helps: {ates:?}");
    // The family has no other sensor than its camera.
    assert_eq!(rows[0][5..], rows[2][5..]);
}
