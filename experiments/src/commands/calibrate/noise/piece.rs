//! Pieces of straight surface: where readings lie on one line.

use std::collections::BTreeMap;

use sensor::Ray;

use super::line::{dot, minus, straight};

/// Half the length of the surface that a line is fitted to, m, ...
const HALF_M: f64 = 0.25;

/// ... and at least so many sigma: a shorter one cannot tell which way it faces.
const HALF_SIGMAS: f64 = 6.0;

/// The scatter of a piece's own readings may be so many times that of the middle piece.
const ROUGH: f64 = 1.25;

/// A reading as a place on its ray.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    pub(super) origin_m: [f64; 2],
    pub(super) direction: [f64; 2],
    pub(super) range_m: f64,
    /// What its range is taken to scatter by, m.
    pub(super) sigma_m: f64,
}

impl Point {
    pub(super) fn place_m(&self) -> [f64; 2] {
        [0, 1].map(|k| self.origin_m[k] + self.range_m * self.direction[k])
    }
}

/// A piece of surface: the points `x` with `normal . (x - centre) = 0`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub(super) centre_m: [f64; 2],
    /// Rays that see it go along it.
    pub(super) normal: [f64; 2],
    /// Where a ray must cross it, m on either side of the centre.
    pub(super) half_m: f64,
    /// Covariance of the offset and the angle, m^2, m, 1.
    pub(super) covariance: [f64; 3],
    /// Scatter of its own readings, in those that they were taken to have.
    pub(super) scatter: f64,
}

/// Where a ray crosses a piece.
pub(super) struct Crossing {
    pub(super) range_m: f64,
    pub(super) variance_m2: f64,
    /// Distance from the centre, m.
    pub(super) off_m: f64,
}

impl Piece {
    /// The angle that a ray makes with it, rad; negative from the other side.
    pub(super) fn angle(&self, ray: &Ray) -> f64 {
        libm::asin(dot(self.normal, ray.direction).clamp(-1.0, 1.0))
    }

    /// Where a ray crosses it from the side that it was seen from, at no smaller sine than this.
    pub(super) fn crossing(&self, ray: &Ray, slant: f64) -> Option<Crossing> {
        let sine = dot(self.normal, ray.direction);
        if sine < slant {
            return None;
        }
        let from = minus(ray.origin_m, self.centre_m);
        let range_m = -dot(self.normal, from) / sine;
        let along = dot([-self.normal[1], self.normal[0]], from)
            + range_m * dot([-self.normal[1], self.normal[0]], ray.direction);
        if range_m <= 0.0 || along.abs() > self.half_m {
            return None;
        }
        let [offset, both, angle] = self.covariance;
        let variance_m2 = (offset - 2.0 * along * both + along * along * angle) / (sine * sine);
        Some(Crossing { range_m, variance_m2, off_m: along.abs() })
    }
}

/// The straight pieces of what was seen: about the middle of every square of places, for either side it was seen from.
pub(super) fn pieces(points: &[Point]) -> Vec<Piece> {
    let mut sigmas: Vec<f64> = points.iter().map(|point| point.sigma_m).collect();
    if sigmas.is_empty() {
        return Vec::new();
    }
    let middle = sigmas.len() / 2;
    let sigma_m = *sigmas.select_nth_unstable_by(middle, f64::total_cmp).1;
    let half_m = HALF_M.max(HALF_SIGMAS * sigma_m);
    let side_m = 0.5 * half_m;
    let square = |at: [f64; 2]| at.map(|x| libm::floor(x / side_m) as i64);
    let mut squares: BTreeMap<[i64; 2], Vec<&Point>> = BTreeMap::new();
    points.iter().for_each(|point| squares.entry(square(point.place_m())).or_default().push(point));
    let reach = libm::ceil(1.3 * half_m / side_m) as i64;
    let mut pieces = Vec::new();
    for (at, within) in &squares {
        let first = within[0].direction;
        for side in [1.0, -1.0] {
            let faces = |point: &&&Point| side * dot(point.direction, first) > 0.0;
            let seeds: Vec<&Point> = within.iter().filter(faces).copied().collect();
            if seeds.len() < 3 {
                continue;
            }
            let mean = |of: &dyn Fn(&Point) -> [f64; 2]| {
                let sum = seeds.iter().fold([0.0; 2], |sum, point| [0, 1].map(|k| sum[k] + of(point)[k]));
                sum.map(|sum| sum / seeds.len() as f64)
            };
            let (centre_m, facing) = (mean(&Point::place_m), mean(&|point| point.direction));
            let mut near: Vec<Point> = Vec::new();
            for x in at[0] - reach..=at[0] + reach {
                for y in at[1] - reach..=at[1] + reach {
                    near.extend(squares.get(&[x, y]).into_iter().flatten().copied().filter(|point| {
                        let off = minus(point.place_m(), centre_m);
                        dot(point.direction, facing) > 0.0 && dot(off, off) < (1.3 * half_m) * (1.3 * half_m)
                    }));
                }
            }
            pieces.extend(straight(&near, centre_m, facing, half_m));
        }
    }
    let mut scatters: Vec<f64> = pieces.iter().map(|piece| piece.scatter).collect();
    if scatters.is_empty() {
        return pieces;
    }
    let middle = scatters.len() / 2;
    let usual = *scatters.select_nth_unstable_by(middle, f64::total_cmp).1;
    pieces.retain(|piece| piece.scatter <= ROUGH * usual);
    pieces
}
