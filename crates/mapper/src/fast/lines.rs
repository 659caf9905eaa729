//! Several digital lines traced in lockstep: the cells of [`grid::DigitalLine`], to the bit.

use sensor::lanes::{LANES, Lanes, each};

use crate::fast::tiles::Numbering;
use crate::fast::walk::Place;

/// Lines on their way, a lane to each. A lane whose line has ended stays in its last cell.
///
/// All is in double precision, whole numbers too: then every operation is one on whole vectors.
#[derive(Clone)]
pub(crate) struct Lines {
    numbering: Numbering,
    /// Column and row of the cell that each line is in.
    column_row: [Lanes<u32>; 2],
    /// Range at which each line left the cell before, m.
    pub(crate) entered: Lanes<f64>,
    /// 1 where a line goes on, 0 where it has left the grid or come to its end.
    pub(crate) alive: Lanes<f64>,
    /// Range at which each line ends, m.
    until: Lanes<f64>,
    x: Axes,
    y: Axes,
}

/// One coordinate of the lines.
#[derive(Clone, Default)]
struct Axes {
    /// Range of the next grid line, m.
    next: Lanes<f64>,
    /// Its number.
    line: Lanes<f64>,
    /// What a step adds to that number: 1 or -1.
    towards: Lanes<f64>,
    origin: Lanes<f64>,
    /// 1 / direction; 0 where the lane never crosses a line of this axis ...
    inverse: Lanes<f64>,
    /// ... and infinity there, 0 otherwise.
    never: Lanes<f64>,
    /// Steps that are left before the border.
    left: Lanes<f64>,
    /// What a grid line's number is ahead of that of the cell before it, with its sign changed: -1 or 0.
    behind: Lanes<f64>,
    grid_origin: f64,
}

/// A step of all lines.
pub(crate) struct Step {
    /// Range at which each line leaves its cell, m.
    pub(crate) exit: Lanes<f64>,
    /// The edge crossed: twice the number of its left or lower cell, plus one where the other is above rather than to
    /// the right; of a line that ends, any of the grid's.
    pub(crate) edge: Lanes<u32>,
}

/// Whole numbers from 0, below 2^32.
#[inline(always)]
fn whole(number: &Lanes<f64>) -> Lanes<u32> {
    const UNITS: f64 = 4_503_599_627_370_496.0; // 2^52: the low bits of a sum with it are the number
    each(|l| (number[l] + UNITS).to_bits() as u32)
}

impl Lines {
    /// No line in any lane.
    pub(crate) fn new(numbering: Numbering) -> Self {
        let [x, y] = numbering.spec().origin_m.map(|origin| Axes {
            grid_origin: origin,
            never: [f64::INFINITY; LANES],
            next: [f64::INFINITY; LANES],
            ..Axes::default()
        });
        let none = [0.0; LANES];
        Self { numbering, column_row: [[0; LANES]; 2], entered: none, alive: none, until: none, x, y }
    }

    /// A line from `origin` (m) along the unit vector `direction` to `until` (m) or the border of the grid; false where
    /// it starts outside the grid.
    pub(crate) fn start(&mut self, lane: usize, origin: [f64; 2], direction: [f64; 2], until: f64) -> bool {
        let spec = *self.numbering.spec();
        let Some(cell) = spec.locate(origin) else { return false };
        let (column, row) = spec.column_row(cell);
        let place = Place { at: [column as u32, row as u32], entered: 0.0 };
        self.go_on_from(lane, origin, direction, place, until);
        true
    }

    /// The same line from a cell on it.
    pub(super) fn go_on_from(
        &mut self,
        lane: usize,
        origin: [f64; 2],
        direction: [f64; 2],
        Place { at: [column, row], entered }: Place,
        until: f64,
    ) {
        let spec = *self.numbering.spec();
        self.column_row[0][lane] = column;
        self.column_row[1][lane] = row;
        self.entered[lane] = entered;
        self.alive[lane] = 1.0;
        self.until[lane] = until;
        let (column, row) = (column as usize, row as usize);
        let starts = [(column, spec.width), (row, spec.height)];
        for (k, (axes, (at, limit))) in [&mut self.x, &mut self.y].into_iter().zip(starts).enumerate() {
            let (forward, still) = (direction[k] > 0.0, direction[k] == 0.0);
            axes.origin[lane] = origin[k];
            axes.inverse[lane] = if still { 0.0 } else { 1.0 / direction[k] };
            axes.never[lane] = if still { f64::INFINITY } else { 0.0 };
            axes.towards[lane] = if forward { 1.0 } else { -1.0 };
            axes.behind[lane] = if forward { -1.0 } else { 0.0 };
            axes.line[lane] = (at + usize::from(forward)) as f64;
            axes.left[lane] = (if forward { limit - 1 - at } else { at }) as f64;
            axes.next[lane] = axes.crossing(lane, spec.cell_m);
        }
    }

    /// The cell that a line is in.
    pub(super) fn place(&self, lane: usize) -> Place {
        Place { at: [self.column_row[0][lane], self.column_row[1][lane]], entered: self.entered[lane] }
    }

    /// Whether no line goes on.
    #[inline(always)]
    pub(crate) fn done(&self) -> bool {
        self.alive.iter().sum::<f64>() <= 0.0
    }

