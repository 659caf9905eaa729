//! Output folders that are replaced whole or not at all, and only where the files in them are a former run's.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::detail;
use super::ledger::{self, FileEntry, Ledger, RECORD, Sealed};
use super::publication::{Hidden, Lock};
use crate::failure::Failure;
use crate::jobs::interruption::{self, CleanUp};

/// What a run means to do with a folder.
#[derive(Debug, Clone)]
pub struct Purpose {
    /// The command, as records name it.
    pub command: String,
    /// Files that the run reads; it replaces none of them.
    pub reads: Vec<PathBuf>,
    /// Every file that it may write, the record aside.
    pub writes: Vec<String>,
}

impl Purpose {
    /// A run of `command` that reads some files and may write others, its record aside.
    pub fn new(
        command: &str,
        reads: &[&(impl AsRef<Path> + ?Sized)],
        writes: impl IntoIterator<Item = impl Into<String>>,
    ) -> Self {
        let reads = reads.iter().map(|path| path.as_ref().to_owned()).collect();
        Self { command: command.to_owned(), reads, writes: writes.into_iter().map(Into::into).collect() }
    }
}

/// What becomes of files that an earlier run of the command wrote and this one does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Others {
    /// They go: the run makes all files of the folder.
    Go,
    /// They stay: the run makes some of them anew.
    Stay,
}

/// A folder of results in the making.
///
/// Files are written to a hidden folder inside the output folder and moved to their names by
/// [`publish`](Self::publish). A run that fails or is killed leaves the former results as they were.
#[derive(Debug)]
pub struct Staging {
    folder: PathBuf,
    others: Others,
    /// Names that the run said it would write.
    announced: Vec<String>,
    hidden: Hidden,
    files: Vec<String>,
    former: Former,
    /// The run made the folder, and takes it away again if nothing comes of it.
    new: bool,
    _clean_up: CleanUp,
    /// Held while the run lasts, so that two runs do not mix their files.
    _lock: Option<Lock>,
}

/// The results that an earlier run of the same command left.
#[derive(Debug, Default)]
struct Former {
    record: Option<Box<Sealed>>,
    /// Those of its files that are there as it wrote them, its record among them.
    proved: Vec<FileEntry>,
}

impl Staging {
    /// Makes the output folder if need be, and proves before any work that it can be written and that nothing in it
    /// is lost by that.
    ///
    /// # Errors
    /// A folder that cannot be written, or that another run is writing; a file in the place of one that is to be
    /// written that is read, or that no earlier run of the command left.
    pub fn open(folder: &Path, purpose: &Purpose) -> Result<Self, Failure> {
        Self::open_for(folder, purpose, Others::Go)
    }

