//! How well a moved map agrees with the truth at one cell size, and which way to move it.

use grid::Frame;

use super::field::{Field, blur};

/// Cells of which less is known than this do not count.
const LEAST_WEIGHT: f32 = 1e-3;

/// A map of less variance than this is constant but for rounding.
const LEAST_VARIANCE: f64 = 1e-9;

/// A map that rises by less than this from free to occupied does not agree at all.
const LEAST_SLOPE: f64 = 1e-6;

/// What a direction gets of stiffness, as a share of the stiffest one: along a corridor nothing says how far to go.
const STIFFNESS: f64 = 1e-4;

/// A place of the map: where it is moved to from where its file says, about the pivot.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Place {
    pub(super) shift_m: [f64; 2],
    pub(super) turn_rad: f64,
}

/// What was found of a place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    /// 1 less the square of the correlation of the smoothed maps where both are known; 1 where they do not agree at all.
    pub(super) error: f64,
    /// Where to go from there.
    pub(super) next: Place,
}

/// A map and the truth at one cell size, with room to work in.
pub(super) struct Level {
    pub(super) map: Field,
    pub(super) truth: Field,
    pub(super) pivot: [f64; 2],
    /// Whether the map may turn.
    pub(super) turns: bool,
    room: [Vec<f32>; 4],
}

impl Level {
    pub(super) fn new(map: Field, truth: Field, pivot: [f64; 2], turns: bool) -> Self {
        Self { map, truth, pivot, turns, room: Default::default() }
    }

    /// Side of a cell, m.
    pub(super) fn cell_m(&self) -> f64 {
        self.truth.frame.spec.cell_m
    }

    /// Looks at a place: a step of Gauss and Newton on the smoothed difference (Lucas and Kanade 1981), up to brightness and contrast, so that the correlation
    /// rises (Evangelidis and Psarakis 2008). Both maps are smoothed over
    /// the cells that both know, so that what one does not know pulls at neither. `None` where they have nothing in common.
    pub(super) fn look(&mut self, place: &Place) -> Option<Look> {
        self.lay(place);
        let spec = self.truth.frame.spec;
        let (width, height) = (spec.width, spec.height);
        let [ours, theirs, weights, spare] = &mut self.room;
        for values in [&mut *ours, &mut *theirs, &mut *weights] {
            blur(values, width, spare);
        }
        for ((ours, theirs), weight) in ours.iter_mut().zip(theirs.iter_mut()).zip(weights.iter()) {
            let by = if *weight > LEAST_WEIGHT { 1.0 / weight } else { 0.0 };
            *ours *= by;
            *theirs *= by;
        }
        let line = Line::through(ours, theirs, weights)?;
        if line.slope < LEAST_SLOPE {
            return Some(Look { error: 1.0, next: *place });
        }
        let middle = self.truth.frame.to_cells(self.pivot);
        let mut normal = Normal::default();
        for row in 0..height {
            let (below, above) = (row.saturating_sub(1), (row + 1).min(height - 1));
            for column in 0..width {
                let cell = row * width + column;
                let (left, right) = (column.saturating_sub(1), (column + 1).min(width - 1));
                let around = [row * width + left, row * width + right, below * width + column, above * width + column];
                if weights[cell] > LEAST_WEIGHT && around.iter().all(|cell| weights[*cell] > LEAST_WEIGHT) {
                    let slope =
                        |a: usize, b: usize, cells: usize| f64::from(theirs[b] - theirs[a]) / cells.max(1) as f64;
                    let g = [slope(around[0], around[1], right - left), slope(around[2], around[3], above - below)];
                    let at = [column as f64 + 0.5 - middle[0], row as f64 + 0.5 - middle[1]];
                    let difference = (f64::from(ours[cell]) - line.at_zero) / line.slope - f64::from(theirs[cell]);
                    normal.add([g[0], g[1], at[0] * g[1] - at[1] * g[0]], f64::from(weights[cell]), difference);
                }
            }
        }
        Some(Look { error: line.unexplained, next: self.moved(place, &normal) })
    }

    /// Lays the map upon the truth: products of value and weight of both, and of weights.
    fn lay(&mut self, place: &Place) {
        let frame = self.map.frame.moved(self.pivot, place.shift_m, place.turn_rad);
        let to_map = self.truth.frame.cells_to(&frame);
        let spec = self.truth.frame.spec;
        let [ours, theirs, weights, _] = &mut self.room;
        for values in [&mut *ours, &mut *theirs, &mut *weights] {
            values.clear();
        }
        for row in 0..spec.height {
            for column in 0..spec.width {
                let cell = spec.index(column, row);
                let known = self.truth.weights[cell];
                let (sum, weight) = match known > 0.0 {
                    true => self.map.at(to_map.of([column as f64 + 0.5, row as f64 + 0.5])),
                    false => (0.0, 0.0),
                };
                ours.push(sum * known);
                theirs.push(self.truth.sums[cell] * weight);
                weights.push(known * weight);
            }
        }
    }

