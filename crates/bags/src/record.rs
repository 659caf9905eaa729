//! What a bag gives: messages with their topics.

use std::ops::{Deref, Range};
use std::sync::Arc;

/// How the messages of a topic are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// The serialisation of ROS 1: little-endian, without padding.
    Ros1,
    /// The common data representation of ROS 2, whose header says which end comes first.
    Cdr,
    /// Another one, such as JSON or protobuf, which is not decoded.
    Other,
}

/// A topic of a bag.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Topic {
    /// Its name, such as `/scan`.
    pub name: String,
    /// The type of its messages as package and name, such as `sensor_msgs/LaserScan`: the `msg/` of ROS 2 is left out.
    pub kind: String,
    /// How they are written.
    pub encoding: Encoding,
}

impl Topic {
    /// A topic; `kind` is as either ROS writes it.
    pub(crate) fn new(name: &str, kind: &str, encoding: Encoding) -> Self {
        Self { name: plain(name), kind: plain(&kind.replacen("/msg/", "/", 1)), encoding }
    }
}

/// Names of ROS are shorter, characters.
const LONGEST_NAME: usize = 100;

/// A name as messages quote it: of bounded length and without control characters, which no name of ROS has.
pub(crate) fn plain(name: &str) -> String {
    let letters = name.chars().map(|letter| if letter.is_control() { char::REPLACEMENT_CHARACTER } else { letter });
    letters.take(LONGEST_NAME).collect()
}

/// A message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Record {
    /// Its topic.
    pub topic: Arc<Topic>,
    /// When it was recorded, ns by the recorder's clock.
    pub time_ns: u64,
    /// The message as it was written; may be empty where the topic is not wanted.
    pub bytes: Bytes,
}

/// Bytes that share the chunk in which they stand.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Bytes {
    chunk: Arc<Vec<u8>>,
    range: Range<usize>,
}

impl Bytes {
    /// A part of a chunk; empty where the chunk does not have it.
    pub(crate) fn of(chunk: &Arc<Vec<u8>>, range: Range<usize>) -> Self {
        let range = if chunk.get(range.clone()).is_some() { range } else { 0..0 };
        Self { chunk: Arc::clone(chunk), range }
    }
}

impl From<Vec<u8>> for Bytes {
    fn from(bytes: Vec<u8>) -> Self {
        let range = 0..bytes.len();
        Self { chunk: Arc::new(bytes), range }
    }
}

impl Deref for Bytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.chunk[self.range.clone()]
    }
}
