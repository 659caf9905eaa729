//! The local engine: every thread takes a shard that is not done.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::manifest::Manifest;
use super::shard;
use crate::failure::Failure;
use crate::interruption;

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
    let progress = progress(jobs);
    let done = Arc::new(AtomicUsize::new(0));
    let (so_far, all, place) = (Arc::clone(&done), shards.len(), manifest.folder.display().to_string());
    interruption::keeps(move || {
        let done = so_far.load(Ordering::SeqCst);
        Some(format!(
            "{done} of {all} shards were finished and are kept in {place}; run the same command again to go on"
        ))
    });
    let (next, failed, first) = (AtomicUsize::new(0), AtomicU64::new(0), Mutex::new(None::<Failure>));
    let worker = || {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(Failure::internal)?;
        pool.install(|| {
            while let Some(&number) = shards.get(next.fetch_add(1, Ordering::Relaxed)) {
                if let Err(failure) = shard_of(manifest, number, &progress, &failed) {
                    shard::note_failure(manifest, number, &failure.to_string());
                    if let Ok(mut first) = first.lock() {
                        first.get_or_insert(failure);
                    }
                    continue;
                }
                done.fetch_add(1, Ordering::SeqCst);
            }
        });
        Ok::<(), Failure>(())
    };
    let ended = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.clamp(1, shards.len().max(1))).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().try_for_each(|worker| {
            worker.join().unwrap_or_else(|_| Err(Failure::Internal("a worker thread has died".to_owned())))
        })
    });
    progress.finish_and_clear();
    ended?;
    match first.into_inner() {
        Ok(Some(failure)) => Err(failure),
        _ => Ok(Ran { jobs, failed: failed.into_inner() }),
    }
}

/// Runs a shard and writes its result, unless it is done: another worker may have been faster.
fn shard_of(manifest: &Manifest, number: u32, progress: &ProgressBar, failed: &AtomicU64) -> Result<(), Failure> {
    if matches!(shard::state(manifest, number), shard::State::Done { .. }) {
        progress.inc(manifest.jobs_of(number));
        return Ok(());
    }
    let mut csv = csv::Writer::from_writer(Vec::new());
    manifest.each_job(number, |id, job| {
        for row in job.run()? {
            failed.fetch_add(u64::from(!row.error.is_empty()), Ordering::Relaxed);
            csv.write_record(row.fields(id, &job, &manifest.head.keys)).map_err(Failure::internal)?;
        }
        progress.inc(1);
        progress.set_message(match failed.load(Ordering::Relaxed) {
            0 => String::new(),
            failed => format!(", {failed} failed"),
        });
        Ok(ControlFlow::Continue(()))
    })?;
    shard::write(manifest, number, &csv.into_inner().map_err(Failure::internal)?)
}

/// Silent where stderr is not a terminal.
fn progress(jobs: u64) -> ProgressBar {
    let bar = ProgressBar::new(jobs);
    let style = ProgressStyle::with_template("{bar:28} {pos}/{len} jobs, {per_sec:.1}, {eta} left{msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}
