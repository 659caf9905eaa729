//! Squares of 16 x 16 patches: rays leap over one at once where all of it is settled, so that wide settled space takes few steps.

use crate::fast::budget::SETTLED;
use crate::fast::map::{Map, Summary};
use crate::fast::tiles::{Numbering, SIDE, SQUARE_SIDE};
use crate::memory::Held;

/// What a ray needs to know of every square of a map: of its patches, the largest probability and the mean hazard.
#[derive(Debug, Clone)]
pub(super) struct Squares {
    numbering: Numbering,
    summaries: Vec<Summary>,
}

impl Squares {
    /// Of an unseen map.
    pub(super) fn unseen(map: &Map) -> Self {
        let unsettled = Summary { most: map.of_unseen()[0], onset: 1.0 };
        Self { numbering: map.numbering, summaries: vec![unsettled; map.numbering.squares()] }
    }

    /// The square of a cell, by column and row, where all of it is settled.
    #[inline(always)]
    pub(super) fn settled(&self, at: [u32; 2]) -> Option<Summary> {
        Some(self.summaries[self.numbering.square_at(at)]).filter(|summary| summary.most <= SETTLED)
    }

    /// Brings up to date what is known of squares, by their numbers, in which cells have moved. O(1) of one whose first patch is not settled.
    pub(super) fn summarise(&mut self, map: &Map, squares: &[u32]) {
        for &square in squares {
            self.summaries[square as usize] = self.of(map, square as usize);
        }
    }

    fn of(&self, map: &Map, square: usize) -> Summary {
        let spec = self.numbering.spec();
        let [columns, rows] = {
            let corner = self.numbering.corner_of(square);
            [0, 1].map(|k| corner[k]..(corner[k] + SQUARE_SIDE).min([spec.width, spec.height][k]))
        };
        let (mut all, mut patches) = (Summary { most: 0.0, onset: 0.0 }, 0.0);
        for row in rows.step_by(SIDE) {
            for column in columns.clone().step_by(SIDE) {
                let patch = map.summary(self.numbering.number(column, row));
                if patch.most > SETTLED {
                    return patch;
                }
                all = Summary { most: all.most.max(patch.most), onset: all.onset + patch.onset };
                patches += 1.0;
            }
        }
        Summary { onset: all.onset / patches, ..all }
    }
}

impl Held for Squares {
    fn held(&self) -> usize {
        self.summaries.held()
    }
}
