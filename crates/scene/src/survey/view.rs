//! Sets of cells as bits, so that what a place shows anew is counted and not traced again.

use grid::GridSpec;

/// Cells in a word.
const BITS: usize = u64::BITS as usize;

/// A set of cells of the whole grid: words run along the rows, and every row begins with a new one.
pub(super) struct Seen {
    words_per_row: usize,
    width: usize,
    words: Vec<u64>,
}

/// The cells that are seen from one place: the words of the rectangle around them.
pub(super) struct View {
    /// First word of a row, and first row.
    low: [usize; 2],
    words_per_row: usize,
    words: Vec<u64>,
}

impl Seen {
    /// The empty set.
    pub(super) fn nothing(spec: &GridSpec) -> Self {
        let words_per_row = spec.width.div_ceil(BITS);
        Self { words_per_row, width: spec.width, words: vec![0; words_per_row * spec.height] }
    }

    /// A view of the cells of this grid.
    pub(super) fn view(&self, cells: &[usize]) -> View {
        let at = |cell: usize| [cell % self.width / BITS, cell / self.width];
        let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
        for at in cells.iter().map(|&cell| at(cell)) {
            for k in 0..2 {
                (low[k], high[k]) = (low[k].min(at[k]), high[k].max(at[k] + 1));
            }
        }
        let low = if cells.is_empty() { [0; 2] } else { low };
        let words_per_row = high[0] - low[0];
        let mut words = vec![0; words_per_row * (high[1] - low[1])];
        for &cell in cells {
            let [word, row] = at(cell);
            words[(row - low[1]) * words_per_row + word - low[0]] |= 1 << (cell % self.width % BITS);
        }
        View { low, words_per_row, words }
    }

    /// How many cells of a view are not in the set.
    pub(super) fn missing(&self, view: &View) -> usize {
        let rows = view.rows().map(|(row, words)| {
            let seen = &self.words[row * self.words_per_row + view.low[0]..][..words.len()];
            words.iter().zip(seen).map(|(view, seen)| (view & !seen).count_ones() as usize).sum::<usize>()
        });
        rows.sum()
    }

    /// Takes the cells of a view into the set.
    pub(super) fn add(&mut self, view: &View) {
        for (row, words) in view.rows() {
            let seen = &mut self.words[row * self.words_per_row + view.low[0]..][..words.len()];
            seen.iter_mut().zip(words).for_each(|(seen, view)| *seen |= view);
        }
    }
}

impl View {
    /// Memory that it takes.
    pub(super) fn bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(&self.words[..])
    }

    /// The words of each row, with the row.
    fn rows(&self) -> impl Iterator<Item = (usize, &[u64])> {
        self.words.chunks_exact(self.words_per_row.max(1)).enumerate().map(|(k, words)| (self.low[1] + k, words))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn counts_are_those_of_sets(
            width in 1_usize..300, views in prop::collection::vec(prop::collection::vec(0_usize..3000, 0..60), 1..6),
        ) {
            let spec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width, height: 3000_usize.div_ceil(width) };
            let (mut seen, mut set) = (Seen::nothing(&spec), BTreeSet::new());
            for cells in views {
                let view = seen.view(&cells);
                let expected = cells.iter().filter(|cell| !set.contains(*cell)).collect::<BTreeSet<_>>().len();
                prop_assert_eq!(seen.missing(&view), expected);
                seen.add(&view);
                set.extend(cells);
                prop_assert_eq!(seen.missing(&view), 0);
            }
        }
    }
}
