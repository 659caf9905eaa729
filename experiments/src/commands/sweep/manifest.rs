//! The manifest of a sweep: every job, in order, with its shard. It is written once and never changed.

mod plan;

use std::fs::File;
use std::io::{BufRead as _, BufReader, Seek as _, SeekFrom};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

pub use self::plan::{Replace, plan};

use super::job::Job;
use super::source::SourceFile;
use crate::failure::Failure;
use crate::output::digest::{Running, build, number};

/// Name of the file in the folder of a sweep.
pub const MANIFEST: &str = "manifest.jsonl";

/// The first line of the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Head {
    /// Version of the form of the file: 1.
    pub schema_version: u32,
    /// Digest of the ids of all jobs in order, and of the other values of this line: the same for every build.
    pub sweep: String,
    /// Number of jobs.
    pub jobs: u64,
    /// Number of shards.
    pub shards: u32,
    /// Parameters that are columns of the table, in order.
    pub keys: Vec<String>,
    /// Whether the metrics of worlds that move are columns of it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub of_movement: bool,
    /// The program that planned it; the same must run it.
    pub build: String,
    /// The files that the worlds come from.
    pub sites: Vec<SourceFile>,
}

/// Every other line: a job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    id: String,
    shard: u32,
    job: Job,
}

/// A manifest on the disk.
#[derive(Debug, Clone, PartialEq)]
pub struct Manifest {
    /// The folder of the sweep.
    pub folder: PathBuf,
    /// Its first line.
    pub head: Head,
    /// SHA-256 of the file, in hexadecimal: results of another manifest do not count.
    pub digest: String,
    /// Where the jobs of each shard begin, bytes.
    starts: Vec<u64>,
    /// Digest of the ids of each shard's jobs, so that a file that is replaced later is not taken for this one.
    parts: Vec<u64>,
}

/// The shard of the job at a place in the order: runs of it that differ by one job at most.
fn shard_of(at: u64, jobs: u64, shards: u32) -> u32 {
    (u128::from(at) * u128::from(shards) / u128::from(jobs)) as u32
}

impl Head {
    /// What [`sweep`](Self::sweep) must be for jobs with these ids.
    fn sweep_digest(&self, ids: impl Iterator<Item = impl AsRef<[u8]>>) -> String {
        // The form never changes: by this digest, sweeps that were planned by other builds are found again.
        let site = |SourceFile { file, digest, family }: &SourceFile| {
            format!("Site {{ file: {file:?}, digest: {digest:?}, family: {family:?} }}")
        };
        let sites = self.sites.iter().map(site).collect::<Vec<_>>().join(", ");
        let mut digest = Running::default();
        digest.add(format!("{} {} {:?} [{sites}]", self.jobs, self.shards, self.keys).as_bytes());
        ids.for_each(|id| digest.add(id.as_ref()));
        digest.hex()
    }
}

impl Manifest {
    /// Reads the first line of a folder's manifest, and its digest.
    ///
    /// # Errors
    /// No manifest, or something else in its place; I/O.
    pub fn open(folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(MANIFEST);
        let refuse = |what: &dyn std::fmt::Display| {
            Failure::BadInput(format!("{}: {what}; plan a sweep into the folder with `sweep plan`", path.display()))
        };
        let file = File::open(&path).map_err(|e| refuse(&format!("cannot be read: {e}")))?;
        let mut reader = BufReader::new(file);
        let mut digest = Running::default();
        let mut line = Vec::new();
        reader.read_until(b'\n', &mut line).map_err(|e| refuse(&e))?;
        digest.add(&line);
        let head: Head = serde_json::from_slice(&line).map_err(|e| refuse(&format!("line 1 is no manifest's: {e}")))?;
        if head.schema_version != 1 {
            return Err(refuse(&format!("schema_version = {}: must be 1", head.schema_version)));
        }
        if head.jobs == 0 || head.shards == 0 || u64::from(head.shards) > head.jobs {
            return Err(refuse(&format!("line 1 says {} jobs in {} shards, which cannot be", head.jobs, head.shards)));
        }
        let mut starts = Vec::new();
        let mut ids: Vec<[u8; 16]> = Vec::new();
        let (mut offset, mut jobs) = (line.len() as u64, 0);
        loop {
            line.clear();
            if reader.read_until(b'\n', &mut line).map_err(|e| refuse(&e))? == 0 {
                break;
            }
            if starts.len() as u64 <= u64::from(shard_of(jobs, head.jobs, head.shards)) {
                starts.push(offset);
            }
            // A line begins with `{"id":"` and the 16 digits of the id.
            ids.push(line.get(7..23).and_then(|id| id.try_into().ok()).unwrap_or_default());
            digest.add(&line);
            offset += line.len() as u64;
            jobs += 1;
        }
        if jobs != head.jobs {
            return Err(refuse(&format!("line 1 says {} jobs, and {jobs} follow", head.jobs)));
        }
        if head.sweep_digest(ids.iter()) != head.sweep {
            return Err(refuse(&"line 1 does not fit the jobs that follow"));
        }
        let mut manifest = Self { folder: folder.to_owned(), head, digest: digest.hex(), starts, parts: Vec::new() };
        let mut rest = ids.as_slice();
        for shard in 0..manifest.head.shards {
            let (own, others) = rest.split_at(manifest.jobs_of(shard) as usize);
            manifest.parts.push(number(own.as_flattened()));
            rest = others;
        }
        Ok(manifest)
    }

