//! `compare` as a user meets it: files, the same bytes every time, interruption, and messages.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use experiments::commands::compare::plan::ON_REQUEST;
use tempfile::TempDir;

use crate::checked::checked;
use crate::nook::FAMILY;

struct Place {
    folder: TempDir,
}

impl Place {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("temporary folder");
        fs::write(folder.path().join("nook.toml"), FAMILY).expect("writable");
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
        command.current_dir(self.folder.path()).args(["compare", "--families", "nook.toml"]).args(args);
        command
    }

    /// Number of finished worlds in a folder that is not complete.
    fn kept(&self, out: &str) -> usize {
        let journals = fs::read_dir(self.path(out)).into_iter().flatten().flatten().map(|entry| entry.path());
        let journals = journals.filter(|path| path.to_string_lossy().contains(".finished-"));
        let worlds = journals.flat_map(fs::read_dir).flatten().flatten().map(|entry| entry.path());
        worlds.filter(|path| path.extension().is_some_and(|extension| extension == "json")).count()
    }

    /// Runs and expects an exit code; gives stdout and stderr.
    fn expect(&self, code: i32, args: &[&str]) -> (String, String) {
        checked(code, &args, &self.command(args).output().expect("runs"))
    }
}

/// Every file of a folder with its bytes; a folder in it has none.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).expect("there").map(|entry| entry.expect("entry").path());
    let read = |path: PathBuf| {
        (path.file_name().expect("named").to_string_lossy().into_owned(), fs::read(&path).unwrap_or_default())
    };
    entries.map(read).collect()
}

#[test]
fn compare_leaves_every_file_it_promises_and_an_account_of_eighty_columns() {
    let place = Place::new();
    let (out, _) = place.expect(0, &["--seeds", "8", "--batch-seeds", "2", "--out", "o"]);
    let found = files(&place.path("o"));
    let names: Vec<&str> = found.keys().map(String::as_str).collect();
    let record: serde_json::Value = serde_json::from_slice(&found["run.json"]).expect("JSON");
    let mappers: Vec<&str> =
        record["configuration"]["mappers"].as_array().into_iter().flatten().filter_map(|name| name.as_str()).collect();
    let scores: Vec<String> = mappers.iter().map(|mapper| format!("scores-{mapper}.csv")).collect();
    let fixed = [
        "differences.csv",
        "differences.png",
        "profiles.csv",
        "profiles.png",
        "reliability.csv",
        "reliability.png",
        "repeats.csv",
        "repeats.png",
        "report.html",
        "run.json",
        "summary.csv",
        "summary.md",
    ];
    let mut expected: Vec<&str> = fixed.into_iter().chain(scores.iter().map(String::as_str)).collect();
    expected.sort_unstable();
    assert_eq!(names, expected, "and no journal is left");
    let listed: Vec<&str> =
        record["files"].as_array().into_iter().flatten().filter_map(|f| f["name"].as_str()).collect();
    assert_eq!(listed, expected.into_iter().filter(|name| *name != "run.json").collect::<Vec<_>>());
    assert_eq!(
        mappers.len(),
        mapper::catalogue::MAPPERS.len() - 2 - ON_REQUEST.len(),
        "but for its reference, the variant that visibility is anyway, and those on request"
    );

    let text = |name: &str| String::from_utf8(found[name].clone()).expect("text");
    // Batch mappers, of which there are two, ran on two of eight worlds; six regions each.
    for mapper in &mappers {
        let worlds = if ["mrf", "forward-em"].contains(mapper) { 2 } else { 8 };
        assert_eq!(text(&format!("scores-{mapper}.csv")).lines().count(), 1 + 6 * worlds, "{mapper}");
    }
    // One scope, since there is one family and one condition.
    // Fifteen metrics in every region, and six of drives in one.
    assert_eq!(text("differences.csv").lines().count(), 1 + (6 * 15 + 6) * (mappers.len() - 1));
    let summary = text("summary.csv");
    for metric in ["reached", "colliding", "detour"] {
        assert_eq!(summary.matches(&format!(",{metric},")).count(), mappers.len(), "{metric} in one region");
    }
    assert!(summary.contains("all,all,visibility,reached,1,8,0."), "{metric} has a value", metric = "reached");
    assert!(text("summary.md").contains("| conventional loses on log loss |"));
    retention_stands_where_the_robot_does(&text("repeats.csv"));
    assert!(!text("report.html").contains("://"), "the report needs no network");
    assert!(found["report.html"].len() < 10_000_000);
    let wide: Vec<&str> = out.lines().filter(|line| line.chars().count() > 80).collect();
    assert!(wide.is_empty(), "{wide:#?}");
    assert!(out.contains("log-odds-cartographer") && out.contains("holds  conventional loses on log loss"));
}

