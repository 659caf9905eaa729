//! What a run may replace and remove, case by case; [`random`] tries everything at once.

mod random;

use serde_json::json;

use super::*;

fn purpose(command: &str, reads: &[&Path], writes: &[&str]) -> Purpose {
    Purpose::new(command, reads, writes.iter().copied())
}

/// A run that writes some files.
fn run(folder: &Path, command: &str, reads: &[&Path], files: &[(&str, &str)]) -> Result<(), Failure> {
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    let mut staging = Staging::open(folder, &purpose(command, reads, &names))?;
    for (name, text) in files {
        staging.write(name, |out| out.write_all(text.as_bytes()))?;
    }
    staging.record(&json!({"schema_version": 1, "command": command}))?;
    staging.publish()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("there");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn text(path: &Path) -> String {
    fs::read_to_string(path).expect("there")
}

fn refusal(outcome: Result<(), Failure>) -> String {
    match outcome.expect_err("refused") {
        Failure::BadInput(message) => message,
        other => panic!("{other:?}"),
    }
}

#[test]
fn published_files_replace_those_of_the_former_run_and_no_others() {
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(folder.path().join("mine.txt"), "keep").expect("writable");
    run(folder.path(), "room", &[], &[("old.csv", "1"), ("both.csv", "1")]).expect("free");
    run(folder.path(), "room", &[], &[("new.csv", "2"), ("both.csv", "2")]).expect("its own");
    assert_eq!(names(folder.path()), ["both.csv", "mine.txt", "new.csv", "run.json"]);
    assert_eq!(text(&folder.path().join("both.csv")), "2");
}

#[test]
fn the_record_has_name_size_and_digest_of_every_file() {
    let folder = tempfile::tempdir().expect("temporary folder");
    run(folder.path(), "room", &[], &[("b", "abc"), ("a", "")]).expect("free");
    let record: serde_json::Value = serde_json::from_str(&text(&folder.path().join(RECORD))).expect("JSON");
    let empty = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
    let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
    let files = json!([{"name": "a", "bytes": 0, "sha256": empty}, {"name": "b", "bytes": 3, "sha256": abc}]);
    assert_eq!(record["files"], files);
}

#[test]
fn files_of_another_command_or_of_nobody_known_are_refused_before_any_work() {
    let folder = tempfile::tempdir().expect("temporary folder");
    run(folder.path(), "room", &[], &[("scans.csv", "1")]).expect("free");
    let log = folder.path().join("scans.csv");
    let message = refusal(run(folder.path(), "replay", &[&log], &[("predictions.csv", "2")]));
    assert!(message.contains("run.json: holds the results of `room`") && message.contains("--out"), "{message}");
    assert_eq!(names(folder.path()), ["run.json", "scans.csv"]);

    let own = tempfile::tempdir().expect("temporary folder");
    fs::write(own.path().join("visibility.pgm"), "mine").expect("writable");
    let message = refusal(run(own.path(), "replay", &[], &[("visibility.pgm", "2")]));
    assert!(message.contains("visibility.pgm: was not written by an earlier `replay`"), "{message}");
    assert_eq!(
        (names(own.path()), text(&own.path().join("visibility.pgm"))),
        (vec!["visibility.pgm".into()], "mine".into())
    );
}

#[test]
fn a_foreign_record_is_refused_and_what_it_lists_stays() {
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(folder.path().join("run.log"), "mine").expect("writable");
    fs::write(folder.path().join(RECORD), r#"{"command":"replay","files":["run.log"]}"#).expect("writable");
    let message = refusal(run(folder.path(), "replay", &[], &[("predictions.csv", "2")]));
    assert!(message.contains("run.json: lists no files with size and digest"), "{message}");
    assert_eq!(names(folder.path()), ["run.json", "run.log"]);
}

#[test]
fn a_file_that_was_changed_is_not_replaced_and_one_that_is_not_made_again_stays() {
    let folder = tempfile::tempdir().expect("temporary folder");
    run(folder.path(), "room", &[], &[("a.csv", "1"), ("b.csv", "1")]).expect("free");
    fs::write(folder.path().join("a.csv"), "mine").expect("writable");
    let message = refusal(run(folder.path(), "room", &[], &[("a.csv", "2")]));
    assert!(message.contains("a.csv: has changed since `room` wrote it"), "{message}");
    run(folder.path(), "room", &[], &[("b.csv", "2")]).expect("b.csv is its own");
    assert_eq!(text(&folder.path().join("a.csv")), "mine");
}

#[test]
fn a_file_that_is_read_is_neither_replaced_nor_removed() {
    let folder = tempfile::tempdir().expect("temporary folder");
    run(folder.path(), "replay", &[], &[("scans.csv", "1"), ("other.csv", "1")]).expect("free");
    let read = folder.path().join("scans.csv");
    let alias = folder.path().join("alias");
    fs::hard_link(&read, &alias).expect("links");
    for read in [&read, &alias] {
        let message = refusal(run(folder.path(), "replay", &[read], &[("scans.csv", "2")]));
        assert!(message.contains("scans.csv: is read by this run, which would replace it"), "{message}");
        let message = refusal(run(folder.path(), "replay", &[read], &[("other.csv", "2")]));
        assert!(message.contains("scans.csv: is read by this run, which would remove it"), "{message}");
    }
    assert_eq!(text(&read), "1");
}

#[test]
fn a_run_that_makes_some_files_anew_leaves_the_others() {
    let folder = tempfile::tempdir().expect("temporary folder");
    run(folder.path(), "room", &[], &[("a.csv", "1"), ("report.html", "1")]).expect("free");
    let mut staging = Staging::amend(folder.path(), &purpose("room", &[], &["report.html"])).expect("its own");
    staging.write("report.html", |out| out.write_all(b"2")).expect("writable");
    staging.record_again().expect("writable");
    staging.publish().expect("writable");
    assert_eq!(names(folder.path()), ["a.csv", "report.html", "run.json"]);
    run(folder.path(), "room", &[], &[("a.csv", "3"), ("report.html", "3")]).expect("the record knows both");
    assert_eq!(text(&folder.path().join("report.html")), "3");
}

#[test]
fn a_run_that_ends_early_leaves_nothing() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let new = folder.path().join("new");
    let mut staging = Staging::open(&new, &purpose("room", &[], &["a.csv"])).expect("writable");
    staging.write("a.csv", |out| out.write_all(b"1")).expect("writable");
    drop(staging);
    assert!(names(folder.path()).is_empty());
}

#[test]
fn a_folder_is_made_while_no_interruption_cleans_up() {
    let place = tempfile::tempdir().expect("writable");
    let folder = place.path().join("new");
    let interrupted = interruption::not_now();
    std::thread::scope(|scope| {
        let opened = scope.spawn(|| Staging::open(&folder, &purpose("room", &[], &["a.csv"])).map(drop));
        std::thread::sleep(std::time::Duration::from_millis(50));
        assert!(!folder.exists(), "an interruption now would leave it behind");
        drop(interrupted);
        assert!(opened.join().expect("ends").is_ok());
    });
}

#[test]
fn a_file_put_in_the_way_during_the_run_stops_everything() {
    let folder = tempfile::tempdir().expect("temporary folder");
    run(folder.path(), "room", &[], &[("a.csv", "1")]).expect("free");
    let mut staging = Staging::open(folder.path(), &purpose("room", &[], &["a.csv", "b.csv"])).expect("its own");
    for name in ["a.csv", "b.csv"] {
        staging.write(name, |out| out.write_all(b"2")).expect("writable");
    }
    staging.record(&json!({"command": "room"})).expect("writable");
    fs::write(folder.path().join("b.csv"), "mine").expect("writable");
    let message = refusal(staging.publish());
    assert!(message.contains("b.csv: another file has its name"), "{message}");
    assert_eq!(names(folder.path()), ["a.csv", "b.csv", "run.json"]);
    assert_eq!((text(&folder.path().join("a.csv")), text(&folder.path().join("b.csv"))), ("1".into(), "mine".into()));
}

#[test]
fn a_folder_or_a_file_in_the_way_is_refused_before_any_work() {
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::create_dir(folder.path().join("b.csv")).expect("writable");
    let message = refusal(run(folder.path(), "room", &[], &[("b.csv", "1")]));
    assert!(message.contains("b.csv: is a folder where a file is to go"), "{message}");
    fs::write(folder.path().join("out"), "a file").expect("writable");
    refusal(run(&folder.path().join("out"), "room", &[], &[]));
}

#[test]
fn two_runs_do_not_share_a_folder_and_hidden_folders_of_others_stay() {
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::create_dir(folder.path().join(".partial-1")).expect("writable");
    fs::write(folder.path().join(".partial-1/notes"), "mine").expect("writable");
    let first = Staging::open(folder.path(), &purpose("room", &[], &[])).expect("writable");
    let message = refusal(run(folder.path(), "room", &[], &[]));
    assert!(message.contains("another run"), "{message}");
    drop(first);
    run(folder.path(), "room", &[], &[]).expect("free again");
    assert_eq!(text(&folder.path().join(".partial-1/notes")), "mine");
}

#[test]
fn two_sources_of_one_name_get_two_folders() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let base = folder.path().join("replay-run");
    let sources = ["day1", "day2", "day3"].map(|day| folder.path().join(day).join("run.log"));
    let recorded = |record: &serde_json::Value| record["log"].as_str().map(PathBuf::from);
    let mut chosen = Vec::new();
    for source in &sources {
        let out = for_source(&base, source, recorded);
        let mut staging = Staging::open(&out, &purpose("replay", &[], &[])).expect("free");
        staging.record(&json!({"command": "replay", "log": source.display().to_string()})).expect("writable");
        staging.publish().expect("writable");
        chosen.push(out.file_name().expect("named").to_string_lossy().into_owned());
    }
    assert_eq!(chosen, ["replay-run", "replay-run-2", "replay-run-3"]);
    assert_eq!(for_source(&base, &sources[1], recorded), folder.path().join("replay-run-2"), "its own again");
}
