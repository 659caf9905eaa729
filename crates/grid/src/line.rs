//! Viewing rays as 4-connected digital lines (Figure 2 of the paper).

mod crossings;
mod staircase;

use crate::GridSpec;
pub use staircase::{Block, Staircase};

/// The cells that a ray crosses, nearest first, and where it enters and leaves each.
///
/// Consecutive cells share a side. A ray that passes exactly through a corner goes by the cell to
/// the side in x, which then has a chord of length zero. A line is a buffer to trace into, so that
/// a scan needs no allocation per ray.
#[derive(Debug, Clone, Default)]
pub struct DigitalLine {
    stairs: Staircase,
    /// Buffers are as long as the longest line so far.
    cells: Vec<usize>,
    ranges: Vec<f64>,
    /// Ranges (m) of the crossings of the axis of which there are fewer, and of one more.
    others_m: Vec<f64>,
}

impl DigitalLine {
    /// Traces the ray from `origin` (m) along the unit vector `direction` to `max_range` (m) or the
    /// border of the grid, whichever comes first; pass infinity for the border.
    ///
    /// The line is empty where the origin lies outside the grid.
    pub fn trace(&mut self, spec: &GridSpec, origin: [f64; 2], direction: [f64; 2], max_range: f64) {
        if !self.stairs.trace(spec, origin, direction, max_range) {
            return;
        }
        let cells = self.stairs.cells();
        if self.cells.len() < cells {
            self.cells.resize(cells, 0);
            self.ranges.resize(cells + 1, 0.0);
            self.others_m.resize(cells, 0.0);
        }
        self.merge(spec);
    }

    /// Puts the crossings of both axes in order.
    fn merge(&mut self, spec: &GridSpec) {
        let Some([(_, mains), (other, others)]) = self.stairs.axes() else { return };
        let others_m = &mut self.others_m[..=others];
        for (k, range_m) in others_m.iter_mut().enumerate() {
            *range_m = ahead(other.range_m(k as f64));
        }
        // What a crossing of either axis adds to the index of a cell.
        let [start, along, across] = [[0, 0], [1, 0], [0, 1]].map(|[main, other]| {
            let [column, row] = self.stairs.cell(main, other);
            column.wrapping_add(row.wrapping_mul(spec.width))
        });
        let (along, across) = (along.wrapping_sub(start), across.wrapping_sub(start));
        let (cells, ranges) = (&mut self.cells[..=mains + others], &mut self.ranges[..=mains + others + 1]);
        let (mut place, mut passed) = (start, 0);
        (cells[0], ranges[0]) = (place, 0.0);
        for (k, (&before, &range_m)) in self.stairs.before().iter().zip(self.stairs.ranges_m()).enumerate() {
            let before = (before as usize).min(others);
            // There is none or one of the other axis in between, and no branch on which. Rounding can make it two.
            let at = k + passed + 1;
            (cells[at], ranges[at]) = (place.wrapping_add(across), others_m[passed]);
            for second in passed + 1..before {
                let crossings = across.wrapping_mul(second + 1 - passed);
                (cells[k + second + 1], ranges[k + second + 1]) = (place.wrapping_add(crossings), others_m[second]);
            }
            place = place.wrapping_add(across.wrapping_mul(before - passed)).wrapping_add(along);
            passed = before;
            let at = k + passed + 1;
            (cells[at], ranges[at]) = (place, ahead(range_m));
        }
        for last in passed..others {
            place = place.wrapping_add(across);
            (cells[mains + last + 1], ranges[mains + last + 1]) = (place, others_m[last]);
        }
        ranges[mains + others + 1] = self.stairs.end_m();
    }

    /// Indices of the cells, nearest first.
    pub fn cells(&self) -> &[usize] {
        &self.cells[..self.len()]
    }

    /// Ranges (m) at which the ray crosses from cell to cell: cell `k` is entered at `ranges()[k]`
    /// and left at `ranges()[k + 1]`. One longer than [`cells`](Self::cells), never decreasing.
    pub fn ranges(&self) -> &[f64] {
        if self.is_empty() { &[0.0] } else { &self.ranges[..=self.len()] }
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.stairs.cells()
    }

