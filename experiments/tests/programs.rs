//! Programs of one's own as mappers: what they are told, how they are scored, and what becomes of hostile ones.

#![cfg(unix)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::time::Duration;

use assert_cmd::Command;
use experiments::output::args::{Edges, Law, PriorOptions};
use experiments::programs::program::Program;
use experiments::worlds::condition::AS_BELIEVED;
use experiments::worlds::run::{Keep, RegionScore, Run, Trial};
use experiments::worlds::site::{Assumptions, Site};
use mapper::catalogue::{Entry, find};
use serde_json::Value;
use tempfile::TempDir;

use crate::checked::checked;
use crate::closet::SCENE;

/// The program of `tests/child`.
const CHILD: &str = env!("CARGO_BIN_EXE_test-program");

struct Place(TempDir);

impl Place {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("temporary folder");
        fs::write(folder.path().join("closet.toml"), SCENE).expect("writable");
        fs::create_dir(folder.path().join("tmp")).expect("writable");
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, args: &[&str]) -> Output {
        let mut command = Command::cargo_bin("experiments").expect("built");
        command.current_dir(self.0.path()).env("TMPDIR", self.path("tmp")).args(args).output().expect("runs")
    }

    /// `room` with `prior` and a program called `mine`.
    fn room(&self, code: i32, program: &str, more: &[&str]) -> (Vec<Value>, String) {
        let program = format!("mine={program}");
        let args = ["room", "--scene", "closet.toml", "--mappers", "prior", "--mapper", &program, "--format", "json"];
        let args = [&args[..], &["--out", "out"], more].concat();
        let (out, err) = checked(code, &args, &self.run(&args));
        let json: Value = serde_json::from_str(&out).expect("JSON");
        let rows = json["rows"].as_array().expect("rows").clone();
        assert_eq!(fs::read_dir(self.path("tmp")).expect("there").count(), 0, "nothing is left: {program}");
        (rows, err)
    }
}

fn of<'a>(rows: &'a [Value], mapper: &str) -> Vec<&'a Value> {
    rows.iter().filter(|row| row["mapper"] == mapper).collect()
}

/// A trial in the closet, in this process.
fn trial(mappers: &[&Entry]) -> (Trial, usize) {
    let folder = tempfile::tempdir().expect("temporary folder");
    let file = folder.path().join("closet.toml");
    fs::write(&file, SCENE).expect("writable");
    let scene = scene::load(&file, None, None).expect("a scene");
    let prior = PriorOptions {
        occupancy: 0.15,
        correlation: 0.871,
        correlation_law: Law::Scaled,
        reconciliation: Edges::AllEdges,
    };
    let Site { ground, setup } = Site::of(scene, &AS_BELIEVED, &Assumptions::of(&prior)).expect("a way");
    let keep = Keep { timeline: true, frames: Vec::new() };
    let trial = ground.trial(1, mappers, &setup, &keep, &|_, _| {}).expect("probabilities");
    (trial, ground.scans())
}

fn program(text: &str) -> &'static Entry {
    Program::parse(text).expect("valid").entry(Duration::from_secs(60))
}

/// Whether two values agree to 1e-9, or neither is there.
fn agree(a: Option<f64>, b: Option<f64>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= 1e-9,
        (a, b) => a.is_none() && b.is_none(),
    }
}

fn same_scores(run: &Run, prior: &Run, without: &[&str]) {
    assert_eq!(run.stages.len(), prior.stages.len());
    let mut values = 0;
    for (ours, theirs) in run.stages.iter().zip(&prior.stages) {
        assert_eq!(ours.fault, None);
        for (ours, theirs) in ours.scores.iter().zip(&theirs.scores) {
            let (ours, theirs) = ((&ours.region, ours.metric), (&theirs.region, theirs.metric));
            assert_eq!((ours.0, ours.1.name, ours.1.support), (theirs.0, theirs.1.name, theirs.1.support));
            if without.contains(&ours.1.name) {
                assert_eq!(ours.1.value, None, "{ours:?}");
            } else {
                assert!(agree(ours.1.value, theirs.1.value), "{ours:?} {theirs:?}");
                values += usize::from(ours.1.value.is_some());
            }
        }
    }
    assert!(values > 50, "metrics have values: {values}");
}

