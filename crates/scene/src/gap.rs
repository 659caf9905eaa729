//! Distances between shapes.

use crate::Shape;
use crate::geometry::{outline_contains, segment_distance, segments_meet, sides};

/// Distance between two shapes, m; 0 where they overlap or touch.
pub(crate) fn between(a: &Shape, b: &Shape) -> f64 {
    match (a, b) {
        (Shape::Disc { center_m, radius_m }, other) | (other, Shape::Disc { center_m, radius_m }) => {
            (other.distance_m(*center_m) - radius_m).max(0.0)
        }
        _ => outlines(&a.corners_m(), &b.corners_m()),
    }
}

/// Distance of a shape to the way from one point to another, m.
pub(crate) fn to_way(shape: &Shape, from: [f64; 2], to: [f64; 2]) -> f64 {
    match shape {
        Shape::Disc { center_m, radius_m } => (segment_distance(*center_m, from, to) - radius_m).max(0.0),
        _ => outlines(&shape.corners_m(), &[from, to]),
    }
}

/// Distance of two outlines; a way is an outline of two points, which holds nothing.
fn outlines(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    if outline_contains(a, b[0]) || outline_contains(b, a[0]) {
        return 0.0;
    }
    let pairs = sides(a).flat_map(|side| sides(b).map(move |other| (side, other)));
    pairs.map(|((p, q), (r, s))| segments(p, q, r, s)).fold(f64::INFINITY, f64::min)
}

/// Distance of two segments: where they do not meet, an end of one is nearest to the other.
fn segments(p: [f64; 2], q: [f64; 2], r: [f64; 2], s: [f64; 2]) -> f64 {
    if segments_meet(p, q, r, s) {
        return 0.0;
    }
    let ends =
        [segment_distance(p, r, s), segment_distance(q, r, s), segment_distance(r, p, q), segment_distance(s, p, q)];
    ends.into_iter().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn turned_box(center_m: [f64; 2], half_m: [f64; 2], angle: f64) -> Shape {
        Shape::Box { center_m, half_m, axis: [angle.cos(), angle.sin()] }
    }

    #[test]
    fn overlap_is_no_distance() {
        let small = turned_box([0.0, 0.0], [0.1, 0.1], 0.3);
        let large = turned_box([0.0, 0.0], [1.0, 1.0], 0.0);
        for (a, b) in [(&small, &large), (&large, &small), (&large, &Shape::Disc { center_m: [0.0; 2], radius_m: 0.1 })]
        {
            assert!(between(a, b).abs() < 1e-15);
        }
        assert!(to_way(&large, [-0.2, 0.0], [0.2, 0.0]).abs() < 1e-15, "a way inside");
        assert!(to_way(&small, [-2.0, 0.0], [2.0, 0.0]).abs() < 1e-15, "a way across");
    }

    proptest! {
        /// Against points along the outline of one and the distance to the other, which has tests of its own.
        #[test]
        fn equals_the_nearest_of_many_points(
            at in prop::array::uniform2(-2.0f64..2.0), half in prop::array::uniform2(0.1f64..0.8), angle in 0.0f64..3.2,
            other in prop::array::uniform2(0.1f64..0.8), round in prop::bool::ANY, to in prop::array::uniform2(-2.0f64..2.0),
        ) {
            let a = turned_box(at, half, angle);
            let b = if round { Shape::Disc { center_m: [0.0; 2], radius_m: other[0] } } else { turned_box([0.0; 2], other, 0.2) };
            let along = |p: [f64; 2], q: [f64; 2]| {
                (0..=300).map(move |i| f64::from(i) / 300.0).map(move |t| [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])])
            };
            let corners = a.corners_m();
            let slow = sides(&corners).flat_map(|(p, q)| along(p, q)).map(|p| b.distance_m(p)).fold(f64::INFINITY, f64::min);
            let overlaps = a.distance_m([0.0; 2]) <= 0.0;
            let found = between(&a, &b);
            prop_assert!(found <= slow + 1e-12 && (overlaps || found > slow - 0.01), "{found} {slow}");
            let slow = along(at, to).map(|p| b.distance_m(p)).fold(f64::INFINITY, f64::min);
            let found = to_way(&b, at, to);
            prop_assert!(found <= slow + 1e-12 && found > slow - 0.01, "{found} {slow}");
        }
    }
}
