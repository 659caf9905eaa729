//! The posteriors of a scan, summed over its rays: the moments of [`crate::Moments`] where the scan touched the map.

use sensor::lanes::{LANES, Lanes};

use crate::fast::tiles::{Numbering, PATCH, TILE};
use crate::memory::Held;

/// Sums over the rays through a cell, and along the edges to its right and upper neighbour: 32 bytes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Entry {
    /// Sum of `P(E)` over the pairs of cells that rays ran along, once for each.
    pub(super) occupied: f64,
    /// Sums of the probability that the cell and its right, or upper, neighbour differ.
    pub(super) differ: [f64; 2],
    /// From the lowest bit on, 20 bits each: over how many rays those sums are, and over how many pairs that of `P(E)`;
    /// in the last 4 the edges.
    counts: u64,
}

const COUNT: u64 = (1 << 20) - 1;

/// An edge of a cell.
pub(super) const RIGHT: u32 = 1;
/// An edge of a cell.
pub(super) const ABOVE: u32 = 2;
/// An edge of a cell.
pub(super) const LEFT: u32 = 4;
/// An edge of a cell.
pub(super) const BELOW: u32 = 8;

impl Entry {
    /// How many rays ran along the edge to the right (0) or upper (1) neighbour.
    #[inline(always)]
    pub(super) fn rays(&self, axis: usize) -> u32 {
        ((self.counts >> (20 * axis)) & COUNT) as u32
    }

    /// In how many pairs of rays the cell is; 0 of a cell that was not touched.
    #[inline(always)]
    pub(super) fn pairs(&self) -> u32 {
        ((self.counts >> 40) & COUNT) as u32
    }

    /// The edges that a ray ran along: to the [`RIGHT`], [`ABOVE`], to the [`LEFT`], [`BELOW`].
    #[inline(always)]
    pub(super) fn edges(&self) -> u32 {
        (self.counts >> 60) as u32
    }

    /// A ray ran along an edge.
    #[inline(always)]
    pub(super) fn mark(&mut self, edge: u32) {
        self.counts |= u64::from(edge) << 60;
    }

    /// A ray ran along the edge to the right (0) or upper (1) neighbour: they differ with the given probability.
    #[inline(always)]
    pub(super) fn add_differ(&mut self, axis: usize, differ: f64) {
        self.differ[axis] += differ;
        self.counts += 1 << (20 * axis);
        self.mark(RIGHT << axis);
    }

    fn add(&mut self, other: &Self) {
        let edges = COUNT << 60;
        self.occupied += other.occupied;
        self.differ[0] += other.differ[0];
        self.differ[1] += other.differ[1];
        self.counts = ((self.counts & !edges) + (other.counts & !edges)) | ((self.counts | other.counts) & edges);
    }
}

/// A cell's patch, and its place in it.
#[inline(always)]
fn split(cell: u32) -> (usize, usize) {
    (cell as usize / PATCH, cell as usize % PATCH)
}

/// The entries of the patches that were touched, a sheet of them for each. Sums are exact, so that they do not depend on
/// the order of the rays, up to [`super::visibility::FastVisibility::MOST_RAYS`].
pub(super) struct Sums {
    /// Number of every patch's sheet, 0 where it has none.
    numbers: Vec<u32>,
    /// The entries of one sheet after the other; sheet 0 is that of no patch. Those of sheets not in use are empty.
    entries: Vec<Entry>,
    /// The patch of each sheet in use.
    patches: Vec<u32>,
}

/// Adding and taking away this rounds to a multiple of 2^-36.
const ROUND: f64 = 98_304.0; // 1.5 * 2^16

/// A probability as it is summed: a multiple of 2^-36.
#[inline(always)]
pub(super) fn rounded(probability: &Lanes<f32>) -> Lanes<f64> {
    std::array::from_fn(|l| (f64::from(probability[l]) + ROUND) - ROUND)
}

/// The same of one.
pub(super) fn rounded_one(probability: f64) -> f64 {
    rounded(&[probability as f32; LANES])[0]
}

impl Sums {
    /// No ray.
    pub(super) fn new(numbering: Numbering) -> Self {
        let patches = numbering.tiles() * (TILE / PATCH);
        Self { numbers: vec![0; patches], entries: vec![Entry::default(); PATCH], patches: vec![0] }
    }

    /// Number of a cell's entry, in a new sheet if need be.
    #[inline(always)]
    pub(super) fn entry(&mut self, cell: u32) -> usize {
        let (patch, place) = split(cell);
        let sheet = match self.numbers[patch] {
            0 => self.open(patch),
            sheet => sheet,
        };
        sheet as usize * PATCH + place
    }