/// Retention is that of a stand; what comes of driving on is a row of its own, once for every stand and mapper.
fn retention_stands_where_the_robot_does(repeats: &str) {
    let mut reader = csv::Reader::from_reader(repeats.as_bytes());
    let heads = reader.headers().expect("a head").clone();
    let place = |name: &str| heads.iter().position(|head| head == name).unwrap_or_else(|| panic!("{name}: {heads:?}"));
    let [readings, mapper, count, log_loss, retention] =
        ["readings", "mapper", "repeats", "log_loss", "retention"].map(place);
    let rows: Vec<csv::StringRecord> = reader.records().map(|row| row.expect("a row")).collect();
    let of = |name: &str| rows.iter().filter(|row| &row[readings] == name).count();
    let most = rows.iter().filter_map(|row| row[count].parse::<usize>().ok()).max().expect("counts");
    let counts = rows.iter().filter(|row| &row[readings] == "same" && row[count] == most.to_string()).count();
    assert!(of("same") > counts && of("driven") == counts, "{counts} stands, {} drives", of("driven"));
    for row in &rows {
        let stands = ["standing", "driven"].contains(&&row[readings]);
        assert!(stands || row[retention].is_empty(), "{row:?}");
        assert!(&row[readings] != "driven" || row[count] == most.to_string(), "{row:?}");
        let kept: Option<f64> = row[retention].parse().ok();
        assert!(kept.is_none_or(|kept| (0.0..=1.0).contains(&kept)), "{row:?}");
        // What knows the truth but for the noise keeps what it knows.
        assert!(!stands || &row[mapper] != "visibility" || kept.is_some_and(|kept| kept > 0.8), "{row:?}");
    }
    // Driving on shows what was looked at from one place alone from others.
    let mean = |name: &str| {
        let of = rows
            .iter()
            .filter(|row| &row[readings] == name && &row[mapper] == "visibility" && row[count] == most.to_string());
        let losses: Vec<f64> = of.map(|row| row[log_loss].parse().expect("a loss")).collect();
        losses.iter().sum::<f64>() / losses.len() as f64
    };
    assert!(mean("driven") < mean("standing"), "{} {}", mean("driven"), mean("standing"));
}

#[test]
fn the_same_bytes_with_any_number_of_threads_and_after_an_interruption() {
    let place = Place::new();
    let args = |out: &'static str, threads: &'static str| {
        [
            "--seeds",
            "12",
            "--batch-seeds",
            "2",
            "--mappers",
            "visibility,mrf,conventional",
            "--out",
            out,
            "--threads",
            threads,
        ]
    };
    place.expect(0, &args("one", "1"));
    place.expect(0, &args("three", "3"));
    let one = files(&place.path("one"));
    assert_eq!(one, files(&place.path("three")));

    // Interrupted when the first world is finished.
    let mut command = place.command(&args("cut", "1"));
    let run = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("runs");
    let finished = || place.kept("cut");
    while finished() == 0 {
        std::thread::sleep(Duration::from_millis(1));
    }
    Command::new("kill").args(["-INT", &run.id().to_string()]).status().expect("kill");
    let (_, err) = checked(75, &["cut"], &run.wait_with_output().expect("ends"));
    assert!(err.contains("interrupted: ") && err.contains("of 12 worlds are finished and kept in cut"), "{err}");
    assert!((1..12).contains(&finished()) && !place.path("cut/run.json").exists());
    place.expect(0, &args("cut", "2"));
    assert_eq!(one, files(&place.path("cut")), "the rest, and nothing of the interruption");
}

#[test]
fn an_interruption_keeps_no_world_of_a_family_that_was_changed_since() {
    let place = Place::new();
    let args = ["--seeds", "12", "--mappers", "visibility,conventional", "--threads", "1"];
    let run = place.command(&[&args[..], &["--out", "cut"]].concat()).stderr(Stdio::null()).spawn();
    let mut run = run.expect("runs");
    while place.kept("cut") == 0 {
        std::thread::sleep(Duration::from_millis(1));
    }
    run.kill().expect("kill");
    run.wait().expect("ends");
    fs::write(place.path("nook.toml"), FAMILY.replace("0.04", "0.08")).expect("writable");
    place.expect(0, &[&args[..], &["--out", "cut"]].concat());
    place.expect(0, &[&args[..], &["--out", "whole"]].concat());
    assert!(files(&place.path("cut")) == files(&place.path("whole")), "worlds of two families are mixed");
}

