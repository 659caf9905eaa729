//! The container: MCAP, version 0 (<https://mcap.dev/spec>), uncompressed, in chunks with their indexes.
//!
//! Written here and not by a library: it is a few records, and the library brings more to the first build than all of them together.

use std::collections::BTreeMap;

/// What a file begins and ends with.
pub(super) const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

/// A chunk is closed once it has so many bytes: players read what they need chunk by chunk.
const CHUNK: usize = 1 << 20;

mod opcode {
    pub(super) const HEADER: u8 = 0x01;
    pub(super) const FOOTER: u8 = 0x02;
    pub(super) const SCHEMA: u8 = 0x03;
    pub(super) const CHANNEL: u8 = 0x04;
    pub(super) const MESSAGE: u8 = 0x05;
    pub(super) const CHUNK: u8 = 0x06;
    pub(super) const MESSAGE_INDEX: u8 = 0x07;
    pub(super) const CHUNK_INDEX: u8 = 0x08;
    pub(super) const STATISTICS: u8 = 0x0b;
    pub(super) const SUMMARY_OFFSET: u8 = 0x0e;
    pub(super) const DATA_END: u8 = 0x0f;
}

/// A file that grows.
pub(super) struct McapFile {
    bytes: Vec<u8>,
    chunk: Chunk,
    chunks: Vec<u8>,
    chunk_count: u32,
    /// Records of schemas and channels, for the summary.
    schemas: Vec<u8>,
    schema_count: u16,
    channels: Vec<u8>,
    /// Messages of every channel.
    counts: BTreeMap<u16, u64>,
    /// First and last time, ns.
    span: Option<(u64, u64)>,
}

/// Records that wait for their chunk.
#[derive(Default)]
struct Chunk {
    records: Vec<u8>,
    /// Times and places of the messages of every channel.
    index: BTreeMap<u16, Vec<(u64, u64)>>,
}

/// The content of a record.
#[derive(Default)]
struct Content(Vec<u8>);

impl Content {
    fn u16(mut self, value: u16) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn u32(mut self, value: u32) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn u64(mut self, value: u64) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn text(self, text: &str) -> Self {
        self.sized(text.as_bytes())
    }

    /// With its length before it.
    fn sized(mut self, bytes: &[u8]) -> Self {
        self = self.u32(bytes.len() as u32);
        self.0.extend(bytes);
        self
    }

    /// Ends a record.
    fn record(self, opcode: u8, out: &mut Vec<u8>) {
        out.push(opcode);
        out.extend((self.0.len() as u64).to_le_bytes());
        out.extend(self.0);
    }
}

impl McapFile {
    pub(super) fn new(profile: &str, library: &str) -> Self {
        let mut bytes = MAGIC.to_vec();
        Content::default().text(profile).text(library).record(opcode::HEADER, &mut bytes);
        Self {
            bytes,
            chunk: Chunk::default(),
            chunks: Vec::new(),
            chunk_count: 0,
            schemas: Vec::new(),
            schema_count: 0,
            channels: Vec::new(),
            counts: BTreeMap::new(),
            span: None,
        }
    }

    /// Adds the definition of a type; gives its number.
    pub(super) fn schema(&mut self, name: &str, encoding: &str, definition: &str) -> u16 {
        self.schema_count += 1;
        let content = || Content::default().u16(self.schema_count).text(name).text(encoding).text(definition);
        content().record(opcode::SCHEMA, &mut self.chunk.records);
        content().record(opcode::SCHEMA, &mut self.schemas);
        self.schema_count
    }

    /// Adds a topic of messages of a type; gives its number.
    pub(super) fn channel(&mut self, schema: u16, topic: &str, encoding: &str) -> u16 {
        let number = self.counts.len() as u16;
        let content = || Content::default().u16(number).u16(schema).text(topic).text(encoding).sized(&[]);
        content().record(opcode::CHANNEL, &mut self.chunk.records);
        content().record(opcode::CHANNEL, &mut self.channels);
        self.counts.insert(number, 0);
        number
    }

