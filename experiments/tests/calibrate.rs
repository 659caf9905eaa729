//! `calibrate` as a user meets it: what was put into simulated readings comes back.

use crate::recorded;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use experiments::commands::calibrate::noise::{self, Instrument};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};
use sensor::Laser;
use serde_json::Value;
use tempfile::TempDir;

use crate::checked::checked;
use crate::recorded::{recorded, room};

fn calibrate(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::cargo_bin("experiments").expect("built");
    command.current_dir(folder).arg("calibrate").args(arguments).output().expect("starts")
}

/// The rows by the name of their parameter.
fn found(folder: &Path, arguments: &[&str]) -> impl Fn(&str) -> Value {
    let arguments = [arguments, &["--format", "json"]].concat();
    let (out, _) = checked(0, &arguments, &calibrate(folder, &arguments));
    let json: Value = serde_json::from_str(&out).expect("JSON");
    let rows = json["rows"].as_array().expect("rows").clone();
    move |name| rows.iter().find(|row| row["parameter"] == name).unwrap_or_else(|| panic!("{name} in {rows:?}")).clone()
}

fn number(row: &Value, column: &str) -> f64 {
    row[column].as_f64().unwrap_or_else(|| panic!("{column} of {row}"))
}

/// Matches of a camera with the given chance to be correct, sigma and offset, in 60 rows; and the share that is correct.
fn matches(correct: f64, sigma: f64, offset: f64) -> (String, f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut uniform = || f64::from(rng.next_u32()) / 4_294_967_296.0;
    let mut text = "row,column,disparity_px,true_disparity_px,left_right_consistent\n".to_owned();
    let mut right = 0.0;
    for k in 0..6000 {
        let truth = 5.0 + 40.0 * uniform();
        let normal = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        let is_correct = uniform() < correct;
        let read = if is_correct { truth + offset + sigma * normal } else { 60.0 * uniform() };
        right += if is_correct { 1.0 / 6000.0 } else { 0.0 };
        let consistent = u8::from(is_correct || uniform() < 0.5);
        let _ = writeln!(text, "{},{},{read:.4},{truth:.4},{consistent}", k / 100, k % 100);
    }
    (text, right)
}

#[test]
fn disparities_give_back_the_kernel_that_they_were_drawn_from() {
    let folder = TempDir::new().expect("temporary folder");
    let (text, share) = matches(0.7, 0.16, -0.07);
    fs::write(folder.path().join("m.csv"), text).expect("writable");
    let found_all = found(folder.path(), &["m.csv", "--max-disparity", "60", "--out", "o"]);
    for (name, truth) in [("correct_match", share), ("disparity_sigma", 0.16), ("offset", -0.07)] {
        let row = found_all(name);
        assert!((number(&row, "value") / truth - 1.0).abs() < 0.05, "{row}");
        assert!(number(&row, "low") < truth && truth < number(&row, "high") && row["identified"] == true, "{row}");
    }
    for file in ["calibration.csv", "profile.csv", "fit.png", "run.json"] {
        assert!(folder.path().join("o").join(file).exists(), "{file}");
    }
    let share = share / (share + 0.5 * (1.0 - share));
    let row = found(folder.path(), &["m.csv", "--consistent"])("correct_match");
    assert!((number(&row, "value") - share).abs() < 0.02, "{row}");
    let text = checked(0, &"text", &calibrate(folder.path(), &["m.csv"])).0;
    // All but what is to be pasted.
    let lines: Vec<&str> = text.lines().collect();
    assert!(
        lines[..lines.len() - 1].iter().all(|line| line.chars().count() <= 80) && text.contains("px off on average"),
        "{text}"
    );
}

/// The laser of a drive through the room.
#[test]
fn a_log_gives_back_the_laser_that_it_was_drawn_from() {
    let laser = Laser { max_range_m: 20.0, range_sigma_m: 0.06, hit: 0.8, no_echo: 0.1, early_per_m: 0.02 };
    let folder = TempDir::new().expect("temporary folder");
    fs::write(folder.path().join("room.log"), recorded(&room(), &laser, 4).0).expect("writable");
    let found = found(folder.path(), &["room.log", "--beams", "46"]);
    for (name, truth, within) in
        [("range_sigma", 0.06, 0.04), ("hit", 0.8, 0.05), ("no_echo", 0.1, 0.25), ("early", 0.02, 0.5)]
    {
        let row = found(name);
        assert!((number(&row, "value") / truth - 1.0).abs() < within, "{name} {truth}: {row}");
        assert!(row["identified"] == true, "{row}");
    }
    let sigma = found("range_sigma");
    assert!(number(&sigma, "low") < 0.06 && 0.06 < number(&sigma, "high"), "{sigma}");
}

