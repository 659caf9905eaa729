//! Pixels of a drawing: lines by their distance, areas and letters by what they cover of a pixel. No system's mathematics
//! takes part, so that a picture is the same on every machine.

use ab_glyph_rasterizer::{Point as Corner, Rasterizer, point};

use super::drawing::{Drawing, Item, Point, Stroke};
use super::ink::Colour;
use super::letters;
use crate::failure::Failure;

/// Rows of colours.
pub(super) struct Pixels {
    pub width: usize,
    pub height: usize,
    pub colours: Vec<Colour>,
}

/// Draws with so many pixels to a unit.
///
/// # Errors
/// A font that cannot be read.
pub(super) fn pixels(drawing: &Drawing, scale: f64) -> Result<Pixels, Failure> {
    let [width, height] = [drawing.width, drawing.height].map(|side| (side * scale).round().max(1.0) as usize);
    let mut pixels = Pixels { width, height, colours: vec![Colour::WHITE; width * height] };
    let place = |(x, y): &Point| (x * scale, y * scale);
    for item in &drawing.items {
        match item {
            Item::Line { points, stroke } => {
                let stroke = Stroke { width: (stroke.width * scale).max(1.0), ..*stroke };
                pixels.line(&points.iter().map(place).collect::<Vec<_>>(), stroke);
            }
            Item::Area { points, colour } => {
                let points: Vec<Point> = points.iter().map(place).collect();
                let sides = (0..points.len()).map(|k| Piece::Line(points[k], points[(k + 1) % points.len()]));
                pixels.outline(&sides.collect::<Vec<_>>(), *colour);
            }
            Item::Disc { centre, radius, colour } => pixels.stroke(&[[place(centre); 2]], radius * scale, *colour),
            Item::Letters { text, start, size, colour, upwards } => {
                pixels.outline(&letter_pieces(text, place(start), size * scale, *upwards)?, *colour);
            }
            Item::Cells { corner, size, columns, colours } => {
                pixels.cells(place(corner), place(size), *columns, colours);
            }
        }
    }
    Ok(pixels)
}

/// A piece of an outline.
enum Piece {
    Line(Point, Point),
    Quad(Point, Point, Point),
    Cubic(Point, Point, Point, Point),
}

impl Piece {
    fn points(&self) -> Vec<Point> {
        match *self {
            Self::Line(a, b) => vec![a, b],
            Self::Quad(a, b, c) => vec![a, b, c],
            Self::Cubic(a, b, c, d) => vec![a, b, c, d],
        }
    }
}

fn letter_pieces(text: &str, (x, y): Point, size: f64, upwards: bool) -> Result<Vec<Piece>, Failure> {
    let mut pieces = Vec::new();
    for placed in letters::place(text).0 {
        let put = |(right, up): (f64, f64)| {
            let along = (placed.at + right) * size;
            if upwards { (x - up * size, y - along) } else { (x + along, y - up * size) }
        };
        pieces.extend(letters::outline(placed.glyph)?.into_iter().map(|curve| {
            let (from, to) = (put(curve.from), put(curve.to));
            match curve.by[..] {
                [] => Piece::Line(from, to),
                [by] => Piece::Quad(from, put(by), to),
                _ => Piece::Cubic(from, put(curve.by[0]), put(curve.by[1]), to),
            }
        }));
    }
    Ok(pieces)
}

/// The pixels between two ends that a picture has.
fn span(low: f64, high: f64, most: usize) -> std::ops::Range<usize> {
    let bound = |v: f64| v.clamp(0.0, most as f64) as usize;
    bound(low.floor())..bound(high.ceil())
}

impl Pixels {
    /// Lays a colour over a pixel by the share of it that is covered.
    fn cover(&mut self, at: usize, share: f64, colour: Colour) {
        // Sixteen shades are enough for the eye, and make small files.
        let share = (share.clamp(0.0, 1.0) * 16.0).round() / 16.0;
        if share > 0.0 {
            self.colours[at] = self.colours[at].towards(colour, share);
        }
    }

    fn line(&mut self, points: &[Point], stroke: Stroke) {
        let points = crisp(points, stroke.width);
        let legs = match stroke.dashes.lengths() {
            Some([dash, gap]) => dashes(&points, dash * stroke.width, gap * stroke.width),
            None if points.len() == 1 => vec![[points[0]; 2]],
            None => points.windows(2).map(|leg| [leg[0], leg[1]]).collect(),
        };
        self.stroke(&legs, 0.5 * stroke.width, stroke.colour);
    }