    /// Adds a message; its time is in ns.
    pub(super) fn message(&mut self, channel: u16, time: u64, data: &[u8]) {
        let count = self.counts.entry(channel).or_default();
        *count += 1;
        let (first, last) = self.span.unwrap_or((time, time));
        self.span = Some((first.min(time), last.max(time)));
        self.chunk.index.entry(channel).or_default().push((time, self.chunk.records.len() as u64));
        let mut content = Content::default().u16(channel).u32(*count as u32).u64(time).u64(time);
        content.0.extend(data);
        content.record(opcode::MESSAGE, &mut self.chunk.records);
        if self.chunk.records.len() >= CHUNK {
            self.close();
        }
    }

    /// Writes the chunk that waits, with its indexes.
    fn close(&mut self) {
        let Chunk { records, index } = std::mem::take(&mut self.chunk);
        if records.is_empty() {
            return;
        }
        let times = || index.values().flatten().map(|(time, _)| *time);
        let (start, end) = (times().min().unwrap_or(0), times().max().unwrap_or(0));
        let size = records.len() as u64;
        let chunk_start = self.bytes.len() as u64;
        // A checksum of 0 says that there is none.
        let mut content = Content::default().u64(start).u64(end).u64(size).u32(0).text("").u64(size);
        content.0.extend(records);
        content.record(opcode::CHUNK, &mut self.bytes);
        let chunk_length = self.bytes.len() as u64 - chunk_start;
        let index_start = self.bytes.len() as u64;
        let mut offsets = Content::default();
        for (channel, places) in &index {
            offsets = offsets.u16(*channel).u64(self.bytes.len() as u64);
            let places = places.iter().fold(Content::default(), |content, (time, at)| content.u64(*time).u64(*at));
            Content::default().u16(*channel).sized(&places.0).record(opcode::MESSAGE_INDEX, &mut self.bytes);
        }
        Content::default()
            .u64(start)
            .u64(end)
            .u64(chunk_start)
            .u64(chunk_length)
            .sized(&offsets.0)
            .u64(self.bytes.len() as u64 - index_start)
            .text("")
            .u64(size)
            .u64(size)
            .record(opcode::CHUNK_INDEX, &mut self.chunks);
        self.chunk_count += 1;
    }

