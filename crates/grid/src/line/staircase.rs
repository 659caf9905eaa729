//! A ray as a staircase: how far the one coordinate has come at every grid line of the other.

use super::crossings::{BLOCK, Crossings};
use crate::GridSpec;

/// A ray over the cells of a grid. Of its two axes, the main one is that of which it crosses more grid lines; between two of them it
/// crosses at most one of the other, or two where rounding has it so.
///
/// A walk from cell to cell would have every step wait for the one before, and every third branch on which grid line comes next
/// be guessed wrongly. Here nothing waits: for several crossings of the main axis at a time, those of the other axis that come before
/// them are counted. A staircase is a buffer to trace into.
#[derive(Debug, Clone, Default)]
pub struct Staircase {
    /// Whether the main axis is y.
    steep: bool,
    /// The main axis and the other; none of a ray that starts outside the grid.
    axes: Option<[Crossings; 2]>,
    /// Crossings of each.
    crossings: [usize; 2],
    end_m: f64,
    /// Crossings of the main axis that are only there so that the others come in blocks.
    lead: usize,
    /// Range (m) of every crossing of the main axis, after the lead.
    ranges_m: Vec<f64>,
    /// How many crossings of the other axis come before it, and before that, one more of the lead: 0 in the lead, all from the last crossing
    /// to the end of the last block.
    before: Vec<u32>,
}

impl Staircase {
    /// Columns, or rows, are taken in blocks of so many, from the border of the grid on.
    pub const BLOCK: usize = BLOCK;

    /// Traces the ray from `origin` (m) along the unit vector `direction` to `max_range` (m) or the border of the grid,
    /// whichever comes first; pass infinity for the border. False where the origin lies outside the grid.
    pub fn trace(&mut self, spec: &GridSpec, origin: [f64; 2], direction: [f64; 2], max_range: f64) -> bool {
        debug_assert!((direction[0].hypot(direction[1]) - 1.0).abs() < 1e-9, "{direction:?} is no unit vector");
        self.axes = None;
        let Some(start) = spec.locate(origin) else { return false };
        let (column, row) = spec.column_row(start);
        let x = Crossings::new(spec, 0, column, origin[0], direction[0]);
        let y = Crossings::new(spec, 1, row, origin[1], direction[1]);
        let (x_border_m, y_border_m) = (x.border_m(), y.border_m());
        // Where x and y are crossed at once, x comes first.
        let [mut columns, mut rows] = [x.inside_before(y_border_m, true), y.inside_before(x_border_m, false)];
        let border_m = x_border_m.min(y_border_m).max(0.0);
        if max_range < border_m {
            // Rounding can put a crossing a hair before the origin.
            let until_m = if max_range > 0.0 { max_range } else { f64::NEG_INFINITY };
            (columns, rows) = (columns.min(x.inside_before(until_m, false)), rows.min(y.inside_before(until_m, false)));
        }
        self.end_m = border_m.min(max_range);
        self.steep = rows > columns;
        (self.axes, self.crossings) =
            if self.steep { (Some([y, x]), [rows, columns]) } else { (Some([x, y]), [columns, rows]) };
        self.lead = if self.steep { y.in_block() } else { x.in_block() };
        let room = (self.lead + self.crossings[0]).next_multiple_of(BLOCK);
        if self.before.len() <= room {
            self.before.resize(room + 1, 0);
            self.ranges_m.resize(room, 0.0);
        }
        pulp::Arch::new().dispatch(Count(self, room));
        self.before[..=self.lead].fill(0);
        self.before[1 + self.lead + self.crossings[0]..=room].fill(self.crossings[1] as u32);
        true
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        if self.axes.is_some() { self.crossings[0] + self.crossings[1] + 1 } else { 0 }
    }

    /// Range (m) at which the ray ends.
    pub fn end_m(&self) -> f64 {
        self.end_m
    }

    /// Whether the main axis is y.
    pub fn steep(&self) -> bool {
        self.steep
    }

    /// Whether the ray is so near to a diagonal that rounding can put two crossings of the other axis between two of the main axis.
    pub fn diagonal(&self) -> bool {
        self.axes.is_some_and(|[main, other]| other.per_m() > 0.999 * main.per_m())
    }

    /// Number of crossings of the main axis and of the other.
    pub fn crossings(&self) -> [usize; 2] {
        self.crossings
    }

