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
        let rows = job.run()?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::{file, manifest};

    fn planned(folder: &std::path::Path) -> Manifest {
        let scene = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/room.toml");
        let text = format!("scene = \"{}\"\nmappers = [\"prior\"]\n[vary]\ngrid = [0.5, 1.0]\n", scene.display());
        manifest::plan(&file::parse(&text, "s.toml").expect("valid"), folder, None, manifest::Replace::Never)
            .expect("planned")
    }

    #[test]
    fn a_sample_is_of_one_job_and_reckoned_for_all() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let manifest = planned(folder.path());
        let estimate = sample(&manifest, &[0, 1], 2).expect("read").expect("there are jobs");
        assert_eq!(estimate.jobs, 2);
        assert!(estimate.job > Duration::ZERO && estimate.bytes > 100);
        assert_eq!(estimate.time, estimate.job);
        assert_eq!(sample(&manifest, &[], 2).expect("nothing to read"), None);
    }

    #[test]
    fn long_runs_are_announced_and_what_the_disk_does_not_hold_is_refused() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let manifest = planned(folder.path());
        let job = Duration::from_secs(4);
        let short = Estimate { jobs: 900, job, time: 900 * job, bytes: 1 };
        assert_eq!(short.announce(&manifest).expect("room for a byte"), None);
        let long = Estimate { jobs: 2700, time: 2700 * job, ..short };
        let said = long.announce(&manifest).expect("room for a byte").expect("three hours");
        assert!(said.contains("2700 jobs of about 4.00 s (one was timed) will take about 3.0 h"), "{said}");
        let refused = Estimate { bytes: u64::MAX, ..short }.announce(&manifest).expect_err("no disk is so large");
        assert!(matches!(&refused, Failure::BadInput(text) if text.contains("make room")), "{refused}");
    }
}
