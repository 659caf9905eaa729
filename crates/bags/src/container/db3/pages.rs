//! The pages of a database, and what a writer that was stopped left beside it.

use std::collections::HashMap;
use std::io::{Read, SeekFrom};

use super::walk::Cell;
use crate::MOST_BYTES;
use crate::container::Source;

/// What a database begins with.
pub(crate) const MAGIC: &[u8] = b"SQLite format 3\0";

/// Size of the head of the database, which stands on its first page, bytes.
pub(super) const HEAD: usize = 100;

/// What a write-ahead log begins with; the last bit says how its checksums are made.
const AHEAD: [u32; 2] = [0x377f_0682, 0x377f_0683];

/// Pages by their number, from 1.
pub(crate) struct Pages {
    source: Box<dyn Source>,
    size: usize,
    /// Bytes of a page that hold content.
    pub(super) usable: usize,
    /// Number of pages that are there.
    pub(super) count: u32,
    /// Pages that are newer in the write-ahead log, and where they begin in it.
    ahead: Vec<u8>,
    newer: HashMap<u32, usize>,
}

impl Pages {
    /// # Errors
    /// What is no database by its head.
    pub(crate) fn new(mut source: Box<dyn Source>, ahead: Option<Vec<u8>>) -> Result<Self, String> {
        let unreadable = |error: std::io::Error| format!("cannot be read: {error}");
        let mut head = Vec::new();
        source.seek(SeekFrom::Start(0)).map_err(unreadable)?;
        source.by_ref().take(HEAD as u64).read_to_end(&mut head).map_err(unreadable)?;
        if head.len() < HEAD || !head.starts_with(MAGIC) {
            return Err("is no SQLite database, or one that is cut within its head; get a whole copy".to_owned());
        }
        let size = match u16_at(&head, 16) {
            Some(1) => 1 << 16,
            Some(size) if size >= 512 && size.is_power_of_two() => usize::from(size),
            size => return Err(format!("its head claims pages of {} bytes; get a whole copy", size.unwrap_or(0))),
        };
        let usable = size - usize::from(head[20]);
        if usable < 480 {
            return Err(format!("its head leaves {usable} bytes of a page, fewer than 480; get a whole copy"));
        }
        let end = source.seek(SeekFrom::End(0)).map_err(unreadable)?;
        let ahead = ahead.unwrap_or_default();
        let newer = newer(&ahead, size);
        let whole = u32::try_from(end.div_ceil(size as u64)).unwrap_or(u32::MAX);
        let count = newer.keys().copied().fold(whole, u32::max);
        Ok(Self { source, size, usable, count, ahead, newer })
    }

    /// Where a page begins, bytes.
    pub(super) fn offset(&self, page: u32) -> u64 {
        u64::from(page.saturating_sub(1)) * self.size as u64
    }

    /// A page.
    pub(super) fn page(&mut self, page: u32) -> Result<Vec<u8>, String> {
        if page == 0 || page > self.count {
            return Err(format!("page {page} is not there: the file has {} pages", self.count));
        }
        if let Some(at) = self.newer.get(&page) {
            return Ok(self.ahead[*at..*at + self.size].to_vec());
        }
        let mut bytes = Vec::with_capacity(self.size);
        let start = self.offset(page);
        let read = self.source.seek(SeekFrom::Start(start));
        let read = read.and_then(|_| self.source.by_ref().take(self.size as u64).read_to_end(&mut bytes));
        read.map_err(|error| format!("page {page} cannot be read: {error}"))?;
        if bytes.len() < self.size {
            return Err(format!("the file ends within page {page}"));
        }
        Ok(bytes)
    }

    /// The whole payload of a cell: what stands on its page, and on pages of overflow.
    pub(super) fn payload(&mut self, cell: &Cell) -> Result<Vec<u8>, String> {
        if cell.length > MOST_BYTES {
            return Err(format!("a row claims {} bytes, more than the {MOST_BYTES} that any has", cell.length));
        }
        let mut payload = cell.local.clone();
        let mut next = cell.overflow;
        while (payload.len() as u64) < cell.length {
            let page = self.page(next)?;
            next = u32_at(&page, 0).unwrap_or(0);
            let left = cell.length as usize - payload.len();
            payload.extend_from_slice(&page[4..self.usable.min(4 + left)]);
        }
        Ok(payload)
    }
}

/// Places of the newest pages in a write-ahead log, up to its last commit.
fn newer(log: &[u8], size: usize) -> HashMap<u32, usize> {
    let mut committed = HashMap::new();
    let fits = u32_at(log, 0).is_some_and(|magic| AHEAD.contains(&magic)) && u32_at(log, 8) == u32::try_from(size).ok();
    let Some(salts) = log.get(16..24).filter(|_| fits) else { return committed };
    let mut open = HashMap::new();
    for (number, frame) in log[32.min(log.len())..].chunks_exact(24 + size).enumerate() {
        if &frame[8..16] != salts {
            break; // of an older log, over which this one is written
        }
        open.insert(u32_at(frame, 0).unwrap_or(0), 32 + number * (24 + size) + 24);
        if u32_at(frame, 4) != Some(0) {
            committed.extend(open.drain());
        }
    }
    committed
}

/// The write-ahead log beside a database, if it is not too long to be one.
pub(crate) fn write_ahead(database: &std::path::Path) -> Option<Vec<u8>> {
    let mut name = database.as_os_str().to_owned();
    name.push("-wal");
    let file = std::fs::File::open(name).ok()?;
    let mut bytes = Vec::new();
    file.take(MOST_BYTES).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}

pub(super) fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_be_bytes(*bytes.get(at..)?.first_chunk()?))
}

pub(super) fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_be_bytes(*bytes.get(at..)?.first_chunk()?))
}
