//! Containers that are read record by record, of which one may hold many messages or none.

use std::collections::VecDeque;

use super::Container;
use super::tape::Tape;
use crate::damage::{Damage, Loss};
use crate::record::Record;

/// What waits to be given.
pub(super) type Waiting = VecDeque<Result<Record, Damage>>;

/// What such a container keeps.
pub(super) struct Parts<'a> {
    pub(super) tape: &'a Tape,
    pub(super) waiting: &'a mut Waiting,
    /// Whether nothing more is read.
    pub(super) ended: &'a mut bool,
}

/// A container that is read record by record.
pub(super) trait Stepped: Send {
    /// What it keeps.
    fn parts(&mut self) -> Parts<'_>;

    /// Reads the next record and gives what it holds, or says what is damaged: a chunk alone, or all from there on.
    fn step(&mut self) -> Result<(), Damage>;

    /// Gives a message, or says why there is none in the record that begins at `from`.
    fn give(&mut self, record: Result<Record, String>, from: u64) {
        let Parts { tape, waiting, .. } = self.parts();
        waiting.push_back(record.map_err(|reason| tape.damage(from, reason, Loss::Message)));
    }
}

impl<T: Stepped> Container for T {
    fn next(&mut self) -> Option<Result<Record, Damage>> {
        loop {
            let Parts { waiting, ended, .. } = self.parts();
            if let Some(item) = waiting.pop_front() {
                return Some(item);
            }
            if *ended {
                return None;
            }
            if let Err(damage) = self.step() {
                let Parts { waiting, ended, .. } = self.parts();
                *ended = damage.loss != Loss::Chunk;
                waiting.push_back(Err(damage));
            }
        }
    }
}
