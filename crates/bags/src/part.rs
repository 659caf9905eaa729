//! A file of a bag, on disk or in memory.

use std::fs::File;
use std::io::{self, Cursor, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::container::{Source, bag1, db3, mcap};
use crate::unpack::{ZSTD, Zstd};

/// What a file is by its first bytes, unpacked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    Bag1,
    /// A bag of ROS 1 before format 2.0.
    OldBag,
    Mcap,
    Db3,
}

/// Bytes by which forms are told.
const START: u64 = 16;

impl Form {
    fn of(start: &[u8]) -> Option<Self> {
        let all = [
            (bag1::MAGIC, Self::Bag1),
            (bag1::ANY_VERSION, Self::OldBag),
            (&mcap::MAGIC[..5], Self::Mcap),
            (db3::MAGIC, Self::Db3),
        ];
        all.into_iter().find_map(|(magic, form)| start.starts_with(magic).then_some(form))
    }
}

/// A file of a bag.
#[derive(Debug, Clone)]
pub(crate) struct Part {
    /// How messages call it.
    pub(crate) name: Arc<str>,
    content: Content,
}

#[derive(Debug, Clone)]
enum Content {
    File(PathBuf),
    Memory(Arc<[u8]>),
}

impl Part {
    pub(crate) fn file(path: &Path) -> Self {
        Self { name: path.display().to_string().into(), content: Content::File(path.to_owned()) }
    }

    pub(crate) fn memory(bytes: Vec<u8>, place: &str) -> Self {
        Self { name: place.into(), content: Content::Memory(bytes.into()) }
    }

    pub(crate) fn path(&self) -> Option<&Path> {
        match &self.content {
            Content::File(path) => Some(path),
            Content::Memory(_) => None,
        }
    }

    pub(crate) fn open(&self) -> io::Result<Box<dyn Source>> {
        Ok(match &self.content {
            Content::File(path) => Box::new(File::open(path)?),
            Content::Memory(bytes) => Box::new(Cursor::new(Arc::clone(bytes))),
        })
    }

    fn start(&self) -> io::Result<Vec<u8>> {
        start(self.open()?)
    }

    /// Whether zstd packs the whole file.
    pub(crate) fn is_packed(&self) -> io::Result<bool> {
        Ok(self.start()?.starts_with(&ZSTD))
    }

    /// What it is, below what packs it; none for what is no bag.
    pub(crate) fn form(&self) -> io::Result<Option<Form>> {
        let plain = self.start()?;
        if plain.starts_with(&ZSTD) {
            return Ok(start(Zstd::new(self.open()?)).ok().and_then(|start| Form::of(&start)));
        }
        Ok(Form::of(&plain))
    }

    /// What is packed, in a file without name in the system's temporary folder, for what is read at any place. What is cut is
    /// unpacked as far as it goes.
    pub(crate) fn unpacked(&self) -> io::Result<File> {
        let mut whole = nameless()?;
        let mut source = Zstd::new(self.open()?);
        let mut buffer = vec![0; 1 << 16];
        while let Ok(count) = source.read(&mut buffer) {
            if count == 0 {
                break;
            }
            whole.write_all(&buffer[..count])?;
        }
        whole.seek(SeekFrom::Start(0))?;
        Ok(whole)
    }
}

/// A new file in the system's temporary folder that goes when it is closed: its name is taken away at once.
fn nameless() -> io::Result<File> {
    static NUMBER: AtomicU64 = AtomicU64::new(0);
    const TRIES: u32 = 100;
    let mut found = Err(io::ErrorKind::AlreadyExists.into());
    for _ in 0..TRIES {
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("bag-{}-{number}", std::process::id()));
        found = File::options().read(true).write(true).create_new(true).open(&path);
        match &found {
            Ok(_) => {
                std::fs::remove_file(&path)?;
                break;
            }
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(_) => break,
        }
    }
    found
}

fn start(source: impl Read) -> io::Result<Vec<u8>> {
    let mut start = Vec::new();
    source.take(START).read_to_end(&mut start)?;
    Ok(start)
}