    /// Whether the ray crosses no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl PartialEq for DigitalLine {
    fn eq(&self, other: &Self) -> bool {
        self.cells() == other.cells() && self.ranges() == other.ranges()
    }
}

/// A range that rounding has not put a hair before the origin.
#[inline(always)]
fn ahead(range_m: f64) -> f64 {
    if range_m > 0.0 { range_m } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SPEC: GridSpec = GridSpec { cell_m: 0.05, origin_m: [-0.5, 1.0], width: 40, height: 30 };

    fn line(origin: [f64; 2], direction: [f64; 2], max_range: f64) -> DigitalLine {
        let mut line = DigitalLine::default();
        line.trace(&SPEC, origin, direction, max_range);
        line
    }

    /// Every property a mapper relies on.
    fn check(line: &DigitalLine, origin: [f64; 2], direction: [f64; 2]) {
        assert_eq!(line.ranges().len(), line.len() + 1);
        assert_eq!(line.cells().first().copied(), SPEC.locate(origin));
        for pair in line.cells().windows(2) {
            SPEC.edge_between(pair[0], pair[1]); // asserts that they are neighbours
        }
        let mut seen = std::collections::HashSet::new();
        for (k, &cell) in line.cells().iter().enumerate() {
            assert!(seen.insert(cell), "cell {cell} twice");
            let (enter, exit) = (line.ranges()[k], line.ranges()[k + 1]);
            assert!(enter <= exit, "{enter} > {exit}");
            let middle = 0.5 * (enter + exit);
            let centre = SPEC.centre(cell);
            for axis in 0..2 {
                let at = origin[axis] + middle * direction[axis];
                assert!((at - centre[axis]).abs() <= 0.5 * SPEC.cell_m + 1e-9, "middle of chord {k} outside its cell");
            }
        }
    }

    #[test]
    fn a_ray_along_a_grid_line_stays_on_its_upper_side() {
        let line = line([0.0, 1.5], [1.0, 0.0], f64::INFINITY);
        assert_eq!(line.len(), 30);
        assert!(line.cells().iter().all(|&c| SPEC.column_row(c).1 == 10));
        check(&line, [0.0, 1.5], [1.0, 0.0]);
    }

    #[test]
    fn a_diagonal_from_a_corner_goes_by_the_side() {
        let h = std::f64::consts::FRAC_1_SQRT_2;
        let line = line([0.0, 1.5], [h, h], 0.2);
        check(&line, [0.0, 1.5], [h, h]);
        assert!(line.len() >= 5);
    }

    #[test]
    fn the_range_ends_the_line_inside_its_cell() {
        let line = line([0.01, 1.51], [1.0, 0.0], 0.12);
        assert_eq!(line.len(), 3);
        assert_eq!(line.ranges().last(), Some(&0.12));
    }

    #[test]
    fn outside_there_is_no_line() {
        assert!(line([-1.0, 1.5], [1.0, 0.0], f64::INFINITY).is_empty());
        assert!(line([f64::NAN, 1.5], [1.0, 0.0], f64::INFINITY).is_empty());
    }

    #[test]
    fn a_grid_of_one_cell() {
        let one = GridSpec { cell_m: 1.0, origin_m: [0.0; 2], width: 1, height: 1 };
        let mut line = DigitalLine::default();
        line.trace(&one, [0.25, 0.5], [0.0, -1.0], f64::INFINITY);
        assert_eq!((line.cells(), line.ranges()), (&[0][..], &[0.0, 0.5][..]));
    }

    /// The walk from cell to cell, one crossing after the other.
    fn walk(spec: &GridSpec, origin: [f64; 2], direction: [f64; 2], max_range: f64) -> (Vec<usize>, Vec<f64>) {
        let (mut cells, mut ranges) = (Vec::new(), vec![0.0]);
        let Some(start) = spec.locate(origin) else { return (cells, ranges) };
        let (column, row) = spec.column_row(start);
        let (mut at, limits) = ([column, row], [spec.width, spec.height]);
        loop {
            cells.push(spec.index(at[0], at[1]));
            let next = [0, 1].map(|k| {
                let line = spec.origin_m[k] + (at[k] + usize::from(direction[k] > 0.0)) as f64 * spec.cell_m;
                let inverse = 1.0 / direction[k];
                if inverse.is_finite() { (line - origin[k]) * inverse } else { f64::INFINITY }
            });
            let axis = usize::from(next[0] > next[1]);
            let entered = next[axis].max(*ranges.last().expect("one from the start")).min(max_range);
            ranges.push(entered);
            let last = if direction[axis] > 0.0 { limits[axis] - 1 } else { 0 };
            if entered >= max_range || at[axis] == last {
                return (cells, ranges);
            }
            at[axis] = if direction[axis] > 0.0 { at[axis] + 1 } else { at[axis] - 1 };
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        /// To the bit: also from corners and grid lines, along them, along diagonals and next to all of these, to ranges that end
        /// on a grid line, in grids far from the origin.
        #[test]
        fn it_is_the_walk_from_cell_to_cell(
            width in 1usize..60, height in 1usize..60, at in prop::array::uniform2((0.0f64..1.0, 0usize..3)),
            kind in 0usize..7, angle in -7.0f64..7.0, tilt in prop::sample::select(vec![0.0, 1e-17, -1e-16, 1e-15, -1e-12, 1e-300, 1e-9]),
            until in 0usize..4, reach in 0.0f64..6.0, far in prop::sample::select(vec![0.0, -0.5, 1e3, 4.7e5, -3e7]),
            cell_m in prop::sample::select(vec![0.05, 0.1, 0.25, 0.013]),
        ) {
            let spec = GridSpec { cell_m, origin_m: [far, 1.0 - far], width, height };
            let size = [width, height];
            let origin = [0, 1].map(|k| {
                let (share, snap) = at[k];
                let cells = share * size[k] as f64;
                let cells = if snap == 1 { cells.floor() } else if snap == 2 { cells.floor() + 0.5 } else { cells };
                spec.origin_m[k] + cells * cell_m
            });
            let quarter = angle.abs() as usize % 4;
            let h = std::f64::consts::FRAC_1_SQRT_2;
            let mut direction = match kind {
                0 => [[1.0, tilt], [tilt, 1.0], [-1.0, tilt], [tilt, -1.0]][quarter],
                1 => [[h, h], [-h, h], [h, -h], [-h, -h]][quarter],
                2 => [[h, h + tilt], [-h, h], [h - tilt, -h], [-h, -h]][quarter],
                3 => [[0.6, 0.8], [-0.8, 0.6], [0.8, -0.6], [-0.6, -0.8]][quarter],
                _ => [angle.cos(), angle.sin()],
            };
            if kind == 4 {
                direction = [angle.sin(), angle.cos()];
            }
            let until = match until {
                0 => f64::INFINITY,
                1 => (reach / cell_m).floor() * cell_m,
                2 => reach * 1e-3,
                _ => reach,
            };
            let (cells, ranges) = walk(&spec, origin, direction, until);
            let mut line = DigitalLine::default();
            line.trace(&SPEC, [0.0, 1.5], [0.6, 0.8], f64::INFINITY); // something before
            line.trace(&spec, origin, direction, until);
            prop_assert_eq!(line.cells(), &cells[..]);
            prop_assert_eq!(line.ranges(), &ranges[..]);
        }
    }

    proptest! {
        #[test]
        fn lines_are_connected_and_tile_the_ray(
            x in -0.5f64..1.5, y in 1.0f64..2.5, angle in -7.0f64..7.0, corner: bool, along: bool,
        ) {
            let snap = |v: f64, origin: f64| ((v - origin) / 0.05).floor() * 0.05 + origin;
            let origin = if corner { [snap(x, -0.5), snap(y, 1.0)] } else { [x, y] };
            let direction = if along {
                [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][angle.abs() as usize % 4]
            } else {
                [angle.cos(), angle.sin()]
            };
            prop_assume!(SPEC.locate(origin).is_some());
            check(&line(origin, direction, f64::INFINITY), origin, direction);
        }
    }
}
