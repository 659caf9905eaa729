//! Bags of ROS 1, format 2.0 (<http://wiki.ros.org/Bags/Format/2.0>), read forwards: a bag without index is read as far as it goes.
//!
//! Connections stand before their messages, and in the index again: where the index is there it is read first, so that a
//! damaged chunk takes no connection with it.

use std::collections::HashMap;
use std::io::{Read, SeekFrom};
use std::ops::Range;
use std::sync::Arc;

use super::Source;
use super::stepped::{Parts, Stepped, Waiting};
use super::tape::Tape;
use crate::damage::{Damage, Loss};
use crate::record::{Bytes, Encoding, Record, Topic};
use crate::unpack::Packing;

/// What a bag begins with.
pub(crate) const MAGIC: &[u8] = b"#ROSBAG V2.0\n";

/// What bags of every version begin with.
pub(crate) const ANY_VERSION: &[u8] = b"#ROSBAG V";

/// The head of a record has a few fields, and is not longer than this, bytes.
const MOST_HEAD: u64 = 1 << 20;

/// The longest index whose connections are read first, bytes.
const MOST_INDEX: u64 = 1 << 26;

mod op {
    pub(super) const MESSAGE: u8 = 0x02;
    pub(super) const BAG: u8 = 0x03;
    pub(super) const CHUNK: u8 = 0x05;
    pub(super) const CONNECTION: u8 = 0x07;
    /// Index and chunk information.
    pub(super) const OTHERS: [u8; 2] = [0x04, 0x06];
}

/// A bag, read record by record.
pub(crate) struct Bag1 {
    tape: Tape,
    topics: Topics,
    waiting: Waiting,
    ended: bool,
}

/// Topics by the number of their connection.
#[derive(Default)]
struct Topics(HashMap<u32, Arc<Topic>>);

impl Bag1 {
    /// A file; the connections of its index are read.
    pub(crate) fn open(file: &Arc<str>, mut source: Box<dyn Source>) -> std::io::Result<Self> {
        let index = index(&mut *source).unwrap_or_default();
        source.seek(SeekFrom::Start(0))?;
        let mut bag = Self::forwards(file, Box::new(source));
        for (fields, range) in Records::of(&index).map_while(Result::ok) {
            if fields.op() == Some(op::CONNECTION) {
                bag.topics.take(&fields, &index[range]);
            }
        }
        Ok(bag)
    }

    /// A bag that is read forwards alone.
    pub(crate) fn forwards(file: &Arc<str>, source: Box<dyn Read + Send>) -> Self {
        let tape = Tape::new(file, source);
        Self { tape, topics: Topics::default(), waiting: Waiting::new(), ended: false }
    }

    /// The four bytes before a record; none at the end of the file.
    fn length(&mut self, from: u64) -> Result<Option<u64>, Damage> {
        match self.tape.take(4) {
            Ok(bytes) if bytes.is_empty() => Ok(None),
            Ok(bytes) if bytes.len() == 4 => Ok(u32_at(&bytes, 0).map(u64::from)),
            _ => Err(self.tape.damage(from, "the file ends within the head of a record", Loss::Rest)),
        }
    }

    fn content(&mut self, fields: &Fields, length: u64, from: u64) -> Result<(), Damage> {
        match fields.op() {
            Some(op::CHUNK) => {
                let (content, cut) = self.tape.up_to(length, from, "a chunk")?;
                let Some(cut) = cut else { return self.chunk(fields, content, from) };
                let name = String::from_utf8_lossy(fields.value("compression").unwrap_or_default()).into_owned();
                let records = Arc::new(Packing::named(&name).map(|known| known.partly(content)).unwrap_or_default());
                self.records(&records, from).unwrap_or_default();
                Err(cut)
            }
            Some(op::CONNECTION) => {
                let content = self.tape.exactly(length, from, "a connection")?;
                self.topics.take(fields, &content);
                Ok(())
            }
            Some(op::MESSAGE) => {
                let content = Arc::new(self.tape.exactly(length, from, "a message")?);
                let record = self.topics.message(fields, &content, 0..content.len());
                self.give(record, from);
                Ok(())
            }
            Some(op::BAG) => {
                // A recorder that was stopped hard has not come to write where the index is.
                let content = self.tape.exactly(length, from, "the head of the bag")?;
                if fields.number("index_pos", 8) == Some(0) {
                    let reason = "the bag has no index, as where its recorder was stopped hard";
                    self.waiting.push_back(Err(self.tape.damage(from, reason, Loss::Index)));
                }
                drop(content);
                Ok(())
            }
            Some(other) if op::OTHERS.contains(&other) => {
                let passed = self.tape.pass(length).unwrap_or(0);
                if passed < length {
                    let reason = format!("the file ends within its index, after {passed} of {length} bytes");
                    return Err(self.tape.damage(from, reason, Loss::Index));
                }
                Ok(())
            }
            _ => Err(self.tape.damage(from, "no record begins here: its head has no known op", Loss::Rest)),
        }
    }

