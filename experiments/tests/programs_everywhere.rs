//! Programs of one's own wherever built-in mappers are named.

#![cfg(unix)]

use crate::attic;
use crate::closet;
use std::fs;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

use crate::checked::checked;

/// The program of `tests/child`.
const CHILD: &str = env!("CARGO_BIN_EXE_test-program");

fn run(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::cargo_bin("experiments").expect("built");
    let same = format!("same={CHILD} prior");
    let bad = format!("bad={CHILD} fails");
    command.current_dir(folder).args(args).args(["--mapper", &same, "--mapper", &bad]).output().expect("starts")
}

fn rows(out: &str) -> Vec<Value> {
    let json: Value = serde_json::from_str(out).expect("JSON");
    json["rows"].as_array().expect("rows").clone()
}

fn of<'a>(rows: &'a [Value], mapper: &'a str) -> impl Iterator<Item = &'a Value> {
    rows.iter().filter(move |row| row["mapper"] == mapper)
}

/// Lines of a table without what differs between `same` and `prior` on purpose.
fn lines(folder: &Path, mapper: &str) -> Vec<Vec<String>> {
    let mut table = csv::Reader::from_path(folder.join(format!("c/scores-{mapper}.csv"))).expect("there");
    let heads = table.headers().expect("heads").clone();
    let kept = |head: &str| head != "mapper" && head != "retention";
    let line = |record: csv::StringRecord| {
        heads.iter().zip(&record).filter(|(head, _)| kept(head)).map(|(_, field)| field.to_owned()).collect()
    };
    table.records().map(|record| line(record.expect("a row"))).collect()
}

/// The time in the process of each program is told apart from ours, and only once.
fn told_times(err: &str) {
    for program in ["same", "bad"] {
        let line = |line: &&str| line.starts_with(&format!("{program}: ")) && line.contains(" s in its process, ");
        assert_eq!(err.lines().filter(line).count(), 1, "{program}: {err}");
    }
}

#[test]
fn compare_pairs_a_program_with_the_reference() {
    let folder = TempDir::new().expect("temporary folder");
    fs::write(folder.path().join("attic.toml"), attic::FAMILY).expect("writable");
    let args = ["compare", "--families", "attic.toml", "--seeds", "3", "--batch-seeds", "3", "--out", "c"];
    let args = [&args[..], &["--mappers", "visibility,prior", "--quick", "--format", "json"]].concat();
    let (out, err) = checked(3, &args, &run(folder.path(), &args));
    assert!(err.contains("mappers gave no map 3 times, first bad: attic"), "{err}");
    told_times(&err);
    let rows = rows(&out);
    let mut pairs = 0;
    for (same, prior) in of(&rows, "same").zip(of(&rows, "prior")) {
        for key in ["scope", "region", "metric"] {
            assert_eq!(same[key], prior[key]);
        }
        if same["metric"] != "retention" {
            assert_eq!((&same["pairs"], &same["difference"]), (&prior["pairs"], &prior["difference"]));
            pairs += same["pairs"].as_u64().unwrap_or(0);
        }
    }
    assert!(pairs > 10);
    assert!(of(&rows, "bad").count() > 0 && of(&rows, "bad").all(|row| row["difference"].is_null()));
    assert_eq!(lines(folder.path(), "same"), lines(folder.path(), "prior"));
    // The page is laid anew without starting a program.
    let page = fs::read(folder.path().join("c/report.html")).expect("there");
    fs::remove_file(folder.path().join("c/report.html")).expect("there");
    let mut command = Command::cargo_bin("experiments").expect("built");
    let report = command.current_dir(folder.path()).env("PATH", "").args(["report", "c"]).output().expect("starts");
    let (_, err) = checked(0, &"report", &report);
    assert!(!err.contains("same") && fs::read(folder.path().join("c/report.html")).expect("there") == page, "{err}");
    let bad = fs::read_to_string(folder.path().join("c/scores-bad.csv")).expect("there");
    assert!(bad.lines().skip(1).all(|line| line.contains("exit code 3: must be 0")), "{bad}");
}

