//! A line that goes on patch by patch, or square by square: the cells at which it enters them are those of [`super::lines::Lines`], to the bit.

use crate::fast::tiles::Numbering;

/// A cell on a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// Column and row.
    pub(super) at: [u32; 2],
    /// Range at which the line enters it, m.
    pub(super) entered: f64,
}

/// A way through a patch or a square.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    /// The last cell in it.
    pub(super) last: Place,
    /// The first cell of the next; none where the line leaves the grid.
    pub(super) next: Option<Place>,
    /// Number of cells from the one that it was in to the last, both included.
    pub(super) cells: u32,
    /// Range at which it leaves it, m.
    pub(super) exit: f64,
}

/// A line on its way.
#[derive(Debug, Clone)]
pub(super) struct Walk {
    axes: [Axis; 2],
    /// The cell that it is in.
    pub(super) place: Place,
}

/// One coordinate of a line.
#[derive(Debug, Clone, Copy)]
struct Axis {
    cell_m: f64,
    /// 1 / cell_m, as near as need be: nothing but a guess depends on it.
    per_cell_m: f64,
    grid_origin: f64,
    origin: f64,
    direction: f64,
    /// 1 / direction; 0 where it is 0 ...
    inverse: f64,
    /// ... and infinity there, 0 otherwise.
    never: f64,
    forward: bool,
    /// Number of cells.
    limit: u32,
}

impl Axis {
    /// Range at which a grid line is crossed, m, as [`super::lines::Lines`] has it. It never falls from one line to the next.
    #[inline(always)]
    fn range(&self, line: u32) -> f64 {
        (self.grid_origin + f64::from(line) * self.cell_m - self.origin) * self.inverse + self.never
    }

    /// The grid line before a cell.
    #[inline(always)]
    fn entry(&self, at: u32) -> u32 {
        if self.forward { at } else { at + 1 }
    }

    /// The grid line behind it.
    #[inline(always)]
    fn exit(&self, at: u32) -> u32 {
        if self.forward { at + 1 } else { at }
    }

    /// The grid line behind its patch or square, of which this is the side, or the border.
    #[inline(always)]
    fn border(&self, at: u32, side: u32) -> u32 {
        let first = at / side * side;
        if self.forward { (first + side).min(self.limit) } else { first }
    }

    /// The cell before a grid line, as the line runs.
    #[inline(always)]
    fn before(&self, line: u32) -> u32 {
        if self.forward { line - 1 } else { line }
    }

    /// The cell behind it; none at the border.
    #[inline(always)]
    fn behind(&self, line: u32) -> Option<u32> {
        if self.forward { (line < self.limit).then_some(line) } else { line.checked_sub(1) }
    }

    /// The last cell from `at` on whose entry has been crossed, by `passed`, before a border.
    #[inline(always)]
    fn at_range(&self, at: u32, border: u32, range: f64, passed: impl Fn(u32) -> bool) -> u32 {
        let end = self.before(border);
        let guess = (self.origin + range * self.direction - self.grid_origin) * self.per_cell_m;
        let mut here = (guess.max(0.0) as u32).clamp(at.min(end), at.max(end));
        while here != at && !passed(self.entry(here)) {
            here = if self.forward { here - 1 } else { here + 1 };
        }
        while here != end && passed(self.exit(here)) {
            here = if self.forward { here + 1 } else { here - 1 };
        }
        here
    }
}

impl Walk {
    /// A line from `origin` (m) along the unit vector `direction` that is in a cell.
    pub(super) fn new(numbering: &Numbering, origin: [f64; 2], direction: [f64; 2], place: Place) -> Self {
        let spec = numbering.spec();
        let axes = [0, 1].map(|k| Axis {
            cell_m: spec.cell_m,
            per_cell_m: 1.0 / spec.cell_m,
            grid_origin: spec.origin_m[k],
            origin: origin[k],
            direction: direction[k],
            inverse: if direction[k] == 0.0 { 0.0 } else { 1.0 / direction[k] },
            never: if direction[k] == 0.0 { f64::INFINITY } else { 0.0 },
            forward: direction[k] > 0.0,
            limit: [spec.width, spec.height][k] as u32,
        });
        Self { axes, place }
    }