#[test]
fn a_program_that_answers_the_prior_scores_as_the_prior_does() {
    let mappers = [
        find("prior").expect("known"),
        program(&format!("same={CHILD} prior")),
        program(&format!("unseen={CHILD} unseen")),
        program(&format!("online=online: {CHILD} online")),
    ];
    let (trial, scans) = trial(&mappers);
    let [prior, same, unseen, online] = &trial.runs[..] else { panic!("four runs") };
    same_scores(same, prior, &["retention"]);
    same_scores(unseen, prior, &["retention"]);
    same_scores(online, prior, &[]);
    assert!(same.timeline.is_empty(), "a batch program has no map after every scan");
    assert_eq!((online.timeline.len(), prior.timeline.len()), (scans, scans));
    for (ours, theirs) in online.timeline.iter().zip(&prior.timeline) {
        assert!(agree(ours.log_loss, theirs.log_loss) && agree(ours.retention, theirs.retention));
    }
    assert!(online.program.is_some());
    assert_eq!(prior.program, None);
}

#[test]
fn a_mapper_in_rust_is_the_same_as_a_program() {
    for name in ["visibility", "log-odds-octomap", "forward-em"] {
        let own = find(name).expect("known");
        let (trial, _) = trial(&[own, program(&format!("served=online: {CHILD} serves {name}"))]);
        let [own, served] = &trial.runs[..] else { panic!("two runs") };
        assert!(own.stages.len() == served.stages.len() && !own.stages.is_empty());
        for (own, served) in own.stages.iter().zip(&served.stages) {
            assert_eq!(served.fault, None);
            assert_eq!(own.occupancy, served.occupancy, "{name}: to the last bit");
            // A program answers with marginals alone: footprints of a map that holds joints are other ones.
            let alike = |scores: &[RegionScore]| {
                scores
                    .iter()
                    .filter(|score| name != "visibility" || !score.metric.name.starts_with("footprint"))
                    .cloned()
                    .collect::<Vec<_>>()
            };
            let scores = [&own.scores, &served.scores].map(|scores| alike(scores));
            assert!(scores[0] == scores[1] || name == "forward-em", "{name}: retention of every scan");
        }
    }
}

#[test]
fn a_room_is_mapped_by_a_program_and_the_rest_is_as_ever() {
    let place = Place::new();
    let (rows, err) = place.room(0, &format!("{CHILD} prior-f4"), &["--seeds", "2"]);
    let (prior, mine) = (of(&rows, "prior"), of(&rows, "mine"));
    assert!(!prior.is_empty() && prior.len() == mine.len());
    for (prior, mine) in prior.iter().zip(&mine) {
        assert!(mine["error"].is_null());
        if mine["metric"] == "retention" {
            assert!(mine["value"].is_null());
        } else if let (Some(a), Some(b)) = (prior["value"].as_f64(), mine["value"].as_f64()) {
            assert!((a - b).abs() < 1e-5, "{prior} {mine}");
        } else {
            assert_eq!(prior["value"], mine["value"], "{prior} {mine}");
        }
    }
    assert!(err.contains("mine: ") && err.contains(" s in its process"), "{err}");
    assert!(place.path("out/mine-end.npy").is_file());
    let record: Value = serde_json::from_slice(&fs::read(place.path("out/run.json")).expect("there")).expect("JSON");
    assert_eq!(record["configuration"]["programs"][0]["name"], "mine");
    let without =
        place.run(&["room", "--scene", "closet.toml", "--mappers", "prior", "--format", "csv", "--out", "o2"]);
    assert!(
        String::from_utf8_lossy(&without.stdout)
            .starts_with("scene,seed,mapper,stage,region,metric,value,unit,support\n")
    );
}