    fn chunk(&mut self, fields: &Fields, content: Vec<u8>, from: u64) -> Result<(), Damage> {
        let lost = |tape: &Tape, reason: String| tape.damage(from, format!("the chunk {reason}"), Loss::Chunk);
        let records = Arc::new(unpacked(fields, content).map_err(|reason| lost(&self.tape, reason))?);
        let outcome = self.records(&records, from);
        outcome.map_err(|at| lost(&self.tape, format!("has a record that is cut, at byte {at} of its records")))
    }

    /// Gives the messages of a chunk; where a record is cut, its place.
    fn records(&mut self, records: &Arc<Vec<u8>>, from: u64) -> Result<(), usize> {
        for item in Records::of(records) {
            let (fields, range) = item?;
            match fields.op() {
                Some(op::CONNECTION) => self.topics.take(&fields, &records[range]),
                Some(op::MESSAGE) => {
                    let record = self.topics.message(&fields, records, range);
                    self.give(record, from);
                }
                _ => {}
            }
        }
        Ok(())
    }
}

impl Stepped for Bag1 {
    fn parts(&mut self) -> Parts<'_> {
        Parts { tape: &self.tape, waiting: &mut self.waiting, ended: &mut self.ended }
    }

    fn step(&mut self) -> Result<(), Damage> {
        let from = self.tape.at();
        if from == 0 {
            let magic = self.tape.exactly(MAGIC.len() as u64, 0, "the first bytes")?;
            return if magic == MAGIC {
                Ok(())
            } else {
                Err(self.tape.damage(0, "is no bag of format 2.0", Loss::Rest))
            };
        }
        let Some(length) = self.length(from)? else {
            self.ended = true;
            return Ok(());
        };
        if length > MOST_HEAD {
            let reason = format!("no record begins here: its head would have {length} bytes");
            return Err(self.tape.damage(from, reason, Loss::Rest));
        }
        let head = self.tape.exactly(length, from, "the head of a record")?;
        let fields = Fields::of(&head).map_err(|reason| self.tape.damage(from, reason, Loss::Rest))?;
        let length = self.tape.exactly(4, from, "the head of a record")?;
        let length = u64::from(u32_at(&length, 0).unwrap_or(0));
        self.content(&fields, length, from)
    }
}

impl Topics {
    /// A connection: its number and topic in the head, its type in the content.
    fn take(&mut self, fields: &Fields, content: &[u8]) {
        let (Some(number), Ok(described)) = (fields.number("conn", 4), Fields::of(content)) else { return };
        let text = |value: Option<&[u8]>| value.map(|value| String::from_utf8_lossy(value).into_owned());
        let (Some(name), Some(kind)) = (text(fields.value("topic")), text(described.value("type"))) else { return };
        let topic = Topic::new(&name, &kind, Encoding::Ros1);
        let number = number as u32;
        if self.0.get(&number).is_none_or(|known| **known != topic) {
            self.0.insert(number, Arc::new(topic));
        }
    }

