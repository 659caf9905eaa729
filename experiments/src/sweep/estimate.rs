//! What a run will take, from a timed sample, before it starts.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use super::manifest::Manifest;
use crate::failure::Failure;

/// A run that takes longer than this is announced.
const LONG: Duration = Duration::from_secs(3600);

/// What a run will take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Number of jobs.
    pub jobs: u64,
    /// How long one took.
    pub job: Duration,
    /// How long all will take.
    pub time: Duration,
    /// How many bytes they will write.
    pub bytes: u64,
}

/// Runs one job of the first of the given shards, and reckons from it what all of them will take.
///
/// # Errors
/// A manifest that cannot be read.
pub fn sample(manifest: &Manifest, shards: &[u32], threads: usize) -> Result<Option<Estimate>, Failure> {
    let Some(&first) = shards.first() else { return Ok(None) };
    let mut sampled = None;
    manifest.each_job(first, |id, job| {
        let start = Instant::now();
        let rows = job.run();
        let length = |fields: Vec<String>| fields.iter().map(|field| field.len() + 1).sum::<usize>() as u64;
        let bytes: u64 = rows.iter().map(|row| length(row.fields(id, &job, &manifest.head.keys))).sum();
        sampled = Some((start.elapsed(), bytes));
        Ok(ControlFlow::Break(()))
    })?;
    let Some((job, bytes)) = sampled else { return Ok(None) };
    let jobs: u64 = shards.iter().map(|shard| manifest.jobs_of(*shard)).sum();
    let time = job.mul_f64(jobs as f64 / threads.max(1) as f64);
    // The shards, and the table made of them.
    Ok(Some(Estimate { jobs, job, time, bytes: 2 * bytes * jobs }))
}

impl Estimate {
    /// What to say before the run starts, if anything.
    ///
    /// # Errors
    /// More than the disk has room for.
    pub fn announce(&self, manifest: &Manifest) -> Result<Option<String>, Failure> {
        let free = fs4::available_space(&manifest.folder).unwrap_or(u64::MAX);
        if self.bytes > free {
            return Err(Failure::BadInput(format!(
                "{}: {} jobs will write about {}, and the disk has {} left; make room, or plan into a folder on another disk",
                manifest.folder.display(),
                self.jobs,
                size(self.bytes),
                size(free)
            )));
        }
        Ok((self.time > LONG).then(|| {
            format!(
                "{} jobs of about {:.2} s (one was timed) will take about {:.1} h and write {}; Ctrl-C loses nothing that is finished",
                self.jobs,
                self.job.as_secs_f64(),
                self.time.as_secs_f64() / 3600.0,
                size(self.bytes)
            )
        }))
    }
}

fn size(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}
