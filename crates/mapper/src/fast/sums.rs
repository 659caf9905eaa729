//! The posteriors of a scan, summed over its rays: the moments of [`crate::Moments`] where the scan touched the map.

use sensor::lanes::{LANES, Lanes, each};

use crate::fast::tiles::{Numbering, PATCH, SIDE, TILE};
use crate::memory::Held;

/// Bits of a word that count; the others sum.
const COUNT_BITS: u32 = 20;

/// Those that count the pairs of a cell: two bits less, which mark edges.
const PAIRS: u64 = (1 << (COUNT_BITS - 2)) - 1;

/// Those that count the rays along an edge.
const RAYS: u64 = (1 << COUNT_BITS) - 1;

/// The mark of the edge to the left; that of the edge below is one bit higher.
const LEFT_MARK: u64 = 1 << (COUNT_BITS - 2);

/// Both marks.
const MARKS: u64 = 3 * LEFT_MARK;

/// An edge of a cell.
pub(super) const RIGHT: u32 = 1;
/// An edge of a cell.
pub(super) const ABOVE: u32 = 2;
/// An edge of a cell.
pub(super) const LEFT: u32 = 4;
/// An edge of a cell.
pub(super) const BELOW: u32 = 8;

/// A word that counts one, and sums a probability in units of 2^-27.
pub(super) type Word = u64;

/// Units of one.
const UNITS: f64 = 134_217_728.0; // 2^27

/// The low bits of a sum with it are a whole number.
const ONES: f64 = 4_503_599_627_370_496.0; // 2^52

/// Words of probabilities; of what is none, anything.
#[inline(always)]
pub(super) fn words(probability: &Lanes<f32>) -> Lanes<Word> {
    each(|l| (((f64::from(probability[l]) * UNITS + ONES).to_bits() ^ ONES.to_bits()) << COUNT_BITS) | 1)
}

/// The word of one, which rounding may have put below 0.
pub(super) fn word(probability: f64) -> Word {
    words(&[probability.max(0.0) as f32; LANES])[0]
}

/// A whole number below 2^52.
#[inline(always)]
fn whole(number: u64) -> f64 {
    f64::from_bits(number | ONES.to_bits()) - ONES
}

/// The sums of the cells of a patch: 24 bytes for each. A word is a sum of probabilities, in units of 2^-27, and in its last
/// 20 bits of how many. That is exact up to [`super::visibility::FastVisibility::MOST_RAYS`], in whatever order rays come.
#[derive(Clone)]
pub(super) struct Sheet {
    /// `P(E)` over the pairs of cells that rays ran along, once for each. Two marks, for edges to the left and below.
    occupied: [u64; PATCH],
    /// The probability that the cell and its right, or upper, neighbour differ, over the rays along that edge.
    differ: [[u64; PATCH]; 2],
}

/// A row of words.
#[inline(always)]
fn row_of(cells: &[u64; PATCH], row: usize) -> Lanes<u64> {
    each(|c| cells[row * SIDE + c])
}

/// Sums of words, each a probability times their number.
#[inline(always)]
fn sums(words: &Lanes<u64>) -> Lanes<f64> {
    each(|c| whole(words[c] >> COUNT_BITS) * (1.0 / UNITS))
}

impl Sheet {
    const EMPTY: Self = Self { occupied: [0; PATCH], differ: [[0; PATCH]; 2] };

    /// In how many pairs of rays the cells of a row are; 0 of cells that were not touched.
    #[inline(always)]
    pub(super) fn pairs(&self, row: usize) -> Lanes<f64> {
        let words = row_of(&self.occupied, row);
        each(|c| whole(words[c] & PAIRS))
    }

    /// Sum of `P(E)` over these pairs.
    #[inline(always)]
    pub(super) fn occupied(&self, row: usize) -> Lanes<f64> {
        sums(&row_of(&self.occupied, row))
    }

    /// How many rays ran along the edges of a row of cells to the right (0) or upper (1) neighbour.
    #[inline(always)]
    pub(super) fn rays(&self, axis: usize, row: usize) -> Lanes<f64> {
        let words = row_of(&self.differ[axis], row);
        each(|c| whole(words[c] & RAYS))
    }