/// Four of the twenty rooms of `cargo bench -p experiments --bench calibrate`, with half of their scans.
#[test]
fn intervals_of_sigma_hold_the_truth_in_rooms_whose_walls_lie_anywhere_in_their_cells() {
    let (mut held, mut half) = (0, 0.0);
    for ((name, layout), range_sigma_m) in
        [("clutter", 1), ("halls", 6), ("two-rooms", 7), ("corridors", 3)].into_iter().zip([0.01, 0.02, 0.03, 0.05])
    {
        let laser = Laser { max_range_m: 20.0, range_sigma_m, hit: 0.9, no_echo: 0.05, early_per_m: 0.01 };
        let scans = recorded::scans(&recorded::layout(name, layout), &laser, layout, 100);
        let noise = noise::of(&scans, Instrument::Laser, 0.025).expect("enough readings");
        let [value, low, high] = [noise.sigma, noise.interval.low, noise.interval.high].map(|x| x / range_sigma_m);
        assert!((value - 1.0).abs() < 0.05 && low < value && value < high, "{name}: {value} [{low}, {high}]");
        held += usize::from(low < 1.0 && 1.0 < high);
        half += (high - low) / 8.0;
    }
    assert!(held >= 3 && half < 0.08, "{held} of 4, {half}");
}

/// A room without outliers, early returns or lost pulses says little of them.
#[test]
fn what_is_advised_is_identified_and_can_be_pasted() {
    let laser = Laser { max_range_m: 20.0, range_sigma_m: 0.03, hit: 1.0, no_echo: 0.0, early_per_m: 0.0 };
    let folder = TempDir::new().expect("temporary folder");
    fs::write(folder.path().join("a room.log"), recorded(&room(), &laser, 12).0).expect("writable");
    let arguments = ["a room.log", "--beams", "30", "--grid", "0.1", "--fov", "180", "--out", "o"];
    let (text, _) = checked(0, &arguments, &calibrate(folder.path(), &arguments));
    let table = fs::read_to_string(folder.path().join("o/calibration.csv")).expect("written");
    let mut rows = csv::Reader::from_reader(table.as_bytes());
    let advice = text.lines().last().expect("a last line");
    let (mut known, mut unknown) = (0, 0);
    for row in rows.records().map(|row| row.expect("a row")) {
        let option = format!("--{} ", row[0].replace('_', "-"));
        let identified = &row[5] == "true";
        assert_eq!(advice.contains(&option), identified, "{advice}\n{table}");
        *(if identified { &mut known } else { &mut unknown }) += 1;
    }
    assert!(known > 0 && unknown > 0, "{table}");
    // As a shell takes it.
    let program = assert_cmd::cargo::cargo_bin("experiments");
    let pasted = format!("'{}' {advice} --out r", program.display());
    let output = std::process::Command::new("sh").current_dir(folder.path()).args(["-c", &pasted]).output();
    checked(0, &pasted, &output.expect("starts"));
    assert!(folder.path().join("r/run.json").exists());
}

/// A camera that stands for a while at every stop, where its pose jitters, and then drives on or turns: false matches come again where it stands alone.
const STANDING: &str = r#"
name = "standing"
[bounds]
min = [0.0, 0.0]
max = [5.0, 4.0]
[grid]
cell = 0.1
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
[waypoints]
A = [1.0, 1.0]
B = [4.0, 1.0]
C = [4.0, 3.0]
D = [1.0, 3.0]
[route]
stops = ["A", { at = "B", wait_s = 10.0 }, { at = "C", wait_s = 10.0 }, { at = "D", wait_s = 10.0 }, "A"]
[[stage]]
name = "end"
after = ["A", "B", "C", "D", "A"]
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
speed = 0.5
turn_rate_deg = 45.0
scan_interval = 0.2
jitter_m = 0.002
jitter_deg = 0.1
"#;

