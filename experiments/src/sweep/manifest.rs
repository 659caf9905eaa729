//! The manifest of a sweep: every job, in order, with its shard. It is written once and never changed.

use std::fs::{self, File};
use std::io::{self, BufRead as _, BufReader, BufWriter, Seek as _, SeekFrom, Write as _};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::digest::{Running, build, number};
use super::file::Sweep;
use super::job::Job;
use super::site::Site;
use crate::failure::Failure;
use crate::staging;

/// Name of the file in the folder of a sweep.
pub const MANIFEST: &str = "manifest.jsonl";

/// A shard has about so many jobs where nobody says how many shards there are to be ...
const JOBS_PER_SHARD: u64 = 500;

/// ... and there are at least so many shards, so that many workers have something to do.
const FEWEST_SHARDS: u64 = 64;

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
    /// The program that planned it; the same must run it.
    pub build: String,
    /// The files that the worlds come from.
    pub sites: Vec<HeadSite>,
}

/// A file in the head, see [`Site`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeadSite {
    file: String,
    digest: String,
    family: bool,
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

/// When a manifest takes the place of another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Replace {
    /// Never.
    Never,
    /// If it is of the same sweep, planned by another build.
    OtherBuild,
    /// Whatever it is.
    Always,
}

/// Where a job of the product is, for sorting: 16 bytes for each of millions.
struct Place {
    id: u64,
    number: u64,
}

/// The manifest of a sweep in a folder; what is there already is kept if it is the same.
///
/// # Errors
/// A file of the sweep that cannot be read; another manifest in the folder, unless `replace`; I/O.
pub fn plan(sweep: &Sweep, folder: &Path, shards: Option<u32>, replace: Replace) -> Result<Manifest, Failure> {
    let families = sweep.of_families;
    let sites: Vec<Site> = sweep.sites.iter().map(|path| Site::load(path, families)).collect::<Result<_, _>>()?;
    let settings_count = sweep.settings_count().unwrap_or(0);
    let jobs = sweep.jobs().unwrap_or(0);
    let job = |number: u64| {
        let (settings, rest) = (number % settings_count, number / settings_count);
        let site = &sites[(rest / sweep.seeds) as usize];
        Job {
            file: site.file.clone(),
            digest: site.digest.clone(),
            family: site.family,
            seed: sweep.first_seed + rest % sweep.seeds,
            settings: sweep.settings(settings),
            mappers: sweep.mappers.clone(),
            regions: sweep.regions.clone(),
        }
    };
    let mut places: Vec<Place> = (0..jobs).map(|number| Place { id: job(number).id(), number }).collect();
    places.sort_unstable_by_key(|place| place.id);
    if let Some(pair) = places.windows(2).find(|pair| pair[0].id == pair[1].id) {
        let same = job(pair[0].number).json() == job(pair[1].number).json();
        let why =
            if same { "two jobs are the same" } else { "two jobs have one id by chance; change any value a little" };
        return Err(Failure::BadInput(format!("the sweep: {why}: {}", job(pair[0].number).json())));
    }
    let usual = jobs.div_ceil(JOBS_PER_SHARD).max(FEWEST_SHARDS);
    let shards = shards.map_or(usual, u64::from).clamp(1, jobs.max(1)) as u32;
    let mut head = Head {
        schema_version: 1,
        sweep: String::new(),
        jobs,
        shards,
        keys: sweep.keys().into_iter().map(str::to_owned).collect(),
        build: build(),
        sites: sites.iter().map(HeadSite::of).collect(),
    };

    head.sweep = head.sweep_digest(places.iter().map(|place| format!("{:016x}", place.id)));

    fs::create_dir_all(folder).map_err(|e| Failure::write(folder, &e))?;
    let path = folder.join(MANIFEST);
    let partial = staging::Temporary::beside(&path);
    let write = || -> io::Result<String> {
        let mut digest = Running::default();
        let mut out = BufWriter::new(File::create(partial.path())?);
        let mut put = |line: String| {
            digest.add(line.as_bytes());
            out.write_all(line.as_bytes())
        };
        put(serde_json::to_string(&head)? + "\n")?;
        for (at, place) in places.iter().enumerate() {
            let shard = shard_of(at as u64, jobs, shards);
            let line = Line { id: format!("{:016x}", place.id), shard, job: job(place.number) };
            put(serde_json::to_string(&line)? + "\n")?;
        }
        out.flush()?;
        out.get_ref().sync_all()?;
        Ok(digest.hex())
    };
    let digest = write().map_err(|e| Failure::write(&path, &e))?;
    let stays = path.exists()
        && match (Manifest::open(folder), replace) {
            (_, Replace::Always) => false,
            (Ok(former), Replace::OtherBuild) => former.head.sweep != head.sweep,
            (Ok(former), Replace::Never) => former.digest != digest,
            (Err(_), _) => true,
        };
    if stays {
        return Err(Failure::BadInput(format!(
            "{}: is the manifest of another sweep, or was planned by another build; choose another folder with --out, or give --replace",
            path.display()
        )));
    }
    partial.publish(&path).map_err(|e| Failure::write(&path, &e))?;
    Manifest::open(folder)
}

