//! Putting files in place so that a kill at any moment loses nothing.
//!
//! The new files wait in a hidden folder. A journal beside them names the former and the new set with digests. Then
//! the former files move into the hidden folder, the new ones move to their names, and the journal goes. Whoever
//! finds a journal can finish what it says, or undo it: at every moment each file of both sets is at its name or in
//! the hidden folder, and nothing that neither set names is ever removed or replaced.

use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::ledger::{FileEntry, is_plain};

/// Name of the journal.
const JOURNAL: &str = "publication.json";

/// Where the new files wait.
const NEW: &str = "new";

/// Where the former files wait until the new ones are in place.
const FORMER: &str = "former";

/// What proves that a hidden folder is ours.
const OWNER: &str = "owner";

/// Beginning of the names of hidden folders.
pub const PREFIX: &str = ".partial-";

/// A hidden folder beside the files that are to come of it.
#[derive(Debug)]
pub struct Hidden {
    /// The folder of results.
    folder: PathBuf,
    /// The hidden one.
    pub path: PathBuf,
    /// The owner's file, locked as long as the owner lives.
    _alive: Option<Lock>,
}

/// A lock on an open file or folder, given back when it goes.
///
/// Closing the file is not enough: a program that another thread is just starting holds a copy of every open file
/// until it runs, and with it the lock.
#[derive(Debug)]
pub struct Lock(File);

impl Lock {
    /// The exclusive lock on an open file or folder.
    ///
    /// # Errors
    /// Somebody else has it, or the system has no such locks.
    pub fn take(file: File) -> Result<Self, fs::TryLockError> {
        file.try_lock().map(|()| Self(file))
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        let _ = self.0.unlock();
    }
}

/// What is to happen: the journal.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Publication {
    /// Files that an earlier run wrote and that go.
    former: Vec<FileEntry>,
    /// Files that come.
    new: Vec<FileEntry>,
}

/// What proves whose a hidden folder is.
fn owner_text(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    format!("{name}: files in the making; the next run into this folder finishes or removes them\n")
}

/// Host, process and a number that is not used twice.
pub fn unique() -> String {
    use std::hash::{BuildHasher as _, RandomState};
    let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let host: String = host.chars().filter(char::is_ascii_alphanumeric).take(32).collect();
    format!("{host}.{}.{:016x}", std::process::id(), RandomState::new().hash_one(0))
}

/// Asked before every change on disk: an error stands for the moment at which the program is killed.
pub type Tick<'a> = &'a mut dyn FnMut() -> io::Result<()>;

impl Hidden {
    /// Makes a hidden folder in `folder`.
    ///
    /// # Errors
    /// Whatever the system reports.
    pub fn make(folder: &Path) -> io::Result<Self> {
        let path = folder.join(format!("{PREFIX}{}", unique()));
        fs::create_dir(&path)?;
        let made = File::create(path.join(OWNER)).and_then(|mut owner| {
            owner.write_all(owner_text(&path).as_bytes())?;
            let alive = Lock::take(owner).ok(); // some systems have no locks
            fs::create_dir(path.join(NEW))?;
            fs::create_dir(path.join(FORMER))?;
            Ok(alive)
        });
        match made {
            Ok(alive) => Ok(Self { folder: folder.to_owned(), path, _alive: alive }),
            Err(error) => {
                let _ = fs::remove_dir_all(&path);
                Err(error)
            }
        }
    }

    /// The hidden folders of ours in `folder` whose owners are dead. Where the system has no locks there are none: the
    /// owner may still be at work.
    pub fn orphans(folder: &Path) -> Vec<Self> {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let mut orphans: Vec<Self> = entries.filter_map(|entry| Self::orphan(folder, entry.path())).collect();
        orphans.sort_by(|a, b| a.path.cmp(&b.path));
        orphans
    }

