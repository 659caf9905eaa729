//! MCAP, version 0 (<https://mcap.dev/spec>), read forwards: a file without summary, of a robot that died, is read as far as it goes.
//!
//! Schemas and channels stand before their messages, and in the summary again: where the summary is there it is read first, so
//! that a damaged chunk takes no channel with it.

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

/// What a file begins and ends with.
pub(crate) const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

/// The longest part of a file that may hold schemas and channels again, bytes.
const MOST_SUMMARY: u64 = 1 << 26;

mod opcode {
    pub(super) const FOOTER: u8 = 0x02;
    pub(super) const SCHEMA: u8 = 0x03;
    pub(super) const CHANNEL: u8 = 0x04;
    pub(super) const MESSAGE: u8 = 0x05;
    pub(super) const CHUNK: u8 = 0x06;
    pub(super) const DATA_END: u8 = 0x0f;
}

/// A file, read record by record.
pub(crate) struct Mcap {
    tape: Tape,
    defined: Defined,
    waiting: Waiting,
    ended: bool,
}

/// Schemas by name and topics, by their numbers.
#[derive(Default)]
struct Defined {
    schemas: HashMap<u16, String>,
    topics: HashMap<u16, Arc<Topic>>,
}

impl Mcap {
    /// A file that can be read again from its end; its summary is read.
    pub(crate) fn open(file: &Arc<str>, mut source: Box<dyn Source>) -> std::io::Result<Self> {
        let summary = summary(&mut *source).unwrap_or_default();
        source.seek(SeekFrom::Start(0))?;
        let mut mcap = Self::forwards(file, Box::new(source));
        for (opcode, range) in Records::of(&summary).map_while(Result::ok) {
            mcap.defined.take(opcode, &summary[range]);
        }
        Ok(mcap)
    }

    /// A file that is read forwards alone.
    pub(crate) fn forwards(file: &Arc<str>, source: Box<dyn Read + Send>) -> Self {
        Self { tape: Tape::new(file, source), defined: Defined::default(), waiting: Waiting::new(), ended: false }
    }

    fn chunk(&mut self, content: Vec<u8>, from: u64) -> Result<(), Damage> {
        let lost = |tape: &Tape, reason: String| tape.damage(from, format!("the chunk {reason}"), Loss::Chunk);
        let records = Arc::new(unpacked(content).map_err(|reason| lost(&self.tape, reason))?);
        let outcome = self.records(&records, from);
        outcome.map_err(|at| lost(&self.tape, format!("has a record that is cut, at byte {at} of its records")))
    }

    /// Gives the messages of a chunk; where a record is cut, its place.
    fn records(&mut self, records: &Arc<Vec<u8>>, from: u64) -> Result<(), usize> {
        for item in Records::of(records) {
            let (opcode, range) = item?;
            match opcode {
                opcode::MESSAGE => {
                    let record = self.defined.message(records, range.start, range.end);
                    self.give(record, from);
                }
                _ => self.defined.take(opcode, &records[range]),
            }
        }
        Ok(())
    }
}

impl Stepped for Mcap {
    fn parts(&mut self) -> Parts<'_> {
        Parts { tape: &self.tape, waiting: &mut self.waiting, ended: &mut self.ended }
    }

    fn step(&mut self) -> Result<(), Damage> {
        let from = self.tape.at();
        if from == 0 {
            let magic = self.tape.exactly(MAGIC.len() as u64, 0, "the first bytes")?;
            return if magic == MAGIC { Ok(()) } else { Err(self.tape.damage(0, "is no MCAP file", Loss::Rest)) };
        }
        let head = match self.tape.take(9) {
            Ok(head) if head.is_empty() => {
                let reason = "the file has no end mark, as where its recorder was stopped hard";
                return Err(self.tape.damage(from, reason, Loss::Rest));
            }
            Ok(head) if head.len() == 9 => head,
            _ => return Err(self.tape.damage(from, "the file ends within the head of a record", Loss::Rest)),
        };
        let (opcode, length) = (head[0], u64_at(&head, 1).unwrap_or(0));
        match opcode {
            opcode::FOOTER | opcode::DATA_END => self.ended = true,
            opcode::SCHEMA | opcode::CHANNEL => {
                let content = self.tape.exactly(length, from, "a record")?;
                self.defined.take(opcode, &content);
            }
            opcode::MESSAGE => {
                let content = Arc::new(self.tape.exactly(length, from, "a message")?);
                let record = self.defined.message(&content, 0, content.len());
                self.give(record, from);
            }
            opcode::CHUNK => {
                let (content, cut) = self.tape.up_to(length, from, "a chunk")?;
                let Some(cut) = cut else { return self.chunk(content, from) };
                let records = Arc::new(partly(content));
                self.records(&records, from).unwrap_or_default();
                return Err(cut);
            }
            0 => return Err(self.tape.damage(from, "no record begins here", Loss::Rest)),
            _ => {
                let passed = self.tape.pass(length).unwrap_or(0);
                if passed < length {
                    let reason = format!("the file ends within a record, after {passed} of its {length} bytes");
                    return Err(self.tape.damage(from, reason, Loss::Rest));
                }
            }
        }
        Ok(())
    }
}

