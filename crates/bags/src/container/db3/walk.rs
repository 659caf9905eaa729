//! A table, row after row: the leaves of its tree from left to right.

use super::pages::{HEAD, Pages, u16_at, u32_at};
use super::row::varint;

/// Trees of tables are not deeper: a tree of 20 levels has more rows than a file can hold.
const DEEPEST: usize = 20;

const LEAF: u8 = 0x0d;
const INTERIOR: u8 = 0x05;

/// A row, of which the first part stands here.
pub(super) struct Cell {
    pub(super) row: i64,
    /// Bytes of the whole payload.
    pub(super) length: u64,
    pub(super) local: Vec<u8>,
    /// The page on which it goes on; 0 where it is whole.
    pub(super) overflow: u32,
    /// Where its page begins, bytes.
    pub(super) offset: u64,
}

/// The way through a tree.
pub(super) struct Walk {
    /// Pages from the root on, each with the child or row that comes next.
    path: Vec<(u32, Vec<u8>, usize)>,
    /// The page to go down to.
    next: Option<u32>,
    visited: u64,
}

/// Where a page is damaged, and why.
pub(super) type Fault = (u64, String);

impl Walk {
    /// From the root of a table on.
    pub(super) fn of(root: u32) -> Self {
        Self { path: Vec::new(), next: Some(root), visited: 0 }
    }

    /// The next row, or a page that cannot be read, with all below it.
    pub(super) fn next(&mut self, pages: &mut Pages) -> Option<Result<Cell, Fault>> {
        loop {
            if let Some(page) = self.next.take()
                && let Err(reason) = self.enter(page, pages)
            {
                return Some(Err((pages.offset(page), reason)));
            }
            let (number, page, at) = self.path.last_mut()?;
            let (start, offset) = (start_of(*number), pages.offset(*number));
            let (is_leaf, count) = (page[start] == LEAF, usize::from(u16_at(page, start + 3).unwrap_or(0)));
            let here = *at;
            *at += 1;
            if is_leaf && here < count {
                return Some(cell(page, start, here, pages.usable, offset).ok_or_else(|| {
                    (offset, format!("row {} of {count} on page {number} does not fit on it", here + 1))
                }));
            }
            if is_leaf || here > count {
                self.path.pop();
                continue;
            }
            let child = if here == count {
                u32_at(page, start + 8)
            } else {
                let place = u16_at(page, start + 12 + 2 * here).map(usize::from);
                place.and_then(|place| u32_at(page, place))
            };
            match child {
                Some(child) => self.next = Some(child),
                None => return Some(Err((offset, format!("page {number} is damaged")))),
            }
        }
    }

    fn enter(&mut self, number: u32, pages: &mut Pages) -> Result<(), String> {
        self.visited += 1;
        if self.path.len() >= DEEPEST || self.visited > u64::from(pages.count) {
            self.path.clear();
            return Err(format!("page {number} comes again: the tree of the table is damaged"));
        }
        let page = pages.page(number)?;
        match page[start_of(number)] {
            LEAF | INTERIOR => {
                self.path.push((number, page, 0));
                Ok(())
            }
            kind => Err(format!("page {number} is damaged: it has the kind {kind}, not that of a table")),
        }
    }
}

/// Where the head of a page stands.
fn start_of(page: u32) -> usize {
    if page == 1 { HEAD } else { 0 }
}

/// A row of a leaf: length, number, the part of the payload that stands on the page, and where it goes on.
fn cell(page: &[u8], start: usize, index: usize, usable: usize, offset: u64) -> Option<Cell> {
    let place = usize::from(u16_at(page, start + 8 + 2 * index)?);
    let (length, place) = varint(page, place)?;
    let (row, place) = varint(page, place)?;
    let length = u64::try_from(length).ok()?;
    let most = usable - 35;
    let local = if length <= most as u64 {
        length as usize
    } else {
        let least = (usable - 12) * 32 / 255 - 23;
        let local = least + ((length - least as u64) % (usable as u64 - 4)) as usize;
        if local <= most { local } else { least }
    };
    let bytes = page.get(..usable)?.get(place..)?.get(..local)?.to_vec();
    let overflow = if local as u64 == length { 0 } else { u32_at(page, place + local)? };
    Some(Cell { row, length, local: bytes, overflow, offset })
}
