//! Slurm's queue.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::commands::sweep::manifest::Manifest;
use crate::failure::Failure;

/// The largest array of a site that does not say.
const USUAL_LIMIT: u32 = 1001;

/// `MaxArraySize`: indices stay below it.
pub(super) fn largest_array() -> u32 {
    let shown = Command::new("scontrol").args(["show", "config"]).output().map(|output| output.stdout);
    let text = String::from_utf8_lossy(&shown.unwrap_or_default()).into_owned();
    let line = text.lines().find_map(|line| line.trim_start().strip_prefix("MaxArraySize"));
    let limit = line.and_then(|rest| rest.trim_start_matches([' ', '=']).trim().parse().ok());
    limit.filter(|limit| *limit > 0).unwrap_or(USUAL_LIMIT)
}

/// Submits a script and gives the job's number.
///
/// # Errors
/// No Slurm; a script or option that it refuses, in its own words.
pub(super) fn submit(script: &str, arguments: &[String]) -> Result<String, Failure> {
    let ran = || -> io::Result<Output> {
        let mut child = Command::new("sbatch")
            .arg("--parsable")
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()?;
        if let Some(mut stdin) = child.stdin.take() {
            // An sbatch that refuses its options does not read: what it says comes below.
            let _ = stdin.write_all(script.as_bytes());
        }
        child.wait_with_output()
    };
    let output = ran().map_err(|e| {
        Failure::BadInput(format!("sbatch: {e}; run this where Slurm is, or see what it would submit with --dry-run"))
    })?;
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    // `JOB` or `JOB;CLUSTER`.
    let job = out.trim().split(';').next().unwrap_or_default().to_owned();
    if !output.status.success() || job.parse::<u64>().is_err() {
        return Err(Failure::BadInput(format!("sbatch: {}; correct the options after --sbatch", err.trim())));
    }
    Ok(job)
}

/// Those of the jobs that are in the queue. A queue that cannot be asked for a while is no empty queue: what
/// squeue's exit code says, an unknown job or a controller that is down, is found out by asking for all jobs.
///
/// # Errors
/// A controller that does not answer for `patience_s` seconds.
pub(super) fn waiting(jobs: &BTreeSet<String>, patience_s: u64) -> Result<BTreeSet<String>, Failure> {
    let start = Instant::now();
    loop {
        let asked = Command::new("squeue").args(["--noheader", "--me", "--format=%F"]).output();
        match asked {
            Ok(output) if output.status.success() => {
                let text = String::from_utf8_lossy(&output.stdout).into_owned();
                return Ok(text.lines().map(|line| line.trim().to_owned()).filter(|job| jobs.contains(job)).collect());
            }
            answer if start.elapsed() > Duration::from_secs(patience_s) => {
                let why = match answer {
                    Ok(output) => String::from_utf8_lossy(&output.stderr).trim().to_owned(),
                    Err(error) => error.to_string(),
                };
                return Err(Failure::Internal(format!(
                    "squeue: {why}; the jobs may still run: when Slurm answers again, run the same command to go on"
                )));
            }
            _ => std::thread::sleep(Duration::from_secs(1)),
        }
    }
}

fn file(folder: &Path) -> PathBuf {
    folder.join("slurm-jobs.txt")
}

/// The jobs that an earlier call has submitted for this manifest.
pub(super) fn remembered(manifest: &Manifest) -> BTreeSet<String> {
    let text = fs::read_to_string(file(&manifest.folder)).unwrap_or_default();
    let own = |line: &str| line.strip_prefix(&manifest.digest).map(|job| job.trim().to_owned());
    text.lines().filter_map(own).filter(|job| job.parse::<u64>().is_ok()).collect()
}

/// Remembers a job, so that a later call does not submit its shards again while it is in the queue.
///
/// # Errors
/// A folder that cannot be written.
pub(super) fn remember(manifest: &Manifest, job: &str) -> Result<(), Failure> {
    let path = file(&manifest.folder);
    let opened = fs::OpenOptions::new().create(true).append(true).open(&path);
    opened.and_then(|mut file| writeln!(file, "{} {job}", manifest.digest)).map_err(|e| Failure::write(&path, &e))
}

/// Forgets all jobs: every shard is done.
pub(super) fn forget(folder: &Path) {
    let _ = fs::remove_file(file(folder));
}
