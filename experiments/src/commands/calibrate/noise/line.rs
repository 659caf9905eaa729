//! A straight line through readings, by least squares along their rays.

use super::piece::{Piece, Point};

/// A line is fitted to so many readings at least.
const FEWEST: usize = 12;

/// A bend of more than so many standard errors is none of a straight surface. (Every third straight one is left out with them.)
const BEND: f64 = 1.0;

/// Readings that meet the line at a smaller sine than this are not used.
const SLANT: f64 = 0.25;

/// Rounds of least squares.
const ROUNDS: usize = 10;

/// Tukey's constant: 95 % efficient where nothing is an outlier.
const TUKEY: f64 = 4.685;

pub(super) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(super) fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// The direction in which places spread least, towards `facing`.
fn first_normal(points: &[Point], centre_m: [f64; 2], facing: [f64; 2]) -> [f64; 2] {
    let [mut xx, mut xy, mut yy] = [0.0; 3];
    for point in points {
        let [x, y] = minus(point.place_m(), centre_m);
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
    }
    let along = 0.5 * libm::atan2(2.0 * xy, xx - yy);
    let normal = [-libm::sin(along), libm::cos(along)];
    if dot(normal, facing) < 0.0 { normal.map(|x| -x) } else { normal }
}

/// A reading beside a line.
struct Row {
    /// How much an offset of the line moves the reading, in sigmas of the reading per m.
    scale: f64,
    /// Where its ray crosses the line, m from the centre.
    along_m: f64,
    /// In sigmas of the reading.
    error: f64,
}

/// Weighted normal equations for the offset of a line, its angle (a turn moves it by `-along`), and its bend.
#[derive(Default)]
struct Equations {
    left: [[f64; 3]; 3],
    right: [f64; 3],
    /// Sums of the weights, and of the weighted squares of errors.
    weights: f64,
    squares: f64,
}

impl Equations {
    /// Of all readings but outliers.
    fn of(rows: &[Row]) -> Self {
        let mut sizes: Vec<f64> = rows.iter().map(|row| row.error.abs()).collect();
        let middle = sizes.len() / 2;
        let spread = (1.4826 * *sizes.select_nth_unstable_by(middle, f64::total_cmp).1).max(1e-6);
        let mut equations = Self::default();
        for Row { scale, along_m, error } in rows {
            let share = (error / (TUKEY * spread)).abs().min(1.0);
            let weight = (1.0 - share * share).powi(2);
            let row = [*scale, -along_m * scale, along_m * along_m * scale];
            for i in 0..3 {
                (0..3).for_each(|j| equations.left[i][j] += weight * row[i] * row[j]);
                equations.right[i] += weight * row[i] * error;
            }
            equations.weights += weight;
            equations.squares += weight * error * error;
        }
        equations
    }

    /// Scatter of the readings, in what they are taken to have.
    fn scatter(&self) -> f64 {
        libm::sqrt(self.squares / self.weights)
    }

    fn determinant(&self) -> f64 {
        self.left[0][0] * self.left[1][1] - self.left[0][1] * self.left[0][1]
    }

    /// Offset and angle for a right side.
    fn solve(&self, right: [f64; 2]) -> [f64; 2] {
        let [[a, b, _], [_, d, _], _] = self.left;
        [right[0] * d - right[1] * b, a * right[1] - b * right[0]].map(|x| x / self.determinant())
    }

    /// Covariance of the offset and the angle.
    fn covariance(&self) -> [f64; 3] {
        [self.left[1][1], -self.left[0][1], self.left[0][0]].map(|entry| entry / self.determinant())
    }

    /// The bend in its standard errors, were those of readings as they are taken to be.
    fn bend(&self) -> Option<f64> {
        let of_bend = self.solve([self.left[0][2], self.left[1][2]]);
        let of_error = self.solve([self.right[0], self.right[1]]);
        let rest = |of: [f64; 2], whole: f64| whole - self.left[2][0] * of[0] - self.left[2][1] * of[1];
        let left = rest(of_bend, self.left[2][2]);
        (left > 0.0).then(|| rest(of_error, self.right[2]) / libm::sqrt(left))
    }
}

/// The readings whose rays cross the line within half its length, from the side that `normal` points away from.
fn rows(points: &[Point], centre_m: [f64; 2], normal: [f64; 2], half_m: f64) -> Vec<Row> {
    let tangent = [-normal[1], normal[0]];
    let row = |point: &Point| {
        let sine = dot(normal, point.direction);
        let from = minus(point.origin_m, centre_m);
        let range_m = -dot(normal, from) / sine;
        let along_m = dot(tangent, from) + range_m * dot(tangent, point.direction);
        (sine > SLANT && along_m.abs() < half_m).then(|| Row {
            scale: 1.0 / (sine * point.sigma_m),
            along_m,
            error: (point.range_m - range_m) / point.sigma_m,
        })
    };
    points.iter().filter_map(row).collect()
}

/// The line through the readings about a place, if they lie on one, on both sides of it.
pub(super) fn straight(points: &[Point], mut centre_m: [f64; 2], facing: [f64; 2], half_m: f64) -> Option<Piece> {
    let mut normal = first_normal(points, centre_m, facing);
    for round in 0..ROUNDS {
        let rows = rows(points, centre_m, normal, half_m);
        if rows.len() < FEWEST {
            return None;
        }
        let beyond = |side: f64| rows.iter().filter(|row| side * row.along_m > 0.3 * half_m).count();
        let equations = Equations::of(&rows);
        let is_whole = beyond(1.0).min(beyond(-1.0)) * 8 >= rows.len() && equations.weights >= 0.5 * rows.len() as f64;
        if !is_whole || equations.determinant() <= 0.0 {
            return None;
        }
        if round + 1 == ROUNDS {
            let (scatter, covariance) = (equations.scatter(), equations.covariance());
            let is_straight = equations.bend()?.abs() <= BEND * scatter;
            return is_straight.then_some(Piece { centre_m, normal, half_m: 0.5 * half_m, covariance, scatter });
        }
        let [offset_m, angle] = equations.solve([equations.right[0], equations.right[1]]);
        centre_m = [0, 1].map(|k| centre_m[k] + offset_m * normal[k]);
        let (sin, cos) = libm::sincos(angle.clamp(-0.3, 0.3));
        normal = [cos * normal[0] - sin * normal[1], cos * normal[1] + sin * normal[0]];
    }
    None
}
