//! Finished worlds, kept so that a comparison that was interrupted goes on where it was.

use std::fs;
use std::path::{Path, PathBuf};

use super::world::{WorldJob, WorldScores};
use crate::failure::Failure;
use crate::jobs::seal::{self, State};
use crate::output::digest;

/// Beginning of the names of folders of finished worlds.
const PREFIX: &str = ".finished-";

/// A folder with a sealed file per finished world, inside the output folder until that is complete. It is made
/// with the first world, so that a comparison that fails before leaves nothing.
///
/// Its name holds a digest of the configuration and of the program: worlds that were mapped with
/// other options, or by another build, are not taken for those asked for.
#[derive(Debug, Clone)]
pub struct Journal {
    folder: PathBuf,
}

impl Journal {
    /// The journal of a configuration in the output folder.
    ///
    /// # Errors
    /// As [`digest::build`].
    pub fn open(out: &Path, configuration: &str) -> Result<Self, Failure> {
        let digest = digest::number(format!("{configuration}\n{}", digest::build()?).as_bytes());
        Ok(Self { folder: out.join(format!("{PREFIX}{digest:016x}")) })
    }

    /// The world of a job, if it was finished before. A file that was cut short or changed does not count.
    pub fn read(&self, job: &WorldJob) -> Option<WorldScores> {
        let mut line = Vec::new();
        match seal::copy(&self.file(job), job, &mut line) {
            Ok(State::Done { .. }) => serde_json::from_slice(&line).ok(),
            _ => None,
        }
    }

    /// How many of these worlds are kept, by their files: whoever interrupts may have seen one that its job has not yet
    /// counted.
    pub fn kept(&self, jobs: &[WorldJob]) -> usize {
        jobs.iter().filter(|job| self.read(job).is_some()).count()
    }

    /// Keeps a finished world: whole or not at all.
    ///
    /// # Errors
    /// Whatever the system reports, a full disk for example.
    pub fn keep(&self, world: &WorldScores) -> Result<(), Failure> {
        let line = serde_json::to_string(world).map_err(Failure::internal)? + "\n";
        seal::write(&self.file(&world.job), &world.job, line.as_bytes()).inspect_err(|_| {
            let _ = fs::remove_dir(&self.folder); // refused by the system unless it is empty
        })
    }

    /// Removes the journals of the output folder, of whatever configuration: its results are complete. What is no
    /// journal of ours stays.
    pub fn clear(out: &Path) {
        let journal = |name: &str| {
            let digest = name.strip_prefix(PREFIX)?;
            (digest.len() == 16 && u64::from_str_radix(digest, 16).is_ok()).then_some(())
        };
        let folders = fs::read_dir(out).into_iter().flatten().flatten();
        for folder in folders.filter(|entry| journal(&entry.file_name().to_string_lossy()).is_some()) {
            for kept in fs::read_dir(folder.path()).into_iter().flatten().flatten().map(|entry| entry.path()) {
                if seal::is_whole(&kept) {
                    let _ = fs::remove_file(kept);
                }
            }
            let _ = fs::remove_dir(folder.path()); // refused by the system unless it is empty
        }
    }

    fn file(&self, job: &WorldJob) -> PathBuf {
        self.folder.join(format!("{}-{}-{}.json", job.world.family, job.world.condition, job.world.seed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::compare::world::{MapScores, RegionScores};
    use crate::worlds::site::WorldId;

    fn world(seed: u64) -> WorldScores {
        let id = WorldId { family: "f".to_owned(), condition: "c".to_owned(), cell_um: None, seed };
        let job = WorldJob { world: id, batch: true };
        let values = vec![Some(0.1 + 0.2), None, Some(f64::MIN_POSITIVE)];
        let regions = vec![RegionScores { region: "all".to_owned(), cells: 7, values }];
        let map = MapScores {
            mapper: "m".to_owned(),
            regions,
            reliability: Vec::new(),
            range: Vec::new(),
            looks: Vec::new(),
            mixing: None,
            fault: None,
        };
        WorldScores { job, maps: vec![map], at_rest: Vec::new() }
    }

    #[test]
    fn what_is_kept_is_read_to_the_last_bit_and_nothing_else() {
        let out = tempfile::tempdir().expect("temporary folder");
        let journal = Journal::open(out.path(), "one").expect("the build");
        assert_eq!(fs::read_dir(out.path()).expect("there").count(), 0, "nothing is kept yet");
        journal.keep(&world(1)).expect("writable");
        assert_eq!(journal.read(&world(1).job), Some(world(1)));
        assert_eq!(journal.read(&world(2).job), None);
        assert_eq!(journal.kept(&[world(1).job, world(2).job]), 1);
        assert_eq!(journal.read(&WorldJob { batch: false, ..world(1).job }), None, "fewer mappers ran on it");
        assert_eq!(Journal::open(out.path(), "two").expect("the build").read(&world(1).job), None);

        let kept = fs::read_to_string(journal.file(&world(1).job)).expect("kept");
        fs::write(journal.file(&world(1).job), kept.replacen(":7", ":8", 1)).expect("writable");
        assert_eq!(journal.read(&world(1).job), None, "a number changed");
        fs::write(journal.file(&world(1).job), &kept).expect("writable");
        let foreign = out.path().join(format!("{PREFIX}notes"));
        fs::create_dir(&foreign).expect("writable");
        fs::write(foreign.join("mine.txt"), "keep").expect("writable");
        Journal::clear(out.path());
        assert!(!journal.folder.exists());
        assert!(foreign.join("mine.txt").exists(), "a folder whose name only begins like ours");
    }
}