    /// Sum of the probability that its ends differ over these rays.
    #[inline(always)]
    pub(super) fn differ(&self, axis: usize, row: usize) -> Lanes<f64> {
        sums(&row_of(&self.differ[axis], row))
    }

    /// The edges of a row of cells that a ray ran along: to the [`RIGHT`], [`ABOVE`], to the [`LEFT`], [`BELOW`].
    #[inline(always)]
    pub(super) fn edges(&self, row: usize) -> Lanes<u32> {
        let cells = row_of(&self.occupied, row);
        let [right, above] = [0, 1].map(|axis| row_of(&self.differ[axis], row));
        each(|c| {
            let ahead = [u32::from(right[c] & RAYS > 0) * RIGHT, u32::from(above[c] & RAYS > 0) * ABOVE];
            ahead[0] | ahead[1] | (((cells[c] & MARKS) / LEFT_MARK) as u32 * LEFT)
        })
    }

    /// Whether a ray was added to a cell of a row or to an edge of one.
    #[inline(always)]
    pub(super) fn is_busy(&self, row: usize) -> bool {
        let [cells, right, above] = [&self.occupied, &self.differ[0], &self.differ[1]].map(|cells| row_of(cells, row));
        each(|c| cells[c] | right[c] | above[c]).into_iter().fold(0, |any, word| any | word) > 0
    }

    /// The rows and columns, as bits, of cells that a ray was added through.
    fn extent(&self) -> [u8; 2] {
        let (mut rows, mut columns) = (0, [0; SIDE]);
        for r in 0..SIDE {
            let row = row_of(&self.occupied, r);
            columns = each(|c| columns[c] | row[c]);
            rows |= u8::from(row.into_iter().fold(0, |any, word| any | word) & PAIRS > 0) << r;
        }
        [rows, (0..SIDE).fold(0, |touched, c| touched | u8::from(columns[c] & PAIRS > 0) << c)]
    }

    /// Whether a ray was added through the cell in a place.
    pub(super) fn is_touched(&self, place: usize) -> bool {
        self.occupied[place] & PAIRS > 0
    }

    fn add(&mut self, other: &Self) {
        for (word, other) in self.occupied.iter_mut().zip(&other.occupied) {
            *word = ((*word & !MARKS) + (other & !MARKS)) | ((*word | other) & MARKS);
        }
        for (words, others) in self.differ.iter_mut().zip(&other.differ) {
            words.iter_mut().zip(others).for_each(|(word, other)| *word += other);
        }
    }
}

/// The sums of one cell, and of its edges to the right and upper neighbour.
pub(super) struct Totals {
    /// Sum of `P(E)`, and over how many pairs.
    pub(super) occupied: (f64, f64),
    /// Sums of the probability that its ends differ, and over how many rays.
    pub(super) differ: [(f64, f64); 2],
    /// The edges that a ray ran along.
    pub(super) edges: u32,
}

/// A cell's patch, and its place in it.
#[inline(always)]
fn split(cell: u32) -> (usize, usize) {
    (cell as usize / PATCH, cell as usize % PATCH)
}

/// The sums of the patches that were touched, on a sheet for each.
pub(super) struct Sums {
    numbering: Numbering,
    /// Number of every patch's sheet, 0 where it has none.
    numbers: Vec<u32>,
    /// Sheet 0 is that of no patch. Those not in use are empty.
    sheets: Vec<Sheet>,
    /// The patch of each sheet in use.
    patches: Vec<u32>,
    /// Whether a patch of a square has a sheet ...
    busy: Vec<bool>,
    /// ... and the squares of which one has.
    squares: Vec<u32>,
}

/// A cell's sheet, and its place on it. The default is on the sheet of no patch: marks there are marks nowhere.
#[derive(Clone, Copy, Default)]
pub(super) struct Entry {
    sheet: u32,
    place: u32,
}

impl Sums {
    /// No ray.
    pub(super) fn new(numbering: Numbering) -> Self {
        let patches = numbering.tiles() * (TILE / PATCH);
        Self {
            numbering,
            numbers: vec![0; patches],
            sheets: vec![Sheet::EMPTY],
            patches: vec![0],
            busy: vec![false; numbering.squares()],
            squares: Vec::new(),
        }
    }

