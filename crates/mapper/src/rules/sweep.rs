//! The cells of a ray as sets of bits, one for every patch that it crosses.

use std::ops::Range;

use grid::Staircase;
use sensor::lanes::{LANES, Lanes, each};
use sensor::{Ray, in_lanes};

use crate::fast::tiles::{Numbering, PATCH, SIDE};
use crate::memory::Held;

/// Cells of a patch: bit `k` is the cell `k` places behind its first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cells {
    /// Number of the patch: that of its first cell by the number of cells of a patch.
    pub(crate) patch: u32,
    pub(crate) bits: u64,
}

/// The cells that a ray crosses. A buffer to trace into.
///
/// A patch is eight columns wide, of which the ray (if it is no steeper than a diagonal) crosses at most two patches. The bits of both are put
/// together at once, so that what remains to be done of a cell of a ray is an eighth of a few operations.
#[derive(Clone, Default)]
pub(crate) struct Sweep {
    stairs: Staircase,
    cells: Vec<Cells>,
    last: Option<Cells>,
}

impl Sweep {
    /// Traces a ray up to a range (m) or the border; no cell where it starts outside the grid.
    pub(crate) fn trace(&mut self, numbering: &Numbering, ray: &Ray, until_m: f64) {
        self.cells.clear();
        self.last = None;
        if !self.stairs.trace(numbering.spec(), ray.origin_m, ray.direction, until_m) {
            return;
        }
        let [main, other] = self.stairs.crossings();
        let mut passed = 0;
        if self.stairs.diagonal() {
            for (column, going) in self.stairs.before().iter().map(|before| *before as usize).enumerate() {
                self.cells.extend((passed..=going).map(|row| cell(&self.stairs, numbering, column, row)));
                passed = going;
            }
        } else {
            sweep(self, numbering);
            passed = self.stairs.before().last().map_or(0, |before| *before as usize);
        }
        // The column in which the ray ends.
        self.cells.extend((passed..other).map(|row| cell(&self.stairs, numbering, main, row)));
        self.last = Some(cell(&self.stairs, numbering, main, other));
    }

    /// Number of cells.
    pub(crate) fn len(&self) -> usize {
        self.stairs.cells()
    }

    /// All cells but the last.
    pub(crate) fn before_last(&self) -> &[Cells] {
        &self.cells
    }

    /// The last cell.
    pub(crate) fn last(&self) -> Option<Cells> {
        self.last
    }

    /// Range (m) at which the ray ends.
    pub(crate) fn end_m(&self) -> f64 {
        self.stairs.end_m()
    }
}

/// The cell behind so many crossings of the main axis and so many of the other.
fn cell(stairs: &Staircase, numbering: &Numbering, main: usize, other: usize) -> Cells {
    let [column, row] = stairs.cell(main, other);
    let number = numbering.number(column, row);
    Cells { patch: number / PATCH as u32, bits: 1 << (number % PATCH as u32) }
}

in_lanes! {
    fn sweep<'a>(sweep: &'a mut Sweep, numbering: &'a Numbering) {
        sweep_blocks(sweep, numbering);
    }
}

#[inline(always)]
fn sweep_blocks(Sweep { stairs, cells, .. }: &mut Sweep, numbering: &Numbering) {
    let columns = Columns::new(stairs);
    for block in stairs.blocks() {
        let first = columns.first(numbering, block.number);
        let coming = columns.numbers(numbering, first, block.coming);
        let going = columns.numbers(numbering, first, block.going);
        // The ray crosses at most two patches.
        let (near, far) = (coming[0] / PATCH as u32, going[LANES - 1] / PATCH as u32);
        let ([a, b], [c, d]) = (bits(&coming, near), bits(&going, near));
        let crossed = columns.crossed(block.columns);
        cells.push(Cells { patch: near, bits: (a | c) & crossed });
        if far != near {
            cells.push(Cells { patch: far, bits: (b | d) & crossed });
        }
    }
}

/// The bits of some cells: of those in a patch, and of those in another.
#[inline(always)]
fn bits(numbers: &Lanes<u32>, patch: u32) -> [u64; 2] {
    let bit = each(|l| 1 << (u64::from(numbers[l]) % PATCH as u64));
    let here = each(|l| if numbers[l] / PATCH as u32 == patch { bit[l] } else { 0 });
    let (mut all, mut inside) = (0, 0);
    for l in 0..LANES {
        (all, inside) = (all | bit[l], inside | here[l]);
    }
    [inside, all & !inside]
}

/// How the cells of a ray are numbered: columns, or rows of a steep ray, by what each adds to the number of a cell.
struct Columns {
    steep: bool,
    /// What the columns of a block add to the number of its first cell, in the order in which the ray comes to them.
    inside: Lanes<u32>,
    /// Row in which the ray starts, and what a crossing adds to it.
    row: u32,
    towards: u32,
}

impl Columns {
    #[inline(always)]
    fn new(stairs: &Staircase) -> Self {
        let steep = stairs.steep();
        let [column, row] = [0, 1].map(|axis| {
            let [here, next] = [stairs.cell(0, 0), stairs.cell(1, 1)].map(|cell| cell[axis] as u32);
            (here, next.wrapping_sub(here))
        });
        let ((_, main), (row, towards)) = if steep { (row, column) } else { (column, row) };
        let step = if steep { SIDE } else { 1 } as u32;
        let inside = each(|l| step * (if main == 1 { l } else { LANES - 1 - l }) as u32);
        Self { steep, inside, row, towards }
    }

    /// Number of the first cell of a block of columns of the grid.
    #[inline(always)]
    fn first(&self, numbering: &Numbering, block: usize) -> u32 {
        let at = block * LANES;
        if self.steep { numbering.number(0, at) } else { numbering.number(at, 0) }
    }

    /// Numbers of cells behind so many crossings, one in each column of a block.
    #[inline(always)]
    fn numbers(&self, numbering: &Numbering, first: u32, crossings: &Lanes<u32>) -> Lanes<u32> {
        let row = each(|l| self.row.wrapping_add(crossings[l].wrapping_mul(self.towards)));
        let none = [0; LANES];
        let rows = if self.steep { numbering.lanes(&row, &none) } else { numbering.lanes(&none, &row) };
        each(|l| first + self.inside[l] + rows[l])
    }

    /// The bits of some columns of a block.
    #[inline(always)]
    fn crossed(&self, columns: Range<usize>) -> u64 {
        if columns.len() == LANES {
            return u64::MAX;
        }
        let column = if self.steep { 0xff } else { 0x0101_0101_0101_0101 };
        columns.fold(0, |all, l| all | column << self.inside[l])
    }
}

impl Held for Sweep {
    fn held(&self) -> usize {
        self.cells.held() + self.stairs.held()
    }
}
