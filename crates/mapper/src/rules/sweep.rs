//! The cells of a ray as sets of bits, one for every patch that it crosses.

use grid::Staircase;
use sensor::Ray;
use sensor::lanes::LANES;

use crate::fast::tiles::{Numbering, PATCH, SIDE};
use crate::memory::Held;

/// Cells of a patch: bit `k` is the cell `k` places behind its first.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Cells {
    /// Number of the patch: that of its first cell by the number of cells of a patch.
    pub(crate) patch: u32,
    pub(crate) bits: u64,
}

/// The cells that a ray crosses. A buffer to trace into.
///
/// A patch is eight columns wide. In these, a ray that is no steeper than a diagonal crosses two patches at most, and their bits are put together
/// from one shift per column: little is left to be done cell by cell. Steep rays are those with rows for columns.
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
            sweep(&self.stairs, numbering, &mut self.cells);
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

/// A block of columns (or of rows of a steep ray) is as wide as a patch.
const _: () = assert!(Staircase::BLOCK == SIDE && SIDE * SIDE == PATCH && PATCH == 64);

/// All columns but the last.
fn sweep(stairs: &Staircase, numbering: &Numbering, cells: &mut Vec<Cells>) {
    let (steep, main) = (stairs.steep(), usize::from(stairs.steep()));
    let [start, next] = [stairs.cell(0, 0), stairs.cell(1, 1)];
    let backward = next[main] < start[main];
    let (first, towards) = (start[1 - main], next[1 - main].wrapping_sub(start[1 - main]));
    let mut len = 0;
    cells.resize(2 * (stairs.crossings()[0] / SIDE + 2), Cells::default());
    for block in stairs.blocks() {
        let (begin, end) = (block.columns.start, block.columns.end - 1);
        let row = |crossings: u32| first.wrapping_add(towards.wrapping_mul(crossings as usize));
        // The ray crosses at most two patches, one above the other.
        let below = row(block.coming[begin]).min(row(block.going[end])) / SIDE;
        let from = row(0).wrapping_sub(SIDE * below);
        let place = |column: usize, crossings: u32| {
            let row = from.wrapping_add(towards.wrapping_mul(crossings as usize));
            row.wrapping_mul(SIDE) | if backward { SIDE - 1 - column } else { column }
        };
        // Bits of both, of which no two are the same, and those of the one above.
        let (mut both, mut above) = (0u64, 0u64);
        let mut add = |cells: u64, place: usize| {
            let bits = cells << (place % PATCH);
            both |= bits;
            above |= if place & PATCH == 0 { 0 } else { bits };
        };
        add(1, place(0, block.coming[0]));
        add(1, place(SIDE - 1, block.going[SIDE - 1]));
        // The cells on either side of every grid line between two columns.
        for column in 0..SIDE - 1 {
            add(0b11, place(column + usize::from(backward), block.going[column]));
        }
        let crossed = crossed(block.columns, backward);
        (both, above) = (both & crossed, above & crossed);
        // The second is often empty, which is no branch: it is overwritten by the next.
        let patch = |above: usize, bits: u64| {
            let corner = [SIDE * block.number, SIDE * (below + above)];
            let ([column, row], bits) = if steep { ([corner[1], corner[0]], transposed(bits)) } else { (corner, bits) };
            Cells { patch: numbering.lanes(&[column as u32; LANES], &[row as u32; LANES])[0] / PATCH as u32, bits }
        };
        let (here, next) = (patch(0, both & !above), patch(1, above));
        (cells[len], cells[len + 1]) = (if here.bits == 0 { next } else { here }, next);
        len += 1 + usize::from(here.bits != 0 && next.bits != 0);
    }
    cells.truncate(len);
}

/// The bits of some columns of a patch, in the order in which a ray comes to them.
#[inline(always)]
fn crossed(columns: std::ops::Range<usize>, backward: bool) -> u64 {
    if columns.len() == SIDE {
        return u64::MAX;
    }
    let inside = |column: usize| if backward { SIDE - 1 - column } else { column };
    columns.fold(0, |all, column| all | 0x0101_0101_0101_0101 << inside(column))
}

/// A patch with rows for columns: 2 x 2 cells change places, then 2 x 2 squares of them, then 2 x 2 of these.
fn transposed(bits: u64) -> u64 {
    let swap = |bits: u64, distance: u32, mask: u64| {
        let differ = (bits ^ (bits >> distance)) & mask;
        bits ^ differ ^ (differ << distance)
    };
    let bits = swap(bits, 7, 0x00aa_00aa_00aa_00aa);
    let bits = swap(bits, 14, 0x0000_cccc_0000_cccc);
    swap(bits, 28, 0x0000_0000_f0f0_f0f0)
}

impl Held for Sweep {
    fn held(&self) -> usize {
        self.cells.held() + self.stairs.held()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::{DigitalLine, GridSpec};
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        /// The cells of the digital line, also along grid lines and diagonals, from corners, and beyond the border.
        #[test]
        fn it_is_a_digital_line(
            width in 1usize..70, height in 1usize..70, at in prop::array::uniform2((0.0f64..1.0, any::<bool>())), kind in 0usize..4,
            angle in -4.0f64..4.0, until in prop_oneof![0.0f64..5.0, Just(0.0), Just(f64::INFINITY)],
        ) {
            let spec = GridSpec { cell_m: 0.05, origin_m: [-0.3, 7.0], width, height };
            let numbering = Numbering::new(spec);
            let origin_m = [0, 1].map(|k| {
                let cells = at[k].0 * [width, height][k] as f64;
                spec.origin_m[k] + 0.05 * if at[k].1 { cells.floor() } else { cells }
            });
            let eighth = std::f64::consts::FRAC_PI_4;
            let angle = if kind == 0 { (angle / eighth).round() * eighth } else if kind == 1 { (angle / eighth).round() * eighth + 1e-4 } else { angle };
            let ray = Ray { origin_m, direction: [angle.cos(), angle.sin()], bearing_rad: 0.0, reading: None };
            let mut line = DigitalLine::default();
            line.trace(&spec, origin_m, ray.direction, until);
            let mut sweep = Sweep::default();
            sweep.trace(&numbering, &ray, until);
            prop_assert_eq!(sweep.len(), line.len());
            let numbers = |cells: &[Cells]| -> BTreeSet<u32> {
                let of = |cells: &Cells| (0..64).filter(|k| cells.bits >> k & 1 == 1).map(|k| 64 * cells.patch + k).collect::<Vec<_>>();
                cells.iter().flat_map(of).collect()
            };
            let Some((last, before)) = line.cells().split_last() else { return Ok(()) };
            let expected: BTreeSet<u32> = before.iter().map(|cell| numbering.of(*cell)).collect();
            prop_assert_eq!(numbers(sweep.before_last()), expected);
            prop_assert_eq!(numbers(&[sweep.last().expect("a ray")]), BTreeSet::from([numbering.of(*last)]));
            prop_assert_eq!(Some(&sweep.end_m()), line.ranges().last());
        }

        #[test]
        fn transposed_twice_is_as_before(bits: u64, row in 0u32..8, column in 0u32..8) {
            prop_assert_eq!(transposed(transposed(bits)), bits);
            prop_assert_eq!(transposed(1 << (8 * row + column)), 1 << (8 * column + row));
        }
    }
}
