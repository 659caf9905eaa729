//! A bag: one file or several, read as often as it is needed.

use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use crate::container::bag1::Bag1;
use crate::container::db3::{self, Db3};
use crate::container::mcap::Mcap;
use crate::container::{Container, Wanted};
use crate::damage::{Damage, Loss};
use crate::error::BagError;
use crate::folder;
use crate::part::{Form, Part};
use crate::record::{Encoding, Record, Topic};
use crate::unpack::{Packing, ZSTD, Zstd};

/// A bag of one file or several.
#[derive(Debug, Clone)]
pub struct Bag {
    parts: Vec<Part>,
}

impl Bag {
    /// Whether a path is a bag by its first bytes, or a folder of rosbag2. False for what cannot be read.
    pub fn is_at(path: &Path) -> bool {
        if path.is_dir() {
            return folder::is_bag(path);
        }
        path.is_file() && Part::file(path).form().is_ok_and(|form| form.is_some())
    }

    /// A bag at a path: a file, or a folder with `metadata.yaml` or files of rosbag2.
    ///
    /// # Errors
    /// What cannot be read, is no bag, or is one of ROS before format 2.0; a folder of which a file is missing.
    pub fn open(path: &Path) -> Result<Self, BagError> {
        let files = if path.is_dir() { folder::files(path)? } else { vec![path.to_owned()] };
        Self::of(files.iter().map(|file| Part::file(file)).collect())
    }

    /// A bag in memory, of one file; `place` names it in messages.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn read(bytes: Vec<u8>, place: &str) -> Result<Self, BagError> {
        Self::of(vec![Part::memory(bytes, place)])
    }

    fn of(parts: Vec<Part>) -> Result<Self, BagError> {
        for part in &parts {
            let refused =
                |reason: &str| Err(BagError::Form { place: part.name.to_string(), reason: reason.to_owned() });
            match part.form().map_err(|source| BagError::Unreadable { place: part.name.to_string(), source })? {
                None => return refused("is no bag; give a .bag of ROS 1, an .mcap, a .db3 or a folder of rosbag2"),
                Some(Form::OldBag) => {
                    return refused("is a bag of ROS before format 2.0; convert it with `rosbag migrate`");
                }
                Some(_) => {}
            }
        }
        Ok(Self { parts })
    }

    /// All messages from the first file on, in the order in which they stand there. Of topics that are not `wanted`, the bytes may
    /// be left out.
    pub fn records(&self, wanted: impl Fn(&Topic) -> bool + Send + Sync + 'static) -> Records {
        Records { parts: self.parts.clone(), next: 0, container: None, wanted: Arc::new(wanted) }
    }
}

/// The messages of a bag, and what is damaged of it.
pub struct Records {
    parts: Vec<Part>,
    next: usize,
    container: Option<Box<dyn Container>>,
    wanted: Arc<dyn Fn(&Topic) -> bool + Send + Sync>,
}

impl Iterator for Records {
    type Item = Result<Record, Damage>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(item) = self.container.as_mut().and_then(|container| container.next()) {
                return Some(item.and_then(unpacked));
            }
            let part = self.parts.get(self.next)?;
            self.next += 1;
            let wanted = Arc::clone(&self.wanted);
            match opened(part, Box::new(move |topic| wanted(topic))) {
                Ok(container) => self.container = Some(container),
                Err(reason) => {
                    self.container = None;
                    return Some(Err(Damage { file: Arc::clone(&part.name), offset: 0, reason, loss: Loss::Rest }));
                }
            }
        }
    }
}

/// A message that was compressed by itself, as rosbag2 does in the mode `message`: no message of ROS 2 begins as zstd does.
fn unpacked(record: Record) -> Result<Record, Damage> {
    if !record.bytes.starts_with(&ZSTD) || record.topic.encoding != Encoding::Cdr {
        return Ok(record);
    }
    match Packing::Zstd.unpack(record.bytes.to_vec(), None) {
        Ok(bytes) => Ok(Record { bytes: bytes.into(), ..record }),
        Err(reason) => Err(Damage {
            file: record.topic.name.as_str().into(),
            offset: 0,
            reason: format!("a message {reason}"),
            loss: Loss::Message,
        }),
    }
}

/// A file from its beginning.
fn opened(part: &Part, wanted: Wanted) -> Result<Box<dyn Container>, String> {
    let unreadable = |error: std::io::Error| format!("cannot be read: {error}");
    let name = &part.name;
    let packed =
        || -> Result<Box<dyn Read + Send>, String> { Ok(Box::new(Zstd::new(part.open().map_err(unreadable)?))) };
    let is_packed = part.is_packed().map_err(unreadable)?;
    let open = || part.open().map_err(unreadable);
    match part.form().map_err(unreadable)? {
        Some(Form::Mcap) if is_packed => Ok(Box::new(Mcap::forwards(name, packed()?))),
        Some(Form::Mcap) => Ok(Box::new(Mcap::open(name, open()?).map_err(unreadable)?)),
        Some(Form::Bag1) if is_packed => Ok(Box::new(Bag1::forwards(name, packed()?))),
        Some(Form::Bag1) => Ok(Box::new(Bag1::open(name, open()?).map_err(unreadable)?)),
        Some(Form::Db3) => {
            let source = if is_packed { Box::new(part.unpacked().map_err(unreadable)?) } else { open()? };
            let ahead = part.path().filter(|_| !is_packed).and_then(db3::write_ahead);
            Ok(Box::new(Db3::open(name, db3::Pages::new(source, ahead)?, wanted)?))
        }
        Some(Form::OldBag) | None => Err("is no bag any more: was it written anew?".to_owned()),
    }
}