    /// The place after the step that the normal equations give, in the frame of the world.
    fn moved(&self, place: &Place, normal: &Normal) -> Place {
        let [x, y, turn] = normal.solved(self.turns);
        let (sin, cos) = libm::sincos(self.truth.frame.yaw_rad);
        let [x, y] = [x, y].map(|cells| cells * self.cell_m());
        let shift_m = [place.shift_m[0] + cos * x - sin * y, place.shift_m[1] + sin * x + cos * y];
        Place { shift_m, turn_rad: place.turn_rad + turn }
    }

    /// Distance from the pivot to the farthest corner, m.
    pub(super) fn radius_m(&self) -> f64 {
        let Frame { spec, .. } = self.truth.frame;
        0.5 * spec.cell_m * libm::hypot(spec.width as f64, spec.height as f64)
    }
}

/// The straight line that makes the map of the truth: a map that is less sure than the truth lies no better for that.
struct Line {
    slope: f64,
    at_zero: f64,
    /// Share of the map's variance that is not on it: 1 less the square of the correlation.
    unexplained: f64,
}

impl Line {
    /// By weighted least squares; `None` where either does not vary.
    fn through(ours: &[f32], theirs: &[f32], weights: &[f32]) -> Option<Self> {
        let cells = || {
            let cells = ours.iter().zip(theirs).zip(weights).filter(|(_, weight)| **weight > LEAST_WEIGHT);
            cells.map(|((ours, theirs), weight)| [*ours, *theirs, *weight].map(f64::from))
        };
        let mean = |of: fn([f64; 3]) -> f64| {
            let (sum, total) =
                cells().fold((0.0, 0.0), |(sum, total), cell| (sum + cell[2] * of(cell), total + cell[2]));
            sum / total
        };
        let means = [mean(|cell| cell[0]), mean(|cell| cell[1])];
        let [mut xx, mut xy, mut yy] = [0.0; 3];
        let mut total = 0.0;
        for [ours, theirs, weight] in cells() {
            let (y, x) = (ours - means[0], theirs - means[1]);
            (xx, xy, yy) = (xx + weight * x * x, xy + weight * x * y, yy + weight * y * y);
            total += weight;
        }
        let varies = |sum: f64| sum > LEAST_VARIANCE * total;
        let line =
            |slope: f64| Self { slope, at_zero: means[0] - slope * means[1], unexplained: 1.0 - xy * xy / (xx * yy) };
        (varies(xx) && varies(yy)).then(|| line(xy / xx))
    }
}

/// The normal equations of a step: columns, rows (cells) and turn (rad).
#[derive(Debug, Default)]
struct Normal {
    matrix: [[f64; 3]; 3],
    right: [f64; 3],
}

impl Normal {
    /// A cell: a map that lies `d` too far has the difference `-g d`, so that the step back is `d = (sum g g')^-1 sum g difference`.
    fn add(&mut self, g: [f64; 3], weight: f64, difference: f64) {
        for (i, gi) in g.iter().enumerate() {
            self.right[i] += weight * gi * difference;
            for (j, gj) in g.iter().enumerate() {
                self.matrix[i][j] += weight * gi * gj;
            }
        }
    }

    /// The step; nothing in a direction of which nothing is known.
    fn solved(&self, turns: bool) -> [f64; 3] {
        let size = if turns { 3 } else { 2 };
        let mut m = self.matrix;
        let mut b = self.right;
        let stiffest = m[0][0].max(m[1][1]);
        for (k, row) in m.iter_mut().enumerate() {
            row[k] += STIFFNESS * if k < 2 { stiffest } else { row[k] } + f64::MIN_POSITIVE;
        }
        // Positive definite: no pivots are needed.
        for k in 0..size {
            for i in k + 1..size {
                let by = m[i][k] / m[k][k];
                let upper = m[k];
                for (own, above) in m[i].iter_mut().zip(upper).skip(k) {
                    *own -= by * above;
                }
                b[i] -= by * b[k];
            }
        }
        let mut step = [0.0; 3];
        for k in (0..size).rev() {
            let known: f64 = (k + 1..size).map(|j| m[k][j] * step[j]).sum();
            step[k] = (b[k] - known) / m[k][k];
        }
        if step.iter().all(|value| value.is_finite()) { step } else { [0.0; 3] }
    }
}
