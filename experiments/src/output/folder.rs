//! Output folders that are replaced whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use serde::Serialize;

use crate::failure::Failure;

/// Folders to remove when the program is interrupted.
static OPEN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Name of the file that lists what a run wrote; it is put in place last.
pub const RECORD: &str = "run.json";

/// A folder of results in the making.
///
/// Files are written to a hidden folder inside the output folder and moved to their names by
/// [`publish`](Self::publish). A run that fails or is killed leaves the former results as they were.
#[derive(Debug)]
pub struct Staging {
    folder: PathBuf,
    partial: PathBuf,
    files: Vec<String>,
    /// The run made the folder, and takes it away again if nothing comes of it.
    new: bool,
    /// Held while the run lasts, so that two runs do not mix their files.
    _lock: Option<File>,
}

impl Staging {
    /// Makes the output folder if need be, and proves before any work that it can be written.
    ///
    /// # Errors
    /// A folder that cannot be written, or that another run is writing.
    pub fn open(folder: &Path) -> Result<Self, Failure> {
        let refuse = |what: &str, error: &dyn std::fmt::Display| {
            Failure::BadInput(format!(
                "{}: {what}: {error}; choose another folder with --out, or make this one writable",
                folder.display()
            ))
        };
        let new = !folder.exists();
        fs::create_dir_all(folder).map_err(|e| refuse("the output folder cannot be made", &e))?;
        let lock = lock(folder).map_err(|()| refuse("the output folder is in use", &"another run is writing to it"))?;
        remove_leftovers(folder);
        let partial = folder.join(format!(".partial-{}", std::process::id()));
        let staging = Self { folder: folder.to_owned(), partial, files: Vec::new(), new, _lock: lock };
        fs::create_dir(&staging.partial)
            .and_then(|()| fs::write(staging.partial.join("probe"), b"x"))
            .and_then(|()| fs::remove_file(staging.partial.join("probe")))
            .map_err(|e| refuse("the output folder cannot be written", &e))?;
        if let Ok(mut open) = OPEN.lock() {
            open.push(staging.partial.clone());
        }
        Ok(staging)
    }

    /// Writes a file through `fill`, which is handed a buffered writer.
    ///
    /// # Errors
    /// Whatever the system reports, a full disk for example.
    pub fn write<E: Into<io::Error>>(
        &mut self,
        name: &str,
        fill: impl FnOnce(&mut BufWriter<File>) -> Result<(), E>,
    ) -> Result<(), Failure> {
        let path = self.path(name);
        let written = File::create(&path).and_then(|file| {
            let mut out = BufWriter::new(file);
            fill(&mut out).map_err(Into::into)?;
            out.flush()
        });
        written.map_err(|e| Failure::write(&self.folder.join(name), &e))
    }

    /// Writes the record of the run.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn record(&mut self, record: &impl Serialize) -> Result<(), Failure> {
        self.write(RECORD, |out| -> io::Result<()> {
            serde_json::to_writer_pretty(&mut *out, record)?;
            writeln!(out)
        })
    }

    /// Where to write the file of the given name; it is published with the others.
    pub fn path(&mut self, name: &str) -> PathBuf {
        if !self.files.iter().any(|f| f == name) {
            self.files.push(name.to_owned());
        }
        self.partial.join(name)
    }

    /// Names of the files so far and of those to come, sorted.
    pub fn files_and(&self, to_come: &[&str]) -> Vec<String> {
        let mut files = self.files.clone();
        files.extend(to_come.iter().map(|name| (*name).to_owned()));
        files.sort();
        files
    }

    /// Moves all files to their names, the record last, and removes files that only the former run wrote.
    ///
    /// The former record goes first: whatever happens, no record stands beside files of another run.
    ///
    /// # Errors
    /// A folder where a file is to go, before anything is touched; whatever the system reports.
    pub fn publish(self) -> Result<(), Failure> {
        let stale = former_files(&self.folder);
        let mut files = self.files_and(&[]);
        files.sort_by_key(|name| name == RECORD);
        if let Some(name) = files.iter().find(|name| self.folder.join(name).is_dir()) {
            let path = self.folder.join(name);
            return Err(Failure::BadInput(format!("{}: is a folder where a file is to go; remove it", path.display())));
        }
        let _ = fs::remove_file(self.folder.join(RECORD));
        for name in &files {
            let target = self.folder.join(name);
            fs::rename(self.partial.join(name), &target).map_err(|e| Failure::write(&target, &e))?;
        }
        for name in stale.iter().filter(|name| !files.contains(name)) {
            let _ = fs::remove_file(self.folder.join(name));
        }
        Ok(())
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.partial);
        if self.new {
            let _ = fs::remove_dir(&self.folder); // refused by the system unless it is empty
        }
        if let Ok(mut open) = OPEN.lock() {
            open.retain(|path| path != &self.partial);
        }
    }
}

/// Writes a single file through `fill`, whole or not at all.
///
/// # Errors
/// Whatever the system reports; what had the name before has it still.
pub fn whole(path: &Path, fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let partial = Temporary::beside(path);
    let mut out = BufWriter::new(File::create(partial.path())?);
    fill(&mut out)?;
    out.flush()?;
    out.get_ref().sync_all()?;
    partial.publish(path)
}

/// Writes a single file that the user named, whole or not at all.
///
/// # Errors
/// A place that cannot be written.
pub fn replace(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    whole(path, |out| out.write_all(bytes)).map_err(|e| {
        Failure::BadInput(format!("{}: cannot be written: {e}; choose another file with --out", path.display()))
    })
}

