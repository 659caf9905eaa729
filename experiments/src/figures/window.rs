//! A rectangle at which lines end.

use std::ops::RangeInclusive;

use super::drawing::Point;

/// A rectangle in units.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    x: RangeInclusive<f64>,
    y: RangeInclusive<f64>,
}

impl Window {
    /// Between two corners, upper left and lower right.
    pub fn new((left, top): Point, (right, bottom): Point) -> Self {
        Self { x: left..=right, y: top..=bottom }
    }

    /// Whether a point is inside, or on its border.
    pub fn holds(&self, (x, y): Point) -> bool {
        const NEAR: f64 = 0.5;
        let inside = |v: f64, side: &RangeInclusive<f64>| (side.start() - NEAR..=side.end() + NEAR).contains(&v);
        inside(x, &self.x) && inside(y, &self.y)
    }

    /// The point inside that is nearest.
    pub fn nearest(&self, (x, y): Point) -> Point {
        (x.clamp(*self.x.start(), *self.x.end()), y.clamp(*self.y.start(), *self.y.end()))
    }

    /// The part of a straight line that is inside (Liang and Barsky 1984).
    fn clip(&self, from: Point, to: Point) -> Option<(Point, Point)> {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let sides = [
            (-dx, from.0 - self.x.start()),
            (dx, self.x.end() - from.0),
            (-dy, from.1 - self.y.start()),
            (dy, self.y.end() - from.1),
        ];
        let (mut enter, mut leave) = (0.0f64, 1.0f64);
        for (step, room) in sides {
            if step.abs() < 1e-12 {
                if room < 0.0 {
                    return None;
                }
            } else if step < 0.0 {
                enter = enter.max(room / step);
            } else {
                leave = leave.min(room / step);
            }
        }
        let at = |share: f64| (from.0 + share * dx, from.1 + share * dy);
        (enter <= leave).then(|| (at(enter), at(leave)))
    }

    /// The pieces of a line that are inside.
    pub fn pieces(&self, points: &[Point]) -> Vec<Vec<Point>> {
        let mut pieces: Vec<Vec<Point>> = Vec::new();
        for leg in points.windows(2) {
            let Some((from, to)) = self.clip(leg[0], leg[1]) else { continue };
            let follows = |piece: &&mut Vec<Point>| {
                piece.last().is_some_and(|last| (last.0 - from.0).abs() + (last.1 - from.1).abs() < 1e-6)
            };
            match pieces.last_mut().filter(follows) {
                Some(piece) => piece.push(to),
                None => pieces.push(vec![from, to]),
            }
        }
        pieces
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_line_that_leaves_and_comes_back_is_two() {
        let window = Window::new((0.0, 0.0), (10.0, 10.0));
        let pieces = window.pieces(&[(1.0, 5.0), (4.0, 5.0), (4.0, 15.0), (8.0, 15.0), (8.0, 5.0)]);
        assert_eq!(pieces, [vec![(1.0, 5.0), (4.0, 5.0), (4.0, 10.0)], vec![(8.0, 10.0), (8.0, 5.0)]]);
        assert!(window.pieces(&[(5.0, 5.0)]).is_empty());
    }

    proptest! {
        #[test]
        fn what_is_left_of_a_line_is_all_of_it_that_is_inside(a in (-20.0..30.0f64, -20.0..30.0f64), b in (-20.0..30.0f64, -20.0..30.0f64)) {
            let window = Window::new((0.0, 0.0), (10.0, 10.0));
            let inside = |k: u32| {
                let share = f64::from(k) / 1000.0;
                let (x, y) = (a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1));
                (0.0..=10.0).contains(&x) && (0.0..=10.0).contains(&y)
            };
            let shown = f64::from((0..=1000).filter(|k| inside(*k)).count() as u32) / 1000.0;
            let length = |(p, q): (Point, Point)| ((p.0 - q.0) * (p.0 - q.0) + (p.1 - q.1) * (p.1 - q.1)).sqrt();
            let left = window.clip(a, b).map_or(0.0, length);
            prop_assert!((left - shown * length((a, b))).abs() <= 2e-3 * length((a, b)) + 1e-9);
        }
    }
}