#[test]
fn sweeps_take_programs_into_their_jobs() {
    let folder = TempDir::new().expect("temporary folder");
    fs::write(folder.path().join("attic.toml"), attic::FAMILY).expect("writable");
    let sweep =
        "families = [\"attic.toml\"]\nmappers = [\"prior\"]\nseeds = { count = 2 }\n[vary]\nprior = [0.1, 0.2]\n";
    fs::write(folder.path().join("s.toml"), sweep).expect("writable");
    checked(0, &"plan", &run(folder.path(), &["sweep", "plan", "s.toml", "--out", "s"]));
    // Shards run wherever the manifest is, and know the programs from it.
    let mut shards = Command::cargo_bin("experiments").expect("built");
    let ran = shards.current_dir(folder.path()).args(["sweep", "run", "s"]).output().expect("starts");
    let (_, err) = checked(0, &"run", &ran);
    assert!(err.contains("4 jobs") && err.contains("4 rows with an error"), "{err}");
    told_times(&err);
    checked(0, &"all", &run(folder.path(), &["sweep", "s.toml", "--out", "s"]));
    let mut table = csv::Reader::from_path(folder.path().join("s/table.csv")).expect("there");
    let heads = table.headers().expect("heads").clone();
    let place = |name: &str| heads.iter().position(|head| head == name).expect("a column");
    let (mapper, region, error, retention) = (place("mapper"), place("region"), place("error"), place("retention"));
    let rows: Vec<csv::StringRecord> = table.records().map(|row| row.expect("a row")).collect();
    let of = |name: &str| rows.iter().filter(|row| &row[mapper] == name).collect::<Vec<_>>();
    let (same, prior, bad) = (of("same"), of("prior"), of("bad"));
    assert_eq!((same.len(), prior.len(), bad.len()), (12, 12, 4));
    for (same, prior) in same.iter().zip(&prior) {
        for k in (0..heads.len()).filter(|k| ![mapper, retention].contains(k)) {
            assert_eq!(same[k], prior[k], "{}", &heads[k]);
        }
        assert!(same[retention].is_empty());
    }
    assert!(bad.iter().all(|row| row[region].is_empty() && row[error].contains("exit code 3: must be 0")));
}

#[test]
fn gates_judge_a_program_and_fail_where_it_fails() {
    let folder = TempDir::new().expect("temporary folder");
    fs::write(folder.path().join("attic.toml"), attic::FAMILY).expect("writable");
    let gate = |mapper: &str| {
        format!(
            "[[gate]]\nname = \"{mapper}\"\nmapper = \"{mapper}\"\nmetric = \"log_loss\"\nfamilies = [\"attic.toml\"]\n\
             seeds = 2\nat_most = 1.0\n"
        )
    };
    fs::write(folder.path().join("gates.toml"), gate("same") + &gate("prior") + &gate("bad")).expect("writable");
    let args = ["gate", "--gates", "gates.toml", "--format", "json"];
    let (out, err) = checked(3, &args, &run(folder.path(), &args));
    told_times(&err);
    let rows = rows(&out);
    let value = |name: &str| rows.iter().find(|row| row["gate"] == name).expect("a row");
    assert_eq!(value("same")["value"], value("prior")["value"]);
    assert_eq!((&value("same")["verdict"], &value("bad")["verdict"]), (&"pass".into(), &"ERROR".into()));
    assert!(out.contains("exit code 3: must be 0"), "{out}");
    let args = ["gate", "--gates", "gates.toml", "--only", "same,prior"];
    checked(0, &args, &run(folder.path(), &args));
}

#[test]
fn replay_and_speed_take_programs() {
    let folder = TempDir::new().expect("temporary folder");
    fs::write(folder.path().join("closet.toml"), closet::SCENE).expect("writable");
    let args = ["room", "--scene", "closet.toml", "--mappers", "prior", "--out", "room"];
    checked(3, &args, &run(folder.path(), &args));

    let args = ["replay", "room/scans.csv", "--mappers", "visibility,prior", "--grid", "0.1", "--hold-out", "5"];
    let args = [&args[..], &["--format", "json", "--out", "r"]].concat();
    let (out, err) = checked(3, &args, &run(folder.path(), &args));
    assert!(err.contains("same: ") && err.contains("in its process"), "{err}");
    let replayed = rows(&out);
    let row = |mapper: &str| replayed.iter().find(|row| row["mapper"] == mapper).expect("a row");
    assert_eq!(row("same")["predictive_log_loss"], row("prior")["predictive_log_loss"]);
    assert!(row("bad")["predictive_log_loss"].is_null());
    assert!(row("bad")["error"].as_str().is_some_and(|error| error.contains("exit code 3")));

    let args = ["speed", "--scans", "room/scans.csv", "--mappers", "prior", "--repeats", "2", "--format", "json"];
    let (out, _) = checked(3, &args, &run(folder.path(), &args));
    let speeds = rows(&out);
    let row = |mapper: &str| speeds.iter().find(|row| row["mapper"] == mapper).expect("a row");
    assert!(row("same")["process_s"].as_f64() > Some(0.0) && row("same")["ns_per_cell"].as_f64() > Some(0.0));
    assert!(row("bad")["ns_per_cell"].is_null() && row("bad")["error"].is_string());
    assert!(row("prior")["process_s"].is_null() && row("prior")["error"].is_null());
    let (_, err) = checked(2, &"growth", &run(folder.path(), &["speed", "--growth", "--mappers", "prior"]));
    assert!(err.contains("leave out --mapper"), "{err}");
}
