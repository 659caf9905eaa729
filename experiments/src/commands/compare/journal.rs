//! Finished worlds, kept so that a comparison that was interrupted goes on where it was.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::world::{Job, World};
use crate::failure::Failure;
use crate::output::digest;
use crate::output::single;

/// Beginning of the names of folders of finished worlds.
const PREFIX: &str = ".finished-";

/// A folder with a file per finished world, inside the output folder until that is complete. It is made
/// with the first world, so that a comparison that fails before leaves nothing.
///
/// A file is a digest of the world, a line feed, and the world as JSON.
///
/// Its name holds a digest of the configuration and of the program: worlds that were mapped with
/// other options, or by another build, are not taken for those asked for.
#[derive(Debug)]
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
    pub fn read(&self, job: &Job) -> Option<World> {
        let text = fs::read_to_string(self.file(job)).ok()?;
        serde_json::from_str(whole(&text)?).ok().filter(|world: &World| world.job == *job)
    }

    /// Keeps a finished world: whole or not at all.
    ///
    /// # Errors
    /// Whatever the system reports, a full disk for example.
    pub fn keep(&self, world: &World) -> Result<(), Failure> {
        let path = self.file(&world.job);
        let text = serde_json::to_string(world).map_err(Failure::internal)?;
        let text = format!("{:016x}\n{text}", digest::number(text.as_bytes()));
        let written =
            fs::create_dir_all(&self.folder).and_then(|()| single::whole(&path, |out| out.write_all(text.as_bytes())));
        written.map_err(|e| {
            let _ = fs::remove_dir(&self.folder); // refused by the system unless it is empty
            Failure::write(&path, &e)
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
                if fs::read_to_string(&kept).is_ok_and(|text| whole(&text).is_some()) {
                    let _ = fs::remove_file(kept);
                }
            }
            let _ = fs::remove_dir(folder.path()); // refused by the system unless it is empty
        }
    }

    fn file(&self, job: &Job) -> PathBuf {
        self.folder.join(format!("{}-{}-{}.json", job.family, job.condition, job.seed))
    }
}

/// The world in the text of a file that is as it was written.
fn whole(text: &str) -> Option<&str> {
    let (sum, world) = text.split_once('\n')?;
    (sum == format!("{:016x}", digest::number(world.as_bytes()))).then_some(world)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::compare::world::{MapScores, RegionScores};

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
        let journal = Journal::open(out.path(), "one").expect("the build");
        assert_eq!(fs::read_dir(out.path()).expect("there").count(), 0, "nothing is kept yet");
        journal.keep(&world(1)).expect("writable");
        assert_eq!(journal.read(&world(1).job), Some(world(1)));
        assert_eq!(journal.read(&world(2).job), None);
        assert_eq!(journal.read(&Job { batch: false, ..world(1).job }), None, "fewer mappers ran on it");
        assert_eq!(Journal::open(out.path(), "two").expect("the build").read(&world(1).job), None);

        let kept = fs::read_to_string(journal.file(&world(1).job)).expect("kept");
        for (wrong, why) in [
            (kept[..kept.len() / 2].to_owned(), "cut short"),
            (kept.replacen(":7", ":8", 1), "a number changed"),
            (kept[17..].to_owned(), "no digest"),
            (String::new(), "empty"),
        ] {
            assert_ne!(wrong, kept);
            fs::write(journal.file(&world(1).job), wrong).expect("writable");
            assert_eq!(journal.read(&world(1).job), None, "{why}");
        }
        fs::write(journal.file(&world(1).job), &kept).expect("writable");
        let foreign = out.path().join(format!("{PREFIX}notes"));
        fs::create_dir(&foreign).expect("writable");
        fs::write(foreign.join("mine.txt"), "keep").expect("writable");
        Journal::clear(out.path());
        assert!(!journal.folder.exists());
        assert!(foreign.join("mine.txt").exists(), "a folder whose name only begins like ours");
    }

    #[test]
    fn a_world_that_cannot_be_kept_is_an_error_and_leaves_nothing() {
        let out = tempfile::tempdir().expect("temporary folder");
        let journal = Journal::open(out.path(), "one").expect("the build");
        fs::create_dir_all(journal.file(&world(1).job)).expect("writable");
        let message = journal.keep(&world(1)).expect_err("in the way").to_string();
        assert!(message.contains("cannot be written"), "{message}");
        assert_eq!(fs::read_dir(&journal.folder).expect("there").count(), 1);
    }
}