    /// How many crossings of the other axis come before each of the main axis: never decreases.
    pub fn before(&self) -> &[u32] {
        &self.before[1 + self.lead..][..self.crossings[0]]
    }

    /// The same a block at a time: every column (of a steep ray, every row) but the one in which the ray ends.
    pub fn blocks(&self) -> impl Iterator<Item = Block<'_>> {
        let (main, crossings) = self.axes.map_or((None, 0), |[main, _]| (Some(main), self.crossings[0]));
        let columns = self.lead + crossings;
        let counts = [&self.before, self.before.get(1..).unwrap_or_default()].map(|before| before.as_chunks().0);
        let blocks = counts[0].iter().zip(counts[1]).take(if crossings > 0 { columns.div_ceil(BLOCK) } else { 0 });
        blocks.enumerate().map(move |(k, (coming, going))| Block {
            number: main.map_or(0, |main| main.block(k)),
            columns: (if k == 0 { self.lead } else { 0 })..BLOCK.min(columns - k * BLOCK),
            coming,
            going,
        })
    }

    /// Column and row of the cell behind so many crossings of the main axis and so many of the other.
    ///
    /// # Panics
    /// If there is no ray.
    #[inline(always)]
    pub fn cell(&self, main: usize, other: usize) -> [usize; 2] {
        let [along, across] = self.axes.expect("a ray");
        let cell = [along.behind(main), across.behind(other)];
        if self.steep { [cell[1], cell[0]] } else { cell }
    }

    /// Bytes that its buffers hold.
    pub fn held(&self) -> usize {
        self.before.capacity() * size_of::<u32>() + self.ranges_m.capacity() * size_of::<f64>()
    }

    /// The main axis and the other with the number of crossings of each, if there is a ray.
    pub(super) fn axes(&self) -> Option<[(&Crossings, usize); 2]> {
        let [main, other] = self.axes.as_ref()?;
        Some([(main, self.crossings[0]), (other, self.crossings[1])])
    }

    /// Ranges (m) of the crossings of the main axis, below 0 by rounding alone.
    pub(super) fn ranges_m(&self) -> &[f64] {
        &self.ranges_m[self.lead..][..self.crossings[0]]
    }
}

/// A block of columns, or of rows of a steep ray, in the order in which the ray comes to them.
pub struct Block<'a> {
    /// Its number among the blocks of the grid: that of its columns by [`Staircase::BLOCK`].
    pub number: usize,
    /// Those of its columns that the ray crosses from side to side, or from its start.
    pub columns: std::ops::Range<usize>,
    /// Crossings of the other axis before each column ...
    pub coming: &'a [u32; BLOCK],
    /// ... and up to the next: the cells in a column are those behind `coming` to `going` of them. They go on as they were in columns that the
    /// ray does not cross.
    pub going: &'a [u32; BLOCK],
}

/// The crossings of the main axis, so many of them.
struct Count<'a>(&'a mut Staircase, usize);

impl pulp::WithSimd for Count<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self(Staircase { steep, axes, crossings, lead, ranges_m, before, .. }, room) = self;
        let (Some([main, other]), [_, others]) = (*axes, *crossings) else { return };
        let blocks = ranges_m[..room].chunks_exact_mut(BLOCK).zip(before[1..=room].chunks_exact_mut(BLOCK));
        for (block, (ranges_m, before)) in blocks.enumerate() {
            let from = (block * BLOCK) as f64 - *lead as f64;
            for (l, range_m) in ranges_m.iter_mut().enumerate() {
                *range_m = main.range_m(from + l as f64);
            }
            if others == 0 {
                before.fill(0);
            } else if *steep {
                count::<true>(&other, ranges_m, before);
            } else {
                count::<false>(&other, ranges_m, before);
            }
        }
    }
}

/// How many crossings come before each of some ranges (m), or at it if `TIES`.
#[inline(always)]
fn count<const TIES: bool>(crossings: &Crossings, ranges_m: &[f64], before: &mut [u32]) {
    /// The low bits of a sum with 2^52 are the other number.
    const WHOLE: f64 = 4_503_599_627_370_496.0;
    for (before, range_m) in before.iter_mut().zip(ranges_m) {
        *before = (crossings.before(*range_m, TIES) + WHOLE).to_bits() as u32;
    }
}