    /// Where a cell is summed, on a new sheet if need be.
    #[inline(always)]
    pub(super) fn entry(&mut self, cell: u32) -> Entry {
        let (patch, place) = split(cell);
        let sheet = match self.numbers[patch] {
            0 => self.open(patch),
            sheet => sheet,
        };
        Entry { sheet, place: place as u32 }
    }

    #[cold]
    #[inline(never)]
    fn open(&mut self, patch: usize) -> u32 {
        let sheet = self.patches.len();
        self.patches.push(patch as u32);
        self.numbers[patch] = sheet as u32;
        let square = self.numbering.square_of((patch * PATCH) as u32);
        if !std::mem::replace(&mut self.busy[square], true) {
            self.squares.push(square as u32);
        }
        if self.sheets.len() == sheet {
            // Not twice as many: it is as large as the largest scan for good.
            self.sheets.reserve_exact(sheet / 16 + 1);
            self.sheets.resize(self.sheets.capacity(), Sheet::EMPTY);
        }
        sheet as u32
    }

    /// A step of a ray from a cell to the next, which is in so many pairs: [`add_cell`](Self::add_cell) of the next and
    /// [`add_edge`](Self::add_edge) at once. It goes `forward` from the low end of the edge.
    #[inline(always)]
    pub(super) fn add_step(
        &mut self,
        [from, to]: [Entry; 2],
        forward: bool,
        axis: usize,
        (pairs, occupied, differ): (u32, Word, Word),
    ) {
        let mark = LEFT_MARK << axis;
        let (sheet, place) = (&mut self.sheets[to.sheet as usize], to.place as usize % PATCH);
        let sum = sheet.occupied[place] + occupied * u64::from(pairs);
        sheet.occupied[place] = if forward { sum | mark } else { sum };
        if forward {
            self.add_differ(from, axis, differ);
        } else {
            sheet.differ[axis][place] += differ;
            self.mark(from, axis);
        }
    }

    /// A pair of neighbours that a ray runs along: they differ with the given probability.
    #[inline(always)]
    pub(super) fn add_edge(&mut self, low: Entry, high: Entry, axis: usize, differ: Word) {
        self.add_differ(low, axis, differ);
        self.mark(high, axis);
    }

    /// A ray runs along the edge to the right (0) or upper (1) neighbour: they differ with the given probability.
    #[inline(always)]
    pub(super) fn add_differ(&mut self, low: Entry, axis: usize, differ: Word) {
        let words = &mut self.sheets[low.sheet as usize].differ[axis];
        words[low.place as usize % PATCH] += differ;
    }

    /// A ray runs along the edge to the left (0) or lower (1) neighbour.
    #[inline(always)]
    pub(super) fn mark(&mut self, high: Entry, axis: usize) {
        self.sheets[high.sheet as usize].occupied[high.place as usize % PATCH] |= LEFT_MARK << axis;
    }

    /// A cell that is in so many pairs of a ray.
    #[inline(always)]
    pub(super) fn add_cell(&mut self, at: Entry, pairs: u32, occupied: Word) {
        let words = &mut self.sheets[at.sheet as usize].occupied;
        words[at.place as usize % PATCH] += occupied * u64::from(pairs);
    }

    /// Whether a ray was added through a cell.
    pub(super) fn is_touched(&self, cell: u32) -> bool {
        let (patch, place) = split(cell);
        self.sheets[self.numbers[patch] as usize].is_touched(place)
    }