    #[cold]
    #[inline(never)]
    fn open(&mut self, patch: usize) -> u32 {
        let sheet = self.patches.len();
        self.patches.push(patch as u32);
        self.numbers[patch] = sheet as u32;
        if self.entries.len() == sheet * PATCH {
            // Not twice as many: it is as large as the largest scan for good.
            self.entries.reserve_exact((sheet / 16 + 1) * PATCH);
            self.entries.resize(self.entries.capacity() / PATCH * PATCH, Entry::default());
        }
        sheet as u32
    }

    /// A pair of neighbours that a ray runs along, `low` the entry of the left or lower one: they differ with the given
    /// probability.
    #[inline(always)]
    pub(super) fn add_edge(&mut self, low: usize, high: usize, axis: usize, differ: f64) {
        self.entries[low].add_differ(axis, differ);
        self.entries[high].mark(LEFT << axis);
    }

    /// A cell that is in so many pairs of a ray.
    #[inline(always)]
    pub(super) fn add_cell(&mut self, entry: usize, pairs: u32, occupied: f64) {
        let entry = &mut self.entries[entry];
        entry.occupied += occupied * f64::from(pairs);
        entry.counts += u64::from(pairs) << 40;
    }

    pub(super) fn at(&mut self, entry: usize) -> &mut Entry {
        &mut self.entries[entry]
    }

    /// The entry of a cell.
    pub(super) fn get(&self, cell: u32) -> &Entry {
        let (patch, place) = split(cell);
        &self.entries[self.numbers[patch] as usize * PATCH + place]
    }

    /// Whether a ray was added through a cell.
    pub(super) fn is_touched(&self, cell: u32) -> bool {
        self.get(cell).pairs() > 0
    }

    /// Numbers of the sheets in use.
    pub(super) fn sheets(&self) -> std::ops::Range<usize> {
        1..self.patches.len()
    }

    /// The patch of a sheet.
    pub(super) fn patch(&self, sheet: usize) -> usize {
        self.patches[sheet] as usize
    }

    /// The sheet of a patch, if there is one.
    pub(super) fn sheet_of(&self, patch: usize) -> Option<usize> {
        Some(self.numbers[patch] as usize).filter(|sheet| *sheet > 0)
    }

    /// The entries of a sheet.
    pub(super) fn sheet(&self, sheet: usize) -> &[Entry; PATCH] {
        let from = sheet * PATCH;
        self.entries[from..from + PATCH].try_into().expect("a sheet has as many entries as a patch has cells")
    }

    /// Takes over what other sums hold, and empties it.
    pub(super) fn absorb(&mut self, other: &mut Self) {
        for sheet in other.sheets() {
            let number = self.entry((other.patch(sheet) * PATCH) as u32);
            let pairs = self.entries[number..number + PATCH].iter_mut().zip(other.sheet(sheet));
            for (entry, from) in pairs {
                entry.add(from);
            }
        }
        other.clear();
    }

    /// Forgets everything, at the cost of what was touched.
    pub(super) fn clear(&mut self) {
        self.entries[..self.patches.len() * PATCH].fill(Entry::default());
        for patch in self.patches.drain(1..) {
            self.numbers[patch as usize] = 0;
        }
    }
}

impl Held for Sums {
    fn held(&self) -> usize {
        self.numbers.held() + self.patches.held() + self.entries.held()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FastVisibility;
    use grid::GridSpec;

    /// As many rays as a scan may have, all through one cell and along one edge: no digit is lost, and no count runs over.
    #[test]
    fn sums_of_the_most_rays_are_exact() {
        let numbering = Numbering::new(GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 2, height: 1 });
        let mut sums = Sums::new(numbering);
        let [p, smallest] = [0.999_999f32, f32::MIN_POSITIVE].map(|p| rounded_one(f64::from(p)));
        let (low, high) = (sums.entry(0), sums.entry(1));
        for _ in 0..FastVisibility::MOST_RAYS - 1 {
            sums.add_cell(low, 2, p);
            sums.add_edge(low, high, 0, p);
        }
        sums.add_cell(low, 2, 1.0 / (1u64 << 36) as f64);
        sums.add_edge(low, high, 0, smallest);
        let entry = sums.get(0);
        let expected = (p * (1u64 << 36) as f64) as u64 * 2 * (FastVisibility::MOST_RAYS as u64 - 1) + 2;
        assert_eq!((entry.occupied * (1u64 << 36) as f64) as u64, expected);
        assert_eq!((entry.rays(0), entry.rays(1)), (FastVisibility::MOST_RAYS as u32, 0));
        assert_eq!((entry.pairs(), entry.edges()), (2 * FastVisibility::MOST_RAYS as u32, RIGHT));
    }
}
