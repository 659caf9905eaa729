//! Viewing rays as 4-connected digital lines (Figure 2 of the paper).

use crate::GridSpec;

/// The cells that a ray crosses, nearest first, and where it enters and leaves each.
///
/// Consecutive cells share a side. A ray that passes exactly through a corner goes by the cell to
/// the side in x, which then has a chord of length zero. A line is a buffer to trace into, so that
/// a scan needs no allocation per ray.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DigitalLine {
    cells: Vec<usize>,
    ranges: Vec<f64>,
}

impl DigitalLine {
    /// Traces the ray from `origin` (m) along the unit vector `direction` to `max_range` (m) or the
    /// border of the grid, whichever comes first; pass infinity for the border.
    ///
    /// The line is empty where the origin lies outside the grid.
    pub fn trace(&mut self, spec: &GridSpec, origin: [f64; 2], direction: [f64; 2], max_range: f64) {
        debug_assert!((direction[0].hypot(direction[1]) - 1.0).abs() < 1e-9, "{direction:?} is no unit vector");
        self.cells.clear();
        self.ranges.clear();
        self.ranges.push(0.0);
        let Some(start) = spec.locate(origin) else { return };
        let (column, row) = spec.column_row(start);
        let mut x = Axis::new(origin[0], direction[0], spec.origin_m[0], spec.cell_m, column, spec.width);
        let mut y = Axis::new(origin[1], direction[1], spec.origin_m[1], spec.cell_m, row, spec.height);
        let mut entered = 0.0;
        loop {
            self.cells.push(spec.index(x.at, y.at));
            let (next, axis) = if x.next <= y.next { (x.next, &mut x) } else { (y.next, &mut y) };
            // Rounding can put a crossing a hair before the one that precedes it.
            entered = next.max(entered).min(max_range);
            self.ranges.push(entered);
            if entered >= max_range || !axis.step() {
                return;
            }
        }
    }

    /// Indices of the cells, nearest first.
    pub fn cells(&self) -> &[usize] {
        &self.cells
    }

    /// Ranges (m) at which the ray crosses from cell to cell: cell `k` is entered at `ranges()[k]`
    /// and left at `ranges()[k + 1]`. One longer than [`cells`](Self::cells), never decreasing.
    pub fn ranges(&self) -> &[f64] {
        &self.ranges
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether the ray crosses no cell.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }
}

/// One coordinate of the walk: the current column (or row) and the range of the next grid line.
struct Axis {
    at: usize,
    limit: usize,
    forward: bool,
    next: f64,
    origin: f64,
    inverse: f64,
    grid_origin: f64,
    cell_m: f64,
}

impl Axis {
    fn new(origin: f64, direction: f64, grid_origin: f64, cell_m: f64, at: usize, limit: usize) -> Self {
        let mut axis = Self {
            at,
            limit,
            forward: direction > 0.0,
            next: f64::INFINITY,
            origin,
            inverse: if direction == 0.0 { f64::INFINITY } else { 1.0 / direction },
            grid_origin,
            cell_m,
        };
        axis.look_ahead();
        axis
    }

    /// Computed from the line's number, not by adding up steps: errors do not grow with range.
    fn look_ahead(&mut self) {
        if self.inverse.is_finite() {
            let line = self.grid_origin + (self.at + usize::from(self.forward)) as f64 * self.cell_m;
            self.next = (line - self.origin) * self.inverse;
        }
    }

    /// Moves to the next cell along this axis; false at the border of the grid.
    fn step(&mut self) -> bool {
        if self.forward && self.at + 1 < self.limit {
            self.at += 1;
        } else if !self.forward && self.at > 0 {
            self.at -= 1;
        } else {
            return false;
        }
        self.look_ahead();
        true
    }
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