    fn orphan(folder: &Path, path: PathBuf) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy();
        let plain = fs::symlink_metadata(&path).is_ok_and(|found| found.is_dir());
        let ours = name.starts_with(PREFIX) && plain;
        let owner = path.join(OWNER);
        if !ours || fs::read_to_string(&owner).ok()? != owner_text(&path) {
            return None;
        }
        let alive = Lock::take(File::open(&owner).ok()?).ok()?;
        Some(Self { folder: folder.to_owned(), path, _alive: Some(alive) })
    }

    /// Where a new file of the given name is written.
    pub fn new_file(&self, name: &str) -> PathBuf {
        self.path.join(NEW).join(name)
    }

    /// Moves the files `former` away, in this order, and puts those called `new`, all of which were written, in place,
    /// in this order: what names other files is the first to go and the last to come.
    ///
    /// # Errors
    /// A file in the way that is neither; whatever the system reports. The former files are then as they were.
    pub fn publish(&self, former: Vec<FileEntry>, new: &[String]) -> io::Result<()> {
        let alive: Tick = &mut || Ok(());
        let publication = self.begin(former, new, alive)?;
        self.finish(&publication, alive).inspect_err(|_| {
            let _ = self.undo(&publication, alive);
        })
    }

    /// As [`publish`](Self::publish), up to so many changes on disk.
    #[cfg(test)]
    pub fn killed(&self, former: Vec<FileEntry>, new: &[String], changes: usize) {
        let mut left = changes;
        let mut tick = || {
            left = left.checked_sub(1).ok_or_else(|| io::Error::other("killed"))?;
            Ok(())
        };
        let _ = self.begin(former, new, &mut tick).and_then(|publication| self.finish(&publication, &mut tick));
    }

    /// Writes the journal.
    fn begin(&self, former: Vec<FileEntry>, new: &[String], tick: Tick) -> io::Result<Publication> {
        let entries = new.iter().map(|name| {
            sync(&self.new_file(name))?;
            FileEntry::of(&self.new_file(name), name)
        });
        let publication = Publication { former, new: entries.collect::<io::Result<_>>()? };
        let journal = self.path.join(JOURNAL);
        let partial = journal.with_extension("partial");
        tick()?;
        fs::write(&partial, serde_json::to_vec(&publication)?)?;
        sync(&partial)?;
        tick()?;
        fs::rename(&partial, &journal)?;
        Ok(publication)
    }

    /// Finishes what a killed run began, or undoes it.
    ///
    /// # Errors
    /// Files of both sets that are gone, or others in their place: nothing is touched then.
    pub fn recover(&self, tick: Tick) -> io::Result<()> {
        let publication: Option<Publication> =
            fs::read(self.path.join(JOURNAL)).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok());
        // Without a journal no file was moved yet.
        let Some(publication) = publication.filter(Publication::is_plain) else { return self.remove(tick) };
        self.finish(&publication, tick).or_else(|_| self.undo(&publication, tick))
    }

    /// Moves the former files away and the new ones to their names.
    fn finish(&self, publication: &Publication, tick: Tick) -> io::Result<()> {
        // Nothing moves before all that is to come is known to be here, and nothing foreign in its way.
        for new in &publication.new {
            let place = self.folder.join(&new.name);
            let here = new.is_at(&self.new_file(&new.name)) || new.is_at(&place);
            let former = publication.former.iter().any(|former| former.name == new.name && former.is_at(&place));
            if !here || !(former || new.is_at(&place) || is_free(&place)) {
                return Err(in_the_way(&place, here));
            }
        }
        for former in &publication.former {
            let (place, kept) = (self.folder.join(&former.name), self.kept(former));
            let placed = publication.new.iter().any(|new| new.name == former.name && new.is_at(&place));
            if !placed && former.is_at(&place) {
                tick()?;
                fs::rename(&place, &kept)?;
                if !former.is_at(&kept) {
                    put(&kept, &place)?; // somebody wrote it a moment ago
                    return Err(in_the_way(&place, true));
                }
            }
        }
        for new in &publication.new {
            let (place, waiting) = (self.folder.join(&new.name), self.new_file(&new.name));
            if !new.is_at(&place) {
                tick()?;
                put(&waiting, &place)?;
            }
        }
        sync(&self.folder)?;
        self.remove(tick)
    }

    /// Takes the new files away again and moves the former ones back.
    fn undo(&self, publication: &Publication, tick: Tick) -> io::Result<()> {
        for new in &publication.new {
            let place = self.folder.join(&new.name);
            let former = publication.former.iter().any(|former| former.name == new.name && former.is_at(&place));
            if !former && new.is_at(&place) && !self.new_file(&new.name).exists() {
                tick()?;
                fs::rename(&place, self.new_file(&new.name))?;
            }
        }
        for former in publication.former.iter().rev() {
            let (place, kept) = (self.folder.join(&former.name), self.kept(former));
            if kept.exists() && !former.is_at(&place) {
                tick()?;
                put(&kept, &place)?;
            }
        }
        self.remove(tick)
    }

    fn kept(&self, former: &FileEntry) -> PathBuf {
        self.path.join(FORMER).join(&former.name)
    }

    /// Removes the hidden folder, unless files wait in it for a later run to put them in place.
    pub fn give_up(&self) {
        if self.path.exists() && !self.path.join(JOURNAL).exists() {
            let _ = self.remove(&mut || Ok(()));
        }
    }

    /// Removes the hidden folder, the journal first and the owner last.
    ///
    /// # Errors
    /// Whatever the system reports.
    pub fn remove(&self, tick: Tick) -> io::Result<()> {
        for name in [JOURNAL, NEW, FORMER] {
            tick()?;
            let path = self.path.join(name);
            let gone = if path.is_dir() { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
            gone.or_else(|error| if error.kind() == io::ErrorKind::NotFound { Ok(()) } else { Err(error) })?;
        }
        tick()?;
        fs::remove_dir_all(&self.path)
    }
}