    fn message(&self, fields: &Fields, bytes: &Arc<Vec<u8>>, range: Range<usize>) -> Result<Record, String> {
        let (Some(number), Some(time)) = (fields.number("conn", 4), fields.number("time", 8)) else {
            return Err("a message has no connection or no time".to_owned());
        };
        let (seconds, nanoseconds) = (time & 0xffff_ffff, time >> 32);
        match self.0.get(&(number as u32)) {
            Some(topic) => Ok(Record {
                topic: Arc::clone(topic),
                time_ns: seconds * 1_000_000_000 + nanoseconds,
                bytes: Bytes::of(bytes, range),
            }),
            None => Err(format!("a message is of connection {number}, which nothing before it defines")),
        }
    }
}

fn unpacked(fields: &Fields, content: Vec<u8>) -> Result<Vec<u8>, String> {
    let name = fields.value("compression").unwrap_or_default();
    let name = String::from_utf8_lossy(name);
    let known = Packing::named(&name).filter(|known| *known != Packing::Zstd).ok_or_else(|| {
        let name: String = name.chars().take(20).collect();
        format!("is compressed by {name:?}, of which none, bz2 and lz4 are read: recompress it, such as with `rosbag decompress`")
    })?;
    known.unpack(content, fields.number("size", 4))
}

/// The fields of a head: names and values.
#[derive(Debug, Default)]
struct Fields(Vec<(String, Vec<u8>)>);

impl Fields {
    fn of(mut bytes: &[u8]) -> Result<Self, String> {
        let mut fields = Vec::new();
        while !bytes.is_empty() {
            let cut = || "no record begins here: the fields of its head do not fit into it".to_owned();
            let length = u32_at(bytes, 0).ok_or_else(cut)? as usize;
            let (field, rest) = bytes[4..].split_at_checked(length).ok_or_else(cut)?;
            let equals = field.iter().position(|byte| *byte == b'=').ok_or_else(cut)?;
            fields.push((String::from_utf8_lossy(&field[..equals]).into_owned(), field[equals + 1..].to_vec()));
            bytes = rest;
        }
        Ok(Self(fields))
    }

    fn value(&self, name: &str) -> Option<&[u8]> {
        self.0.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_slice())
    }

    /// A number of so many bytes.
    fn number(&self, name: &str, bytes: usize) -> Option<u64> {
        let value = self.value(name).filter(|value| value.len() == bytes)?;
        Some(value.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte)))
    }

    fn op(&self) -> Option<u8> {
        self.number("op", 1).map(|op| op as u8)
    }
}

/// Heads of records and where their content stands; where one is cut, its place.
struct Records<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Records<'a> {
    fn of(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    fn read(&self, from: usize) -> Option<(Fields, Range<usize>)> {
        let head = from + 4..(from + 4).checked_add(u32_at(self.bytes, from)? as usize)?;
        let start = head.end + 4;
        let end = start.checked_add(u32_at(self.bytes, head.end)? as usize).filter(|end| *end <= self.bytes.len())?;
        Some((Fields::of(self.bytes.get(head)?).ok()?, start..end))
    }
}

impl Iterator for Records<'_> {
    type Item = Result<(Fields, Range<usize>), usize>;

    fn next(&mut self) -> Option<Self::Item> {
        let from = self.at;
        if from >= self.bytes.len() {
            return None;
        }
        let record = self.read(from);
        self.at = record.as_ref().map_or(self.bytes.len(), |(_, range)| range.end);
        Some(record.ok_or(from))
    }
}

/// The bytes from the index on; nothing where the bag has none.
fn index(source: &mut dyn Source) -> Option<Vec<u8>> {
    source.seek(SeekFrom::Start(MAGIC.len() as u64)).ok()?;
    let mut head = Vec::new();
    Read::take(&mut *source, 4096).read_to_end(&mut head).ok()?;
    let length = u32_at(&head, 0)? as usize;
    let fields = Fields::of(head.get(4..)?.get(..length)?).ok()?;
    let start = fields.number("index_pos", 8).filter(|start| *start > 0)?;
    let end = source.seek(SeekFrom::End(0)).ok()?;
    if start >= end || end - start > MOST_INDEX {
        return None;
    }
    source.seek(SeekFrom::Start(start)).ok()?;
    let mut records = Vec::new();
    Read::take(&mut *source, end - start).read_to_end(&mut records).ok()?;
    Some(records)
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}