/// Removes all that is in the making: the program is about to end.
pub fn abandon_all() {
    for path in OPEN.lock().iter().flat_map(|open| open.iter()) {
        let _ = fs::remove_dir_all(path);
        let _ = fs::remove_file(path);
        let _ = path.parent().map(fs::remove_dir); // the output folder, if it is empty
    }
}

/// A file in the making, under a name that no other process on any machine takes: `.NAME.HOST.PID.NUMBER`.
/// It goes when nothing comes of it.
#[derive(Debug)]
pub struct Temporary {
    path: PathBuf,
}

impl Temporary {
    /// A name beside the file that it is to become.
    pub fn beside(target: &Path) -> Self {
        let name = target.file_name().unwrap_or_default().to_string_lossy();
        let path = target.with_file_name(format!(".{name}.{}", unique()));
        if let Ok(mut open) = OPEN.lock() {
            open.push(path.clone());
        }
        Self { path }
    }

    /// Where to write.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Gives the file, which must be synced, its name for good, over whatever has it.
    ///
    /// # Errors
    /// Whatever the system reports.
    pub fn publish(self, target: &Path) -> io::Result<()> {
        fs::rename(&self.path, target)?;
        // The name itself is safe once the folder is; some systems cannot sync folders.
        if let Some(folder) = target.parent().and_then(|folder| File::open(folder).ok()) {
            let _ = folder.sync_all();
        }
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
        if let Ok(mut open) = OPEN.lock() {
            open.retain(|path| path != &self.path);
        }
    }
}

/// Host, process and a number that is not used twice.
pub fn unique() -> String {
    use std::hash::{BuildHasher as _, RandomState};
    let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let host: String = host.chars().filter(char::is_ascii_alphanumeric).take(32).collect();
    format!("{host}.{}.{:016x}", std::process::id(), RandomState::new().hash_one(0))
}

/// An exclusive lock on the folder itself; none where the system has no such locks.
fn lock(folder: &Path) -> Result<Option<File>, ()> {
    let Ok(handle) = File::open(folder) else { return Ok(None) };
    match handle.try_lock() {
        Ok(()) => Ok(Some(handle)),
        Err(fs::TryLockError::WouldBlock) => Err(()),
        Err(fs::TryLockError::Error(_)) => Ok(None),
    }
}

/// What a killed run left behind. Safe under the lock.
fn remove_leftovers(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_name().to_string_lossy().starts_with(".partial-") {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

/// Files that the former run says it wrote: plain names only.
fn former_files(folder: &Path) -> Vec<String> {
    let record = fs::read(folder.join(RECORD)).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok());
    let record: serde_json::Value = record.unwrap_or_default();
    let names = record["files"].as_array().into_iter().flatten().filter_map(|name| name.as_str());
    names.filter(|name| !name.contains(['/', '\\']) && !name.starts_with('.')).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put(staging: &mut Staging, name: &str, text: &str) {
        staging.write(name, |out| out.write_all(text.as_bytes())).expect("writable");
    }

    #[test]
    fn published_files_replace_those_of_the_former_run_and_no_others() {
        let folder = tempfile::tempdir().expect("temporary folder");
        fs::write(folder.path().join("mine.txt"), "keep").expect("writable");
        for (name, record) in [("old.csv", r#"{"files":["old.csv","run.json","../x"]}"#), ("new.csv", "{}")] {
            let mut staging = Staging::open(folder.path()).expect("writable");
            put(&mut staging, name, "1");
            put(&mut staging, RECORD, record);
            staging.publish().expect("writable");
        }
        let mut left: Vec<_> =
            fs::read_dir(folder.path()).expect("there").map(|e| e.expect("entry").file_name()).collect();
        left.sort();
        assert_eq!(left, ["mine.txt", "new.csv", "run.json"]);
    }

    #[test]
    fn a_run_that_ends_early_leaves_nothing() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let mut staging = Staging::open(folder.path()).expect("writable");
        put(&mut staging, "a.csv", "1");
        drop(staging);
        assert_eq!(fs::read_dir(folder.path()).expect("there").count(), 0);
    }

    #[test]
    fn a_folder_in_the_place_of_a_file_stops_everything_or_nothing() {
        let folder = tempfile::tempdir().expect("temporary folder");
        fs::write(folder.path().join("a.csv"), "former").expect("writable");
        fs::create_dir(folder.path().join("b.csv")).expect("writable");
        let mut staging = Staging::open(folder.path()).expect("writable");
        put(&mut staging, "a.csv", "new");
        put(&mut staging, "b.csv", "new");
        assert!(staging.publish().expect_err("in the way").to_string().contains("b.csv: is a folder"));
        assert_eq!(fs::read_to_string(folder.path().join("a.csv")).expect("there"), "former");
    }

    #[test]
    fn a_new_folder_goes_when_nothing_comes_of_it() {
        let folder = tempfile::tempdir().expect("temporary folder");
        drop(Staging::open(&folder.path().join("new")).expect("writable"));
        assert!(!folder.path().join("new").exists());
    }

    #[test]
    fn two_runs_do_not_share_a_folder_and_leftovers_of_killed_ones_go() {
        let folder = tempfile::tempdir().expect("temporary folder");
        fs::create_dir(folder.path().join(".partial-1")).expect("writable");
        let first = Staging::open(folder.path()).expect("writable");
        assert!(!folder.path().join(".partial-1").exists());
        let second = Staging::open(folder.path()).expect_err("in use");
        assert!(second.to_string().contains("another run"), "{second}");
        drop(first);
        Staging::open(folder.path()).expect("free again");
    }

    #[test]
    fn a_file_in_the_way_is_refused_before_any_work() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("out");
        fs::write(&path, "a file").expect("writable");
        assert!(matches!(Staging::open(&path), Err(Failure::BadInput(_))));
    }
}