/// The shard of the job at a place in the order: runs of it that differ by one job at most.
fn shard_of(at: u64, jobs: u64, shards: u32) -> u32 {
    (u128::from(at) * u128::from(shards) / u128::from(jobs)) as u32
}

impl Head {
    /// What [`sweep`](Self::sweep) must be for jobs with these ids.
    fn sweep_digest(&self, ids: impl Iterator<Item = impl AsRef<[u8]>>) -> String {
        let mut digest = Running::default();
        digest.add(format!("{} {} {:?} {:?}", self.jobs, self.shards, self.keys, self.sites).as_bytes());
        ids.for_each(|id| digest.add(id.as_ref()));
        digest.hex()
    }
}

impl HeadSite {
    fn of(site: &Site) -> Self {
        Self { file: site.file.clone(), digest: site.digest.clone(), family: site.family }
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

    /// Refuses to run what another build has planned, and worlds whose files have changed since.
    ///
    /// # Errors
    /// Such a manifest.
    pub fn confirm(&self) -> Result<(), Failure> {
        if self.head.build != build() {
            let path = self.folder.join(MANIFEST);
            return Err(Failure::BadInput(format!(
                "{}: was planned by build {}, and this is {}; run that program, or plan again with --replace",
                path.display(),
                self.head.build,
                build()
            )));
        }
        let site = |site: &HeadSite| Site { file: site.file.clone(), digest: site.digest.clone(), family: site.family };
        self.head.sites.iter().try_for_each(|each| site(each).confirm())
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
mod tests {
    use super::super::file::parse;
    use super::*;

    /// A manifest of so many jobs, which no test runs.
    fn planned(folder: &Path, first_seed: u64, jobs: u64, shards: u32) -> Manifest {
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/room.toml");
        let text = format!(
            "scene = {:?}\nmappers = [\"prior\"]\nseeds = {{ first = {first_seed}, count = {jobs} }}",
            scene.display().to_string()
        );
        plan(&parse(&text, "s.toml").expect("valid"), folder, Some(shards), Replace::Always).expect("planned")
    }

    fn ids(manifest: &Manifest, shard: u32) -> Result<Vec<u64>, Failure> {
        let mut ids = Vec::new();
        manifest.each_job(shard, |id, _| {
            ids.push(id);
            Ok(ControlFlow::Continue(()))
        })?;
        Ok(ids)
    }

    #[test]
    fn shards_are_runs_of_all_jobs_whatever_their_numbers() {
        for jobs in (1..=70).chain([997, 1000, 4096]) {
            for shards in (1..=jobs.min(70) as u32).chain([jobs as u32]) {
                let mut counts = vec![0u64; shards as usize];
                let of: Vec<u32> = (0..jobs).map(|at| shard_of(at, jobs, shards)).collect();
                assert!(of.is_sorted());
                of.iter().for_each(|shard| counts[*shard as usize] += 1);
                let manifest = Manifest {
                    folder: PathBuf::new(),
                    head: Head {
                        schema_version: 1,
                        sweep: String::new(),
                        jobs,
                        shards,
                        keys: Vec::new(),
                        build: String::new(),
                        sites: Vec::new(),
                    },
                    digest: String::new(),
                    starts: Vec::new(),
                    parts: Vec::new(),
                };
                let said: Vec<u64> = (0..shards).map(|shard| manifest.jobs_of(shard)).collect();
                assert_eq!(said, counts, "{jobs} jobs, {shards} shards");
                assert!(counts.iter().max() <= counts.iter().min().map(|least| least + 1).as_ref());
            }
        }
    }

    #[test]
    fn the_jobs_of_all_shards_are_all_jobs_in_order() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let all = ids(&planned(folder.path(), 1, 97, 1), 0).expect("read");
        assert!(all.len() == 97 && all.is_sorted());
        for shards in [2, 7, 64, 96, 97, 1000] {
            let manifest = planned(folder.path(), 1, 97, shards);
            let joined: Vec<u64> =
                (0..manifest.head.shards).flat_map(|shard| ids(&manifest, shard).expect("read")).collect();
            assert_eq!(joined, all, "{shards}");
        }
    }

    #[test]
    fn a_file_that_is_replaced_or_cut_short_later_is_not_taken_for_the_one_that_was_opened() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let first = planned(folder.path(), 1000, 40, 4);
        let cut = fs::read(folder.path().join(MANIFEST)).expect("there");
        planned(folder.path(), 2000, 40, 4); // as long, line by line
        for shard in 0..4 {
            let failure = ids(&first, shard).expect_err("other jobs").to_string();
            assert!(failure.contains("cut short or replaced"), "{failure}");
        }
        let end = cut[..cut.len() - 1].iter().rposition(|byte| *byte == b'\n').expect("lines") + 1;
        fs::write(folder.path().join(MANIFEST), &cut[..end]).expect("writable");
        assert_eq!(ids(&first, 0).expect("whole").len(), 10);
        assert!(ids(&first, 3).expect_err("a job less").to_string().contains("cut short or replaced"));
    }
}
