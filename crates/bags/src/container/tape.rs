//! A file that is read forwards, with the place that reading has come to.

use std::io::{self, BufReader, Read};
use std::sync::Arc;

use crate::MOST_BYTES;
use crate::damage::{Damage, Loss};

/// A source that counts its bytes.
pub(super) struct Tape {
    file: Arc<str>,
    source: BufReader<Box<dyn Read + Send>>,
    at: u64,
}

impl Tape {
    pub(super) fn new(file: &Arc<str>, source: Box<dyn Read + Send>) -> Self {
        Self { file: Arc::clone(file), source: BufReader::with_capacity(1 << 16, source), at: 0 }
    }

    /// Bytes that were read or passed over.
    pub(super) fn at(&self) -> u64 {
        self.at
    }

    pub(super) fn damage(&self, offset: u64, reason: impl Into<String>, loss: Loss) -> Damage {
        Damage { file: Arc::clone(&self.file), offset, reason: reason.into(), loss }
    }

    /// So many bytes; fewer at the end of the file. Grows by what is there.
    pub(super) fn take(&mut self, count: u64) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::with_capacity(count.min(1 << 16) as usize);
        let outcome = self.source.by_ref().take(count.min(MOST_BYTES)).read_to_end(&mut bytes);
        self.at += bytes.len() as u64;
        outcome.map(|_| bytes)
    }

    /// Passes over so many bytes; gives how many were there.
    pub(super) fn pass(&mut self, count: u64) -> io::Result<u64> {
        let passed = io::copy(&mut self.source.by_ref().take(count), &mut io::sink())?;
        self.at += passed;
        Ok(passed)
    }

    /// So many bytes; at the end of the file those that are there, with the damage that begins at `from`.
    pub(super) fn up_to(&mut self, count: u64, from: u64, what: &str) -> Result<(Vec<u8>, Option<Damage>), Damage> {
        if count > MOST_BYTES {
            return self.exactly(count, from, what).map(|bytes| (bytes, None));
        }
        match self.take(count) {
            Ok(bytes) if (bytes.len() as u64) < count => {
                let reason = format!("the file ends within {what}, after {} of its {count} bytes", bytes.len());
                Ok((bytes, Some(self.damage(from, reason, Loss::Rest))))
            }
            Ok(bytes) => Ok((bytes, None)),
            Err(error) => Err(self.damage(from, format!("cannot be read: {error}"), Loss::Rest)),
        }
    }

    /// So many bytes, or why there are none: the damage begins at `from`.
    pub(super) fn exactly(&mut self, count: u64, from: u64, what: &str) -> Result<Vec<u8>, Damage> {
        if count > MOST_BYTES {
            let reason = format!("{what} claims {count} bytes, more than the {MOST_BYTES} that any has");
            return Err(self.damage(from, reason, Loss::Rest));
        }
        match self.take(count) {
            Ok(bytes) if bytes.len() as u64 == count => Ok(bytes),
            Ok(bytes) => {
                let reason = format!("the file ends within {what}, after {} of its {count} bytes", bytes.len());
                Err(self.damage(from, reason, Loss::Rest))
            }
            Err(error) => Err(self.damage(from, format!("cannot be read: {error}"), Loss::Rest)),
        }
    }
}
