//! A set of the cells of a map.

use crate::memory::Held;

/// A set of cells, a bit to each, that gives them in the order of their indices.
#[derive(Debug, Clone)]
pub(crate) struct CellSet {
    bits: Vec<u64>,
    /// The first and the last word that may have a bit, the first behind the last where there is none.
    words: [usize; 2],
}

/// No word.
const NONE: [usize; 2] = [usize::MAX, 0];

impl CellSet {
    /// No cell of a map of so many.
    pub(crate) fn new(cells: usize) -> Self {
        Self { bits: vec![0; cells.div_ceil(64)], words: NONE }
    }

    /// Takes in a cell.
    #[inline(always)]
    pub(crate) fn insert(&mut self, cell: usize) {
        let word = cell / 64;
        self.bits[word] |= 1 << (cell % 64);
        self.words = [self.words[0].min(word), self.words[1].max(word)];
    }

    /// The cells.
    pub(crate) fn iter(&self) -> impl Iterator<Item = usize> + use<'_> {
        (self.words[0]..=self.words[1]).flat_map(|word| Bits { word, left: self.bits[word] })
    }

    /// The cells, which it holds no longer.
    pub(crate) fn drain(&mut self) -> impl Iterator<Item = usize> + use<'_> {
        let (bits, [first, last]) = (&mut self.bits, std::mem::replace(&mut self.words, NONE));
        (first..=last).flat_map(|word| Bits { word, left: std::mem::take(&mut bits[word]) })
    }
}

/// The cells of a word.
struct Bits {
    word: usize,
    left: u64,
}

impl Iterator for Bits {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let bit = self.left.trailing_zeros() as usize;
        let any = self.left != 0;
        self.left &= self.left.wrapping_sub(1);
        any.then_some(64 * self.word + bit)
    }
}

impl Held for CellSet {
    fn held(&self) -> usize {
        self.bits.held()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        #[test]
        fn it_holds_what_a_set_in_order_holds(rounds in prop::collection::vec(prop::collection::vec(0usize..700, 0..50), 1..4)) {
            let mut set = CellSet::new(700);
            for cells in rounds {
                let expected: BTreeSet<usize> = cells.iter().copied().collect();
                cells.into_iter().for_each(|cell| set.insert(cell));
                prop_assert!(set.iter().eq(expected.iter().copied()));
                prop_assert!(set.drain().eq(expected));
            }
            prop_assert_eq!(set.iter().next(), None);
        }
    }
}
