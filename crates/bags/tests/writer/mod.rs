//! Writes tiny bags and messages, for tests alone: what the readers read, written by other code than theirs.

#![allow(dead_code, reason = "every test uses a part of it")]

pub(crate) mod bag1;
pub(crate) mod db3;
pub(crate) mod mcap;
pub(crate) mod message;

/// A message to be written: topic, type, time (ns) and bytes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Message {
    pub(crate) topic: &'static str,
    pub(crate) kind: &'static str,
    pub(crate) time_ns: u64,
    pub(crate) bytes: Vec<u8>,
}

/// How a chunk is compressed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Packing {
    None,
    Bz2,
    Lz4,
    Zstd,
}

impl Packing {
    pub(crate) fn name(self, none: &'static str) -> &'static str {
        match self {
            Self::None => none,
            Self::Bz2 => "bz2",
            Self::Lz4 => "lz4",
            Self::Zstd => "zstd",
        }
    }

    pub(crate) fn pack(self, bytes: &[u8]) -> Vec<u8> {
        use std::io::Write;
        match self {
            Self::None => bytes.to_vec(),
            Self::Bz2 => {
                let mut encoder = bzip2::write::BzEncoder::new(Vec::new(), bzip2::Compression::fast());
                encoder.write_all(bytes).expect("memory");
                encoder.finish().expect("memory")
            }
            Self::Lz4 => {
                let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
                encoder.write_all(bytes).expect("memory");
                encoder.finish().expect("memory")
            }
            Self::Zstd => ruzstd::encoding::compress_to_vec(bytes, ruzstd::encoding::CompressionLevel::Fastest),
        }
    }
}

/// The numbers of the topics, in the order in which they come.
pub(crate) fn topics(messages: &[Message]) -> Vec<(&'static str, &'static str)> {
    let mut all = Vec::new();
    for message in messages {
        if !all.contains(&(message.topic, message.kind)) {
            all.push((message.topic, message.kind));
        }
    }
    all
}
