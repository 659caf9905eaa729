//! The largest patch of a mask.

use grid::Raster;

/// Number of cells in the largest part of a mask that hangs together over the sides of its cells (4-connected).
pub(super) fn largest_patch(mask: &Raster<bool>) -> usize {
    let spec = *mask.spec();
    let mut left = mask.clone();
    let mut largest = 0;
    let mut open = Vec::new();
    for first in 0..spec.cells() {
        open.extend(std::mem::take(&mut left[first]).then_some(first));
        let mut cells = 0;
        while let Some(cell) = open.pop() {
            cells += 1;
            let (column, row) = spec.column_row(cell);
            let neighbours = [
                (column > 0).then(|| cell - 1),
                (column + 1 < spec.width).then(|| cell + 1),
                (row > 0).then(|| cell - spec.width),
                (row + 1 < spec.height).then(|| cell + spec.width),
            ];
            open.extend(neighbours.into_iter().flatten().filter(|&next| std::mem::take(&mut left[next])));
        }
        largest = largest.max(cells);
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::drawn;
    use proptest::prelude::*;

    #[test]
    fn sides_join_and_corners_do_not() {
        let patch = |rows: &[&str]| largest_patch(&drawn(rows).map(|cell| *cell == Some(true)));
        assert_eq!(patch(&["...", "..."]), 0);
        assert_eq!(patch(&["#.#", ".#.", "#.#"]), 1);
        assert_eq!(patch(&["##.#", "...#", "#..#"]), 3);
        assert_eq!(patch(&["..#", "#.."]), 1, "the end of a row does not touch the start of the next");
        assert_eq!(patch(&["###", "#.#", "###"]), 8);
    }

    proptest! {
        /// Labels that flow to the least of the neighbours' until nothing changes.
        #[test]
        fn equals_labels_that_settle(width in 1usize..9, cells in prop::collection::vec(any::<bool>(), 1..60)) {
            let height = cells.len().div_ceil(width);
            let spec = grid::GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width, height };
            let inside = |cell: usize| cells.get(cell).copied().unwrap_or(false);
            let mut labels: Vec<usize> = (0..spec.cells()).collect();
            let touch = |a: usize, b: usize| {
                let ((ax, ay), (bx, by)) = (spec.column_row(a), spec.column_row(b));
                ax.abs_diff(bx) + ay.abs_diff(by) == 1 && inside(a) && inside(b)
            };
            for _ in 0..spec.cells() {
                for a in 0..spec.cells() {
                    for b in (0..spec.cells()).filter(|&b| touch(a, b)) {
                        labels[a] = labels[a].min(labels[b]);
                    }
                }
            }
            let size = |label| (0..spec.cells()).filter(|&c| inside(c) && labels[c] == label).count();
            let mask = Raster::new(spec, (0..spec.cells()).map(inside).collect());
            prop_assert_eq!(largest_patch(&mask), (0..spec.cells()).map(size).max().unwrap_or(0));
        }
    }
}