    /// Number of the cell that each line is in.
    #[inline(always)]
    pub(crate) fn cell(&self) -> Lanes<u32> {
        let [column, row] = &self.column_row;
        self.numbering.lanes(column, row)
    }

    /// Every line goes on by one cell.
    #[inline(always)]
    pub(crate) fn step(&mut self) -> Step {
        let (x, y) = (&mut self.x, &mut self.y);
        let next = each(|l| if x.next[l] <= y.next[l] { x.next[l] } else { y.next[l] });
        let along_x = each(|l| if x.next[l] <= y.next[l] { 1.0 } else { 0.0 });
        // Rounding can put a crossing a hair before the one that precedes it.
        let next = each(|l| if next[l] > self.entered[l] { next[l] } else { self.entered[l] });
        let next = each(|l| if next[l] < self.until[l] { next[l] } else { self.until[l] });
        let exit = each(|l| if self.alive[l] > 0.0 { next[l] } else { self.entered[l] });
        let open = each(|l| if exit[l] < self.until[l] { self.alive[l] } else { 0.0 });

        let left = each(|l| if along_x[l] > 0.0 { x.left[l] } else { y.left[l] });
        let goes_on = each(|l| if left[l] > 0.0 { open[l] } else { 0.0 });
        let step_x = each(|l| goes_on[l] * along_x[l]);
        let step_y = each(|l| goes_on[l] * (1.0 - along_x[l]));
        let cell_m = self.numbering.spec().cell_m;
        x.advance(&step_x, cell_m);
        y.advance(&step_y, cell_m);
        let [column, row] = &self.column_row;
        let after = [x.at(), y.at()];
        let low = [each(|l| column[l].min(after[0][l])), each(|l| row[l].min(after[1][l]))];
        let low = self.numbering.lanes(&low[0], &low[1]);
        let axis = whole(&each(|l| 1.0 - along_x[l]));
        let edge = each(|l| 2 * low[l] + axis[l]);
        (self.column_row, self.alive, self.entered) = (after, goes_on, exit);
        Step { exit, edge }
    }
}

impl Axes {
    #[inline(always)]
    fn advance(&mut self, step: &Lanes<f64>, cell_m: f64) {
        self.left = each(|l| self.left[l] - step[l]);
        self.line = each(|l| self.line[l] + step[l] * self.towards[l]);
        self.look_ahead(cell_m);
    }

    /// The cell's column, or row.
    #[inline(always)]
    fn at(&self) -> Lanes<u32> {
        whole(&each(|l| self.line[l] + self.behind[l]))
    }

    /// As [`grid::DigitalLine`] has it, to the bit.
    #[inline(always)]
    fn look_ahead(&mut self, cell_m: f64) {
        self.next = each(|l| self.crossing(l, cell_m));
    }

    /// Range of the next grid line, m.
    #[inline(always)]
    fn crossing(&self, l: usize, cell_m: f64) -> f64 {
        (self.grid_origin + self.line[l] * cell_m - self.origin[l]) * self.inverse[l] + self.never[l]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::{DigitalLine, GridSpec};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn they_are_digital_lines(
            starts in prop::array::uniform8((-0.6f64..1.6, 0.9f64..2.6, -7.0f64..7.0, 0usize..6, 0.0f64..4.0)),
            width in 1usize..50, height in 1usize..40,
        ) {
            let spec = GridSpec { cell_m: 0.05, origin_m: [-0.5, 1.0], width, height };
            let numbering = Numbering::new(spec);
            let mut lines = Lines::new(numbering);
            let snap = |v: f64, origin: f64| ((v - origin) / 0.05).floor() * 0.05 + origin;
            let mut expected = Vec::new();
            for (lane, (x, y, angle, kind, until)) in starts.into_iter().enumerate() {
                let origin = if kind == 1 { [snap(x, -0.5), snap(y, 1.0)] } else { [x, y] };
                let direction = if kind < 4 { [angle.cos(), angle.sin()] } else {
                    [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][angle.abs() as usize % 4]
                };
                let mut line = DigitalLine::default();
                let until = if until < 2.0 { until } else { f64::INFINITY };
                line.trace(&spec, origin, direction, until);
                prop_assert_eq!(lines.start(lane, origin, direction, until), !line.is_empty());
                expected.push(line);
            }
            let mut k = 0;
            while !lines.done() {
                let (cell, entered, alive) = (lines.cell(), lines.entered, lines.alive);
                let step = lines.step();
                for lane in 0..LANES {
                    let line = &expected[lane];
                    prop_assert_eq!(alive[lane] > 0.0, k < line.len());
                    if k < line.len() {
                        prop_assert_eq!(cell[lane], numbering.of(line.cells()[k]));
                        prop_assert_eq!((entered[lane], step.exit[lane]), (line.ranges()[k], line.ranges()[k + 1]));
                    }
                    if k + 1 < line.len() {
                        let edge = spec.edge_between(line.cells()[k], line.cells()[k + 1]);
                        prop_assert_eq!(step.edge[lane], 2 * numbering.of(edge / 2) + edge as u32 % 2);
                    }
                }
                k += 1;
            }
            prop_assert!(expected.iter().all(|line| line.len() <= k));
        }
    }
}