    /// The whole file.
    pub(super) fn finish(mut self) -> Vec<u8> {
        self.close();
        Content::default().u32(0).record(opcode::DATA_END, &mut self.bytes);
        let (start, end) = self.span.unwrap_or((0, 0));
        let counts =
            self.counts.iter().fold(Content::default(), |content, (channel, count)| content.u16(*channel).u64(*count));
        let mut statistics = Vec::new();
        Content::default()
            .u64(self.counts.values().sum())
            .u16(self.schema_count)
            .u32(self.counts.len() as u32)
            .u32(0)
            .u32(0)
            .u32(self.chunk_count)
            .u64(start)
            .u64(end)
            .sized(&counts.0)
            .record(opcode::STATISTICS, &mut statistics);
        let summary = self.bytes.len() as u64;
        let mut groups = Vec::new();
        for (opcode, records) in [
            (opcode::SCHEMA, &self.schemas),
            (opcode::CHANNEL, &self.channels),
            (opcode::STATISTICS, &statistics),
            (opcode::CHUNK_INDEX, &self.chunks),
        ] {
            if !records.is_empty() {
                let group = Content(vec![opcode]).u64(self.bytes.len() as u64).u64(records.len() as u64);
                group.record(opcode::SUMMARY_OFFSET, &mut groups);
                self.bytes.extend(records);
            }
        }
        let offsets = self.bytes.len() as u64;
        self.bytes.extend(groups);
        Content::default().u64(summary).u64(offsets).u32(0).record(opcode::FOOTER, &mut self.bytes);
        self.bytes.extend(MAGIC);
        self.bytes
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    fn number(bytes: &[u8]) -> u64 {
        bytes.iter().rev().fold(0, |value, byte| value << 8 | u64::from(*byte))
    }

    fn sized(bytes: &[u8]) -> (&[u8], &[u8]) {
        let (length, rest) = bytes.split_at(4);
        rest.split_at(number(length) as usize)
    }

    /// Records one after the other: opcode and content.
    fn records(mut bytes: &[u8]) -> Vec<(u8, &[u8])> {
        let mut found = Vec::new();
        while let [opcode, rest @ ..] = bytes {
            let (length, rest) = rest.split_at(8);
            let (content, rest) = rest.split_at(number(length) as usize);
            found.push((*opcode, content));
            bytes = rest;
        }
        found
    }

    /// The record at a place.
    fn record(bytes: &[u8]) -> (u8, &[u8]) {
        (bytes[0], &bytes[9..9 + number(&bytes[1..9]) as usize])
    }

    fn text(bytes: &[u8]) -> String {
        String::from_utf8(bytes.to_vec()).expect("text")
    }

    /// A slow, obvious reader: topic, type and time of every message, by walking over the file from its beginning.
    pub(in super::super) fn read(file: &[u8]) -> Vec<(String, String, u64)> {
        let inner = file.strip_prefix(&MAGIC).and_then(|file| file.strip_suffix(&MAGIC)).expect("magic at both ends");
        let (mut schemas, mut channels) = (BTreeMap::new(), BTreeMap::new());
        let mut found = Vec::new();
        for (_, chunk) in records(inner).into_iter().filter(|(opcode, _)| *opcode == opcode::CHUNK) {
            let size = number(&chunk[16..24]) as usize;
            for (opcode, content) in records(&chunk[chunk.len() - size..]) {
                match opcode {
                    opcode::SCHEMA => drop(schemas.insert(number(&content[..2]), text(sized(&content[2..]).0))),
                    opcode::CHANNEL => {
                        let topic = text(sized(&content[4..]).0);
                        channels.insert(number(&content[..2]), (topic, schemas[&number(&content[2..4])].clone()));
                    }
                    _ => {
                        let (topic, name) = channels[&number(&content[..2])].clone();
                        found.push((topic, name, number(&content[6..14])));
                    }
                }
            }
        }
        found
    }

    #[test]
    fn indexes_lead_to_the_messages() {
        let mut file = McapFile::new("ros2", "test");
        let schema = file.schema("a/msg/B", "ros2msg", "uint8 x\n");
        let channels = [file.channel(schema, "/one", "cdr"), file.channel(schema, "/two", "cdr")];
        for k in 0..600u64 {
            file.message(channels[k as usize % 2], 1000 + k, &vec![k as u8; 9000]);
        }
        let bytes = file.finish();
        let footer = &bytes[bytes.len() - 8 - 20..bytes.len() - 8];
        let (summary, offsets) = (number(&footer[..8]) as usize, number(&footer[8..16]) as usize);
        let groups = records(&bytes[summary..offsets]);
        let opcodes: Vec<u8> = groups.iter().map(|(opcode, _)| *opcode).collect();
        assert_eq!(opcodes[..4], [opcode::SCHEMA, opcode::CHANNEL, opcode::CHANNEL, opcode::STATISTICS]);
        assert_eq!(number(&groups[3].1[..8]), 600);
        assert!(opcodes[4..].len() > 4 && opcodes[4..].iter().all(|opcode| *opcode == opcode::CHUNK_INDEX));
        let mut times = Vec::new();
        for (_, index) in &groups[4..] {
            let (start, length) = (number(&index[16..24]) as usize, number(&index[24..32]) as usize);
            let chunk = record(&bytes[start..start + length]).1;
            let size = number(&chunk[16..24]) as usize;
            let inside = &chunk[chunk.len() - size..];
            let (map, _) = sized(&index[32..]);
            for entry in map.chunks(10) {
                let at = number(&entry[2..]) as usize;
                let (opcode, content) = record(&bytes[at..]);
                assert_eq!((opcode, &content[..2]), (opcode::MESSAGE_INDEX, &entry[..2]));
                for place in sized(&content[2..]).0.chunks(16) {
                    let (opcode, message) = record(&inside[number(&place[8..]) as usize..]);
                    assert_eq!((opcode, number(&message[6..14])), (opcode::MESSAGE, number(&place[..8])));
                    assert_eq!(message[..2], entry[..2]);
                    times.push(number(&place[..8]));
                }
            }
        }
        times.sort_unstable();
        assert_eq!(times, (1000..1600).collect::<Vec<u64>>());
        assert_eq!(read(&bytes).len(), 600);
    }

    #[test]
    fn nothing_is_a_file_too() {
        assert!(read(&McapFile::new("ros2", "test").finish()).is_empty());
    }
}
