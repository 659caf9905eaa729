//! What the rays of a scan say, summed over rays: the moments of [`crate::Moments`] where the scan touched the map.

use std::sync::atomic::AtomicU32;
use std::sync::atomic::Ordering::Relaxed;

use sensor::lanes::Lanes;

use super::Cell;

/// What rays say of a cell, and of the edges to its right and upper neighbour.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Entry {
    /// Sum of `P(E)` over the pairs of cells that rays ran along, each of which says it once.
    pub(super) occupied: f64,
    /// Sums of the probability that the cell and its right, or upper, neighbour differ ...
    pub(super) differ: [f64; 2],
    /// ... and over how many rays.
    pub(super) rays: [u32; 2],
    /// How many pairs.
    pub(super) pairs: u32,
    /// The edges that a ray ran along: to the [`RIGHT`], [`ABOVE`], to the [`LEFT`], [`BELOW`].
    pub(super) edges: u32,
}

/// An edge of a cell.
pub(super) const RIGHT: u32 = 1;
/// An edge of a cell.
pub(super) const ABOVE: u32 = 2;
/// An edge of a cell.
pub(super) const LEFT: u32 = 4;
/// An edge of a cell.
pub(super) const BELOW: u32 = 8;

/// The entries of the cells that were touched. Sums are exact, so that they do not depend on the order of the rays,
/// up to 131,072 rays through a cell.
pub(super) struct Tally {
    /// Number of the entry of every cell, 0 where it has none; none where the map holds them, see [`Cell`].
    slots: Option<Vec<AtomicU32>>,
    /// Entry 0 is that of no cell. Those from [`used`](Self::used) on are empty.
    entries: Vec<Entry>,
    /// The cell of each entry.
    cells: Vec<u32>,
    used: usize,
}

/// Adding and taking away this rounds to a multiple of 2^-36.
const ROUND: f64 = 98_304.0; // 1.5 * 2^16

/// A probability as it is summed: a multiple of 2^-36.
#[inline(always)]
pub(super) fn rounded(probability: &Lanes<f32>) -> Lanes<f64> {
    std::array::from_fn(|l| (f64::from(probability[l]) + ROUND) - ROUND)
}

impl Tally {
    /// Nothing said, and its numbers in the map.
    pub(super) fn first() -> Self {
        Self { slots: None, entries: vec![Entry::default()], cells: vec![0], used: 1 }
    }

    /// Nothing said, and numbers of its own for so many cells.
    pub(super) fn further(cells: usize) -> Self {
        Self { slots: Some((0..cells).map(|_| AtomicU32::new(0)).collect()), ..Self::first() }
    }

    /// Makes room for so many more entries.
    pub(super) fn reserve(&mut self, entries: usize) {
        let needed = self.used + entries + 1;
        if self.entries.len() < needed {
            let more = needed + needed / 8 - self.entries.len();
            self.entries.reserve_exact(more);
            self.entries.resize(self.entries.len() + more, Entry::default());
            self.cells.reserve_exact(more);
            self.cells.resize(self.entries.len(), 0);
        }
    }

    #[inline(always)]
    fn number<'a>(&'a self, map: &'a [Cell], cell: usize) -> &'a AtomicU32 {
        match &self.slots {
            None => &map[cell].slot,
            Some(slots) => &slots[cell],
        }
    }

    /// The entry of a cell, made if there is none; room must be [`reserve`](Self::reserve)d.
    #[inline(always)]
    pub(super) fn entry(&mut self, map: &[Cell], cell: u32) -> usize {
        let number = self.number(map, cell as usize);
        let slot = number.load(Relaxed);
        let fresh = slot == 0;
        let entry = if fresh { self.used } else { slot as usize };
        number.store(entry as u32, Relaxed);
        self.cells[entry] = cell;
        self.used += usize::from(fresh);
        entry
    }

    /// A pair of neighbours that a ray runs along, `low` the entry of the left or lower one: they differ with the given
    /// probability.
    #[inline(always)]
    pub(super) fn pair(&mut self, low: usize, high: usize, axis: usize, differ: f64) {
        let entry = &mut self.entries[low];
        entry.differ[axis] += differ;
        entry.rays[axis] += 1;
        entry.edges |= RIGHT << axis;
        self.entries[high].edges |= LEFT << axis;
    }

    /// A cell that is in so many pairs of a ray.
    #[inline(always)]
    pub(super) fn cell_of(&mut self, entry: usize, pairs: u32, occupied: f64) {
        let entry = &mut self.entries[entry];
        entry.occupied += occupied * f64::from(pairs);
        entry.pairs += pairs;
    }

    #[inline(always)]
    pub(super) fn at(&mut self, entry: usize) -> &mut Entry {
        &mut self.entries[entry]
    }

    /// The entry with the given number.
    pub(super) fn get(&self, entry: usize) -> &Entry {
        &self.entries[entry]
    }

    /// Every entry's number and cell.
    pub(super) fn touched(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.cells[1..self.used].iter().enumerate().map(|(k, cell)| (k + 1, *cell as usize))
    }

    /// Number of entries.
    pub(super) fn len(&self) -> usize {
        self.used - 1
    }

    /// The cell of an entry.
    pub(super) fn cell(&self, entry: usize) -> usize {
        self.cells[entry] as usize
    }

    /// Takes over what another tally holds, and empties it.
    pub(super) fn take(&mut self, other: &mut Self, map: &[Cell]) {
        self.reserve(other.len());
        for k in 1..other.used {
            let from = other.entries[k];
            let number = self.entry(map, other.cells[k]);
            let entry = &mut self.entries[number];
            entry.occupied += from.occupied;
            entry.pairs += from.pairs;
            entry.edges |= from.edges;
            for axis in 0..2 {
                entry.differ[axis] += from.differ[axis];
                entry.rays[axis] += from.rays[axis];
            }
        }
        other.clear(map);
    }

    /// Forgets everything, at the cost of what was touched.
    pub(super) fn clear(&mut self, map: &[Cell]) {
        for cell in &self.cells[1..self.used] {
            self.number(map, *cell as usize).store(0, Relaxed);
        }
        self.entries[1..self.used].fill(Entry::default());
        self.used = 1;
    }

    /// Memory held, bytes.
    pub(super) fn bytes(&self) -> usize {
        4 * (self.slots.as_ref().map_or(0, Vec::capacity) + self.cells.capacity())
            + size_of::<Entry>() * self.entries.capacity()
    }
}