impl Defined {
    /// Takes a schema or a channel; what is cut is left out, so that its messages are said to have no channel.
    fn take(&mut self, opcode: u8, content: &[u8]) {
        match opcode {
            opcode::SCHEMA => {
                if let (Some(id), Some((name, _))) = (u16_at(content, 0), text_at(content, 2)) {
                    self.schemas.insert(id, name);
                }
            }
            opcode::CHANNEL => {
                let ids = u16_at(content, 0).zip(u16_at(content, 2));
                let Some(((id, schema), (name, next))) = ids.zip(text_at(content, 4)) else { return };
                let Some((encoding, _)) = text_at(content, next) else { return };
                let kind = self.schemas.get(&schema).map_or("", String::as_str);
                let encoding = match encoding.as_str() {
                    "cdr" => Encoding::Cdr,
                    "ros1" => Encoding::Ros1,
                    _ => Encoding::Other,
                };
                let topic = Topic::new(&name, kind, encoding);
                if self.topics.get(&id).is_none_or(|known| **known != topic) {
                    self.topics.insert(id, Arc::new(topic));
                }
            }
            _ => {}
        }
    }

    /// The message that stands in a part of some bytes: channel, number, time of recording, time of publication, data.
    fn message(&self, bytes: &Arc<Vec<u8>>, from: usize, to: usize) -> Result<Record, String> {
        let content = &bytes[from..to];
        let (Some(channel), Some(time_ns), true) = (u16_at(content, 0), u64_at(content, 6), content.len() >= 22) else {
            return Err(format!("a message has {} bytes, fewer than its head", content.len()));
        };
        match self.topics.get(&channel) {
            Some(topic) => Ok(Record { topic: Arc::clone(topic), time_ns, bytes: Bytes::of(bytes, from + 22..to) }),
            None => Err(format!("a message is of channel {channel}, which nothing before it defines")),
        }
    }
}

/// The records of a chunk: times, size, CRC-32, compression, data.
fn unpacked(mut content: Vec<u8>) -> Result<Vec<u8>, String> {
    let cut = || "ends within its head".to_owned();
    let size = u64_at(&content, 16).ok_or_else(cut)?;
    let crc = u32_at(&content, 24).ok_or_else(cut)?;
    let (packing, next) = text_at(&content, 28).ok_or_else(cut)?;
    let length = u64_at(&content, next).ok_or_else(cut)?;
    let rest = content.split_off(next + 8);
    if rest.len() as u64 != length {
        return Err(format!("claims {length} bytes of records and has {}", rest.len()));
    }
    let known = Packing::named(&packing).filter(|known| *known != Packing::Bzip2);
    let known = known.ok_or_else(|| {
        let name: String = packing.chars().take(20).collect();
        format!("is compressed by {name:?}, of which none, lz4 and zstd are read: recompress it, such as with `mcap compress`")
    })?;
    let records = known.unpack(rest, Some(size))?;
    let found = crc32fast::hash(&records);
    if crc != 0 && crc != found {
        return Err(format!("is damaged: its CRC-32 is {found:08x} and must be {crc:08x}"));
    }
    Ok(records)
}

/// The records of a chunk that is cut, as far as they go.
fn partly(mut content: Vec<u8>) -> Vec<u8> {
    let known = text_at(&content, 28).and_then(|(packing, next)| Some((Packing::named(&packing)?, next + 8)));
    match known.filter(|(_, start)| *start <= content.len()) {
        Some((packing, start)) => packing.partly(content.split_off(start)),
        None => Vec::new(),
    }
}

/// Opcodes of records and where their content stands; where one is cut, its place.
struct Records<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Records<'a> {
    fn of(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }
}

impl Iterator for Records<'_> {
    type Item = Result<(u8, Range<usize>), usize>;

    fn next(&mut self) -> Option<Self::Item> {
        let from = self.at;
        let opcode = *self.bytes.get(from)?;
        let length = u64_at(self.bytes, from + 1).and_then(|length| usize::try_from(length).ok());
        let end = length.and_then(|length| (from + 9).checked_add(length)).filter(|end| *end <= self.bytes.len());
        self.at = end.unwrap_or(self.bytes.len());
        Some(end.map_or(Err(from), |end| Ok((opcode, from + 9..end))))
    }
}

/// The records between data and footer; nothing where the file has no whole end.
fn summary(source: &mut dyn Source) -> Option<Vec<u8>> {
    const FOOTER: u64 = 1 + 8 + 20;
    let end = source.seek(SeekFrom::End(-((FOOTER + MAGIC.len() as u64) as i64))).ok()?;
    let mut last = Vec::new();
    Read::take(&mut *source, FOOTER + MAGIC.len() as u64).read_to_end(&mut last).ok()?;
    if last.first() != Some(&opcode::FOOTER) || !last.ends_with(&MAGIC) {
        return None;
    }
    let start = u64_at(&last, 9).filter(|start| *start > 0 && *start < end && end - start <= MOST_SUMMARY)?;
    source.seek(SeekFrom::Start(start)).ok()?;
    let mut records = Vec::new();
    Read::take(&mut *source, end - start).read_to_end(&mut records).ok()?;
    Some(records)
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    Some(u64::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

/// A text with its length before it, and where it ends.
fn text_at(bytes: &[u8], at: usize) -> Option<(String, usize)> {
    let length = u32_at(bytes, at)? as usize;
    let text = bytes.get(at + 4..)?.get(..length)?;
    Some((String::from_utf8_lossy(text).into_owned(), at + 4 + length))
}
