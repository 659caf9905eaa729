//! One coordinate of a ray: the grid lines that it crosses, and where.

use crate::GridSpec;

/// Columns, or rows, are taken in blocks of so many.
pub(super) const BLOCK: usize = 8;

/// The grid lines of one direction that a ray crosses, numbered from 0, nearest first, up to that in which the grid ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossings {
    /// Column (or row) in which the ray starts.
    start: usize,
    forward: bool,
    /// Crossings after which the ray is still in the grid.
    pub(super) inside: usize,
    /// Number of the first grid line that is crossed, and what a crossing adds to it: 1 or -1.
    first: f64,
    towards: f64,
    origin: f64,
    /// 1 / direction; infinite where no grid line is ever crossed.
    inverse: f64,
    grid_origin: f64,
    cell_m: f64,
    /// Range (m) of crossing 0 and crossings per metre, roughly.
    from_m: f64,
    per_m: f64,
}

impl Crossings {
    /// Of x (axis 0) or y (axis 1) of a ray that starts in a column or row.
    pub(super) fn new(spec: &GridSpec, axis: usize, start: usize, origin: f64, direction: f64) -> Self {
        let forward = direction > 0.0;
        let limit = [spec.width, spec.height][axis];
        let mut crossings = Self {
            start,
            forward,
            inside: if forward { limit - 1 - start } else { start },
            first: (start + usize::from(forward)) as f64,
            towards: if forward { 1.0 } else { -1.0 },
            origin,
            inverse: if direction == 0.0 { f64::INFINITY } else { 1.0 / direction },
            grid_origin: spec.origin_m[axis],
            cell_m: spec.cell_m,
            from_m: f64::INFINITY,
            per_m: direction.abs() / spec.cell_m,
        };
        if crossings.any() {
            crossings.from_m = crossings.range_m(0.0);
        } else {
            crossings.inside = 0;
        }
        crossings
    }

    /// Whether the ray ever crosses a grid line.
    fn any(&self) -> bool {
        self.inverse.is_finite()
    }

    /// Range (m) of a crossing, if there is [`any`](Self::any). Computed from the grid line's number, not by adding up steps: errors do
    /// not grow with range. Never decreases with the number, since no rounding does.
    #[inline(always)]
    pub(super) fn range_m(&self, crossing: f64) -> f64 {
        (self.grid_origin + (self.first + crossing * self.towards) * self.cell_m - self.origin) * self.inverse
    }

    /// Crossings per metre, roughly.
    pub(super) fn per_m(&self) -> f64 {
        self.per_m
    }

    /// Range (m) at which the ray leaves the grid.
    pub(super) fn border_m(&self) -> f64 {
        if self.any() { self.range_m(self.inside as f64) } else { f64::INFINITY }
    }

    /// The column (or row) behind so many crossings.
    #[inline(always)]
    pub(super) fn behind(&self, crossings: usize) -> usize {
        if self.forward { self.start + crossings } else { self.start.wrapping_sub(crossings) }
    }

    /// Columns (or rows) of the block of the start that the ray does not come to, on its side.
    pub(super) fn in_block(&self) -> usize {
        let at = self.start % BLOCK;
        if self.forward { at } else { BLOCK - 1 - at }
    }

    /// The block of columns to which the ray comes after so many others.
    #[inline(always)]
    pub(super) fn block(&self, blocks: usize) -> usize {
        let start = self.start / BLOCK;
        if self.forward { start + blocks } else { start.wrapping_sub(blocks) }
    }

    /// How many crossings there are before a range (m), those at it among them if `ties`, could the grid go on for ever.
    ///
    /// The range lies nearest to one crossing. Those before that one come before the range, those after it after the range, and of that
    /// one the ranges are compared: the count is exact, although where the range lies is only estimated.
    #[inline(always)]
    pub(super) fn before(&self, range_m: f64, ties: bool) -> f64 {
        /// A sum with 2^52 has no fraction.
        const WHOLE: f64 = 4_503_599_627_370_496.0;
        let place = (range_m - self.from_m) * self.per_m;
        let place = if place > 0.0 { place } else { 0.0 };
        let nearest = (place + WHOLE) - WHOLE;
        let nearest_m = self.range_m(nearest);
        let precedes = if ties { nearest_m <= range_m } else { nearest_m < range_m };
        nearest + if precedes { 1.0 } else { 0.0 }
    }

    /// The same of the crossings after which the ray is still in the grid.
    pub(super) fn inside_before(&self, range_m: f64, ties: bool) -> usize {
        let far = range_m > self.border_m();
        if self.inside == 0 || far { self.inside } else { (self.before(range_m, ties) as usize).min(self.inside) }
    }
}
