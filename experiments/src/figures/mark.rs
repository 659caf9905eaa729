//! Signs at the points of a line: filled, and told apart by their shape alone.

use super::drawing::{Drawing, Point};
use super::ink::Colour;

/// The shape of a sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    Circle,
    Square,
    Diamond,
    Triangle,
    /// A triangle on its head.
    Wedge,
    Plus,
    Cross,
    Star,
    Hourglass,
    /// A triangle that lies to the right.
    Flag,
}

impl Shape {
    /// All of them, the most unlike ones first.
    pub const ALL: [Self; 10] = [
        Self::Circle,
        Self::Square,
        Self::Triangle,
        Self::Cross,
        Self::Diamond,
        Self::Wedge,
        Self::Plus,
        Self::Star,
        Self::Flag,
        Self::Hourglass,
    ];

    /// Draws the sign, in a rim of white that parts it from what is below.
    pub fn draw(self, drawing: &mut Drawing, at: Point, reach: f64, colour: Colour) {
        for (reach, colour) in [(reach + 1.6, Colour::WHITE), (reach, colour)] {
            match self {
                Self::Circle => drawing.disc(at, 0.92 * reach, colour),
                _ => drawing.area(self.corners().map(|(x, y)| (at.0 + x * reach, at.1 + y * reach)), colour),
            }
        }
    }

    /// Corners about the middle, of shapes of about the same size.
    fn corners(self) -> impl Iterator<Item = Point> {
        let wheel = |radii: &'static [f64], first: f64| -> Vec<Point> {
            let corner = |k: usize| {
                let (sin, cos) = libm::sincos(first + std::f64::consts::TAU * k as f64 / radii.len() as f64);
                (radii[k] * cos, radii[k] * sin)
            };
            (0..radii.len()).map(corner).collect()
        };
        let up = -0.25 * std::f64::consts::TAU;
        let bars = |turned: bool| -> Vec<Point> {
            const ARM: f64 = 0.42;
            let quarter = [(ARM, -ARM), (ARM, -1.1), (-ARM, -1.1)];
            let turn = |(x, y): Point, times: usize| (0..times).fold((x, y), |(x, y), _| (y, -x));
            let corners = (0..4).flat_map(|times| quarter.map(|corner| turn(corner, times)));
            let half = std::f64::consts::FRAC_1_SQRT_2;
            corners.map(|(x, y)| if turned { ((x - y) * half, (x + y) * half) } else { (x, y) }).collect()
        };
        let corners = match self {
            Self::Circle => wheel(&[1.0; 16], 0.0),
            Self::Square => vec![(-0.84, -0.84), (0.84, -0.84), (0.84, 0.84), (-0.84, 0.84)],
            Self::Diamond => wheel(&[1.18, 1.18, 1.18, 1.18], 0.0),
            Self::Triangle => wheel(&[1.25; 3], up),
            Self::Wedge => wheel(&[1.25; 3], -up),
            Self::Flag => wheel(&[1.25; 3], 0.0),
            Self::Hourglass => vec![(-0.95, -1.0), (0.95, -1.0), (0.2, 0.0), (0.95, 1.0), (-0.95, 1.0), (-0.2, 0.0)],
            Self::Star => wheel(&[1.35, 0.55, 1.35, 0.55, 1.35, 0.55, 1.35, 0.55, 1.35, 0.55], up),
            Self::Plus => bars(false),
            Self::Cross => bars(true),
        };
        corners.into_iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::raster;

    #[test]
    fn every_shape_covers_another_part_of_its_square() {
        let drawn = Shape::ALL.map(|shape| {
            let mut drawing = Drawing::new(40.0, 40.0);
            shape.draw(&mut drawing, (20.0, 20.0), 12.0, Colour::BLACK);
            raster::pixels(&drawing, 1.0).expect("drawn").colours
        });
        for (k, one) in drawn.iter().enumerate() {
            let dark = one.iter().filter(|colour| colour.0 < 128).count();
            assert!((170..520).contains(&dark), "{:?}: {dark}", Shape::ALL[k]);
            for (other, shape) in drawn[..k].iter().zip(Shape::ALL) {
                let differ = one.iter().zip(other).filter(|(a, b)| a.0.abs_diff(b.0) > 128).count();
                assert!(differ > 50, "{:?} and {shape:?} differ in {differ} pixels", Shape::ALL[k]);
            }
        }
    }
}
