//! Cells as boxes.

use grid::Raster;

use crate::Shape;

/// The set cells as boxes that cover each of them once.
pub(crate) fn boxes(set: &Raster<bool>) -> Vec<Shape> {
    let spec = *set.spec();
    let shape = |r: &Rectangle| {
        let corner = |at: [usize; 2]| [0, 1].map(|a| spec.origin_m[a] + at[a] as f64 * spec.cell_m);
        let (low, high) = (corner(r.low), corner(r.high));
        let center_m = [0, 1].map(|a| 0.5 * (low[a] + high[a]));
        let half_m = [0, 1].map(|a| 0.5 * (high[a] - low[a]));
        Shape::Box { center_m, half_m, axis: [1.0, 0.0] }
    };
    merged(set).iter().map(shape).collect()
}

/// A rectangle of cells: columns and rows from `low` up to but without `high`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Rectangle {
    low: [usize; 2],
    high: [usize; 2],
}

/// Covers the set cells with disjoint rectangles: from every cell not yet covered, row by row, as
/// far right as the run goes and then as far up as that run repeats. Not the fewest, but few.
fn merged(set: &Raster<bool>) -> Vec<Rectangle> {
    let spec = *set.spec();
    let mut left = set.clone();
    let mut rectangles = Vec::new();
    for cell in 0..spec.cells() {
        if !left[cell] {
            continue;
        }
        let (column, row) = spec.column_row(cell);
        let end = (column..spec.width).find(|&c| !left[spec.index(c, row)]).unwrap_or(spec.width);
        let full = |r: usize, left: &Raster<bool>| (column..end).all(|c| left[spec.index(c, r)]);
        let top = (row + 1..spec.height).find(|&r| !full(r, &left)).unwrap_or(spec.height);
        for r in row..top {
            let start = spec.index(column, r);
            left.values_mut()[start..start + (end - column)].fill(false);
        }
        rectangles.push(Rectangle { low: [column, row], high: [end, top] });
    }
    rectangles
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::GridSpec;
    use proptest::prelude::*;

    fn raster(width: usize, cells: Vec<bool>) -> Raster<bool> {
        let height = cells.len() / width;
        Raster::new(GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width, height }, cells)
    }

    #[test]
    fn a_full_map_is_one_rectangle_and_an_empty_one_none() {
        assert_eq!(merged(&raster(4, vec![true; 12])), [Rectangle { low: [0, 0], high: [4, 3] }]);
        assert_eq!(merged(&raster(4, vec![false; 12])), []);
    }

    proptest! {
        #[test]
        fn the_rectangles_cover_the_set_cells_once_and_no_other(cells in prop::collection::vec(prop::bool::weighted(0.7), 48)) {
            let set = raster(8, cells);
            let mut times = vec![0; 48];
            for r in merged(&set) {
                for row in r.low[1]..r.high[1] {
                    for column in r.low[0]..r.high[0] {
                        times[row * 8 + column] += 1;
                    }
                }
            }
            let expected: Vec<i32> = set.values().iter().map(|&v| i32::from(v)).collect();
            prop_assert_eq!(times, expected);
        }
    }
}
