//! Where the robot can be: its configuration space, exactly for square cells.

use grid::{GridSpec, Raster};

/// Taken off the distance that legs keep, in cells, so that rounding refuses none that is just wide enough.
const ROUNDING: f64 = 1e-6;

/// Steps to neighbours, along the sides first.
const AROUND: [[isize; 2]; 8] = [[1, 0], [0, 1], [-1, 0], [0, -1], [1, 1], [-1, 1], [-1, -1], [1, -1]];

/// The largest connected set of cells at whose centres the robot clears everything that is not free.
pub(crate) struct Space {
    spec: GridSpec,
    /// How many cells of a row that are not free lie before each column; `width + 1` numbers per row.
    before: Vec<u32>,
    drivable: Vec<bool>,
    /// The steps of [`AROUND`] that the robot can make from each cell, a bit for each.
    moves: Vec<u8>,
    /// What the robot's centre keeps from cells that are not free, in cells.
    needed: f64,
}

impl Space {
    /// The space of a robot whose centre keeps `needed_m` from cells that are not free. O(cells).
    pub(crate) fn new(cells: &Raster<Option<bool>>, needed_m: f64) -> Self {
        let spec = *cells.spec();
        let solid: Vec<bool> = cells.values().iter().map(|&c| c != Some(false)).collect();
        let needed = needed_m / spec.cell_m;
        let mut before = Vec::with_capacity((spec.width + 1) * spec.height);
        for row in solid.chunks_exact(spec.width) {
            before.push(0);
            let mut sum = 0;
            before.extend(row.iter().map(|&s| {
                sum += u32::from(s);
                sum
            }));
        }
        let drivable = largest(&spec, &clear(&spec, &solid, needed));
        let moves = moves(&spec, &drivable);
        Self { spec, before, drivable, moves, needed }
    }

    pub(crate) fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// Whether the robot can stand at the cell's centre and reach it.
    pub(crate) fn holds(&self, cell: usize) -> bool {
        self.drivable[cell]
    }

    /// The cells that the robot can reach.
    pub(crate) fn drivable(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.drivable.len()).filter(|&cell| self.drivable[cell])
    }

    /// Free cells that the robot's centre reaches, or that are as few steps away as the corner of a room is: the rims
    /// and corners of the space it drives in, but not the room behind a gap too narrow for it.
    pub(crate) fn floor(&self, cells: &Raster<Option<bool>>) -> Raster<bool> {
        let mut floor = Raster::new(self.spec, self.drivable.clone());
        let mut front: Vec<usize> = self.drivable().collect();
        let mut steps = 2.0 * ((self.needed + 0.5 - ROUNDING).ceil() - 1.0);
        while steps > 0.0 && !front.is_empty() {
            let mut next = Vec::new();
            for neighbour in front.iter().flat_map(|&cell| self.spec.neighbours(cell)) {
                if !floor[neighbour.cell] && cells[neighbour.cell] == Some(false) {
                    floor[neighbour.cell] = true;
                    next.push(neighbour.cell);
                }
            }
            (front, steps) = (next, steps - 1.0);
        }
        floor
    }

    /// The neighbours that the robot can step to, with the cost in fifths of a cell. A step aslant needs both cells
    /// beside it: then whatever the disc clears at the ends it clears on the way.
    pub(crate) fn steps(&self, cell: usize) -> impl Iterator<Item = (usize, u32)> + '_ {
        let moves = self.moves[cell];
        let width = self.spec.width as isize;
        AROUND.into_iter().enumerate().filter(move |(k, _)| moves >> k & 1 == 1).map(move |(_, [dx, dy])| {
            let straight = dx == 0 || dy == 0;
            (cell.wrapping_add_signed(dy * width + dx), if straight { 5 } else { 7 })
        })
    }

    /// Whether the robot can drive straight from the centre of one cell to that of another.
    pub(crate) fn leg(&self, from: usize, to: usize) -> bool {
        let centre = |cell| {
            let (column, row) = self.spec.column_row(cell);
            [column as f64 + 0.5, row as f64 + 0.5]
        };
        self.clears(centre(from), centre(to))
    }

    /// Whether the disc swept from `a` to `b`, in cells from the lower-left corner, meets only free cells. Row by
    /// row: the swept area is convex, so it meets the squares of a row within one interval.
    fn clears(&self, a: [f64; 2], b: [f64; 2]) -> bool {
        let reach = self.needed - ROUNDING;
        let (low, high) = ([0, 1].map(|k| a[k].min(b[k]) - reach), [0, 1].map(|k| a[k].max(b[k]) + reach));
        let size = [self.spec.width, self.spec.height].map(|n| n as f64);
        if (0..2).any(|k| low[k] < 0.0 || high[k] > size[k]) {
            return false;
        }
        (low[1] as usize..high[1].ceil() as usize).all(|row| {
            let strip = [low[1].max(row as f64), high[1].min(row as f64 + 1.0)];
            let [left, right] = interval(a, b, reach, strip);
            let (from, to) = (left.max(0.0) as usize, (right.ceil() as usize).min(self.spec.width));
            let line = &self.before[row * (self.spec.width + 1)..];
            from >= to || line[to] == line[from]
        })
    }
}

