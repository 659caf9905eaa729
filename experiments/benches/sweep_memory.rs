//! What a sweep of a million jobs takes in memory: `cargo bench -p experiments --bench sweep_memory`, on Linux.
//!
//! No job is run: `sweep plan` writes the manifest, made-up rows stand for the results, and `sweep merge` makes the
//! table. Prints the time and the peak of the resident memory (`VmHWM`) of both commands, and fails above a bound.

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use experiments::commands::sweep::manifest::Manifest;
use experiments::commands::sweep::shard;

const SWEEP: &str = r#"
mappers = ["visibility"]
seeds = { first = 1, count = 1000 }
[vary]
grid = { from = 0.1, to = 1.0, steps = 10 }
prior = { from = 0.05, to = 0.5, steps = 10 }
correlation = { from = 0.0, to = 0.9, steps = 10 }
"#;

/// Neither command may take more, MB.
const MOST_MB: f64 = 500.0;

fn main() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = folder.path();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/room.toml");
    let text = format!("scene = {:?}\n{SWEEP}", scene.display().to_string());
    fs::write(place.join("million.toml"), text).expect("writable");
    measured(place, &["sweep", "plan", "million.toml", "--out", "million"]);

    let manifest = Manifest::open(&place.join("million")).expect("planned");
    assert_eq!(manifest.head.jobs, 1_000_000);
    for number in 0..manifest.head.shards {
        let mut rows = String::new();
        let row = |id, _| {
            for region in ["observable", "visible", "surface"] {
                let _ =
                    writeln!(rows, "{id:016x},room,1,0.1,0.05,0.0,visibility,{region},100,0.123456789,0.0123456789,");
            }
            Ok(ControlFlow::Continue(()))
        };
        manifest.each_job(number, row).expect("read");
        shard::write(&manifest, number, rows.as_bytes()).expect("written");
    }
    measured(place, &["sweep", "missing", "million"]);
    measured(place, &["sweep", "merge", "million"]);
    let table = fs::metadata(place.join("million/table.csv")).expect("merged").len();
    let _ = writeln!(std::io::stdout(), "table of {:.0} MB", table as f64 / 1e6);
}

/// Runs a command and prints its time and the peak of its memory.
fn measured(place: &Path, args: &[&str]) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
    let start = Instant::now();
    let mut child = command.current_dir(place).args(args).stderr(Stdio::null()).spawn().expect("runs");
    let mut peak_kb = 0u64;
    let status = loop {
        let text = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kb = line.and_then(|line| line.split_whitespace().next()?.parse().ok());
        peak_kb = peak_kb.max(kb.unwrap_or(0));
        if let Some(status) = child.try_wait().expect("waits") {
            break status;
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    assert!(status.success(), "{args:?}: {status}");
    let (peak_mb, time) = (peak_kb as f64 / 1024.0, start.elapsed().as_secs_f64());
    let _ = writeln!(std::io::stdout(), "{}: {time:.1} s, peak {peak_mb:.0} MB", args[..2].join(" "));
    assert!(peak_mb > 0.0 && peak_mb < MOST_MB, "{args:?}: {peak_mb} MB");
}