#[test]
fn the_page_of_a_room_is_laid_anew_without_starting_its_programs() {
    let stages = "[[stage]]\nname = \"there\"\nafter = [\"A\", \"B\"]\n[[stage]]\nname = \"back\"\nafter = [\"A\", \"B\", \"A\"]\n";
    for (code, mappers, programs) in [
        (0, "b,prior,a", &["a=./child prior-f4", "b=online: ./child online"][..]),
        (3, "a,b", &["a=./child fails", "b=online: ./child online-dies"]),
        (0, "a", &["a=online: ./child online"]),
    ] {
        let place = Place::new();
        fs::write(place.path("closet.toml"), format!("{SCENE}{stages}")).expect("writable");
        fs::copy(CHILD, place.path("child")).expect("copied");
        let mut args = vec!["room", "--scene", "closet.toml", "--seeds", "2", "--out", "out", "--mappers", mappers];
        programs.iter().for_each(|program| args.extend(["--mapper", program]));
        checked(code, &args, &place.run(&args));
        fs::remove_file(place.path("child")).expect("there");
        let read = |name: &str| fs::read(place.path("out").join(name)).expect("there");
        let (page, record) = (read("report.html"), read("run.json"));
        fs::remove_file(place.path("out/report.html")).expect("there");
        checked(0, &"report", &place.run(&["report", "out"]));
        assert!(read("report.html") == page && read("run.json") == record, "{programs:?}");
        let kept = String::from_utf8(read("a-page.json")).expect("text");
        fs::write(place.path("out/a-page.json"), kept.replace("\"seed\":1", "\"seed\":2")).expect("writable");
        let (_, err) = checked(2, &"report", &place.run(&["report", "out"]));
        assert!(err.contains("a-page.json: has changed since the run that wrote it"), "{err}");
        fs::remove_file(place.path("out/a-page.json")).expect("there");
        let (_, err) = checked(2, &"report", &place.run(&["report", "out"]));
        assert!(err.contains("a-page.json: cannot be read"), "{err}");
    }
}

/// Whether a process has ended, or is about to be buried.
fn is_gone(pid: &str) -> bool {
    let status = fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    status.is_empty() || status.contains("State:\tZ")
}

/// All maps of `mine` are missing for the same reason, and `prior` is scored.
fn fails(program: &str, more: &[&str], parts: &[&str]) {
    let place = Place::new();
    let (rows, err) = place.room(3, program, more);
    assert!(of(&rows, "prior").iter().any(|row| row["value"].is_number()), "{program}");
    let mine = of(&rows, "mine");
    assert!(!mine.is_empty());
    for row in mine {
        assert!(row["value"].is_null());
        let error = row["error"].as_str().unwrap_or_default();
        assert!(parts.iter().all(|part| error.contains(part)) && !error.contains('\n'), "{program}: {row}");
        assert!(error.len() < 800, "{error}");
    }
    assert!(err.contains("error: ") && err.contains("gave no map"), "{err}");
    for name in ["metrics.csv", "report.html", "maps.png", "run.json"] {
        assert!(place.path("out").join(name).is_file(), "{name}");
    }
}

#[test]
fn what_a_program_does_wrong_is_a_row_with_the_error() {
    fails(
        &format!("{CHILD} fails"),
        &[],
        &["exit code 3: must be 0", "its last words: reading scans no memory for them"],
    );
    fails(&format!("{CHILD} aborts"), &[], &["killed by signal 6"]);
    fails("no/such/program --fast", &[], &["no/such/program cannot be started", "check its path"]);
    fails("./closet.toml", &[], &["./closet.toml cannot be started"]);
    fails(&format!("{CHILD} nothing"), &[], &["occupancy.npy was not written"]);
    fails(&format!("{CHILD} pipe"), &[], &["occupancy.npy is no regular file"]);
    fails(&format!("{CHILD} partial"), &[], &["occupancy.npy", "follow its header"]);
    fails(&format!("{CHILD} turned"), &[], &["the map is 30 x 20: must be 20 x 30"]);
    fails(&format!("{CHILD} infinite"), &[], &["value [0, 7] = inf: must be from 0 to 1, or NaN"]);
    fails(&format!("{CHILD} above"), &[], &["value [0, 7] = 1.5: must be from 0 to 1, or NaN"]);
}