impl Publication {
    /// Whether all files are plain names of the folder.
    fn is_plain(&self) -> bool {
        self.former.iter().chain(&self.new).all(|file| is_plain(&file.name))
    }
}

fn is_free(place: &Path) -> bool {
    fs::symlink_metadata(place).is_err_and(|error| error.kind() == io::ErrorKind::NotFound)
}

fn in_the_way(place: &Path, here: bool) -> io::Error {
    let name = place.file_name().unwrap_or_default().to_string_lossy();
    match here {
        true => io::Error::new(io::ErrorKind::AlreadyExists, format!("{name}: another file has its name")),
        false => io::Error::new(io::ErrorKind::NotFound, format!("{name}: is gone")),
    }
}

/// Gives a file a name that nothing has.
fn put(from: &Path, to: &Path) -> io::Result<()> {
    // A link is refused where the name is taken; a renaming would replace what has it.
    match fs::hard_link(from, to) {
        Ok(()) => fs::remove_file(from),
        Err(_) if is_free(to) => fs::rename(from, to), // a file system without links
        Err(error) => Err(error),
    }
}

fn sync(path: &Path) -> io::Result<()> {
    // Some systems cannot sync folders.
    fs::File::open(path)?.sync_all().or_else(|error| if path.is_dir() { Ok(()) } else { Err(error) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_that_is_given_back_is_free_whoever_still_holds_a_copy_of_the_file() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let hidden = Hidden::make(folder.path()).expect("writable");
        // As a program does that is just being started.
        let copy = hidden._alive.as_ref().map(|lock| lock.0.try_clone().expect("copied"));
        assert!(Hidden::orphans(folder.path()).is_empty(), "its owner is alive");
        drop(hidden);
        assert_eq!(Hidden::orphans(folder.path()).len(), 1, "its owner is gone");
        drop(copy);
    }
}