    /// Covers all that is within `reach` of a leg: where legs meet nothing is covered twice.
    fn stroke(&mut self, legs: &[[Point; 2]], reach: f64, colour: Colour) {
        let around =
            |values: [f64; 2]| [values[0].min(values[1]) - reach - 1.0, values[0].max(values[1]) + reach + 1.0];
        let box_of = |leg: &[Point; 2]| (around([leg[0].0, leg[1].0]), around([leg[0].1, leg[1].1]));
        let (mut xs, mut ys) = ([f64::INFINITY, f64::NEG_INFINITY], [f64::INFINITY, f64::NEG_INFINITY]);
        for (x, y) in legs.iter().map(box_of) {
            (xs, ys) = ([xs[0].min(x[0]), xs[1].max(x[1])], [ys[0].min(y[0]), ys[1].max(y[1])]);
        }
        let (columns, rows) = (span(xs[0], xs[1], self.width), span(ys[0], ys[1], self.height));
        let wide = columns.len();
        let mut covered = vec![0.0f64; wide * rows.len()];
        for leg in legs {
            let (x, y) = box_of(leg);
            for row in span(y[0], y[1], self.height) {
                for column in span(x[0], x[1], self.width) {
                    let share = reach + 0.5 - distance((column as f64 + 0.5, row as f64 + 0.5), leg);
                    let at = (row - rows.start) * wide + column - columns.start;
                    covered[at] = covered[at].max(share);
                }
            }
        }
        for (at, share) in covered.into_iter().enumerate() {
            self.cover((rows.start + at / wide) * self.width + columns.start + at % wide, share, colour);
        }
    }

    /// Covers what is inside an outline.
    fn outline(&mut self, pieces: &[Piece], colour: Colour) {
        let all = || pieces.iter().flat_map(Piece::points);
        let ends = |of: fn(&Point) -> f64| {
            all().map(|p| of(&p)).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
        };
        let ((left, right), (top, bottom)) = (ends(|p| p.0), ends(|p| p.1));
        if left > right {
            return; // blanks
        }
        // A border of a pixel keeps every piece inside.
        let (x, y) = (left.floor() - 1.0, top.floor() - 1.0);
        let (wide, high) = ((right - x).ceil() as usize + 2, (bottom - y).ceil() as usize + 2);
        let corner = |p: Point| -> Corner { point((p.0 - x) as f32, (p.1 - y) as f32) };
        let mut rasterizer = Rasterizer::new(wide, high);
        for piece in pieces {
            match *piece {
                Piece::Line(a, b) => rasterizer.draw_line(corner(a), corner(b)),
                Piece::Quad(a, b, c) => rasterizer.draw_quad(corner(a), corner(b), corner(c)),
                Piece::Cubic(a, b, c, d) => rasterizer.draw_cubic(corner(a), corner(b), corner(c), corner(d)),
            }
        }
        rasterizer.for_each_pixel_2d(|column, row, share| {
            let (column, row) = (x + f64::from(column), y + f64::from(row));
            if (0.0..self.width as f64).contains(&column) && (0.0..self.height as f64).contains(&row) {
                self.cover(row as usize * self.width + column as usize, f64::from(share), colour);
            }
        });
    }

    fn cells(&mut self, corner: Point, size: Point, columns: usize, colours: &[Colour]) {
        let rows = colours.len() / columns.max(1);
        let edge = |at: f64, most: usize| at.round().clamp(0.0, most as f64) as usize;
        let (left, right) = (edge(corner.0, self.width), edge(corner.0 + size.0, self.width));
        let (top, bottom) = (edge(corner.1, self.height), edge(corner.1 + size.1, self.height));
        for y in top..bottom {
            let row = (y - top) * rows / (bottom - top);
            for x in left..right {
                let column = (x - left) * columns / (right - left);
                self.colours[y * self.width + x] = colours[row * columns + column];
            }
        }
    }
}

/// An upright or level line lies on whole pixels, so that it is as sharp as any other of its width.
fn crisp(points: &[Point], width: f64) -> Vec<Point> {
    let odd = width.round() as i64 % 2 == 1;
    let snapped = |v: f64| if odd { v.floor() + 0.5 } else { v.round() };
    let same = |of: fn(&Point) -> f64| points.iter().all(|p| (of(p) - of(&points[0])).abs() < 1e-9);
    let (upright, level) = (same(|p| p.0), same(|p| p.1));
    match (upright && !level, level && !upright) {
        (true, _) => points.iter().map(|p| (snapped(p.0), p.1)).collect(),
        (_, true) => points.iter().map(|p| (p.0, snapped(p.1))).collect(),
        _ => points.to_vec(),
    }
}