#[test]
fn lengths_of_views_lie_between_the_jitter_of_a_stand_and_the_steps_of_a_drive() {
    let folder = TempDir::new().expect("temporary folder");
    fs::write(folder.path().join("standing.toml"), STANDING).expect("writable");
    let mut room = Command::cargo_bin("experiments").expect("built");
    let arguments = ["room", "--scene", "standing.toml", "--mappers", "prior", "--out", "r"];
    checked(0, &arguments, &room.current_dir(folder.path()).args(arguments).output().expect("starts"));
    let of_camera =
        ["r/scans.csv", "--focal-baseline", "15", "--max-disparity", "60", "--grid", "0.1", "--beams", "55"];
    let (text, _) = checked(0, &of_camera, &calibrate(folder.path(), &of_camera));
    assert!(text.contains("come again from the same view"), "{text}");
    let found_all = found(folder.path(), &of_camera);
    // Steps are of 0.1 m and 9 degrees; two poses of a stand are 2.5 mm and 0.1 degrees apart in the middle.
    for (name, range) in [("repeat_distance", 0.002..0.09), ("repeat_angle", 0.1..8.0)] {
        let row = found_all(name);
        assert!(row["identified"] == true && range.contains(&number(&row, "value")), "{row}");
    }
    let advice = text.lines().last().expect("a last line");
    assert!(
        advice.contains("--repeat-distance ") && advice.contains("--mappers visibility,visibility-dynamic"),
        "{advice}"
    );
    // What `replay` does with it, it says, and does.
    let mapped = |more: &[&str]| {
        let arguments =
            [&["replay", "r/scans.csv", "--mappers", "visibility-dynamic", "--grid", "0.1", "--out", "m"], more]
                .concat();
        let mut replay = Command::cargo_bin("experiments").expect("built");
        let (_, err) =
            checked(0, &arguments, &replay.current_dir(folder.path()).args(&arguments).output().expect("starts"));
        (fs::read(folder.path().join("m/visibility-dynamic.npy")).expect("a map"), err)
    };
    let (usual, nothing) = (mapped(&[]).0, mapped(&["--repeat-distance", "1e-9", "--repeat-angle", "1e-9"]).0);
    assert!(usual != nothing, "views of no length leave nothing out");
    assert!(mapped(&["--repeat-distance", "0.03", "--repeat-angle", "0.8594"]).0 == usual);
    let record = fs::read_to_string(folder.path().join("m/run.json")).expect("text");
    assert!(!record.contains("repeat_distance_m"), "as usual: {record}");
    let (_, err) = mapped(&["--repeat-angle", "2"]);
    assert!(!err.contains("no effect"), "{err}");
    let arguments =
        ["replay", "r/scans.csv", "--mappers", "visibility", "--grid", "0.1", "--repeat-angle", "2", "--out", "n"];
    let mut replay = Command::cargo_bin("experiments").expect("built");
    let (_, err) = checked(0, &arguments, &replay.current_dir(folder.path()).args(arguments).output().expect("starts"));
    assert!(
        err.contains("--repeat-angle: has no effect on these mappers, of which none is visibility-dynamic"),
        "{err}"
    );
}

/// The sensor of a scene, in the place of the one that is there.
#[test]
fn what_is_advised_of_a_matcher_is_a_line_of_a_scene() {
    let folder = TempDir::new().expect("temporary folder");
    fs::write(folder.path().join("m.csv"), matches(0.7, 0.16, 0.0).0).expect("writable");
    let text = checked(0, &"text", &calibrate(folder.path(), &["m.csv", "--max-disparity", "60"])).0;
    let advice = text.lines().last().expect("a last line");
    let scene = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/room.toml")).expect("there");
    let mut bare = String::new();
    let mut inside = false;
    for line in scene.lines() {
        if line.starts_with('[') {
            inside = line == "[sensor]";
        }
        if !inside {
            let _ = writeln!(bare, "{line}");
        }
    }
    let path = folder.path().join("pasted.toml");
    fs::write(&path, format!("{advice}\n{bare}")).expect("writable");
    let stereo = scene::load(&path, None, None).unwrap_or_else(|error| panic!("{advice}: {error}")).matcher.stereo;
    assert!((stereo.correct_match - 0.7).abs() < 0.05 && (stereo.disparity_sigma - 0.16).abs() < 0.02, "{advice}");
}

/// A room with a laser (1), a ring of sonars (2), a depth camera (3), an omnidirectional stereo camera (4) and a second laser that hardly ever reads (5).
fn of_all_kinds() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/sonar-ring.toml");
    let ring = fs::read_to_string(path).expect("shipped").replace("scan_interval = 1.0", "scan_interval = 0.25");
    let (head, rest) = ring.split_once("[[sensor]]").expect("the ring");
    let (_, tail) = rest.split_once("\n\n").expect("the robot");
    let sensors = [
        "kind = \"laser\"\nbeams = 90\nmax_range = 20.0\nrange_sigma = 0.04\nhit = 0.9\nno_echo = 0.05\nearly_per_m = 0.02",
        "kind = \"sonar\"\ncones = 16\nmax_range = 4.0\nrange_sigma = 0.06\nhit = 0.8\nno_echo = 0.1\nearly_per_m = 0.02",
        "kind = \"depth\"\ncolumns = 240\nfield_of_view_deg = 70.0\nmax_range = 5.0\ninverse_sigma_per_m = 0.008\nhit = 0.9\n\
         detection_rate = 0.85\ngrazing_deg = 15.0",
        "kind = \"stereo\"\ncolumns = 120\nfield_of_view_deg = 360.0\nfocal_baseline = 15.0\ndisparity_sigma = 0.3\n\
         correct_match = 0.85\nmax_disparity = 60.0\ndetection_rate = 0.7",
        "kind = \"laser\"\nbeams = 20\nevery = 40",
    ];
    sensors.iter().fold(format!("{head}{tail}\n"), |text, sensor| format!("{text}[[sensor]]\n{sensor}\n"))
}