#[test]
fn a_comparison_that_fails_with_its_first_world_leaves_nothing() {
    let place = Place::new();
    fs::write(place.path("nook.toml"), FAMILY.replace("radius = 0.15", "radius = 1.8")).expect("writable");
    let (_, err) = place.expect(2, &["--out", "o"]);
    assert!(err.contains("nook.toml:3:1: [generate]: layout 1 finds no room"), "{err}");
    assert!(!place.path("o").exists());
}

#[test]
fn report_makes_the_same_page_from_the_folder_alone() {
    let place = Place::new();
    for (set, out) in [("test", "t"), ("robustness", "r")] {
        let seeds = ["--set", set, "--seeds", "2", "--mappers", "visibility,conventional", "--out", out];
        place.expect(0, &seeds);
        let before = files(&place.path(out));
        let mut report = Command::new(env!("CARGO_BIN_EXE_experiments"));
        let report = report.current_dir(place.folder.path()).args(["report", out]).output().expect("runs");
        checked(0, &["report", out], &report);
        assert!(before == files(&place.path(out)), "{set}: the page is another");
    }
    let scores = fs::read_to_string(place.path("t/scores-visibility.csv")).expect("there");
    fs::write(place.path("t/scores-visibility.csv"), scores.replacen("visibility,surface,", "visibility,surface,9", 1))
        .expect("writable");
    let mut report = Command::new(env!("CARGO_BIN_EXE_experiments"));
    let report = report.current_dir(place.folder.path()).args(["report", "t"]).output().expect("runs");
    let (_, err) = checked(2, &["report", "t"], &report);
    assert!(err.contains("t/scores-visibility.csv: has no line"), "{err}");
}

#[test]
fn every_departure_is_a_part_of_the_robustness_set() {
    let place = Place::new();
    let args = ["--set", "robustness", "--seeds", "1", "--mappers", "visibility,conventional", "--out", "o"];
    let (csv, _) = place.expect(0, &[&args[..], &["--format", "csv"]].concat());
    assert_eq!(csv.as_bytes(), files(&place.path("o"))["differences.csv"]);
    let scopes: std::collections::BTreeSet<&str> =
        csv.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    let expected = ["all", "clusters", "match-0.6", "match-0.95", "sigma-0.5", "sigma-2", "size-0.5", "size-2"];
    assert_eq!(scopes.into_iter().collect::<Vec<_>>(), expected);
    let scores = fs::read_to_string(place.path("o/scores-visibility.csv")).expect("there");
    let loss = |condition: &str| {
        let row = scores
            .lines()
            .find(|line| line.starts_with(&format!("{condition},")) && line.contains("visibility,observable"));
        row.and_then(|row| row.split(',').nth(6)).map(str::to_owned)
    };
    let losses: std::collections::BTreeSet<_> = expected[1..].iter().map(|condition| loss(condition)).collect();
    assert_eq!(losses.len(), 7, "every condition makes another map: {losses:?}");
}

#[test]
fn a_claim_that_does_not_hold_is_exit_code_3_and_says_which() {
    let place = Place::new();
    // Without a reading every map is its prior, and nobody is better.
    fs::write(place.path("nook.toml"), FAMILY.replace("[robot]", "[sensor]\ndetection_rate = 0.0\n[robot]"))
        .expect("writable");
    let (out, err) = place.expect(3, &["--seeds", "2", "--mappers", "visibility,independent", "--out", "o"]);
    assert!(err.contains("2 of 2 claims fail: independent loses on log loss: +0.0000"), "{err}");
    assert!(out.contains("FAILS  independent"), "{out}");
    assert!(place.path("o/report.html").exists(), "the results are there to look into");
}

/// Sensors of a robot besides its camera.
const LASER: &str = "[[sensor]]\nkind = \"laser\"\nbeams = 12\nmax_range = 8.0\n[robot]";

