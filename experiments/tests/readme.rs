//! Every command of the README runs as written, in an empty folder: what it reads comes with the program. Slow ones run shorter.

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;

use crate::checked::checked;

/// Commands that take more than seconds, each with options behind it that shorten it.
const SLOW: [(&str, &str); 8] = [
    ("compare --quick", "--seeds 1 --batch-seeds 0 --mappers visibility,conventional --families halls"),
    ("gate", "--only near"),
    ("calibrate scenes/logs/aces.clf.bz2", "--scans 60 --grid 0.2"),
    ("room --mapper mine='python3 experiments/examples/python/counting.py'", "--mappers prior --grid 0.2"),
    ("room --svg --width 178 --dpi 600", "--mappers visibility --grid 0.1"),
    ("replay scenes/logs/aces.clf.bz2", "--every 5 --mappers visibility,conventional"),
    ("slam scenes/logs/aces.clf.bz2", "--particles 2 --every 3"),
    ("sweep cell-size", "--shards 0"),
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// What the README has behind `cargo run -p experiments --`: its first lines, and its table of what one has.
fn commands() -> Vec<String> {
    let text = fs::read_to_string(root().join("README.md")).expect("readable");
    let typed = text.lines().filter_map(|line| line.strip_prefix("    cargo run -p experiments -- "));
    let typed = typed.map(|line| line.split(" #").next().unwrap_or_default().trim().to_owned());
    let table = text.lines().skip_while(|line| !line.starts_with("| I have |")).skip(2);
    let cells = table.take_while(|line| line.starts_with('|')).filter_map(|line| line.split('`').nth(1));
    let mut commands: Vec<String> = Vec::new();
    for command in typed.chain(cells.map(str::to_owned)) {
        if !commands.contains(&command) {
            commands.push(command);
        }
    }
    commands
}

#[test]
fn every_command_of_the_readme_runs_as_written() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // The programs of the examples are the user's, as they lie in a clone.
    let (examples, here) =
        (root().join("experiments/examples/python"), folder.path().join("experiments/examples/python"));
    fs::create_dir_all(&here).expect("writable");
    fs::copy(examples.join("counting.py"), here.join("counting.py")).expect("copied");
    let python = std::process::Command::new("python3").arg("--version").output().is_ok();
    let commands = commands();
    assert!(commands.len() >= 13, "{commands:?}");
    for command in commands.iter().filter(|command| python || !command.contains("python3")) {
        let shorter = SLOW.iter().find(|(slow, _)| slow == command).map(|(_, options)| *options).unwrap_or_default();
        let mut words = shlex::split(command).expect("words");
        if command.starts_with("sweep") {
            words.insert(1, "plan".to_owned()); // all of it but the work
        } else {
            words.extend(shlex::split(shorter).expect("words"));
        }
        let mut program = Command::cargo_bin("experiments").expect("built");
        checked(0, &command, &program.current_dir(folder.path()).args(&words).output().expect("runs"));
    }
    for (slow, _) in SLOW {
        assert!(commands.iter().any(|command| command == slow), "{slow}");
    }
    for left in ["results/room/report.html", "office.toml", "flat.toml", "results/replay-aces/report.html"] {
        assert!(folder.path().join(left).is_file(), "{left}");
    }
}
