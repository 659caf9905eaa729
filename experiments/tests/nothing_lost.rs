//! No run destroys a file that it should not, whatever the user types.

use crate::attic;
use crate::closet;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use tempfile::TempDir;

use crate::checked::checked;

/// A folder with a scene, and what is in it.
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        let place = Self(tempfile::tempdir().expect("temporary folder"));
        fs::write(place.0.path().join("closet.toml"), closet::SCENE).expect("writable");
        place
    }

    fn run(&self, code: i32, args: &[&str]) -> (String, String) {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_experiments"));
        checked(code, &args, &command.current_dir(self.0.path()).args(args).output().expect("runs"))
    }

    fn at(&self, name: &str) -> std::path::PathBuf {
        self.0.path().join(name)
    }

    /// Runs what must be refused, and changes nothing anywhere.
    fn refuses(&self, args: &[&str], message: &str) {
        let before = files(self.0.path());
        let (_, err) = self.run(2, args);
        assert!(err.contains(message) && err.lines().count() == 1, "{args:?}: {err}");
        assert_eq!(files(self.0.path()), before, "{args:?}");
    }
}

/// Every file below a folder.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(at) = folders.pop() {
        for path in fs::read_dir(at).expect("there").map(|entry| entry.expect("entry").path()) {
            if path.is_dir() {
                folders.push(path);
            } else {
                let bytes = fs::read(&path).expect("readable");
                found.insert(path.display().to_string(), bytes);
            }
        }
    }
    found
}

#[test]
fn no_command_writes_into_the_results_of_another() {
    let place = Place::new();
    place.run(0, &["room", "--scene", "closet.toml", "--out", "r"]);
    let holds = "run.json: holds the results of `room`";
    place.refuses(&["replay", "r/scans.csv", "--out", "r"], holds);
    place.refuses(&["calibrate", "r/scans.csv", "--out", "r"], holds);
    place.refuses(&["ray", "near", "--out", "r"], holds);
    place.refuses(&["speed", "--scans", "r/scans.csv", "--out", "r"], "r");
    place.refuses(&["sensor", "closet.toml", "--out", "r"], holds);
    fs::write(place.at("attics.toml"), attic::FAMILY).expect("writable");
    let sweep = "families = [\"attics.toml\"]\nmappers = [\"prior\"]\nseeds = { first = 1, count = 2 }\n";
    fs::write(place.at("s.toml"), sweep).expect("writable");
    place.refuses(&["sweep", "s.toml", "--out", "r"], holds);
    place.refuses(&["sweep", "plan", "s.toml", "--out", "r"], holds);
    place.refuses(&["compare", "--quick", "--families", "attics.toml", "--out", "r"], holds);
    place.refuses(&["tune", "--families", "attics.toml", "--out", "r"], holds);
    // The command itself may, with any options.
    place.run(0, &["room", "--scene", "closet.toml", "--mappers", "prior", "--seed", "2", "--out", "r"]);
    assert!(!place.at("r/visibility-end.npy").exists() && place.at("r/prior-end.npy").exists());
}