/// Seven suites of every layout, over the same cells, and several held against the better one alone.
#[test]
fn the_set_of_sensors_tells_what_a_second_one_is_worth() {
    let place = Place::new();
    let words = ["--set", "sensors", "--seeds", "2", "--mappers", "visibility,visibility-pool", "--plan-pairs", "20"];
    let (out, _) = place.expect(0, &[&words[..], &["--out", "o"]].concat());
    for said in
        ["sensors set, 1 family x 7 conditions x 2 seeds = 14 worlds", "log loss by sensors", "minus the better"]
    {
        assert!(out.contains(said), "{said}: {out}");
    }
    let table = fs::read_to_string(place.path("o/sensors.csv")).expect("written");
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let of = |region: &str, suite: &str| -> &Vec<&str> {
        let is = |row: &&Vec<&str>| row[..5] == ["all", region, "log_loss", "visibility", suite];
        rows.iter().find(is).expect("a row")
    };
    let mean = |suite: &str| of("in-reach", suite)[6].parse::<f64>().expect("a mean");
    let alone = ["camera", "laser"].map(mean);
    let both = of("in-reach", "camera-laser");
    let better = if alone[0] < alone[1] { "camera" } else { "laser" };
    assert_eq!(both[7], better);
    let difference: f64 = both[8].parse().expect("a difference");
    assert!((difference - (mean("camera-laser") - mean(better))).abs() < 2e-4);
    let [high, margin] = [10, 11].map(|column: usize| both[column].parse::<f64>().expect("a number"));
    assert_eq!(both[12], (high < margin).to_string());
    assert_eq!(of("in-reach", "laser")[7..], [""; 6], "one alone is held against nothing");
    let scores = fs::read_to_string(place.path("o/scores-visibility.csv")).expect("written");
    let cells = |suite: &str| -> Vec<String> {
        let lines = scores.lines().filter(|line| line.starts_with(suite) && line.contains(",in-reach,"));
        lines.map(|line| line.split(',').nth(5).expect("cells").to_owned()).collect()
    };
    assert!(cells("camera,") == cells("sonar,") && cells("laser,") == cells("all-three,"));
    assert_eq!(cells("camera,").len(), 2);
    // The page is made anew from the folder alone.
    let page = fs::read(place.path("o/report.html")).expect("written");
    let mut report = Command::new(env!("CARGO_BIN_EXE_experiments"));
    let done = report.current_dir(place.folder.path()).args(["report", "o"]).output().expect("runs");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    assert!(fs::read(place.path("o/report.html")).expect("written") == page, "the same page");
}

/// A robot that carries a laser beside its camera is compared like any other, standing still too.
#[test]
fn a_robot_with_several_sensors_is_compared() {
    let place = Place::new();
    fs::write(place.path("nook.toml"), FAMILY.replace("[robot]", LASER)).expect("writable");
    place.expect(0, &["--quick", "--seeds", "2", "--mappers", "visibility,visibility-pool", "--out", "o"]);
    let repeats = fs::read_to_string(place.path("o/repeats.csv")).expect("written");
    assert!(repeats.lines().any(|line| line.contains(",driven,")), "{repeats}");
    let (_, err) = place.expect(2, &["--set", "sensors", "--out", "p"]);
    assert!(
        err.contains("nook.toml: its robot carries sensors of [[sensor]], and the set sensors has its own"),
        "{err}"
    );
    let blind = FAMILY.replace("[camera]\ncolumns = 24\nfield_of_view_deg = 80.0\n", "");
    fs::write(place.path("nook.toml"), blind.replace("[robot]", LASER)).expect("writable");
    let (_, err) = place.expect(2, &["--set", "robustness", "--seeds", "1", "--out", "p"]);
    assert!(err.contains("nook.toml: its robot has no [camera], whose noise the condition match-0.6 changes"), "{err}");
    assert!(!place.path("p").exists());
}

#[test]
fn bad_options_are_refused_before_any_work() {
    let place = Place::new();
    fs::write(place.path("twin.toml"), FAMILY).expect("writable");
    fs::write(place.path("scene.toml"), "name = \"x\"\n").expect("writable");
    let refused = |args: &[&str], message: &str| {
        let (_, err) = place.expect(2, &[args, &["--out", "o"]].concat());
        assert!(err.contains(message), "{args:?}: {err}");
        assert!(!place.path("o").exists(), "{args:?} left something");
    };
    refused(&["--mappers", "visibility,mfr"], "no mapper \"mfr\"; the nearest is 'mrf', all are: visibility, ");
    refused(&["--mappers", "visibility,"], "--mappers: a name is empty; name one or more of: visibility, ");
    refused(&["--mappers", "visibility"], "nothing is compared with visibility; add another mapper");
    refused(&["--mappers", "conventional"], "all are compared with visibility, which is not among them; add it");
    refused(&["--mappers", "visibility,visibility"], "given twice");
    refused(&["--families", "nook.toml,twin.toml"], "a family named \"nook\" is among them");
    refused(&["--families", "scene.toml"], "scene.toml");
    refused(&["--families", "nowhere.toml"], "nowhere.toml");
    refused(&["--seeds", "0"], "1..=10000");
    refused(&["--seeds", "10001"], "1..=10000");
    refused(&["--batch-seeds", "-1"], "--batch-seeds");
    refused(&["--set", "tests"], "robustness");
    refused(&["--set", "sensors", "--conditions", "sigma-2"], "--conditions sigma-2: worlds of the sensors set");
    refused(&["--threads", "0"], "--threads");
    refused(&["--prior", "2"], "must be a number from 0 to 1");
    fs::write(place.path("file"), "in the way").expect("writable");
    let (_, err) = place.expect(2, &["--out", "file"]);
    assert!(err.contains("file: the output folder"), "{err}");
}
