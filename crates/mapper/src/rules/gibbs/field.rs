//! The prior over whole maps: how likely every block of 3 x 3 cells looks as it does.

use grid::GridSpec;

use crate::rules::gibbs::weights::{SIZES_M, WEIGHTS};

/// Number of patterns of 3 x 3 cells.
pub const PATTERNS: usize = 512;

/// A field over maps: `ln P(map) = sum over cells of the log weight of the 3 x 3 block about the cell + constant`.
///
/// Bit `3 (dy + 1) + dx + 1` of a pattern is the cell `dx, dy` from the block's centre. Beyond the border the map goes on as its
/// outermost cells are.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockField {
    weights: Vec<f64>,
}

/// The smallest of the eight patterns that turn into each other by turns and mirrors.
///
/// # Panics
/// Unless the pattern is less than [`PATTERNS`].
pub fn orbit(pattern: usize) -> usize {
    assert!(pattern < PATTERNS, "nine bits");
    let turned = |p: usize| moved(p, |x, y| (2 - y, x));
    let mirrored = |p: usize| moved(p, |x, y| (2 - x, y));
    let mut least = pattern;
    let mut seen = pattern;
    for _ in 0..4 {
        seen = turned(seen);
        least = least.min(seen).min(mirrored(seen));
    }
    least
}

fn moved(pattern: usize, to: impl Fn(usize, usize) -> (usize, usize)) -> usize {
    (0..9).filter(|bit| pattern >> bit & 1 == 1).fold(0, |all, bit| {
        let (x, y) = to(bit % 3, bit / 3);
        all | 1 << (3 * y + x)
    })
}

impl BlockField {
    /// The field with the given log weights of all [`PATTERNS`], nats.
    ///
    /// # Panics
    /// Unless there is one weight per pattern.
    pub fn new(weights: Vec<f64>) -> Self {
        assert_eq!(weights.len(), PATTERNS, "one weight per pattern");
        Self { weights }
    }

    /// Independent cells of the given log odds.
    pub fn independent(log_odds: f64) -> Self {
        Self::new((0..PATTERNS).map(|pattern| if pattern >> 4 & 1 == 1 { log_odds } else { 0.0 }).collect())
    }

    /// The field that was fitted on the tuning worlds for cells of side `cell_m` (m): linear in the logarithm of the side
    /// between those that were fitted, the nearest of them beyond.
    pub fn fitted(cell_m: f64) -> Self {
        let place = SIZES_M.iter().filter(|size| **size <= cell_m).count().clamp(1, SIZES_M.len() - 1) - 1;
        let [low, high] = [SIZES_M[place], SIZES_M[place + 1]];
        let share = (libm::log(cell_m / low) / libm::log(high / low)).clamp(0.0, 1.0);
        let of = |pattern| {
            let orbit = orbit(pattern) as u16;
            let row = WEIGHTS.iter().find(|(known, _)| *known == orbit).map_or([0.0; SIZES_M.len()], |row| row.1);
            (1.0 - share) * row[place] + share * row[place + 1]
        };
        Self::new((0..PATTERNS).map(of).collect())
    }

    /// The same with every log weight so many times as large.
    pub fn scaled(mut self, times: f64) -> Self {
        self.weights.iter_mut().for_each(|weight| *weight *= times);
        self
    }

    /// The same with an occupied cell more likely by `log_odds`, nats.
    pub fn shifted(mut self, log_odds: f64) -> Self {
        for (pattern, weight) in self.weights.iter_mut().enumerate() {
            *weight += if pattern >> 4 & 1 == 1 { log_odds } else { 0.0 };
        }
        self
    }

    /// Log weight of a pattern, nats.
    pub fn weight(&self, pattern: usize) -> f64 {
        self.weights[pattern]
    }
}

/// Calls `of` with every block that a cell is part of, by the block's centre, and the bits that the cell is in it.
#[inline(always)]
pub fn blocks(spec: &GridSpec, cell: usize, mut of: impl FnMut(usize, usize)) {
    let (column, row) = spec.column_row(cell);
    if column > 0 && row > 0 && column + 1 < spec.width && row + 1 < spec.height {
        let mut bit = 9; // the cell is the last of the first block
        for middle in [cell - spec.width, cell, cell + spec.width] {
            for centre in middle - 1..=middle + 1 {
                bit -= 1;
                of(centre, 1 << bit);
            }
        }
        return;
    }
    for y in row.saturating_sub(1)..(row + 2).min(spec.height) {
        for x in column.saturating_sub(1)..(column + 2).min(spec.width) {
            let mut bits = 0;
            for bit in 0..9 {
                let at = |centre: usize, step: usize, size: usize| (centre + step).saturating_sub(1).min(size - 1);
                if at(x, bit % 3, spec.width) == column && at(y, bit / 3, spec.height) == row {
                    bits |= 1 << bit;
                }
            }
            of(spec.index(x, y), bits);
        }
    }
}

/// The patterns of all blocks of a map, by the cell in their centre.
pub fn patterns(spec: &GridSpec, occupied: &[bool]) -> Vec<u16> {
    let mut patterns = vec![0; occupied.len()];
    for cell in (0..occupied.len()).filter(|&cell| occupied[cell]) {
        blocks(spec, cell, |centre, bits| patterns[centre] |= bits as u16);
    }
    patterns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_102_orbits_and_each_names_itself() {
        let orbits: std::collections::BTreeSet<usize> = (0..PATTERNS).map(orbit).collect();
        assert_eq!(orbits.len(), 102);
        assert!(orbits.iter().all(|&known| orbit(known) == known && known.count_ones() <= 9));
        assert!((0..PATTERNS).all(|pattern| orbit(pattern).count_ones() == pattern.count_ones()));
    }

    /// Border cells go on beyond it; every block's pattern is that of the map looked up cell by cell.
    #[test]
    fn patterns_are_those_of_the_map() {
        for (width, height) in [(1, 1), (1, 4), (2, 3), (5, 4)] {
            let spec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width, height };
            for map in 0..1usize << spec.cells().min(12) {
                let occupied: Vec<bool> = (0..spec.cells()).map(|cell| map >> (cell % 12) & 1 == 1).collect();
                for (centre, &pattern) in patterns(&spec, &occupied).iter().enumerate() {
                    let (column, row) = spec.column_row(centre);
                    for bit in 0..9 {
                        let x = (column + bit % 3).saturating_sub(1).min(width - 1);
                        let y = (row + bit / 3).saturating_sub(1).min(height - 1);
                        assert_eq!(pattern >> bit & 1 == 1, occupied[spec.index(x, y)], "{width} x {height}, {map:b}");
                    }
                }
            }
        }
    }
}