    /// The same for a run that makes some of the command's files anew.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn amend(folder: &Path, purpose: &Purpose) -> Result<Self, Failure> {
        Self::open_for(folder, purpose, Others::Stay)
    }

    fn open_for(folder: &Path, purpose: &Purpose, others: Others) -> Result<Self, Failure> {
        let refuse = |what: &str, error: &dyn std::fmt::Display| {
            Failure::BadInput(format!(
                "{}: {what}: {error}; choose another folder with --out, or make this one writable",
                folder.display()
            ))
        };
        purpose.reads.iter().for_each(|path| detail(format_args!("reads {}", path.display())));
        let _whole = interruption::not_now(); // until what is made here is known to be taken away
        let new = !folder.exists();
        fs::create_dir_all(folder).map_err(|e| refuse("the output folder cannot be made", &e))?;
        let lock = lock(folder).map_err(|()| refuse("the output folder is in use", &"another run is writing to it"))?;
        let opened = recover(folder).and_then(|()| Former::of(folder, purpose));
        let made = opened.and_then(|former| {
            let hidden = Hidden::make(folder).and_then(|hidden| {
                let probe = hidden.new_file("probe");
                fs::write(&probe, b"x").and_then(|()| fs::remove_file(probe)).map(|()| hidden)
            });
            Ok((former, hidden.map_err(|e| refuse("the output folder cannot be written", &e))?))
        });
        let (former, hidden) = made.inspect_err(|_| {
            if new {
                let _ = fs::remove_dir(folder);
            }
        })?;
        let (partial, parent) = (hidden.path.clone(), folder.to_owned());
        let clean_up = interruption::clean_up(move || {
            let _ = fs::remove_dir_all(&partial);
            if new {
                let _ = fs::remove_dir(&parent); // refused by the system unless it is empty
            }
        });
        Ok(Self {
            folder: folder.to_owned(),
            others,
            announced: purpose.writes.clone(),
            hidden,
            files: Vec::new(),
            former,
            new,
            _clean_up: clean_up,
            _lock: lock,
        })
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
        debug_assert!(name == RECORD || self.announced.iter().any(|known| known == name), "{name} was not announced");
        if !self.files.iter().any(|file| file == name) {
            self.files.push(name.to_owned());
        }
        let written = File::create(self.hidden.new_file(name)).and_then(|file| {
            let mut out = BufWriter::new(file);
            fill(&mut out).map_err(Into::into)?;
            out.flush()
        });
        written.map_err(|e| Failure::write(&self.folder.join(name), &e))?;
        detail(format_args!("writes {}", self.folder.join(name).display()));
        Ok(())
    }

    /// Writes the record of the run, last of all files: an object that names the command. Name, size and digest of
    /// every file, and a digest of itself, are added to it.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn record(&mut self, record: &impl Serialize) -> Result<(), Failure> {
        let text = ledger::text(record, &self.entries()?).map_err(Failure::internal)?;
        self.write(RECORD, |out| out.write_all(text.as_bytes()))
    }

    /// Name, size and digest of every file of the folder as it will be.
    fn entries(&self) -> Result<Vec<FileEntry>, Failure> {
        let mut entries = match (&self.former.record, self.others) {
            (Some(former), Others::Stay) => {
                former.files.iter().filter(|file| !self.files.contains(&file.name)).cloned().collect()
            }
            _ => Vec::new(),
        };
        for name in &self.files {
            let entry = FileEntry::of(&self.hidden.new_file(name), name);
            entries.push(entry.map_err(|e| Failure::write(&self.folder.join(name), &e))?);
        }
        entries.sort();
        Ok(entries)
    }

    /// Writes the record that the former run left, for the files as they are now.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn record_again(&mut self) -> Result<(), Failure> {
        let Some(former) = &self.former.record else {
            return Err(Failure::Internal(format!("{}: there is no former record", self.folder.display())));
        };
        let text = ledger::again(&former.text, &self.entries()?).map_err(Failure::internal)?;
        self.write(RECORD, |out| out.write_all(text.as_bytes()))
    }

    /// The record that an earlier run of the command left in the folder.
    pub fn former_record(&self) -> Option<&serde_json::Value> {
        self.former.record.as_ref().map(|record| &record.value)
    }

    /// Where a file that was written waits for its name.
    pub fn written(&self, name: &str) -> PathBuf {
        self.hidden.new_file(name)
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Names of the files so far and of those to come, sorted.
    pub fn files_and(&self, to_come: &[&str]) -> Vec<String> {
        let mut files = self.files.clone();
        files.extend(to_come.iter().map(|name| (*name).to_owned()));
        files.sort();
        files
    }

    /// Moves all files to their names, the record last, and removes files that only the former run wrote. A kill at
    /// any moment leaves what the next run into the folder needs to finish, or to undo it.
    ///
    /// # Errors
    /// A file that somebody has put in the way meanwhile; whatever the system reports.
    pub fn publish(mut self) -> Result<(), Failure> {
        let _whole = interruption::not_now();
        let former = self.settle_order();
        self.hidden.publish(former, &self.files).map_err(|error| match error.kind() {
            io::ErrorKind::AlreadyExists => Failure::BadInput(format!(
                "{}: somebody has put it there during the run; move it away, or choose another folder with --out",
                self.folder.join(error.to_string()).display()
            )),
            _ => Failure::write(&self.folder, &error),
        })
    }
}

impl Staging {
    /// The former files that go. At no time does a record stand beside files of another run: it is the first to go and
    /// the last to come.
    fn settle_order(&mut self) -> Vec<FileEntry> {
        debug_assert!(self.files.iter().any(|name| name == RECORD), "files without a record");
        let mut former = std::mem::take(&mut self.former.proved);
        former.retain(|file| self.others == Others::Go || self.files.contains(&file.name));
        former.sort_by_key(|file| file.name != RECORD);
        self.files.sort_by_key(|name| name == RECORD);
        former
    }

    /// As [`publish`](Self::publish), and killed after so many changes on disk.
    #[cfg(test)]
    fn killed(mut self, changes: usize) {
        let former = self.settle_order();
        self.hidden.killed(former, &self.files, changes);
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        self.hidden.give_up();
        if self.new {
            let _ = fs::remove_dir(&self.folder); // refused by the system unless it is empty
        }
    }
}

/// Finishes or undoes what killed runs began in the folder.
///
/// # Errors
/// What can be neither finished nor undone; nothing is touched then.
pub fn recover(folder: &Path) -> Result<(), Failure> {
    Hidden::orphans(folder).iter().try_for_each(|hidden| {
        hidden.recover(&mut || Ok(())).map_err(|error| {
            Failure::BadInput(format!(
                "{}: a run was killed while it put its files in place, and {error}; what is not in place is in {}: move it by hand, or choose another folder with --out",
                folder.display(),
                hidden.path.display()
            ))
        })
    })
}