    /// The sums of a cell.
    pub(super) fn totals(&self, cell: u32) -> Totals {
        let (patch, place) = split(cell);
        let sheet = &self.sheets[self.numbers[patch] as usize];
        let (row, column) = (place / SIDE, place % SIDE);
        Totals {
            occupied: (sheet.occupied(row)[column], sheet.pairs(row)[column]),
            differ: [0, 1].map(|axis| (sheet.differ(axis, row)[column], sheet.rays(axis, row)[column])),
            edges: sheet.edges(row)[column],
        }
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

    /// Whether a patch of a square has a sheet.
    #[inline(always)]
    pub(super) fn is_busy(&self, square: usize) -> bool {
        self.busy[square]
    }

    /// The squares of which a patch has a sheet.
    pub(super) fn squares(&self) -> &[u32] {
        &self.squares
    }

    /// The rows and columns of every patch with a sheet, as bits, that rays were added through; by the number of the sheet.
    pub(super) fn extents(&self) -> Vec<[u8; 2]> {
        self.sheets[..self.patches.len()].iter().map(Sheet::extent).collect()
    }

    /// The sums on a sheet.
    pub(super) fn sheet(&self, sheet: usize) -> &Sheet {
        &self.sheets[sheet]
    }

    /// Takes over what other sums hold, and empties it.
    pub(super) fn absorb(&mut self, other: &mut Self) {
        for sheet in other.sheets() {
            let to = self.entry((other.patch(sheet) * PATCH) as u32).sheet;
            self.sheets[to as usize].add(other.sheet(sheet));
        }
        other.clear();
    }

    /// Forgets everything, at the cost of what was touched.
    pub(super) fn clear(&mut self) {
        self.sheets[..self.patches.len()].fill(Sheet::EMPTY);
        self.forget();
    }

    /// Forgets what is on a sheet.
    #[inline(always)]
    pub(super) fn empty(&mut self, sheet: usize) {
        self.sheets[sheet] = Sheet::EMPTY;
    }

    /// Forgets which patches were touched. All sheets but that of no patch have been [emptied](Self::empty).
    pub(super) fn forget(&mut self) {
        self.empty(0);
        for patch in self.patches.drain(1..) {
            self.numbers[patch as usize] = 0;
        }
        for square in self.squares.drain(..) {
            self.busy[square as usize] = false;
        }
    }
}

impl Held for Sums {
    fn held(&self) -> usize {
        self.numbers.held() + self.patches.held() + self.sheets.held() + self.busy.held() + self.squares.held()
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
        let most = word(0.999_998_9);
        let (low, high) = (sums.entry(0), sums.entry(1));
        for _ in 0..FastVisibility::MOST_RAYS - 1 {
            sums.add_cell(low, 2, most);
            sums.add_edge(low, high, 0, most);
        }
        sums.add_cell(low, 2, word(1.0 / UNITS));
        sums.add_edge(low, high, 0, word(0.0));
        let (rays, unit) = (FastVisibility::MOST_RAYS as f64, 1.0 / UNITS);
        let (sheet, all) = (sums.sheet(1), unit * whole(most >> COUNT_BITS) * (rays - 1.0));
        let found =
            [sheet.occupied(0)[0], sheet.differ(0, 0)[0], sheet.pairs(0)[0], sheet.rays(0, 0)[0], sheet.rays(1, 0)[0]];
        let expected = [2.0 * all + 2.0 * unit, all, 2.0 * rays, rays, 0.0];
        assert_eq!(found.map(f64::to_bits), expected.map(f64::to_bits));
        assert_eq!(sheet.edges(0), [RIGHT, LEFT, 0, 0, 0, 0, 0, 0]);
    }

    #[test]
    fn what_two_threads_sum_is_added_up() {
        let numbering = Numbering::new(GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 20, height: 20 });
        let [mut all, mut one, mut other] = [(); 3].map(|()| Sums::new(numbering));
        for (k, cell) in [3u32, 200, 3, 64, 3].into_iter().enumerate() {
            let differ = word(0.1 + 0.1 * k as f64);
            for sums in [&mut all, if k % 2 == 0 { &mut one } else { &mut other }] {
                let (low, high) = (sums.entry(cell), sums.entry(cell + 1));
                sums.add_cell(high, 2, differ);
                sums.add_edge(low, high, k % 2, differ);
            }
        }
        one.absorb(&mut other);
        assert_eq!((one.sheets().len(), other.sheets().len()), (all.sheets().len(), 0));
        for sheet in all.sheets() {
            let [a, b] = [(&all, sheet), (&one, one.sheet_of(all.patch(sheet)).expect("there"))]
                .map(|(sums, sheet)| sums.sheet(sheet));
            assert_eq!((a.occupied, a.differ), (b.occupied, b.differ));
        }
    }
}
