//! Plane geometry on points as `[x, y]`.

pub(crate) fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

pub(crate) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Positive where `b` is counter-clockwise of `a`.
pub(crate) fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(crate) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

/// The sides of a closed outline, from every point to the next.
pub(crate) fn sides(points: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    points.iter().copied().zip(points.iter().copied().cycle().skip(1))
}

/// Area within an outline, m², positive if it runs counter-clockwise.
pub(crate) fn signed_area(points: &[[f64; 2]]) -> f64 {
    // About the first point: far from the origin the plain sum loses its digits.
    let about = points[0];
    0.5 * sides(points).map(|(a, b)| cross(minus(a, about), minus(b, about))).sum::<f64>()
}

/// Whether an outline holds `point`, by the number of sides that a ray to the right crosses.
pub(crate) fn outline_contains(points: &[[f64; 2]], point: [f64; 2]) -> bool {
    let crossed = sides(points).filter(|&(a, b)| {
        (a[1] > point[1]) != (b[1] > point[1]) && {
            let side = cross(minus(b, a), minus(point, a));
            (side > 0.0) == (b[1] > a[1])
        }
    });
    crossed.count() % 2 == 1
}

/// Distance of `point` to the segment from `a` to `b`, m.
pub(crate) fn segment_distance(point: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let along = minus(b, a);
    let length2 = dot(along, along);
    let t = if length2 > 0.0 { (dot(minus(point, a), along) / length2).clamp(0.0, 1.0) } else { 0.0 };
    distance(point, [a[0] + t * along[0], a[1] + t * along[1]])
}

/// Whether two segments share a point, touching included.
pub(crate) fn segments_meet(a: [f64; 2], b: [f64; 2], c: [f64; 2], d: [f64; 2]) -> bool {
    let side = |p, q, r| cross(minus(q, p), minus(r, p));
    let (c_side, d_side, a_side, b_side) = (side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b));
    if opposite(c_side, d_side) && opposite(a_side, b_side) {
        return true;
    }
    let on = |s: f64, p, q, r: [f64; 2]| s == 0.0 && segment_box_holds(p, q, r);
    on(c_side, a, b, c) || on(d_side, a, b, d) || on(a_side, c, d, a) || on(b_side, c, d, b)
}

fn opposite(a: f64, b: f64) -> bool {
    (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0)
}

fn segment_box_holds(p: [f64; 2], q: [f64; 2], r: [f64; 2]) -> bool {
    (0..2).all(|k| p[k].min(q[k]) <= r[k] && r[k] <= p[k].max(q[k]))
}

/// The first two sides of an outline that run across each other; sides that only touch do not.
pub(crate) fn crossed(points: &[[f64; 2]]) -> Option<(usize, usize)> {
    let n = points.len();
    let side = |k: usize| (points[k], points[(k + 1) % n]);
    let across = |(a, b): ([f64; 2], [f64; 2]), (c, d): ([f64; 2], [f64; 2])| {
        let turn = |p, q, r| cross(minus(q, p), minus(r, p));
        opposite(turn(a, b, c), turn(a, b, d)) && opposite(turn(c, d, a), turn(c, d, b))
    };
    (0..n).find_map(|i| (i + 1..n).find(|&j| across(side(i), side(j))).map(|j| (i, j)))
}

/// The first two sides that meet other than at the corner they share.
pub(crate) fn crossing(points: &[[f64; 2]]) -> Option<(usize, usize)> {
    let n = points.len();
    let side = |k: usize| (points[k], points[(k + 1) % n]);
    for i in 0..n {
        let (a, b) = side(i);
        for j in i + 1..n {
            let (c, d) = side(j);
            let meet = if j == i + 1 || (i == 0 && j == n - 1) {
                // Neighbours share a corner; they overlap if the outline turns straight back there.
                let (before, corner, after) = if j == i + 1 { (a, b, d) } else { (c, a, b) };
                let (back, on) = (minus(before, corner), minus(after, corner));
                cross(back, on) == 0.0 && dot(back, on) > 0.0
            } else {
                segments_meet(a, b, c, d)
            };
            if meet {
                return Some((i, j));
            }
        }
    }
    None
}

/// Whether the segment from `a` to `b` has a point in the rectangle from `min` to `max`.
pub(crate) fn segment_meets_rectangle(a: [f64; 2], b: [f64; 2], min: [f64; 2], max: [f64; 2]) -> bool {
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for k in 0..2 {
        let along = b[k] - a[k];
        if along == 0.0 {
            if a[k] < min[k] || a[k] > max[k] {
                return false;
            }
        } else {
            let (t, u) = ((min[k] - a[k]) / along, (max[k] - a[k]) / along);
            enter = enter.max(t.min(u));
            leave = leave.min(t.max(u));
        }
    }
    enter <= leave
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const NOTCHED: [[f64; 2]; 6] = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [2.0, 3.0], [2.0, 1.0], [0.0, 1.0]];

    #[test]
    fn a_notched_outline() {
        assert!((signed_area(&NOTCHED) - 8.0).abs() < 1e-12);
        assert!(outline_contains(&NOTCHED, [1.0, 0.5]) && outline_contains(&NOTCHED, [3.0, 2.0]));
        assert!(!outline_contains(&NOTCHED, [1.0, 2.0]) && !outline_contains(&NOTCHED, [5.0, 0.5]));
        assert!((segment_distance([1.0, 2.0], [2.0, 3.0], [2.0, 1.0]) - 1.0).abs() < 1e-15);
        assert!((segment_distance([5.0, 4.0], [4.0, 0.0], [4.0, 3.0]) - 2f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn segments_meet_by_crossing_and_by_touching() {
        assert!(segments_meet([0.0, 0.0], [2.0, 2.0], [0.0, 2.0], [2.0, 0.0]));
        assert!(segments_meet([0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 5.0]));
        assert!(segments_meet([0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [3.0, 0.0]));
        assert!(!segments_meet([0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]));
        assert!(!segments_meet([0.0, 0.0], [2.0, 0.0], [1.0, 0.1], [1.0, 5.0]));
    }

    proptest! {
        #[test]
        fn clipping_agrees_with_walking_along_the_segment(
            a in prop::array::uniform2(-2.0f64..2.0), b in prop::array::uniform2(-2.0f64..2.0),
        ) {
            let inside = |p: [f64; 2], by: f64| p.iter().all(|v| v.abs() <= 1.0 + by);
            let walk = |by: f64| (0..=2000).any(|i| {
                let t = f64::from(i) / 2000.0;
                inside([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])], by)
            });
            let met = segment_meets_rectangle(a, b, [-1.0; 2], [1.0; 2]);
            prop_assert!(!walk(0.0) || met, "a point inside was missed");
            prop_assert!(!met || walk(3e-3), "no point near the rectangle");
        }
    }
}