    /// The way out of the patch, or the square, of so many cells on a side that the line is in. O(1).
    #[inline(always)]
    pub(super) fn crossing<const SIDE: usize>(&self) -> Crossing {
        let (axes, Place { at, entered }) = (&self.axes, self.place);
        let borders = [0, 1].map(|k| axes[k].border(at[k], SIDE as u32));
        let ranges = [axes[0].range(borders[0]), axes[1].range(borders[1])];
        // Where both lines are crossed at once, that of x is first.
        let (across, range) = if ranges[0] <= ranges[1] { (0, ranges[0]) } else { (1, ranges[1]) };
        let other = 1 - across;
        let passed = |line: u32| {
            let crossed = axes[other].range(line);
            if other == 0 { crossed <= range } else { crossed < range }
        };
        let mut last = [0; 2];
        last[across] = axes[across].before(borders[across]);
        last[other] = axes[other].at_range(at[other], borders[other], range, passed);
        let mut before = entered;
        for k in 0..2 {
            if last[k] != at[k] {
                let range = axes[k].range(axes[k].entry(last[k]));
                before = if range > before { range } else { before };
            }
        }
        let exit = if range > before { range } else { before };
        let next = axes[across].behind(borders[across]).map(|behind| {
            let mut next = last;
            next[across] = behind;
            Place { at: next, entered: exit }
        });
        let cells = 1 + at[0].abs_diff(last[0]) + at[1].abs_diff(last[1]);
        Crossing { last: Place { at: last, entered: before }, next, cells, exit }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fast::tiles::{PATCH, SIDE, SQUARE_SIDE};
    use grid::{DigitalLine, GridSpec};
    use proptest::prelude::*;

    /// A walk over the parts that the cells of a line are in, by their places on it.
    fn walks(
        mut walk: Walk,
        crossing: fn(&Walk) -> Crossing,
        numbering: &Numbering,
        line: &DigitalLine,
        part: &dyn Fn(usize) -> usize,
    ) -> Result<(), TestCaseError> {
        let mut k = 0;
        loop {
            let crossing = crossing(&walk);
            let last = (k..line.len()).take_while(|j| part(*j) == part(k)).count() + k - 1;
            prop_assert_eq!(crossing.cells as usize, last - k + 1);
            let found = |place: &Place| (numbering.at(place.at), place.entered);
            let expected = |k: usize| (numbering.of(line.cells()[k]), line.ranges()[k]);
            prop_assert_eq!(found(&crossing.last), expected(last));
            prop_assert!((crossing.exit - line.ranges()[last + 1]).abs() <= 0.0);
            let Some(next) = crossing.next else {
                prop_assert_eq!(last + 1, line.len());
                return Ok(());
            };
            k = last + 1;
            prop_assert_eq!(found(&next), expected(k));
            walk.place = next;
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2_000))]
        #[test]
        fn they_enter_and_leave_patches_and_squares_where_digital_lines_do(
            x in 0.0f64..1.0, y in 0.0f64..1.0, angle in -7.0f64..7.0, kind in 0usize..8,
            width in 1usize..300, height in 1usize..270,
        ) {
            let spec = GridSpec { cell_m: 0.05, origin_m: [-0.5, 1.0], width, height };
            let inside = |share: f64, cells: usize| share * cells as f64 * 0.05;
            let snapped = |v: f64| if kind % 2 == 1 { (v / 0.05).floor() * 0.05 } else { v };
            let origin = [-0.5 + snapped(inside(x, width)), 1.0 + snapped(inside(y, height))];
            let direction = match kind {
                0..4 => [angle.cos(), angle.sin()],
                4..6 => [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][angle.abs() as usize % 4],
                // Through corners.
                _ => [[0.5f64.sqrt(), 0.5f64.sqrt()], [-0.5f64.sqrt(), 0.5f64.sqrt()]][angle.abs() as usize % 2],
            };
            let mut line = DigitalLine::default();
            line.trace(&spec, origin, direction, f64::INFINITY);
            prop_assume!(!line.is_empty());
            let numbering = Numbering::new(spec);
            let number = |k: usize| numbering.of(line.cells()[k]);
            let (column, row) = spec.column_row(line.cells()[0]);
            let start = Walk::new(&numbering, origin, direction, Place { at: [column as u32, row as u32], entered: 0.0 });
            let patches = |k: usize| number(k) as usize / PATCH;
            let squares = |k: usize| numbering.square_of(number(k));
            walks(start.clone(), Walk::crossing::<SIDE>, &numbering, &line, &patches)?;
            walks(start, Walk::crossing::<SQUARE_SIDE>, &numbering, &line, &squares)?;
        }
    }
}
