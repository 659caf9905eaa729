//! `sweep slurm` on a real Slurm, one that lives on this machine for as long as the test: with tasks that crash and tasks
//! that are killed, the table is that of an undisturbed run. Needs Debian's slurmctld, slurmd, slurm-client and munge.

#[path = "../attic/mod.rs"]
mod attic;
#[path = "../checked/mod.rs"]
mod checked;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use checked::checked;

/// Small cells and many readings, so that a task lives long enough to be killed.
const SWEEP: &str = r#"
families = ["attics.toml"]
mappers = ["visibility", "conventional"]
seeds = { first = 1, count = 4 }
[vary]
grid = [0.01, 0.012]
correlation = [0.0, 0.5, 0.871]
"#;

/// A Slurm that ends with the test.
struct Slurm {
    folder: PathBuf,
}

impl Slurm {
    fn start(folder: PathBuf) -> Self {
        let slurm = Self { folder };
        let output = slurm.script("start");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            output.status.success(),
            "Slurm does not start; are slurmctld, slurmd, slurm-client and munge there?\n{said}"
        );
        slurm
    }

    fn script(&self, what: &str) -> Output {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/slurm/local.sh");
        Command::new(script).arg(what).arg(&self.folder).env("MAX_ARRAY_SIZE", "5").output().expect("a shell")
    }

    fn sweep(&self, place: &Path, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
        command.current_dir(place).arg("sweep").args(args).env("SLURM_CONF", self.folder.join("slurm.conf"));
        command
    }
}

impl Drop for Slurm {
    fn drop(&mut self) {
        self.script("stop");
    }
}

fn place() -> tempfile::TempDir {
    let folder = tempfile::Builder::new().prefix("sl").tempdir_in("/tmp").expect("a short path");
    let family =
        attic::FAMILY.replace("columns = 16", "columns = 32").replace("scan_interval = 0.8", "scan_interval = 0.4");
    fs::write(folder.path().join("attics.toml"), family).expect("writable");
    fs::write(folder.path().join("sweep.toml"), SWEEP).expect("writable");
    folder
}

fn run(mut command: Command, code: i32) -> (String, String) {
    let output = command.output().expect("runs");
    checked(code, &command, &output)
}

fn finished(child: Child, code: i32) -> String {
    let output = child.wait_with_output().expect("ended");
    let err = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{err}");
    err
}