/// Left and right end of what the disc of radius `reach` swept from `a` to `b` has in a strip of heights.
fn interval(a: [f64; 2], b: [f64; 2], reach: f64, [bottom, top]: [f64; 2]) -> [f64; 2] {
    let (left, right) = if a[0] <= b[0] { (a, b) } else { (b, a) };
    // The border is concave: its farthest point in the strip is at the height nearest to where it is farthest of all.
    [across(a, b, reach, left[1].clamp(bottom, top))[0], across(a, b, reach, right[1].clamp(bottom, top))[1]]
}

/// Left and right end of the same at one height.
fn across(a: [f64; 2], b: [f64; 2], reach: f64, y: f64) -> [f64; 2] {
    let mut span = [f64::INFINITY, f64::NEG_INFINITY];
    let mut grow = |low: f64, high: f64| span = [span[0].min(low), span[1].max(high)];
    for end in [a, b] {
        let half = (reach * reach - (y - end[1]) * (y - end[1])).max(0.0).sqrt();
        if (y - end[1]).abs() <= reach {
            grow(end[0] - half, end[0] + half);
        }
    }
    let along = [b[0] - a[0], b[1] - a[1]];
    let length = libm::hypot(along[0], along[1]);
    if along[1] != 0.0 {
        for side in [reach / length, -reach / length] {
            let part = (y - (a[1] + side * along[0])) / along[1];
            if (0.0..=1.0).contains(&part) {
                let x = a[0] - side * along[1] + part * along[0];
                grow(x, x);
            }
        }
    }
    span
}

/// The cells whose centres keep `needed` (in cells) from every solid cell and from the border: the distance
/// to solid cells along each column first, then every row as a union of intervals.
fn clear(spec: &GridSpec, solid: &[bool], needed: f64) -> Vec<bool> {
    let GridSpec { width, height, .. } = *spec;
    let mut steps = vec![0u32; solid.len()];
    for column in 0..width {
        let mut nearest = 0;
        for row in 0..height {
            let cell = spec.index(column, row);
            nearest = if solid[cell] { 0 } else { nearest + 1 };
            steps[cell] = nearest;
        }
        nearest = 0;
        for row in (0..height).rev() {
            let cell = spec.index(column, row);
            nearest = if solid[cell] { 0 } else { nearest + 1 };
            steps[cell] = steps[cell].min(nearest);
        }
    }
    // How many columns away a square is too near, where it is `gap` above or below.
    let reach = |steps: u32| {
        let gap = (f64::from(steps) - 0.5).max(0.0);
        (gap < needed).then(|| ((0.5 + (needed * needed - gap * gap).sqrt() - ROUNDING).ceil() - 1.0) as usize)
    };
    let beside = reach(0).unwrap_or(0);
    let mut clear = vec![false; solid.len()];
    let mut change = vec![0i64; width + 1];
    for (steps, clear) in steps.chunks_exact(width).zip(clear.chunks_exact_mut(width)) {
        change.fill(0);
        let mut block = |from: usize, to: usize| {
            change[from.min(width)] += 1;
            change[to.min(width)] -= 1;
        };
        block(0, beside);
        block(width.saturating_sub(beside), width);
        for (column, &steps) in steps.iter().enumerate() {
            if let Some(reach) = reach(steps) {
                block(column.saturating_sub(reach), (column + 1).saturating_add(reach));
            }
        }
        let mut over = 0;
        for (clear, change) in clear.iter_mut().zip(&change) {
            over += change;
            *clear = over == 0;
        }
    }
    clear
}

/// Which steps of [`AROUND`] lead from each cell to another one of the set; aslant only between two others.
fn moves(spec: &GridSpec, set: &[bool]) -> Vec<u8> {
    let held = |column: usize, row: usize, [dx, dy]: [isize; 2]| {
        let (c, r) = (column.checked_add_signed(dx)?, row.checked_add_signed(dy)?);
        (c < spec.width && r < spec.height && set[spec.index(c, r)]).then_some(())
    };
    let step = |cell: usize, [dx, dy]: [isize; 2]| {
        let (column, row) = spec.column_row(cell);
        held(column, row, [dx, dy])?;
        held(column, row, [dx, 0])?;
        held(column, row, [0, dy])
    };
    let bits = |cell| (0..AROUND.len()).filter(|&k| step(cell, AROUND[k]).is_some()).fold(0, |bits, k| bits | 1 << k);
    (0..set.len()).map(|cell| if set[cell] { bits(cell) } else { 0 }).collect()
}

/// The largest set of cells that are joined by their sides; of equals the one with the lowest cell.
fn largest(spec: &GridSpec, set: &[bool]) -> Vec<bool> {
    let mut left = set.to_vec();
    let mut best: Vec<usize> = Vec::new();
    for cell in 0..set.len() {
        if !left[cell] {
            continue;
        }
        left[cell] = false;
        let (mut part, mut done) = (vec![cell], 0);
        while done < part.len() {
            for neighbour in spec.neighbours(part[done]) {
                if std::mem::take(&mut left[neighbour.cell]) {
                    part.push(neighbour.cell);
                }
            }
            done += 1;
        }
        if part.len() > best.len() {
            best = part;
        }
    }
    let mut largest = vec![false; set.len()];
    best.into_iter().for_each(|cell| largest[cell] = true);
    largest
}
