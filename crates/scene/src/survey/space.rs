//! Where the robot can be: its configuration space, exactly for square cells.

use grid::{GridSpec, Lattice, ROUNDING, Raster, StepCosts, clear};

/// The largest connected set of cells at whose centres the robot clears everything that is not free.
pub(crate) struct Space {
    spec: GridSpec,
    /// How many cells of a row that are not free lie before each column; `width + 1` numbers per row.
    before: Vec<u32>,
    /// The cells at whose centres the robot can stand, and the steps between them.
    ways: Lattice,
    /// What the robot's centre keeps from cells that are not free, in cells.
    needed: f64,
}

impl Space {
    /// The space of a robot whose centre keeps `needed_m` from cells that are not free. O(cells).
    pub(crate) fn new(cells: &Raster<Option<bool>>, needed_m: f64) -> Self {
        let spec = *cells.spec();
        let solid = cells.map(|&c| c != Some(false));
        let needed = needed_m / spec.cell_m;
        let mut before = Vec::with_capacity((spec.width + 1) * spec.height);
        for row in solid.values().chunks_exact(spec.width) {
            before.push(0);
            let mut sum = 0;
            before.extend(row.iter().map(|&s| {
                sum += u32::from(s);
                sum
            }));
        }
        let drivable = Raster::new(spec, largest(&spec, clear(&solid, needed_m).values()));
        Self { spec, before, ways: Lattice::new(drivable, StepCosts::COARSE), needed }
    }

    pub(crate) fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// Whether the robot can stand at the cell's centre and reach it.
    pub(crate) fn holds(&self, cell: usize) -> bool {
        self.ways.holds(cell)
    }

    /// The cells that the robot can reach.
    pub(crate) fn drivable(&self) -> impl Iterator<Item = usize> + '_ {
        self.ways.cells()
    }

    /// Free cells that the robot's centre reaches, or that are as few steps away as the corner of a room is: the rims
    /// and corners of the space it drives in, but not the room behind a gap too narrow for it.
    pub(crate) fn floor(&self, cells: &Raster<Option<bool>>) -> Raster<bool> {
        let mut floor = Raster::new(self.spec, (0..self.spec.cells()).map(|cell| self.holds(cell)).collect());
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

    /// The steps that the robot can make between centres of cells: whatever it clears at their ends it clears on the way.
    pub(crate) fn ways(&self) -> &Lattice {
        &self.ways
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
