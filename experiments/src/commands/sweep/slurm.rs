//! `sweep slurm`: the shards that are not done, as job arrays on a cluster.
//!
//! Slurm is taken for what it is, an engine that runs tasks at least once: a task that it lost, ran twice or calls
//! completed changes nothing, since a shard is done where its result is whole and nowhere else.

mod batch;
mod queue;

use std::collections::BTreeSet;
use std::fs;
use std::time::Duration;

use self::batch::{Array, arrays, script};
use super::manifest::Manifest;
use super::options::SlurmOptions;
use super::{outcome, shard};
use crate::failure::Failure;
use crate::figures::Paper;
use crate::jobs::interruption;
use crate::output::{note, table};

/// Submits what is not done, follows it, and submits again what failed, for so many rounds; then merges and draws.
///
/// # Errors
/// A sweep that this build has not planned; no Slurm; shards that no round has finished (exit code 3).
pub(super) fn run(options: &SlurmOptions) -> Result<(), Failure> {
    if let Some(option) = options.sbatch.iter().find(|option| option.starts_with("--array") || option.starts_with("-a"))
    {
        return Err(Failure::BadInput(format!(
            "--sbatch {option}: which shards run follows from the manifest; leave it out"
        )));
    }
    let manifest = Manifest::open(&options.folder)?;
    manifest.confirm()?;
    let limit = options.max_array.unwrap_or_else(queue::largest_array);
    let executable = std::env::current_exe().map_err(Failure::internal)?;
    let text = |array: &Array| script(&executable, &manifest.folder, options, array);
    if options.dry_run {
        return arrays(&shard::missing(&manifest), limit).iter().try_for_each(|array| table::print(&text(array)));
    }
    let logs = manifest.folder.join("logs");
    fs::create_dir_all(&logs).map_err(|e| Failure::write(&logs, &e))?;
    let place = manifest.folder.display().to_string();
    interruption::keeps(move || {
        Some(format!(
            "the jobs of {place} stay in the queue (`scancel` ends them); run the same command again to follow them"
        ))
    });

    let mut jobs = queue::remembered(&manifest);
    for round in 0..=options.rounds {
        // Jobs of an earlier call may still be in the queue: shards are not submitted twice at once.
        follow(&manifest, &mut jobs, options)?;
        let missing = shard::missing(&manifest);
        if missing.is_empty() {
            queue::forget(&manifest.folder);
            return outcome::conclude(&manifest, None, &Paper::default());
        }
        if round == options.rounds {
            break;
        }
        for array in arrays(&missing, limit) {
            let job = queue::submit(&text(&array), &options.sbatch)?;
            note(format_args!("round {}: job {job}, {} shards", round + 1, array.indices.len()));
            queue::remember(&manifest, &job)?;
            jobs.insert(job);
        }
    }
    let missing = shard::missing(&manifest);
    missing.iter().for_each(|number| shard::note_failure(&manifest, *number, "not done after all rounds on Slurm"));
    Err(Failure::Claim(format!(
        "{}: {} of {} shards are not done after {} rounds: {}; see the logs in {}",
        manifest.folder.display(),
        missing.len(),
        manifest.head.shards,
        options.rounds,
        shard::ranges(&missing),
        logs.display()
    )))
}

/// Waits until none of the jobs is in the queue any more, or every shard is done.
fn follow(manifest: &Manifest, jobs: &mut BTreeSet<String>, options: &SlurmOptions) -> Result<(), Failure> {
    if jobs.is_empty() {
        return Ok(());
    }
    let mut missing = shard::missing(manifest);
    let mut said = usize::MAX;
    loop {
        missing.retain(|number| !shard::is_done(manifest, *number));
        if missing.is_empty() {
            return Ok(()); // what is left of the tasks finds its shards done
        }
        if missing.len() != said {
            note(format_args!("{} of {} shards are not done", missing.len(), manifest.head.shards));
            said = missing.len();
        }
        if jobs.is_empty() {
            return Ok(());
        }
        *jobs = queue::waiting(jobs, options.patience_s)?;
        // Also after the last job has left: its files may be a moment late on a shared disk.
        std::thread::sleep(Duration::from_secs_f64(options.poll));
    }
}