fn distance(p: Point, [a, b]: &[Point; 2]) -> f64 {
    let (along, off) = ((b.0 - a.0, b.1 - a.1), (p.0 - a.0, p.1 - a.1));
    let length = along.0 * along.0 + along.1 * along.1;
    let share = if length > 0.0 { ((off.0 * along.0 + off.1 * along.1) / length).clamp(0.0, 1.0) } else { 0.0 };
    let (x, y) = (off.0 - share * along.0, off.1 - share * along.1);
    (x * x + y * y).sqrt()
}

/// The dashes of a line, which go on around its corners.
fn dashes(points: &[Point], dash: f64, gap: f64) -> Vec<[Point; 2]> {
    let (mut legs, mut along) = (Vec::new(), 0.0);
    for leg in points.windows(2) {
        let length = distance(leg[0], &[leg[1]; 2]);
        let at = |s: f64| {
            let share = if length > 0.0 { s / length } else { 0.0 };
            (leg[0].0 + share * (leg[1].0 - leg[0].0), leg[0].1 + share * (leg[1].1 - leg[0].1))
        };
        let mut number = (along / (dash + gap)).floor();
        while number * (dash + gap) < along + length {
            let begin = (number * (dash + gap) - along).max(0.0);
            let end = (number * (dash + gap) + dash - along).min(length);
            if end > begin {
                legs.push([at(begin), at(end)]);
            }
            number += 1.0;
        }
        along += length;
    }
    legs
}

#[cfg(test)]
mod tests {
    use super::super::ink::Colour;
    use super::*;

    /// The share of black over a drawing of 40 x 40 units, in pixels.
    fn ink(draw: impl Fn(&mut Drawing)) -> f64 {
        let mut drawing = Drawing::new(40.0, 40.0);
        draw(&mut drawing);
        let pixels = pixels(&drawing, 1.0).expect("drawn");
        pixels.colours.iter().map(|c| 1.0 - f64::from(c.0) / 255.0).sum()
    }

    #[test]
    fn a_line_is_as_wide_in_every_direction() {
        let caps = std::f64::consts::PI * 2.25;
        for turn in 0..12 {
            let (sin, cos) = libm::sincos(f64::from(turn) * 0.3);
            let ends = [(20.0 - 15.0 * cos, 20.0 - 15.0 * sin), (20.0 + 15.0 * cos, 20.0 + 15.0 * sin)];
            let covered = ink(|d| d.line(ends, Colour::BLACK.stroke(3.0)));
            assert!((covered - 90.0 - caps).abs() < 3.0, "{turn}: {covered}");
        }
    }

    #[test]
    fn a_line_of_many_points_is_that_of_its_ends() {
        let points = (0..=60).map(|k| (5.0 + f64::from(k) * 0.5, 10.0 + f64::from(k) * 0.3));
        let many = ink(|d| d.line(points.clone(), Colour::BLACK.stroke(2.0)));
        let one = ink(|d| d.line([(5.0, 10.0), (35.0, 28.0)], Colour::BLACK.stroke(2.0)));
        assert!((many - one).abs() < 0.5, "{many} {one}");
    }

    #[test]
    fn areas_and_discs_cover_what_they_are_large() {
        let area = ink(|d| d.area([(3.3, 4.0), (23.3, 4.0), (13.3, 24.0)], Colour::BLACK));
        assert!((area - 200.0).abs() < 2.0, "{area}");
        let disc = ink(|d| d.disc((20.0, 20.0), 7.0, Colour::BLACK));
        assert!((disc - std::f64::consts::PI * 49.0).abs() < 2.0, "{disc}");
    }

    #[test]
    fn dashes_leave_gaps_and_nothing_is_drawn_outside() {
        let dashed = ink(|d| d.line([(0.0, 20.0), (40.0, 20.0)], Colour::BLACK.dashed(2.0)));
        assert!((40.0..70.0).contains(&dashed), "{dashed}");
        assert!(ink(|d| d.line([(-50.0, -9.0), (90.0, -9.0)], Colour::BLACK.stroke(2.0))) < 1e-9);
        assert!(
            ink(|d| d.text(
                "left and right of the sheet",
                (-30.0, 20.0),
                20.0,
                Colour::BLACK,
                super::super::drawing::Anchor::Start
            )) > 9.0
        );
    }
}