#[test]
fn what_a_program_keeps_doing_is_ended() {
    let soon = ["--mapper-timeout", "0.4"];
    fails(&format!("{CHILD} sleeps"), &soon, &["no map within 0.4 s"]);
    fails(&format!("{CHILD} floods-stdout"), &soon, &["no map within 0.4 s"]);
    let later = ["--mapper-timeout", "3"];
    fails(&format!("{CHILD} floods-stderr"), &later, &["no map within 3 s", "its last words: ...xxx"]);
    fails(&format!("{CHILD} fills-the-disk"), &[], &["its folder holds", "bytes more than it was given"]);
    fails("online: sleep 1000", &soon, &["no map within 0.4 s"]);
}

#[test]
fn a_conversation_that_fails_is_a_row_with_the_error() {
    // Time enough for what is answered before, also on a machine that is busy.
    let later = ["--mapper-timeout", "3"];
    fails("online: no/such/program", &[], &["no/such/program cannot be started"]);
    fails(&format!("online: {CHILD} online-babbles"), &[], &["loading the model ...", "print nothing else"]);
    fails(&format!("online: {CHILD} fails"), &[], &["exit code 3"]);
    fails(&format!("online: {CHILD} floods-stdout"), &[], &["must end within 4096 bytes"]);
    // After five maps, in the middle of the drive.
    for (behaviour, part) in [
        ("online-dies", "exit code 5"),
        ("online-silent", "no map within 3 s"),
        ("online-short", "ended before a whole map"),
        ("online-twice", "not asked for"),
    ] {
        let place = Place::new();
        let (rows, _) = place.room(3, &format!("online: {CHILD} {behaviour}"), &later);
        let error = of(&rows, "mine").last().expect("rows")["error"].as_str().expect("an error").to_owned();
        assert!(error.contains(part), "{behaviour}: {error}");
        let timeline = fs::read_to_string(place.path("out/timeline.csv")).expect("there");
        let moments = timeline.lines().filter(|line| line.starts_with("mine,")).count();
        // A second map is noticed when the first that it stands for is asked for, or the one after that.
        let most = if behaviour == "online-twice" { 20 } else { 6 };
        assert!((5..=most).contains(&moments), "{behaviour}: {moments} moments");
    }
}

#[test]
fn a_program_that_closes_its_standard_input_is_ended() {
    let place = Place::new();
    let (rows, _) = place.room(3, "online: sh -c 'exec 0<&-; sleep 1000'", &["--mapper-timeout", "0.4"]);
    let error = of(&rows, "mine")[0]["error"].as_str().expect("an error").to_owned();
    // A pipe may have taken the first lines before.
    let known = ["standard input was closed", "no map within 0.4 s"];
    assert!(known.iter().any(|part| error.contains(part)), "{error}");
}

#[test]
fn a_program_that_does_not_read_is_ended() {
    // More than a pipe holds.
    let place = Place::new();
    let wide = SCENE.replace("columns = 24", "columns = 4000");
    fs::write(place.path("closet.toml"), wide).expect("writable");
    let (rows, _) = place.room(3, "online: sleep 1000", &["--mapper-timeout", "0.4", "--grid", "0.25"]);
    let error = of(&rows, "mine")[0]["error"].as_str().expect("an error").to_owned();
    assert!(error.contains("no scan was read from standard input within 0.4 s"), "{error}");
}