fn wait_for<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(start.elapsed() < Duration::from_secs(120), "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// The process of a task: not the shell that will become it.
fn task(folder: &Path) -> Option<String> {
    let wanted = folder.display().to_string();
    fs::read_dir("/proc").ok()?.flatten().find_map(|entry| {
        let line = fs::read(entry.path().join("cmdline")).ok()?;
        let words: Vec<String> =
            line.split(|byte| *byte == 0).map(|w| String::from_utf8_lossy(w).into_owned()).collect();
        let own = words.iter().any(|word| word == "--shard") && words.iter().any(|word| word.ends_with(&wanted));
        own.then(|| entry.file_name().to_string_lossy().into_owned())
    })
}

#[test]
#[ignore = "needs slurmctld, slurmd, slurm-client and munge"]
fn crashed_and_killed_tasks_run_again_and_the_table_is_the_same() {
    let place = place();
    let place = place.path();
    let slurm = Slurm::start(place.join("s"));
    run(slurm.sweep(place, &["sweep.toml", "--out", "one", "--threads", "2"]), 0);
    let expected = fs::read(place.join("one/table.csv")).expect("merged");

    // Twelve shards in arrays of at most five: the site allows indices below that.
    run(slurm.sweep(place, &["plan", "sweep.toml", "--out", "many", "--shards", "12"]), 0);
    let (script, _) = run(slurm.sweep(place, &["slurm", "many", "--dry-run"]), 0);
    assert_eq!(script.matches("#!/bin/sh").count(), 3, "{script}");
    assert!(script.contains("((10 + SLURM_ARRAY_TASK_ID))") && script.contains("--array=0-1\n"), "{script}");

    // A folder in the place of a result: the task that makes it crashes.
    let shard = place.join("many/shards/000007.csv");
    fs::create_dir_all(&shard).expect("writable");
    let mut command = slurm.sweep(place, &["slurm", "many", "--poll", "0.2", "--rounds", "3"]);
    let following = command.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().expect("runs");
    let killed = wait_for("a task", || task(&place.join("many")));
    assert!(Command::new("kill").args(["-9", &killed]).status().expect("runs").success());
    wait_for("the crash", || fs::read_dir(place.join("many/failures")).ok()?.flatten().next());
    fs::remove_dir(&shard).expect("removed");
    let said = finished(following, 0);
    assert!(said.contains("round 2: job"), "the killed task's shard was submitted again: {said}");
    assert!(fs::read(place.join("many/table.csv")).expect("merged") == expected);
    assert!(!place.join("many/slurm-jobs.txt").exists());
    assert!(fs::read_dir(place.join("many/logs")).expect("there").count() > 12);
}

#[test]
#[ignore = "needs slurmctld, slurmd, slurm-client and munge"]
fn what_never_finishes_is_named_and_what_is_queued_is_not_submitted_twice() {
    let place = place();
    let place = place.path();
    let slurm = Slurm::start(place.join("s"));
    // A space and a percent sign in the name, which scripts must quote.
    run(slurm.sweep(place, &["plan", "sweep.toml", "--out", "never %a", "--shards", "4"]), 0);
    fs::create_dir_all(place.join("never %a/shards/000002.csv")).expect("writable");
    let (_, err) = run(slurm.sweep(place, &["slurm", "never %a", "--poll", "0.2", "--rounds", "2"]), 3);
    assert!(err.contains("1 of 4 shards are not done after 2 rounds: 2; see the logs"), "{err}");
    assert_eq!(run(slurm.sweep(place, &["missing", "never %a"]), 0).0, "2\n");
    fs::remove_dir(place.join("never %a/shards/000002.csv")).expect("removed");

    // Interrupted while its job is in the queue, held there.
    let args = ["slurm", "never %a", "--poll", "0.2", "--sbatch=--hold"];
    let mut command = slurm.sweep(place, &args);
    let child = command.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().expect("runs");
    let jobs = || fs::read_to_string(place.join("never %a/slurm-jobs.txt")).unwrap_or_default();
    let before = jobs().lines().count();
    let job = wait_for("the third job", || jobs().lines().nth(before)?.split(' ').nth(1).map(str::to_owned));
    assert!(Command::new("kill").arg(child.id().to_string()).status().expect("runs").success());
    let err = finished(child, 75);
    assert!(err.contains("stay in the queue"), "{err}");

    let mut command = slurm.sweep(place, &args);
    let child = command.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().expect("runs");
    std::thread::sleep(Duration::from_millis(600));
    let released =
        Command::new("scontrol").args(["release", &job]).env("SLURM_CONF", place.join("s/slurm.conf")).status();
    assert!(released.expect("runs").success());
    let err = finished(child, 0);
    assert!(!err.contains("round"), "nothing was submitted again: {err}");
    assert!(place.join("never %a/table.csv").exists());

    let (_, err) = run(slurm.sweep(place, &["plan", "sweep.toml", "--out", "bad"]), 0);
    assert!(err.contains("24 jobs in 24 shards"), "{err}");
    let (_, err) = run(slurm.sweep(place, &["slurm", "bad", "--sbatch=--partition=none"]), 2);
    assert!(err.contains("sbatch:") && err.contains("partition"), "{err}");
    let (_, err) = run(slurm.sweep(place, &["slurm", "bad", "--sbatch=--array=1"]), 2);
    assert!(err.contains("follows from the manifest"), "{err}");
    let mut nowhere = slurm.sweep(place, &["slurm", "bad"]);
    nowhere.env("PATH", "/nonexistent");
    let (_, err) = run(nowhere, 2);
    assert!(err.contains("sbatch:") && err.contains("--dry-run"), "{err}");
}
