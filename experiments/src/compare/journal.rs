//! Finished worlds, kept so that a comparison that was interrupted goes on where it was.

use std::fs;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};

use super::world::{Job, World};
use crate::failure::Failure;

/// Beginning of the names of folders of finished worlds.
const PREFIX: &str = ".finished-";

/// A folder with a file per finished world, inside the output folder until that is complete.
///
/// Its name holds a digest of the configuration and of the program: worlds that were mapped with
/// other options, or by another build, are not taken for those asked for.
#[derive(Debug)]
pub struct Journal {
    folder: PathBuf,
}

impl Journal {
    /// Opens the journal of a configuration in the output folder.
    ///
    /// # Errors
    /// A folder that cannot be made.
    pub fn open(out: &Path, configuration: &str) -> Result<Self, Failure> {
        let folder = out.join(format!("{PREFIX}{:016x}", digest(configuration)));
        fs::create_dir_all(&folder).map_err(|e| Failure::write(&folder, &e))?;
        Ok(Self { folder })
    }

    /// The world of a job, if it was finished before. A file that was cut short does not count.
    pub fn read(&self, job: &Job) -> Option<World> {
        let bytes = fs::read(self.file(job)).ok()?;
        serde_json::from_slice(&bytes).ok().filter(|world: &World| world.job == *job)
    }

    /// Keeps a finished world: whole or not at all.
    ///
    /// # Errors
    /// Whatever the system reports, a full disk for example.
    pub fn keep(&self, world: &World) -> Result<(), Failure> {
        let path = self.file(&world.job);
        let partial = path.with_extension("partial");
        let bytes = serde_json::to_vec(world).map_err(Failure::internal)?;
        let written = fs::write(&partial, bytes).and_then(|()| fs::rename(&partial, &path));
        written.map_err(|e| {
            let _ = fs::remove_file(&partial);
            Failure::write(&path, &e)
        })
    }

    /// Removes the journals of the output folder, of whatever configuration: its results are complete.
    pub fn clear(out: &Path) {
        for entry in fs::read_dir(out).into_iter().flatten().flatten() {
            if entry.file_name().to_string_lossy().starts_with(PREFIX) {
                let _ = fs::remove_dir_all(entry.path());
            }
        }
    }

    fn file(&self, job: &Job) -> PathBuf {
        self.folder.join(format!("{}-{}-{}.json", job.family, job.condition, job.seed))
    }
}

/// Of the configuration and of the running program.
fn digest(configuration: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    configuration.hash(&mut hasher);
    std::env::current_exe().and_then(fs::read).unwrap_or_default().hash(&mut hasher);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::world::{MapScores, RegionScores};

    fn world(seed: u64) -> World {
        let job = Job { family: "f".to_owned(), condition: "c".to_owned(), seed, batch: true };
        let values = vec![Some(0.1 + 0.2), None, Some(f64::MIN_POSITIVE)];
        let regions = vec![RegionScores { region: "all".to_owned(), cells: 7, values }];
        let map = MapScores {
            mapper: "m".to_owned(),
            regions,
            reliability: Vec::new(),
            range: Vec::new(),
            looks: Vec::new(),
        };
        World { job, maps: vec![map] }
    }

    #[test]
    fn what_is_kept_is_read_to_the_last_bit_and_nothing_else() {
        let out = tempfile::tempdir().expect("temporary folder");
        let journal = Journal::open(out.path(), "one").expect("writable");
        journal.keep(&world(1)).expect("writable");
        assert_eq!(journal.read(&world(1).job), Some(world(1)));
        assert_eq!(journal.read(&world(2).job), None);
        assert_eq!(journal.read(&Job { batch: false, ..world(1).job }), None, "fewer mappers ran on it");
        assert_eq!(Journal::open(out.path(), "two").expect("writable").read(&world(1).job), None);

        fs::write(journal.file(&world(2).job), b"{\"job\":").expect("writable");
        assert_eq!(journal.read(&world(2).job), None, "cut short");
        Journal::clear(out.path());
        assert_eq!(fs::read_dir(out.path()).expect("there").count(), 0);
    }

    #[test]
    fn a_world_that_cannot_be_kept_is_an_error_and_leaves_nothing() {
        let out = tempfile::tempdir().expect("temporary folder");
        let journal = Journal::open(out.path(), "one").expect("writable");
        fs::create_dir(journal.file(&world(1).job)).expect("writable");
        let message = journal.keep(&world(1)).expect_err("in the way").to_string();
        assert!(message.contains("cannot be written"), "{message}");
        assert_eq!(fs::read_dir(&journal.folder).expect("there").count(), 1);
    }
}