/// What these sensors read on a drive, as tables in a folder: `NAME` has the rows of the sensors in `numbers`.
fn tables(folder: &TempDir, tables: &[(&str, &[&str])]) {
    fs::write(folder.path().join("all.toml"), of_all_kinds()).expect("writable");
    let mut room = Command::cargo_bin("experiments").expect("built");
    let arguments = ["room", "--scene", "all.toml", "--mappers", "prior", "--out", "r"];
    checked(0, &arguments, &room.current_dir(folder.path()).args(arguments).output().expect("starts"));
    let whole = fs::read_to_string(folder.path().join("r/scans.csv")).expect("written");
    for (name, numbers) in tables {
        let is_of = |line: &&str| {
            line.starts_with("scan,") || line.split(',').nth(6).is_some_and(|number| numbers.contains(&number))
        };
        let rows: String = whole.lines().filter(is_of).map(|line| format!("{line}\n")).collect();
        fs::write(folder.path().join(name), rows).expect("writable");
    }
}

/// What a kernel was told: its parameter, the truth, and how far off it may be as a share.
type Truth = (&'static str, f64, f64);

/// Whether the rows of a table have the truth, each found to be identified.
fn hold(rows: &[csv::StringRecord], truth: &[Truth]) {
    for (name, truth, within) in truth {
        let row = rows.iter().find(|row| &row[0] == *name).unwrap_or_else(|| panic!("{name}: {rows:?}"));
        let value: f64 = row[1].parse().expect("a number");
        assert!((value / truth - 1.0).abs() < *within && &row[5] == "true", "{name}: {truth} and {row:?}");
    }
}

fn rows_of(table: &str) -> Vec<csv::StringRecord> {
    csv::Reader::from_reader(table.as_bytes()).records().map(|row| row.expect("a row")).collect()
}

/// Settings that fit each of these sensors in seconds, but the sonars.
const QUICK: [&str; 4] = ["--scans", "60", "--grid", "0.1"];

#[test]
fn every_sensor_of_a_table_of_several_kinds_is_fitted_by_itself() {
    let folder = TempDir::new().expect("temporary folder");
    tables(&folder, &[("several.csv", &["1", "3", "4", "5"]), ("depth.csv", &["3"])]);
    let fit = |file: &'static str, more: &[&'static str]| {
        let arguments = [&[file, "--depth", "3", "--max-range", "20"], &QUICK[..], more].concat();
        checked(0, &arguments, &calibrate(folder.path(), &arguments))
    };
    let (text, err) = fit("several.csv", &["--out", "o"]);
    let table = fs::read_to_string(folder.path().join("o/calibration.csv")).expect("written");
    let is_prose = |line: &&str| !line.starts_with("replay ") && !line.starts_with("warning: ");
    assert!(text.lines().filter(is_prose).all(|line| line.chars().count() <= 80), "{text}");
    assert!(err.contains("sensor 5 (a laser) is not fitted:") && err.contains("scans are too few"), "{err}");
    let rows = rows_of(&table);
    let of =
        |sensor: &str| -> Vec<csv::StringRecord> { rows.iter().filter(|row| &row[7] == sensor).cloned().collect() };
    hold(&of("1"), &[("range_sigma", 0.04, 0.05), ("hit", 0.9, 0.05), ("no_echo", 0.05, 0.35)]);
    let depth = [("inverse_sigma_per_m", 0.008, 0.1), ("hit", 0.9, 0.05), ("detection_rate", 0.85, 0.04)];
    hold(&of("3"), &depth);
    // So few looks at grazing angles bound it from above alone, and it is said.
    let grazing = of("3").into_iter().find(|row| &row[0] == "grazing_deg").expect("a row");
    assert!((grazing[1].parse::<f64>().expect("a number") / 15.0 - 1.0).abs() < 0.15, "{grazing:?}");
    hold(&of("4"), &[("disparity_sigma", 0.3, 0.1), ("correct_match", 0.85, 0.06)]);
    assert!(of("5").is_empty(), "{table}");
    // The detection rate holds what texture leaves of it, at most the rate.
    let rate = of("4").iter().find(|row| &row[0] == "detection_rate").map(|row| row[1].parse::<f64>());
    let rate = rate.expect("a row").expect("a number");
    assert!((0.3..0.72).contains(&rate), "{rate}");
    let advice = text.lines().last().expect("a last line");
    for option in ["--range-sigma ", "--depth 3 ", "--depth-sigma ", "--disparity-sigma "] {
        assert!(advice.contains(option), "{advice}");
    }
    assert!(text.contains("[[sensor]]\nkind = \"depth\"\ninverse_sigma_per_m = 0.0"), "{text}");
    // As a shell takes it.
    let program = assert_cmd::cargo::cargo_bin("experiments");
    let pasted = format!("'{}' {advice} --mappers visibility --grid 0.1 --out m", program.display());
    let output = std::process::Command::new("sh").current_dir(folder.path()).args(["-c", &pasted]).output();
    checked(0, &pasted, &output.expect("starts"));
    let record = fs::read_to_string(folder.path().join("m/run.json")).expect("written");
    assert!(record.contains("inverse_sigma_per_m"), "{record}");
    // The camera alone, of the same scans, gives the same to the last digit.
    let (alone, _) = fit("depth.csv", &["--format", "csv"]);
    let own: Vec<String> = alone.lines().skip(1).map(str::to_owned).collect();
    let in_all: Vec<String> = of("3").iter().map(|row| row.iter().take(7).collect::<Vec<_>>().join(",")).collect();
    assert_eq!(own, in_all);
}

