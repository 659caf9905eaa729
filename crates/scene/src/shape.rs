//! The shapes of obstacles.

use crate::geometry::{
    self, distance, dot, minus, outline_contains, segment_distance, segment_meets_rectangle, segments_meet, sides,
};

/// What an obstacle covers, in m. Walls and map cells are boxes too.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A rectangle.
    Box {
        /// Its middle.
        center_m: [f64; 2],
        /// Half its width (along `axis`) and half its height.
        half_m: [f64; 2],
        /// Unit vector along its width.
        axis: [f64; 2],
    },
    /// A disc.
    Disc {
        /// Its middle.
        center_m: [f64; 2],
        /// Its radius.
        radius_m: f64,
    },
    /// A simple polygon, convex or not.
    Polygon {
        /// The corners, counter-clockwise.
        points_m: Vec<[f64; 2]>,
    },
}

impl Shape {
    /// The corners, counter-clockwise; a disc has none.
    pub fn corners_m(&self) -> Vec<[f64; 2]> {
        match self {
            Self::Box { center_m: [x, y], half_m: [w, h], axis: [c, s] } => {
                [[-w, -h], [*w, -h], [*w, *h], [-w, *h]].map(|[u, v]| [x + c * u - s * v, y + s * u + c * v]).to_vec()
            }
            Self::Disc { .. } => Vec::new(),
            Self::Polygon { points_m } => points_m.clone(),
        }
    }

    /// The outline as a closed chain of points, counter-clockwise, for drawing: a disc becomes a
    /// polygon of `disc_points` corners.
    pub fn outline_m(&self, disc_points: usize) -> Vec<[f64; 2]> {
        let Self::Disc { center_m: [x, y], radius_m } = self else { return self.corners_m() };
        let step = std::f64::consts::TAU / disc_points as f64;
        let at = |k: usize| libm::sincos(k as f64 * step);
        (0..disc_points).map(at).map(|(sin, cos)| [x + radius_m * cos, y + radius_m * sin]).collect()
    }

    /// The lower-left and the upper-right corner of the smallest upright rectangle around it, m.
    pub fn extent_m(&self) -> [[f64; 2]; 2] {
        if let Self::Disc { center_m: [x, y], radius_m: r } = self {
            return [[x - r, y - r], [x + r, y + r]];
        }
        let mut extent = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for corner in self.corners_m() {
            for k in 0..2 {
                extent[0][k] = extent[0][k].min(corner[k]);
                extent[1][k] = extent[1][k].max(corner[k]);
            }
        }
        extent
    }

    /// The same shape, moved by `by` (m).
    pub fn moved(&self, by: [f64; 2]) -> Self {
        let at = |point: [f64; 2]| [point[0] + by[0], point[1] + by[1]];
        match self {
            Self::Box { center_m, half_m, axis } => Self::Box { center_m: at(*center_m), half_m: *half_m, axis: *axis },
            Self::Disc { center_m, radius_m } => Self::Disc { center_m: at(*center_m), radius_m: *radius_m },
            Self::Polygon { points_m } => Self::Polygon { points_m: points_m.iter().map(|p| at(*p)).collect() },
        }
    }

    /// Distance of `point` to the shape, m, 0 inside.
    pub fn distance_m(&self, point: [f64; 2]) -> f64 {
        match self {
            Self::Box { center_m, half_m, axis } => {
                let from = minus(point, *center_m);
                let local = [dot(from, *axis), geometry::cross(*axis, from)];
                let [x, y] = [0, 1].map(|k| (local[k].abs() - half_m[k]).max(0.0));
                libm::hypot(x, y)
            }
            Self::Disc { center_m, radius_m } => (distance(point, *center_m) - radius_m).max(0.0),
            Self::Polygon { points_m } if outline_contains(points_m, point) => 0.0,
            Self::Polygon { points_m } => {
                sides(points_m).map(|(a, b)| segment_distance(point, a, b)).fold(f64::INFINITY, f64::min)
            }
        }
    }

    /// Distance of the segment from `a` to `b` to the shape, m, 0 where they share a point.
    pub(crate) fn segment_distance_m(&self, a: [f64; 2], b: [f64; 2]) -> f64 {
        match self {
            Self::Box { center_m, half_m, axis } => {
                let local = |point| {
                    let from = minus(point, *center_m);
                    [dot(from, *axis), geometry::cross(*axis, from)]
                };
                let (a, b, [w, h]) = (local(a), local(b), *half_m);
                if segment_meets_rectangle(a, b, half_m.map(|v| -v), *half_m) {
                    return 0.0;
                }
                // Of two convex shapes that stay apart, a corner or an end is nearest to the other one.
                let from_end = |[x, y]: [f64; 2]| libm::hypot((x.abs() - w).max(0.0), (y.abs() - h).max(0.0));
                let corners = [[-w, -h], [w, -h], [w, h], [-w, h]].map(|corner| segment_distance(corner, a, b));
                corners.into_iter().fold(from_end(a).min(from_end(b)), f64::min)
            }
            Self::Disc { center_m, radius_m } => (segment_distance(*center_m, a, b) - radius_m).max(0.0),
            Self::Polygon { points_m } if outline_contains(points_m, a) => 0.0,
            Self::Polygon { points_m } => {
                let apart = |(c, d)| match segments_meet(a, b, c, d) {
                    true => 0.0,
                    false => segment_distance(c, a, b).min(segment_distance(a, c, d)).min(segment_distance(b, c, d)),
                };
                sides(points_m).map(apart).fold(f64::INFINITY, f64::min)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_box_is_the_polygon_of_its_corners() {
        let (sin, cos) = libm::sincos(0.6);
        let turned = Shape::Box { center_m: [1.0, 2.0], half_m: [0.5, 0.2], axis: [cos, sin] };
        let polygon = Shape::Polygon { points_m: turned.corners_m() };
        assert!((geometry::signed_area(&turned.corners_m()) - 0.4).abs() < 1e-12, "counter-clockwise");
        for i in 0..400 {
            let point = [f64::from(i % 20) * 0.1, 1.0 + f64::from(i / 20) * 0.1];
            assert!((turned.distance_m(point) - polygon.distance_m(point)).abs() < 1e-12, "{point:?}");
        }
        assert_eq!(turned.extent_m(), polygon.extent_m());
    }

    #[test]
    fn a_disc_is_the_limit_of_its_outline() {
        let disc = Shape::Disc { center_m: [-1.0, 0.5], radius_m: 0.3 };
        let outline = Shape::Polygon { points_m: disc.outline_m(4000) };
        for point in [[-1.0, 0.5], [0.0, 0.0], [-1.2, 0.7], [-1.4, 0.5]] {
            assert!((disc.distance_m(point) - outline.distance_m(point)).abs() < 1e-6, "{point:?}");
        }
        assert_eq!(disc.extent_m(), [[-1.3, 0.2], [-0.7, 0.8]]);
    }
}
