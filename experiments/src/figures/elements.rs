//! Elements that plotters has not: broken lines, and signs of every shape.

use plotters::element::{Drawable, PointCollection};
use plotters_backend::BackendCoord;

use super::backend::{Canvas, Drawn, place};
use super::drawing::Stroke;
use super::ink::Colour;
use super::mark::Shape;

/// Half the size of a sign.
pub(super) const SIGN: f64 = 6.5;

/// A place by the axes of a plot.
type At = (f64, f64);

/// A line through points, in dashes if its stroke has them.
pub struct Line {
    pub points: Vec<At>,
    pub stroke: Stroke,
}

/// The sign of a point.
pub struct Sign {
    pub at: At,
    pub shape: Shape,
    pub colour: Colour,
}

impl<'a> PointCollection<'a, At> for &'a Line {
    type Point = &'a At;
    type IntoIter = &'a [At];

    fn point_iter(self) -> &'a [At] {
        &self.points
    }
}

impl<'a> PointCollection<'a, At> for &'a Sign {
    type Point = &'a At;
    type IntoIter = std::iter::Once<&'a At>;

    fn point_iter(self) -> Self::IntoIter {
        std::iter::once(&self.at)
    }
}

impl Drawable<Canvas> for Line {
    fn draw<I: Iterator<Item = BackendCoord>>(&self, pos: I, canvas: &mut Canvas, _: (u32, u32)) -> Drawn {
        canvas.path(pos, self.stroke);
        Ok(())
    }
}

impl Drawable<Canvas> for Sign {
    fn draw<I: Iterator<Item = BackendCoord>>(&self, pos: I, canvas: &mut Canvas, _: (u32, u32)) -> Drawn {
        pos.for_each(|at| self.shape.draw(&mut canvas.drawing, place(at), SIGN, self.colour));
        Ok(())
    }
}