/// By maps a sonar's sigma is told less well than a laser's by surfaces.
#[test]
#[ignore = "a minute and more: .ci/nightly runs it"]
fn a_ring_of_sonars_is_fitted() {
    let folder = TempDir::new().expect("temporary folder");
    tables(&folder, &[("ring.csv", &["2"])]);
    let arguments = [&["ring.csv", "--sonar-range", "4", "--format", "csv"], &QUICK[..]].concat();
    let (table, _) = checked(0, &arguments, &calibrate(folder.path(), &arguments));
    hold(&rows_of(&table), &[("sonar_sigma", 0.06, 0.25), ("sonar_hit", 0.8, 0.08), ("sonar_no_echo", 0.1, 0.35)]);
}

#[test]
fn depth_cameras_that_are_none_are_refused() {
    let folder = TempDir::new().expect("temporary folder");
    let laser = Laser { max_range_m: 20.0, ..Laser::default() };
    fs::write(folder.path().join("a.log"), recorded(&room(), &laser, 12).0).expect("writable");
    let (_, err) = checked(2, &"depth", &calibrate(folder.path(), &["a.log", "--depth", "4"]));
    assert!(err.contains("a.log: --depth 4: the log has no such sensor"), "{err}");
}

#[test]
fn what_cannot_be_fitted_is_refused() {
    let folder = TempDir::new().expect("temporary folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("writable");
    let (whole, _) = matches(0.7, 0.2, 0.0);
    write("few.csv", &whole.lines().take(20).collect::<Vec<_>>().join("\n"));
    write("bad.csv", &whole.replacen("\n0,3,", "\n0,3,x", 1));
    write("short.csv", &whole.replacen("\n0,3,", "\n0,", 1));
    write("good.csv", &whole);
    write("bare.csv", "disparity_px,true_disparity_px\n1,2\n");
    write("none.log", "ODOM 1 2 3\n");
    for (arguments, said) in [
        (vec!["no.csv"], "no.csv: cannot be opened"),
        (vec!["few.csv"], "few.csv: 19 disparities are too few"),
        (vec!["bad.csv"], "bad.csv:5: disparity_px = \"x"),
        (vec!["short.csv"], "short.csv: "),
        (vec!["good.csv", "--max-disparity", "30"], "--max-disparity 30"),
        (vec!["bare.csv", "--consistent"], "left_right_consistent"),
        (vec!["none.log"], "none.log: no scan"),
        (vec!["."], "is a folder"),
    ] {
        let arguments: Vec<&str> = arguments.into_iter().chain(["--out", "o"]).collect();
        let (out, err) = checked(2, &arguments, &calibrate(folder.path(), &arguments));
        assert!(out.is_empty() && err.contains(said) && err.lines().count() == 1, "{arguments:?}: {err}");
        assert!(!folder.path().join("o").exists());
    }
}
