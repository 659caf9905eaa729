//! What cannot be read of a bag.

use std::fmt;
use std::sync::Arc;

/// A part of a bag that cannot be read. Its [`Display`](fmt::Display) is one line: file, offset, reason, and what was lost.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Damage {
    /// The file.
    pub file: Arc<str>,
    /// Where the damaged part begins, bytes from the start of the file.
    pub offset: u64,
    /// What is wrong with it.
    pub reason: String,
    /// How much of the file is lost with it.
    pub loss: Loss,
}

/// How much is lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loss {
    /// One message.
    Message,
    /// A chunk of messages, or a page of a database.
    Chunk,
    /// Everything from here on.
    Rest,
    /// No message: the index alone.
    Index,
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, offset, reason, loss } = self;
        let lost = match loss {
            Loss::Message => "the message is skipped",
            Loss::Chunk => "its messages are skipped",
            Loss::Rest => "what stands before was read",
            Loss::Index => "its messages are read without it",
        };
        write!(f, "{file}, byte {offset}: {reason}; {lost}")
    }
}