#[test]
fn no_process_is_left() {
    for (behaviour, code) in [("forks", 0), ("escapes", 0), ("disguises", 0), ("forks-and-sleeps", 3)] {
        let place = Place::new();
        let pid_file = place.path("pid");
        let program = format!("{CHILD} {behaviour} {}", pid_file.display());
        place.room(code, &program, &["--mapper-timeout", "2"]);
        let pid = fs::read_to_string(&pid_file).expect("the child ran");
        assert!(!pid.is_empty());
        if Path::new("/proc/self/status").is_file() {
            assert!(is_gone(&pid), "{behaviour}: process {pid} is left");
        }
    }
    let place = Place::new();
    place.room(0, &format!("online: {CHILD} online-stays"), &[]);
}

/// The processes, not counting those that wait to be buried, of whose words one contains the text.
fn alive(text: &str) -> Vec<String> {
    let numbers = fs::read_dir("/proc").into_iter().flatten().flatten().map(|entry| entry.file_name());
    let pids = numbers.filter_map(|name| name.into_string().ok()).filter(|name| name.parse::<u32>().is_ok());
    let named = |pid: &String| {
        let words = fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
        String::from_utf8_lossy(&words).replace('\0', " ").contains(text) && !is_gone(pid)
    };
    pids.filter(named).collect()
}

/// Asks again and again, for a minute.
fn becomes_true(mut what: impl FnMut() -> bool) -> bool {
    (0..6000).any(|_| {
        what() || {
            std::thread::sleep(Duration::from_millis(10));
            false
        }
    })
}

/// Starts `room` with a program that leaves a child behind, and gives it when the child runs.
fn room_with_child(place: &Place, behaviour: &str, more: &[&str]) -> std::process::Child {
    let pid_file = place.path("pid");
    let mode = if behaviour.starts_with("online") { "online: " } else { "" };
    let program = format!("mine={mode}{CHILD} {behaviour} {}", pid_file.display());
    let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin!("experiments"));
    command
        .args(["room", "--scene", "closet.toml", "--mappers", "prior", "--mapper", &program, "--out", "out"])
        .args(more);
    command.current_dir(place.0.path()).env("TMPDIR", place.path("tmp"));
    command.stdout(std::process::Stdio::null()).stderr(std::process::Stdio::null());
    let child = command.spawn().expect("starts");
    assert!(becomes_true(|| !fs::read_to_string(&pid_file).unwrap_or_default().is_empty()), "{behaviour}");
    child
}

#[test]
fn no_process_is_left_when_the_harness_itself_is_killed() {
    if !Path::new("/proc/self/cmdline").is_file() {
        return;
    }
    for behaviour in ["forks-and-sleeps", "stays", "online-leaves-and-stays"] {
        let place = Place::new();
        let here = place.0.path().display().to_string();
        let mut harness = room_with_child(&place, behaviour, &[]);
        let watcher = format!("--watch-programs {}", harness.id());
        assert!(alive(&here).len() >= 3 && alive(&watcher).len() == 1, "{behaviour}: harness, program, its child");
        harness.kill().and_then(|()| harness.wait()).expect("killed by signal 9");
        assert!(
            becomes_true(|| alive(&here).is_empty() && alive(&watcher).is_empty()),
            "{behaviour}: {:?}",
            alive(&here)
        );
        assert_eq!(fs::read_dir(place.path("tmp")).expect("there").count(), 0, "{behaviour}: no folder is left");
    }
}

#[test]
fn a_watcher_that_is_killed_is_done_without() {
    if !Path::new("/proc/self/cmdline").is_file() {
        return;
    }
    let place = Place::new();
    let mut harness = room_with_child(&place, "stays", &["--mapper-timeout", "3"]);
    let watcher = alive(&format!("--watch-programs {}", harness.id()));
    let killed = std::process::Command::new("kill").args(["-9", &watcher[0]]).status().expect("kill");
    assert!(killed.success());
    assert_eq!(harness.wait().expect("waited for").code(), Some(3), "the map is late, the rest is as ever");
    assert!(place.path("out/report.html").is_file());
    let here = place.0.path().display().to_string();
    assert!(becomes_true(|| alive(&here).is_empty()), "{:?}", alive(&here));
}