#[test]
fn files_of_the_user_stay_as_they_are() {
    let place = Place::new();
    place.run(0, &["room", "--scene", "closet.toml", "--out", "r"]);
    fs::create_dir(place.at("logs")).expect("writable");
    for (name, text) in [("predictions.csv", None), ("run.csv", None), ("visibility.pgm", Some("a picture"))] {
        match text {
            None => drop(fs::copy(place.at("r/scans.csv"), place.at("logs").join(name)).expect("copied")),
            Some(text) => fs::write(place.at("logs").join(name), text).expect("writable"),
        }
    }
    place.refuses(&["replay", "logs/predictions.csv", "--out", "logs"], "predictions.csv: is read by this run");
    fs::remove_file(place.at("logs/predictions.csv")).expect("there");
    place.refuses(
        &["replay", "logs/run.csv", "--out", "logs"],
        "visibility.pgm: was not written by an earlier `replay`",
    );
    fs::write(place.at("logs/run.json"), r#"{"files":["run.csv"]}"#).expect("writable");
    fs::remove_file(place.at("logs/visibility.pgm")).expect("there");
    place.refuses(&["replay", "logs/run.csv", "--out", "logs"], "run.json: is not a record of this program");
    place.refuses(&["sensor", "closet.toml", "--out", "logs"], "run.json: is not a record of this program");
}

#[test]
fn single_files_are_replaced_only_where_the_user_says_so() {
    let place = Place::new();
    place.run(0, &["room", "--scene", "closet.toml", "--out", "r"]);
    for name in ["map.yaml", "map.pgm", "map-raw.yaml", "closet2.toml", "page.html"] {
        fs::write(place.at(name), "mine").expect("writable");
    }
    fs::write(place.at("attics.toml"), attic::FAMILY).expect("writable");
    let taken = "is there already";
    place.refuses(&["convert", "r/visibility-end.npy", "map.yaml"], taken);
    place.refuses(&["scene", "from-map", "r/visibility-end.yaml", "--out", "closet2.toml"], taken);
    place.refuses(&["scene", "generate", "attics.toml", "--out", "closet2.toml"], taken);
    place.refuses(&["report", "r", "--out", "page.html"], taken);
    place.refuses(&["report", "r", "--out", "r/run.json", "--force"], "is read by this run");
    place.refuses(&["scene", "generate", "attics.toml", "--out", "attics.toml", "--force"], "is read by this run");
    place.run(0, &["convert", "r/visibility-end.npy", "map.yaml", "--force"]);
    let once = files(place.0.path());
    place.run(0, &["convert", "r/visibility-end.npy", "map.yaml"]);
    assert_eq!(files(place.0.path()), once, "the same to the byte is no loss");
    place.refuses(&["convert", "map.yaml", "map.pgm"], "is read by this run");
    place.run(0, &["report", "r", "--out", "page.html", "--force"]);
    place.run(0, &["scene", "generate", "attics.toml", "--out", "closet2.toml", "--force"]);
    // JUnit and Markdown of gates begin in a way of their own.
    fs::write(place.at("junit.xml"), "<notes/>").expect("writable");
    let gates = "[[gate]]\nname = \"g\"\nmapper = \"prior\"\nmetric = \"log_loss\"\nat_most = 9.0\nfamilies = [\"attics.toml\"]\nseeds = 2\n";
    fs::write(place.at("gates.toml"), gates).expect("writable");
    place.refuses(&["gate", "--gates", "gates.toml", "--junit", "junit.xml"], "junit.xml: was not written by `gate`");
    place.refuses(&["gate", "--gates", "gates.toml", "--summary", "gates.toml"], "gates.toml: is read by this run");
    fs::remove_file(place.at("junit.xml")).expect("there");
    for _ in 0..2 {
        place.run(0, &["gate", "--gates", "gates.toml", "--junit", "junit.xml", "--summary", "summary.md"]);
    }
}

#[test]
fn logs_and_scenes_of_one_name_get_folders_of_their_own() {
    let place = Place::new();
    place.run(0, &["room", "--scene", "closet.toml"]);
    for day in ["day1", "day2"] {
        fs::create_dir(place.at(day)).expect("writable");
        fs::copy(place.at("results/closet/scans.csv"), place.at(day).join("run.csv")).expect("copied");
        fs::copy(place.at("results/closet/scans.csv"), place.at(&format!("2026-11-26.{day}.csv"))).expect("copied");
        fs::copy(place.at("closet.toml"), place.at(day).join("other.toml")).expect("copied");
    }
    let mappers = ["--mappers", "prior"];
    for log in ["day1/run.csv", "2026-11-26.day1.csv", "2026-11-26.day2.csv"] {
        place.run(0, &[&["replay", log], &mappers[..]].concat());
    }
    let (_, err) = place.run(0, &[&["replay", "day2/run.csv"], &mappers[..]].concat());
    assert!(err.contains("note: results/replay-run holds the results of another file"), "{err}");
    place.run(0, &[&["replay", "./day2/run.csv"], &mappers[..]].concat());
    let (_, err) = place.run(0, &[&["room", "--scene", "day1/other.toml"], &mappers[..]].concat());
    assert!(err.contains("go to results/closet-2"), "{err}");
    place.run(0, &["sensor", "closet.toml"]);
    place.run(0, &["sensor", "day1/other.toml"]);
    let mut folders: Vec<String> = fs::read_dir(place.at("results"))
        .expect("there")
        .map(|entry| entry.expect("entry").file_name().to_string_lossy().into_owned())
        .collect();
    folders.sort();
    assert_eq!(
        folders,
        [
            "closet",
            "closet-2",
            "replay-2026-11-26.day1",
            "replay-2026-11-26.day2",
            "replay-run",
            "replay-run-2",
            "sensor",
            "sensor-2"
        ]
    );
}

/// A child that inherits what the shell has set: the signals that `trap ''` ignores stay ignored.
#[cfg(target_os = "linux")]
#[test]
fn signals_that_were_ignored_stay_ignored() {
    use std::process::{Command, Stdio};
    let place = Place::new();
    let program = env!("CARGO_BIN_EXE_experiments");
    let run = |trap: &str, signal: &str, out: &str| {
        let line = format!(
            "{trap} exec '{program}' room --scene closet.toml --seeds 300 --mappers visibility,conventional --out {out}"
        );
        let mut shell = Command::new("sh");
        let mut child = shell
            .args(["-c", &line])
            .current_dir(place.0.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("runs");
        // Once the folder is there the signals are watched.
        while !place.at(out).exists() {
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        let kill = Command::new("sh").args(["-c", &format!("kill -s {signal} {}", child.id())]).status().expect("runs");
        assert!(kill.success());
        child.wait().expect("ends").code()
    };
    assert_eq!(run("trap '' HUP;", "HUP", "hup"), Some(0));
    assert!(place.at("hup/run.json").exists());
    assert_eq!(run("trap '' INT;", "INT", "int"), Some(0));
    assert_eq!(run("", "INT", "ended"), Some(130));
    assert!(!place.at("ended").exists());
}