/// Refuses a folder that a run of this purpose cannot write to without losing something.
///
/// # Errors
/// As [`Staging::open`].
pub fn check(folder: &Path, purpose: &Purpose) -> Result<(), Failure> {
    Former::of(folder, purpose).map(drop)
}

impl Former {
    /// What an earlier run of the command left, and may be replaced.
    fn of(folder: &Path, purpose: &Purpose) -> Result<Self, Failure> {
        let record = match Ledger::read(folder) {
            Ledger::Nothing => None,
            Ledger::Ours(record) if record.command == purpose.command => Some(record),
            Ledger::Ours(record) => {
                let why =
                    format!("holds the results of `{}`, and `{}` would replace it", record.command, purpose.command);
                return Err(refused(folder, RECORD, &why));
            }
            Ledger::Foreign(why) => return Err(refused(folder, RECORD, &why)),
        };
        let listed = record.iter().flat_map(|record| record.files.iter().chain([&record.entry]));
        let proved: Vec<FileEntry> = listed.filter(|file| file.is_at(&folder.join(&file.name))).cloned().collect();
        for name in purpose.writes.iter().map(String::as_str).chain([RECORD]) {
            let place = folder.join(name);
            let Ok(found) = fs::symlink_metadata(&place) else { continue };
            if purpose.reads.iter().any(|read| is_same(read, &place)) {
                return Err(refused(folder, name, "is read by this run, which would replace it"));
            }
            if found.is_dir() {
                return Err(refused(folder, name, "is a folder where a file is to go"));
            }
            if proved.iter().all(|file| file.name != name) {
                let why = match record.iter().flat_map(|record| &record.files).any(|file| file.name == name) {
                    true => format!("has changed since `{}` wrote it, and would be replaced", purpose.command),
                    false => format!("was not written by an earlier `{}`, and would be replaced", purpose.command),
                };
                return Err(refused(folder, name, &why));
            }
        }
        let read = |file: &&FileEntry| purpose.reads.iter().any(|read| is_same(read, &folder.join(&file.name)));
        if let Some(file) = proved.iter().find(read) {
            return Err(refused(folder, &file.name, "is read by this run, which would remove it"));
        }
        Ok(Self { record, proved })
    }
}

fn refused(folder: &Path, name: &str, why: &str) -> Failure {
    let place = folder.join(name);
    Failure::BadInput(format!("{}: {why}; choose another folder with --out, or move it away", place.display()))
}

/// Whether two paths lead to one file, by links of either kind too.
pub fn is_same(a: &Path, b: &Path) -> bool {
    let place = |path| fs::canonicalize(path).ok();
    let same_file = |a: &Path, b: &Path| identity(a).is_some() && identity(a) == identity(b);
    place(a).is_some() && (place(a) == place(b) || same_file(a, b))
}

#[cfg(unix)]
fn identity(path: &Path) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt as _;
    fs::metadata(path).ok().map(|found| (found.dev(), found.ino()))
}

#[cfg(not(unix))]
fn identity(_: &Path) -> Option<(u64, u64)> {
    None
}

/// An exclusive lock on the folder itself; none where the system has no such locks.
///
/// # Errors
/// Another run holds it.
fn lock(folder: &Path) -> Result<Option<Lock>, ()> {
    let Ok(handle) = File::open(folder) else { return Ok(None) };
    match Lock::take(handle) {
        Ok(lock) => Ok(Some(lock)),
        Err(fs::TryLockError::WouldBlock) => Err(()),
        Err(fs::TryLockError::Error(_)) => Ok(None),
    }
}

/// The folder `base` for the results of `source`; where that holds the results of another source, the first of
/// `base-2`, `base-3`, ... that does not. `recorded` reads from a record which source its results are of, as a path.
pub fn for_source(base: &Path, source: &Path, recorded: impl Fn(&serde_json::Value) -> Option<PathBuf>) -> PathBuf {
    let other = |folder: &Path| match Ledger::read(folder) {
        Ledger::Ours(record) => {
            recorded(&record.value).is_some_and(|former| former != source && !is_same(&former, source))
        }
        _ => false, // whatever it is, the run says so
    };
    let name = base.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let numbered = (2..).map(|n| base.with_file_name(format!("{name}-{n}")));
    let chosen = std::iter::once(base.to_owned()).chain(numbered).find(|folder| !other(folder));
    let chosen = chosen.unwrap_or_else(|| base.to_owned());
    if chosen != base {
        let (base, chosen, source) = (base.display(), chosen.display(), source.display());
        let note = format!("note: {base} holds the results of another file; those of {source} go to {chosen}");
        let _ = writeln!(io::stderr(), "{note}");
    }
    chosen
}

/// [`for_source`] for commands whose record has the path of a scene.
pub fn for_scene(base: &Path, scene: &Path) -> PathBuf {
    for_source(base, scene, |record| record["configuration"]["scene"].as_str().map(PathBuf::from))
}

#[cfg(test)]
mod tests;
