//! Single files that the user names: whole or not at all, and never over a file that is not theirs to replace.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::digest;
use super::folder::{is_same, recover};
use super::ledger::FileEntry;
use super::publication::{Hidden, unique};
use crate::failure::Failure;
use crate::jobs::interruption::{self, CleanUp};

/// What becomes of a file that has the name already.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existing {
    /// It stays, unless it is the same to the byte: whose it is nobody knows.
    Stays,
    /// It is replaced: the user asks for it.
    Replaced,
}

impl Existing {
    /// From an option `--force`.
    pub fn forced(force: bool) -> Self {
        if force { Self::Replaced } else { Self::Stays }
    }
}

/// A file with all that goes into it.
#[derive(Debug)]
pub struct Whole {
    /// Its place.
    pub path: PathBuf,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// Refuses a name that no file can be given: that of a folder, or of a file that is read.
///
/// # Errors
/// The name, with the remedy.
pub fn refuse_read(path: &Path, reads: &[&Path]) -> Result<(), Failure> {
    let why = match () {
        () if reads.iter().any(|read| is_same(read, path)) => "is read by this run; choose another name to write to",
        () if path.is_dir() => "is a folder where a file is to go; choose another name",
        () => return Ok(()),
    };
    Err(Failure::BadInput(format!("{}: {why}", path.display())))
}

/// The same before work that takes long, where a file that has the name would not be replaced.
///
/// # Errors
/// As [`put`].
pub fn refuse_taken(path: &Path, reads: &[&Path], existing: Existing) -> Result<(), Failure> {
    refuse_read(path, reads)?;
    match fs::symlink_metadata(path) {
        Ok(_) if existing == Existing::Stays => Err(taken(path)),
        _ => Ok(()),
    }
}

fn refused(path: &Path, error: &io::Error) -> Failure {
    Failure::BadInput(format!("{}: cannot be written: {error}; choose another place", path.display()))
}

fn taken(path: &Path) -> Failure {
    Failure::BadInput(format!(
        "{}: is there already, and nothing shows whose it is; choose another name, move it away, or give --force",
        path.display()
    ))
}

/// Writes one or several files of one folder, all or none, in this order.
///
/// # Errors
/// A name that is taken; a file that cannot be written.
pub fn put(files: &[Whole], reads: &[&Path], existing: Existing) -> Result<(), Failure> {
    let same = |file: &&Whole| fs::read(&file.path).is_ok_and(|bytes| bytes == file.bytes);
    for file in files {
        refuse_read(&file.path, reads)?;
        if existing == Existing::Stays && fs::symlink_metadata(&file.path).is_ok() && !same(&file) {
            return Err(taken(&file.path));
        }
    }
    if files.iter().all(|file| same(&file)) {
        return Ok(());
    }
    match files {
        [file] => whole(&file.path, |out| out.write_all(&file.bytes)).map_err(|error| refused(&file.path, &error)),
        files => together(files).map_err(|error| refused(&files[files.len() - 1].path, &error)),
    }
}

/// Several files: one set takes the place of the other as a whole.
fn together(files: &[Whole]) -> io::Result<()> {
    let folder = files[0].path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    recover(folder).map_err(io::Error::other)?;
    let (hidden, _clean_up) = {
        let _whole = interruption::not_now();
        let hidden = Hidden::make(folder)?;
        let partial = hidden.path.clone();
        (hidden, interruption::clean_up(move || drop(fs::remove_dir_all(&partial))))
    };
    let (mut former, mut names) = (Vec::new(), Vec::new());
    let written = files.iter().try_for_each(|file| {
        let name = file.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if fs::symlink_metadata(&file.path).is_ok() {
            former.insert(0, FileEntry::of(&file.path, &name)?);
        }
        fs::write(hidden.new_file(&name), &file.bytes)?;
        names.push(name);
        Ok(())
    });
    let _whole = interruption::not_now();
    let published = written.and_then(|()| hidden.publish(former, &names));
    hidden.give_up();
    published
}

/// Writes a single file through `fill`, whole or not at all, over whatever has the name.
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

/// A file that is written and waits for its name.
#[derive(Debug)]
pub struct Filled<'a> {
    partial: Temporary,
    path: &'a Path,
    existing: Existing,
}

/// Writes a single file through `fill`, of any size, without its name yet.
///
/// # Errors
/// A place that cannot be written.
pub fn fill(
    path: &Path,
    existing: Existing,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<Filled<'_>, Failure> {
    refuse_read(path, &[])?;
    let partial = Temporary::beside(path);
    let write = || {
        let mut out = BufWriter::new(File::create(partial.path())?);
        fill(&mut out)?;
        out.flush()?;
        out.get_ref().sync_all()
    };
    write().map_err(|error| refused(path, &error))?;
    Ok(Filled { partial, path, existing })
}

impl Filled<'_> {
    /// Gives the file its name.
    ///
    /// # Errors
    /// A name that another file has, unless it is the same to the byte.
    pub fn publish(self) -> Result<(), Failure> {
        let digest = |path: &Path| digest::file(path).ok();
        if self.existing == Existing::Stays && fs::symlink_metadata(self.path).is_ok() {
            let same = digest(self.path).is_some_and(|found| digest(self.partial.path()) == Some(found));
            return if same { Ok(()) } else { Err(taken(self.path)) };
        }
        self.partial.publish(self.path).map_err(|error| refused(self.path, &error))
    }
}

/// A file in the making, under a name that no other process on any machine takes: `.NAME.HOST.PID.NUMBER`.
/// It goes when nothing comes of it.
#[derive(Debug)]
pub struct Temporary {
    path: PathBuf,
    _clean_up: CleanUp,
}

impl Temporary {
    /// A name beside the file that it is to become.
    pub fn beside(target: &Path) -> Self {
        let name = target.file_name().unwrap_or_default().to_string_lossy();
        let path = target.with_file_name(format!(".{name}.{}", unique()));
        let partial = path.clone();
        Self { path, _clean_up: interruption::clean_up(move || drop(fs::remove_file(&partial))) }
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
    }
}
