//! What a run will take, from a timed sample, before it starts.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use super::job::Job;
use super::manifest::Manifest;
use super::parameters::number_of;
use super::row::SweepRow;
use crate::failure::Failure;

/// A run that takes longer than this is announced.
const LONG: Duration = Duration::from_secs(3600);

/// Jobs are sorted into kinds by those of the given shards that come first, up to so many. The order of jobs is that
/// of their digests, so that these are like the others.
const LOOKED_AT: u64 = 20_000;

/// At most so many kinds of jobs are timed.
const TIMED: usize = 24;

/// What a run will take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Number of jobs.
    pub jobs: u64,
    /// How long one takes in the mean.
    pub job: Duration,
    /// How many were timed.
    pub timed: usize,
    /// How long all will take.
    pub time: Duration,
    /// How many bytes they will write.
    pub bytes: u64,
}

/// Jobs that take about as long: in the same place, with cells of the same size and as many scans.
struct Alike {
    id: u64,
    first: Job,
    count: u64,
}

/// Runs one job of the smallest cells, and reckons from it what all jobs of the given shards will take. Where that is
/// long, one job of each size of cells and number of scans in each place is run, as far as there are not too many.
///
/// # Errors
/// A manifest that cannot be read; a place whose file cannot be read.
pub fn sample(manifest: &Manifest, shards: &[u32], threads: usize) -> Result<Option<Estimate>, Failure> {
    let mut kinds = kinds(manifest, shards)?;
    let jobs: u64 = shards.iter().map(|shard| manifest.jobs_of(*shard)).sum();
    let (mut timed, mut time, mut bytes, mut counted) = (0, Duration::ZERO, 0, 0);
    kinds.truncate(TIMED);
    for kind in &kinds {
        let (once, written) = run(manifest, kind)?;
        timed += 1;
        time += once.mul_f64(kind.count as f64);
        bytes += written * kind.count;
        counted += kind.count;
        // The first kind takes longest: if all were like it and that is short, the others need not be known.
        if timed == 1 && in_all(once, jobs, threads) <= LONG {
            break;
        }
    }
    if counted == 0 {
        return Ok(None);
    }
    let job = time.div_f64(counted as f64);
    // The shards, and the table made of them.
    let bytes = 2 * (bytes as f64 / counted as f64 * jobs as f64) as u64;
    Ok(Some(Estimate { jobs, job, timed, time: in_all(job, jobs, threads), bytes }))
}

fn in_all(job: Duration, jobs: u64, threads: usize) -> Duration {
    job.mul_f64(jobs as f64 / threads.max(1) as f64)
}

/// How long a job takes, and how many bytes its rows are.
fn run(manifest: &Manifest, kind: &Alike) -> Result<(Duration, u64), Failure> {
    let start = Instant::now();
    let rows = kind.first.run()?;
    let length = |fields: Vec<String>| fields.iter().map(|field| field.len() + 1).sum::<usize>() as u64;
    let fields = |row: &SweepRow| row.fields(kind.id, &kind.first, &manifest.head.keys);
    Ok((start.elapsed(), rows.iter().map(|row| length(fields(row))).sum()))
}

/// The kinds of jobs, those with the smallest cells and the most scans first.
fn kinds(manifest: &Manifest, shards: &[u32]) -> Result<Vec<Alike>, Failure> {
    let mut kinds: Vec<Alike> = Vec::new();
    let mut numbers: HashMap<_, usize> = HashMap::new();
    let mut looked_at = 0;
    for shard in shards {
        if looked_at >= LOOKED_AT {
            break;
        }
        manifest.each_job(*shard, |id, job| {
            looked_at += 1;
            match numbers.entry((job.file.clone(), size(&job).map(f64::to_bits))) {
                Entry::Occupied(number) => kinds[*number.get()].count += 1,
                Entry::Vacant(place) => {
                    place.insert(kinds.len());
                    kinds.push(Alike { id, first: job, count: 1 });
                }
            }
            Ok(if looked_at < LOOKED_AT { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
        })?;
    }
    kinds.sort_by(|a, b| {
        let ([cell, scans], [other_cell, other_scans]) = (size(&a.first), size(&b.first));
        cell.total_cmp(&other_cell).then(other_scans.total_cmp(&scans)).then(a.first.file.cmp(&b.first.file))
    });
    Ok(kinds)
}

/// Side of a cell, m, and number of scans; infinity stands for as many as the drive has, or as large as in the file.
fn size(job: &Job) -> [f64; 2] {
    ["grid", "scans"].map(|key| number_of(&job.settings, key).unwrap_or(f64::INFINITY))
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
                megabytes(self.bytes),
                megabytes(free)
            )));
        }
        Ok((self.time > LONG).then(|| {
            format!(
                "{} jobs of about {:.2} s ({} timed) will take about {:.1} h and write {}; Ctrl-C loses nothing that is finished",
                self.jobs,
                self.job.as_secs_f64(),
                if self.timed == 1 { "one was".to_owned() } else { format!("{} were", self.timed) },
                self.time.as_secs_f64() / 3600.0,
                megabytes(self.bytes)
            )
        }))
    }
}

fn megabytes(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::sweep::{file, manifest};

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
        assert_eq!((estimate.jobs, estimate.timed), (2, 1));
        assert!(estimate.job > Duration::ZERO && estimate.bytes > 100);
        assert_eq!(estimate.time, estimate.job);
        assert_eq!(sample(&manifest, &[], 2).expect("nothing to read"), None);
    }

    #[test]
    fn kinds_are_by_place_and_size_the_slowest_first() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let manifest = planned(folder.path());
        let kinds = kinds(&manifest, &[0, 1]).expect("read");
        let sizes: Vec<(f64, u64)> = kinds.iter().map(|kind| (size(&kind.first)[0], kind.count)).collect();
        assert_eq!(sizes, [(0.5, 1), (1.0, 1)]);
    }

    #[test]
    fn long_runs_are_announced_and_what_the_disk_does_not_hold_is_refused() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let manifest = planned(folder.path());
        let job = Duration::from_secs(4);
        let short = Estimate { jobs: 900, job, timed: 1, time: 900 * job, bytes: 1 };
        assert_eq!(short.announce(&manifest).expect("room for a byte"), None);
        let long = Estimate { jobs: 2700, time: 2700 * job, ..short };
        let said = long.announce(&manifest).expect("room for a byte").expect("three hours");
        assert!(said.contains("2700 jobs of about 4.00 s (one was timed) will take about 3.0 h"), "{said}");
        let refused = Estimate { bytes: u64::MAX, ..short }.announce(&manifest).expect_err("no disk is so large");
        assert!(matches!(&refused, Failure::BadInput(text) if text.contains("make room")), "{refused}");
    }
}
