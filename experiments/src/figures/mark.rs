//! How the points of a series are drawn.

use plotters::prelude::*;

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// A line.
    Line,
    /// A wide line that other series are drawn upon.
    Ground,
    /// A line of dashes.
    Dashes,
    /// "+" at the points.
    Plus,
    /// "o" at the points.
    Ring,
    /// "x" at the points.
    Cross,
    /// Triangles at the points.
    Triangle,
}

/// Half the size of a mark, px.
const REACH: i32 = 5;

impl Mark {
    /// The line through the points; of marks, a thin one that leads the eye.
    pub(super) fn line(self, colour: RGBColor) -> ShapeStyle {
        match self {
            Self::Ground => colour.stroke_width(5),
            Self::Line | Self::Dashes => colour.stroke_width(2),
            _ => colour.mix(0.5).stroke_width(1),
        }
    }

    /// Whether there is anything at the points.
    pub(super) fn at_points(self) -> bool {
        !matches!(self, Self::Line | Self::Ground | Self::Dashes)
    }

    /// The strokes of the mark about its point, px.
    pub(super) fn strokes(self, colour: RGBColor) -> [PathElement<(i32, i32)>; 2] {
        let path = |points: &[(i32, i32)]| {
            let style = colour.stroke_width(2);
            let at = points.iter().map(|(x, y)| (x * REACH, y * REACH));
            PathElement::new(at.collect::<Vec<_>>(), style)
        };
        let none = || path(&[(0, 0)]);
        match self {
            Self::Plus => [path(&[(-1, 0), (1, 0)]), path(&[(0, -1), (0, 1)])],
            Self::Cross => [path(&[(-1, -1), (1, 1)]), path(&[(-1, 1), (1, -1)])],
            Self::Triangle => [path(&[(-1, 1), (0, -1), (1, 1), (-1, 1)]), none()],
            Self::Line | Self::Ground | Self::Dashes | Self::Ring => [none(), none()],
        }
    }

    /// The ring of the mark about the point at `at`, px; of other marks, nothing to be seen.
    pub(super) fn ring(self, at: (i32, i32), colour: RGBColor) -> Circle<(i32, i32), i32> {
        match self {
            Self::Ring => Circle::new(at, REACH, colour.stroke_width(2)),
            _ => Circle::new(at, 0, TRANSPARENT),
        }
    }
}
