//! The three containers behind one interface.

pub(crate) mod bag1;
pub(crate) mod db3;
pub(crate) mod mcap;
mod stepped;
mod tape;

use std::io::{Read, Seek};

use crate::damage::Damage;
use crate::record::{Record, Topic};

/// Which topics' bytes are wanted.
pub(crate) type Wanted = Box<dyn Fn(&Topic) -> bool + Send>;

/// A file in which every place can be read.
pub(crate) trait Source: Read + Seek + Send {}

impl<T: Read + Seek + Send> Source for T {}

/// A file of messages, read from its beginning.
pub(crate) trait Container: Send {
    /// The next message or damage; none at the end, and behind a [`Loss::Rest`](crate::Loss::Rest).
    fn next(&mut self) -> Option<Result<Record, Damage>>;
}