#[test]
fn standard_error_is_kept_and_both_its_ends() {
    let place = Place::new();
    place.room(0, &format!("{CHILD} floods-a-little"), &[]);
    let text = fs::read_to_string(place.path("out/mine-stderr.txt")).expect("kept");
    assert!(text.starts_with("== seed 1, stage ") && text.contains("the beginning\n") && text.contains("the end\n"));
    assert!(text.contains(" bytes left out ") && text.len() < 3 * 70_000, "{} bytes", text.len());
}

#[test]
fn a_stage_that_fails_costs_that_stage_alone() {
    let place = Place::new();
    let stages = "[[stage]]\nname = \"there\"\nafter = [\"A\", \"B\"]\n[[stage]]\nname = \"back\"\nafter = [\"A\", \"B\", \"A\"]\n";
    fs::write(place.path("closet.toml"), format!("{SCENE}{stages}")).expect("writable");
    let all = place.room(0, &format!("{CHILD} prior"), &[]).0;
    let stages = of(&all, "mine")
        .iter()
        .map(|row| row["stage"].as_str().expect("text").to_owned())
        .collect::<std::collections::BTreeSet<_>>();
    assert!(stages.len() > 1, "{stages:?}");
    let scans = fs::read_to_string(place.path("out/scans.csv")).expect("there").lines().count();
    let (rows, _) = place.room(3, &format!("{CHILD} fails-once {scans}"), &[]);
    let failed =
        |stage: &str| of(&rows, "mine").iter().filter(|row| row["stage"] == stage).all(|row| row["error"].is_string());
    assert_eq!(stages.iter().filter(|stage| !failed(stage)).count(), 1, "the last stage, which has all scans");
}

#[test]
fn bad_names_and_commands_are_refused_before_any_work() {
    let place = Place::new();
    for (program, part) in [
        ("mine=python3 'a", "not closed"),
        ("prior=x", "built-in mapper prior"),
        ("../x=y", "must be letters"),
        ("mine", "NAME='COMMAND ARG..'"),
    ] {
        let (_, err) = checked(2, &program, &place.run(&["room", "--scene", "closet.toml", "--mapper", program]));
        assert!(err.contains(part), "{program}: {err}");
    }
    let twice = ["room", "--scene", "closet.toml", "--mapper", "a=x", "--mapper", "a=y"];
    assert!(checked(2, &twice, &place.run(&twice)).1.contains("name of two programs"));
    let never = ["room", "--scene", "closet.toml", "--mapper", "a=x", "--mapper-timeout", "0"];
    assert!(checked(2, &never, &place.run(&never)).1.contains("above 0"));
}

/// Ctrl-C in the middle of a map: the program goes too.
#[cfg(target_os = "linux")]
#[test]
fn an_interruption_ends_the_program() {
    let place = Place::new();
    let pid_file = place.path("pid");
    let program = format!("mine={CHILD} forks-and-sleeps {}", pid_file.display());
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("experiments"))
        .current_dir(place.0.path())
        .env("TMPDIR", place.path("tmp"))
        .args(["room", "--scene", "closet.toml", "--mappers", "prior", "--mapper", &program, "--out", "out"])
        .stderr(std::process::Stdio::null())
        .stdout(std::process::Stdio::null())
        .spawn()
        .expect("starts");
    while fs::read_to_string(&pid_file).unwrap_or_default().is_empty() {
        std::thread::sleep(Duration::from_millis(5));
    }
    let pid = fs::read_to_string(&pid_file).expect("there");
    let killed = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    assert!(killed.success());
    assert_eq!(child.wait().expect("ends").code(), Some(130));
    assert!(is_gone(&pid), "process {pid} is left");
    assert_eq!(fs::read_dir(place.path("tmp")).expect("there").count(), 0);
    assert!(!place.path("out").exists());
}