    /// Whether a file begins as a manifest does, whatever has become of the rest of it.
    fn begins(path: &Path) -> bool {
        let mut line = Vec::new();
        let read = File::open(path).map(|file| BufReader::new(file).read_until(b'\n', &mut line));
        read.is_ok() && serde_json::from_slice::<Head>(&line).is_ok()
    }

    /// The mappers of every job.
    ///
    /// # Errors
    /// As [`each_job`](Self::each_job).
    pub fn mappers(&self) -> Result<Vec<String>, Failure> {
        let mut mappers = Vec::new();
        self.each_job(0, |_, job| {
            mappers = job.mappers;
            Ok(ControlFlow::Break(()))
        })?;
        Ok(mappers)
    }

    /// Refuses to run what another build has planned, and worlds whose files have changed since.
    ///
    /// # Errors
    /// Such a manifest.
    pub fn confirm(&self) -> Result<(), Failure> {
        if self.head.build != build()? {
            let path = self.folder.join(MANIFEST);
            return Err(Failure::BadInput(format!(
                "{}: was planned by build {}, and this is {}; run that program, or plan again with --replace",
                path.display(),
                self.head.build,
                build()?
            )));
        }
        self.head.sites.iter().try_for_each(|site| site.source().map(drop))
    }

    /// Number of jobs of a shard.
    pub fn jobs_of(&self, shard: u32) -> u64 {
        let (jobs, shards) = (u128::from(self.head.jobs), u128::from(self.head.shards));
        let first = |shard: u128| (shard * jobs).div_ceil(shards.max(1)) as u64;
        first(u128::from(shard) + 1) - first(u128::from(shard))
    }

    /// The jobs of a shard in their order, each with its id, one at a time in memory, until `take` has enough.
    ///
    /// # Errors
    /// What `take` reports; a line that is no job; a file that holds other jobs than when it was opened, which shows
    /// after the last job; I/O.
    pub fn each_job(
        &self,
        shard: u32,
        mut take: impl FnMut(u64, Job) -> Result<ControlFlow<()>, Failure>,
    ) -> Result<(), Failure> {
        let path = self.folder.join(MANIFEST);
        let wrong = |what: &dyn std::fmt::Display| {
            Failure::BadInput(format!("{}: shard {shard}: {what}; plan the sweep again", path.display()))
        };
        let mut file = File::open(&path).map_err(|e| wrong(&e))?;
        let start = self.starts.get(shard as usize).copied().unwrap_or(u64::MAX);
        file.seek(SeekFrom::Start(start)).map_err(|e| wrong(&e))?;
        let mut ids = Vec::new();
        for line in BufReader::new(file).lines().take(self.jobs_of(shard) as usize) {
            let line: Line = serde_json::from_str(&line.map_err(|e| wrong(&e))?).map_err(|e| wrong(&e))?;
            let id = u64::from_str_radix(&line.id, 16).map_err(|e| wrong(&e))?;
            if line.shard != shard || line.job.id() != id {
                return Err(wrong(&format!("job {}: is not the one of its id and shard", line.id)));
            }
            ids.extend_from_slice(line.id.as_bytes());
            if take(id, line.job)?.is_break() {
                return Ok(());
            }
        }
        if self.parts.get(shard as usize) != Some(&number(&ids)) {
            return Err(wrong(&"the file has been cut short or replaced since this run began"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
