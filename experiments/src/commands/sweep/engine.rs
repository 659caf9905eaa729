//! The local engine: every thread takes a shard that is not done.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use super::manifest::Manifest;
use super::shard;
use crate::failure::Failure;
use crate::jobs::engine;
use crate::jobs::interruption;
use crate::jobs::progress::Jobs;

/// What a run did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ran {
    /// Number of jobs.
    pub jobs: u64,
    /// Number of rows with an error.
    pub failed: u64,
}

/// Runs shards on so many threads. Ctrl-C drops those that run and keeps those that are done.
///
/// # Errors
/// I/O, after the other shards were tried; each try that fails leaves a note in `failures`.
pub fn run(manifest: &Manifest, shards: &[u32], threads: usize) -> Result<Ran, Failure> {
    let jobs: u64 = shards.iter().map(|shard| manifest.jobs_of(*shard)).sum();
    let progress = Jobs::new(jobs);
    let (kept, all) = (manifest.clone(), shards.to_vec());
    interruption::keeps(move || {
        // By their files: whoever interrupts may have seen one that is not yet counted.
        let done = all.iter().filter(|number| shard::is_done(&kept, **number)).count();
        let (all, place) = (all.len(), kept.folder.display());
        Some(format!(
            "{done} of {all} shards were finished and are kept in {place}; run the same command again to go on"
        ))
    });
    let failed = AtomicU64::new(0);
    let outcomes = engine::each(shards, threads, |&number| {
        let outcome = shard_of(manifest, number, &progress, &failed);
        if let Err(failure) = &outcome {
            shard::note_failure(manifest, number, &failure.to_string());
        }
        Ok(outcome.err())
    });
    progress.finish();
    match outcomes?.into_iter().flatten().next() {
        Some(failure) => Err(failure),
        None => Ok(Ran { jobs, failed: failed.into_inner() }),
    }
}

/// Runs a shard and writes its result, unless it is done: another worker may have been faster.
fn shard_of(manifest: &Manifest, number: u32, progress: &Jobs, failed: &AtomicU64) -> Result<(), Failure> {
    if shard::is_done(manifest, number) {
        progress.step(manifest.jobs_of(number), failed.load(Ordering::Relaxed), None);
        return Ok(());
    }
    let mut csv = csv::Writer::from_writer(Vec::new());
    manifest.each_job(number, |id, job| {
        let mut last = None;
        for row in job.run()? {
            last = row.told().or(last);
            failed.fetch_add(u64::from(!row.error.is_empty()), Ordering::Relaxed);
            csv.write_record(row.fields(id, &job, &manifest.head.keys)).map_err(Failure::internal)?;
        }
        progress.step(1, failed.load(Ordering::Relaxed), last.as_deref());
        Ok(ControlFlow::Continue(()))
    })?;
    shard::write(manifest, number, &csv.into_inner().map_err(Failure::internal)?)
}
