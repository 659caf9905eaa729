//! A rectangle at which lines end: plotters would bend what leads out of it.

use std::ops::RangeInclusive;

use super::drawing::Point;

/// A rectangle, such as of shares of two axes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Window {
    x: RangeInclusive<f64>,
    y: RangeInclusive<f64>,
}

impl Window {
    /// Between two corners, the least and the most.
    pub(super) fn new((left, low): Point, (right, high): Point) -> Self {
        Self { x: left..=right, y: low..=high }
    }

    /// Whether a point is inside, or as good as on its border.
    pub(super) fn holds(&self, (x, y): Point) -> bool {
        const NEAR: f64 = 1e-3;
        let inside = |v: f64, side: &RangeInclusive<f64>| (side.start() - NEAR..=side.end() + NEAR).contains(&v);
        inside(x, &self.x) && inside(y, &self.y)
    }

    /// The part of a straight line that is inside (Liang and Barsky 1984).
    pub(super) fn clip(&self, from: Point, to: Point) -> Option<(Point, Point)> {
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
    pub(super) fn pieces(&self, points: &[Point]) -> Vec<Vec<Point>> {
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
