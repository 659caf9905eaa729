//! `tune`: exit codes, the same bytes every time, and what is built in is what was fitted.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use experiments::commands::tune::candidates::{Tuned, parameters};
use mapper::{Candidate, Setting};
use tempfile::TempDir;

use crate::attic::FAMILY;
use crate::checked::checked;

fn place() -> TempDir {
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(folder.path().join("attics.toml"), FAMILY).expect("writable");
    folder
}

/// Runs `tune` on the small family and expects an exit code; gives stdout and stderr.
fn tune(place: &Path, code: i32, args: &[&str]) -> (String, String) {
    let mut command = Command::cargo_bin("experiments").expect("built");
    command.current_dir(place).arg("tune").args(args);
    for default in [["--families", "attics.toml"], ["--seeds", "1"]] {
        if !args.contains(&default[0]) {
            command.args(default);
        }
    }
    checked(code, &args, &command.output().expect("runs"))
}

/// The rows of a table.
fn rows(csv: &[u8]) -> Vec<csv::StringRecord> {
    csv::Reader::from_reader(csv).records().map(|row| row.expect("a row")).collect()
}

/// The row of a candidate up to its parameters, as in the table.
fn row_of(tuned: Tuned, candidate: &Candidate) -> Vec<String> {
    let value = |name: &&str| match candidate.get(name) {
        Some(Setting::Number(number)) if number == f64::INFINITY => "inf".to_owned(),
        Some(Setting::Number(number)) => serde_json::json!(number).to_string(),
        Some(Setting::Word(word)) => word.to_owned(),
        None => String::new(),
    };
    [tuned.name().to_owned()].into_iter().chain(parameters().iter().map(value)).collect()
}

#[test]
fn what_is_built_in_is_what_the_committed_table_calls_best() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../results/tuning/tuning.csv");
    let rows = rows(&fs::read(&path).expect("results/tuning is committed"));
    let best = |row: &&csv::StringRecord| row.iter().next_back() == Some("true");
    let best: Vec<Vec<String>> = rows
        .iter()
        .filter(best)
        .map(|row| row.iter().take(1 + parameters().len()).map(str::to_owned).collect())
        .collect();
    let built_in: Vec<_> = Tuned::all().into_iter().map(|tuned| row_of(tuned, &tuned.built_in())).collect();
    assert_eq!(best, built_in, "run `tune` and set the constants to its winners, or the other way round");
    let candidates =
        Tuned::all().into_iter().flat_map(|tuned| tuned.candidates().into_iter().map(move |c| row_of(tuned, &c)));
    let listed = rows.iter().map(|row| row.iter().take(1 + parameters().len()).map(str::to_owned).collect::<Vec<_>>());
    assert!(listed.eq(candidates), "the table is of another grid: run `tune` again");
}

/// The part of the committed table that takes seconds to compute is computed again.
#[test]
fn the_committed_table_is_what_tune_finds_for_visibility() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let place = tempfile::tempdir().expect("temporary folder");
    let mut command = Command::cargo_bin("experiments").expect("built");
    command.current_dir(&top).args(["tune", "--mappers", "visibility", "--format", "csv", "--out"]).arg(place.path());
    let (found, _) = checked(0, &"tune", &command.output().expect("runs"));
    let committed = rows(&fs::read(top.join("results/tuning/tuning.csv")).expect("results/tuning is committed"));
    let found = rows(found.as_bytes());
    assert_eq!(found.len(), 2);
    for (found, committed) in found.iter().zip(&committed) {
        for (now, then) in found.iter().zip(committed) {
            let near = |now: f64, then: f64| (now - then).abs() < 1e-5; // what single precision may change in a map
            let same = now == then || matches!((now.parse(), then.parse()), (Ok(now), Ok(then)) if near(now, then));
            assert!(same, "{found:?} {committed:?}");
        }
    }
}

#[test]
fn the_best_has_the_least_log_loss_of_its_mapper() {
    let place = place();
    let (out, _) = tune(place.path(), 0, &["--format", "csv"]);
    let rows = rows(out.as_bytes());
    for tuned in Tuned::all() {
        let own: Vec<_> = rows.iter().filter(|row| &row[0] == tuned.name()).collect();
        assert_eq!(own.len(), tuned.candidates().len());
        let [worlds, log_loss, best] = [0, 1, 3].map(|column| 1 + parameters().len() + column);
        let best: Vec<_> = own.iter().filter(|row| &row[best] == "true").collect();
        assert_eq!(best.len(), 1, "{tuned}");
        let loss = |row: &csv::StringRecord| row[log_loss].parse::<f64>().expect("a number");
        assert!(own.iter().all(|row| loss(row) >= loss(best[0]) && &row[worlds] == "1"), "{tuned}");
    }
}

#[test]
fn the_same_bytes_with_any_number_of_threads() {
    let place = place();
    let files = ["run.json", "tuning.csv", "tuning.png"];
    let [one, two] = ["1", "2"].map(|threads| {
        tune(place.path(), 0, &["--seeds", "2", "--out", threads, "--threads", threads]);
        files.map(|name| fs::read(place.path().join(threads).join(name)).expect("written"))
    });
    assert!(one == two);
}

#[test]
fn a_part_is_fitted_as_in_the_whole() {
    let place = place();
    let (whole, _) = tune(place.path(), 0, &["--format", "csv"]);
    let (part, _) = tune(place.path(), 0, &["--format", "csv", "--mappers", "visibility", "--out", "part"]);
    assert!(whole.starts_with(&part) && part.lines().count() == 3, "{part}");
    assert!(!place.path().join("part/tuning.png").exists(), "there is no curve in it");
}

#[test]
fn the_text_fits_a_terminal_and_says_what_was_chosen() {
    let place = place();
    let (out, err) = tune(place.path(), 0, &[]);
    assert!(out.lines().all(|line| line.chars().count() <= 80), "{out}");
    assert!(err.contains("results/tuning/tuning.csv"), "{err}");
    for tuned in Tuned::all() {
        assert!(out.lines().any(|line| line.starts_with(&format!("{tuned}: "))), "{out}");
    }
}

#[test]
fn bad_options_are_refused_before_any_work() {
    let place = place();
    let refused = |args: &[&str], expected: &str| {
        let (_, err) = tune(place.path(), 2, args);
        assert!(err.contains(expected), "{args:?}: {err}");
        assert!(!place.path().join("results").exists());
    };
    refused(&["--mappers", "prior"], "visibility, conventional-tuned, mrf, ");
    refused(&["--mappers", "mrf,mrf"], "'mrf' is given twice");
    refused(&["--mappers", ""], "--mappers");
    refused(&["--families", "nowhere.toml"], "nowhere.toml");
    refused(&["--families", "attics.toml,attics.toml"], "a family named \"attic\" is among them");
    refused(&["--threads", "0"], "--threads");
    for seeds in ["0", "10001", "-1", "many"] {
        refused(&["--seeds", seeds], "--seeds");
    }
}
