//! Files that a program brings with it, for folders in which they do not lie.

use std::fs::{File, Metadata};
use std::io::{self, Cursor, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::OnceLock;

/// Path and content of each file; paths are relative to the working folder, with `/` between names.
pub type Brought = &'static [(&'static str, &'static [u8])];

static BROUGHT: OnceLock<Brought> = OnceLock::new();

/// Makes `files` readable by [`opened`](crate::opened) wherever the program is started: each stands in for the file of its path
/// in the working folder if there is none. The first call counts; a program makes it once, where it begins.
pub fn bring(files: Brought) {
    BROUGHT.get_or_init(|| files);
}

/// The files that the program brings.
pub fn brought() -> Brought {
    BROUGHT.get().copied().unwrap_or_default()
}

/// Whether [`opened`](crate::opened) finds a file at a path: on disk, or brought with the program.
pub fn is_file(path: &Path) -> bool {
    path.is_file() || content(brought(), path).is_some()
}

/// The content of the file that a path in the working folder means.
pub(crate) fn content(files: Brought, path: &Path) -> Option<&'static [u8]> {
    let plain = plain(path)?;
    files.iter().find(|(name, _)| Path::new(name) == plain).map(|(_, content)| *content)
}

/// A relative path without `.` and `..`; none if it leaves the working folder.
fn plain(path: &Path) -> Option<PathBuf> {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::Normal(name) => plain.push(name),
            Component::ParentDir if plain.pop() => {}
            _ => return None,
        }
    }
    Some(plain)
}

/// A file that was opened to be read.
#[derive(Debug)]
pub struct Opened(Content);

#[derive(Debug)]
enum Content {
    OnDisk(File),
    Brought(Cursor<&'static [u8]>),
}

impl Opened {
    pub(crate) fn on_disk(file: File) -> Self {
        Self(Content::OnDisk(file))
    }

    pub(crate) fn brought(content: &'static [u8]) -> Self {
        Self(Content::Brought(Cursor::new(content)))
    }

    /// Length of a file, bytes; nothing is known of that of a pipe or a device, for which the system says 0.
    ///
    /// # Errors
    /// A file of which the system tells nothing.
    pub fn length(&self) -> io::Result<u64> {
        match &self.0 {
            Content::OnDisk(file) => file.metadata().map(|found| found.len()),
            Content::Brought(content) => Ok(content.get_ref().len() as u64),
        }
    }

    /// Whether it is a folder, which some systems open as they do files.
    pub fn is_folder(&self) -> bool {
        self.found(Metadata::is_dir, false)
    }

    /// Whether it can be read more than once, as a pipe cannot.
    pub fn is_file(&self) -> bool {
        self.found(Metadata::is_file, true)
    }

    fn found(&self, of: impl Fn(&Metadata) -> bool, brought: bool) -> bool {
        match &self.0 {
            Content::OnDisk(file) => file.metadata().is_ok_and(|found| of(&found)),
            Content::Brought(_) => brought,
        }
    }
}

impl Read for Opened {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match &mut self.0 {
            Content::OnDisk(file) => file.read(buffer),
            Content::Brought(content) => content.read(buffer),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILES: Brought = &[("scenes/hall.toml", b"hall"), ("gates.toml", b"gates")];

    #[test]
    fn a_file_is_found_by_every_way_to_it_within_the_working_folder() {
        for path in ["scenes/hall.toml", "./scenes/hall.toml", "scenes//hall.toml", "scenes/maps/../hall.toml"] {
            assert_eq!(content(FILES, Path::new(path)), Some(&b"hall"[..]), "{path}");
        }
        for path in ["/scenes/hall.toml", "../scenes/hall.toml", "scenes", "hall.toml", "", "scenes/../../gates.toml"] {
            assert_eq!(content(FILES, Path::new(path)), None, "{path}");
        }
    }

    #[test]
    fn a_file_that_is_brought_reads_as_one_on_disk() {
        let mut opened = Opened::brought(FILES[0].1);
        assert!(opened.is_file() && !opened.is_folder());
        assert_eq!(opened.length().expect("known"), 4);
        assert_eq!(io::read_to_string(&mut opened).expect("text"), "hall");
    }
}
