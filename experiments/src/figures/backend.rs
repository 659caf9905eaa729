//! What plotters draws on: its shapes become items of a [`Drawing`], which does not know of pixels.

use plotters::style::{FontDesc, RGBColor, ShapeStyle, TextStyle};
use plotters_backend::text_anchor::{HPos, Pos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind, FontFamily,
    FontStyle, FontTransform,
};

use super::drawing::{Anchor, Drawing, Point, Stroke};
use super::ink::Colour;
use super::letters;

/// Steps of a unit: plotters counts in whole numbers, and a step is too small to be seen in any print.
pub(super) const FINE: f64 = 256.0;

/// Height of a line of letters as plotters places it, in sizes: the small letters stand in its middle.
const LINE: f64 = 0.8;

/// A length in steps.
pub(super) fn fine(units: f64) -> i32 {
    (units * FINE).round() as i32
}

/// A place in units.
pub(super) fn place((x, y): BackendCoord) -> Point {
    (f64::from(x) / FINE, f64::from(y) / FINE)
}

/// Something that a drawing has no item for.
#[derive(Debug, thiserror::Error)]
#[error("a drawing has no {0}")]
pub struct Missing(&'static str);

/// What came of drawing a shape.
pub(super) type Drawn = Result<(), DrawingErrorKind<Missing>>;

/// A drawing in the making, as a back end of plotters.
#[derive(Debug)]
pub struct Canvas {
    pub drawing: Drawing,
}

impl Canvas {
    /// A white sheet of so many units.
    pub fn new(width: f64, height: f64) -> Self {
        Self { drawing: Drawing::new(width, height) }
    }

    /// A line, broken or not.
    pub fn path(&mut self, points: impl IntoIterator<Item = BackendCoord>, stroke: Stroke) {
        self.drawing.line(points.into_iter().map(place), stroke);
    }
}

impl DrawingBackend for Canvas {
    type ErrorType = Missing;

    fn get_size(&self) -> (u32, u32) {
        let steps = |units: f64| (units * FINE).round() as u32;
        (steps(self.drawing.width), steps(self.drawing.height))
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    /// A square of one step.
    fn draw_pixel(&mut self, (x, y): BackendCoord, color: BackendColor) -> Drawn {
        self.draw_rect((x, y), (x + 1, y + 1), &color, true)
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Drawn {
        self.draw_path([from, to], style)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Drawn {
        if let Some(colour) = colour(style) {
            self.path(path, colour.stroke(f64::from(style.stroke_width()) / FINE));
        }
        Ok(())
    }

    fn draw_rect<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S, fill: bool) -> Drawn {
        if !fill {
            let corners = [from, (to.0, from.1), to, (from.0, to.1), from];
            return self.draw_path(corners, style);
        }
        if let Some(colour) = colour(style) {
            self.drawing.block(place(from), place(to), colour);
        }
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(&mut self, center: BackendCoord, radius: u32, style: &S, fill: bool) -> Drawn {
        let ((x, y), radius) = (place(center), f64::from(radius) / FINE);
        let Some(colour) = colour(style) else { return Ok(()) };
        if fill {
            self.drawing.disc((x, y), radius, colour);
            return Ok(());
        }
        const SIDES: u32 = 64;
        let corner = |k: u32| {
            let (sin, cos) = libm::sincos(f64::from(k) * std::f64::consts::TAU / f64::from(SIDES));
            (x + radius * cos, y + radius * sin)
        };
        self.drawing.line((0..=SIDES).map(corner), colour.stroke(f64::from(style.stroke_width()) / FINE));
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, vert: I, style: &S) -> Drawn {
        if let Some(colour) = colour(style) {
            self.drawing.area(vert.into_iter().map(place), colour);
        }
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, pos: BackendCoord) -> Drawn {
        let Some(colour) = solid(style.color()).filter(|_| !text.is_empty()) else { return Ok(()) };
        let ((x, y), size) = (place(pos), style.size() / FINE);
        let (anchor, along) = match style.anchor().h_pos {
            HPos::Left => (Anchor::Start, 0.5),
            HPos::Center => (Anchor::Middle, 0.0),
            HPos::Right => (Anchor::End, -0.5),
        };
        let below = match style.anchor().v_pos {
            VPos::Top => 0.5,
            VPos::Center => 0.0,
            VPos::Bottom => -0.5,
        } * LINE
            * size;
        match style.transform() {
            FontTransform::None => self.drawing.text(text, (x, y + below), size, colour, anchor),
            FontTransform::Rotate270 => {
                let along = along * letters::width(text, size);
                self.drawing.upward_text(text, (x + below, y - along), size, colour);
            }
            FontTransform::Rotate90 | FontTransform::Rotate180 => {
                return Err(DrawingErrorKind::DrawingError(Missing("text that runs downwards or stands on its head")));
            }
        }
        Ok(())
    }

    fn estimate_text_size<S: BackendTextStyle>(
        &self,
        text: &str,
        style: &S,
    ) -> Result<(u32, u32), DrawingErrorKind<Missing>> {
        let size = style.size();
        Ok((letters::width(text, size).round() as u32, (LINE * size).round() as u32))
    }
}

/// The colour of a style over white; none of one that cannot be seen.
fn colour(style: &impl BackendStyle) -> Option<Colour> {
    solid(style.color())
}

fn solid(BackendColor { alpha, rgb: (r, g, b) }: BackendColor) -> Option<Colour> {
    (alpha > 0.0).then(|| Colour::WHITE.towards(Colour(r, g, b), alpha.min(1.0)))
}

impl From<Colour> for RGBColor {
    fn from(Colour(r, g, b): Colour) -> Self {
        Self(r, g, b)
    }
}

/// A line in one piece, as plotters styles it.
pub(super) fn shape(stroke: Stroke) -> ShapeStyle {
    let style = ShapeStyle::from(RGBColor::from(stroke.colour));
    style.stroke_width((stroke.width * FINE).round() as u32)
}

/// Letters, as plotters styles them: about the middle of their height.
pub(super) fn lettering(size: f64, colour: Colour, anchor: Anchor) -> TextStyle<'static> {
    let h_pos = match anchor {
        Anchor::Start => HPos::Left,
        Anchor::Middle => HPos::Center,
        Anchor::End => HPos::Right,
    };
    // The name of the font is not asked for: there is but the bundled one.
    let font = FontDesc::new(FontFamily::SansSerif, size * FINE, FontStyle::Normal);
    font.color(&RGBColor::from(colour)).pos(Pos::new(h_pos, VPos::Center))
}

#[cfg(test)]
mod tests {
    use plotters::drawing::IntoDrawingArea;
    use plotters::element::{Circle, PathElement, Polygon, Rectangle, Text};
    use plotters::style::{BLACK, Color, RED};

    use super::super::drawing::Item;
    use super::*;

    /// The items of what is drawn on a canvas of 100 x 50 units.
    fn items(draw: impl FnOnce(&mut Canvas) -> Drawn) -> Vec<Item> {
        let mut canvas = Canvas::new(100.0, 50.0);
        draw(&mut canvas).expect("drawn");
        canvas.drawing.items
    }

    fn at(x: f64, y: f64) -> BackendCoord {
        (fine(x), fine(y))
    }

    #[test]
    fn elements_of_plotters_become_items() {
        let canvas = std::rc::Rc::new(std::cell::RefCell::new(Canvas::new(100.0, 50.0)));
        let area = plotters::drawing::DrawingArea::from(&canvas);
        let stroke = Colour(1, 2, 3).stroke(2.5);
        area.draw(&PathElement::new(vec![at(1.0, 2.0), at(3.5, 4.0), at(9.0, 2.0)], shape(stroke))).expect("a line");
        area.draw(&Rectangle::new([at(1.0, 2.0), at(3.0, 4.0)], RED.filled())).expect("a block");
        area.draw(&Polygon::new(vec![at(0.0, 0.0), at(4.0, 0.0), at(0.0, 4.0)], BLACK)).expect("an area");
        area.draw(&Circle::new(at(5.0, 6.0), fine(2.0), BLACK.filled())).expect("a disc");
        let red = Colour(255, 0, 0);
        let mut expected = Drawing::new(100.0, 50.0);
        expected.line([(1.0, 2.0), (3.5, 4.0), (9.0, 2.0)], stroke);
        expected.block((1.0, 2.0), (3.0, 4.0), red);
        expected.area([(0.0, 0.0), (4.0, 0.0), (0.0, 4.0)], Colour::BLACK);
        expected.disc((5.0, 6.0), 2.0, Colour::BLACK);
        assert_eq!(canvas.borrow().drawing, expected);
    }

    #[test]
    fn outlines_are_closed_and_what_cannot_be_seen_is_not_drawn() {
        let ring = items(|canvas| canvas.draw_circle(at(50.0, 25.0), fine(10.0) as u32, &BLACK, false));
        let [Item::Line { points, .. }] = &ring[..] else { panic!("{ring:?}") };
        let off = |(x, y): &Point| ((x - 50.0) * (x - 50.0) + (y - 25.0) * (y - 25.0)).sqrt() - 10.0;
        assert!(points.iter().all(|point| off(point).abs() < 1e-9) && (points[0].0 - points[64].0).abs() < 1e-9);
        let frame = items(|canvas| canvas.draw_rect(at(1.0, 1.0), at(5.0, 3.0), &BLACK, false));
        let [Item::Line { points, .. }] = &frame[..] else { panic!("{frame:?}") };
        assert_eq!(points[..], [(1.0, 1.0), (5.0, 1.0), (5.0, 3.0), (1.0, 3.0), (1.0, 1.0)]);
        assert!(items(|canvas| canvas.draw_line(at(1.0, 1.0), at(5.0, 3.0), &BLACK.mix(0.0))).is_empty());
        let half = items(|canvas| canvas.draw_rect(at(1.0, 1.0), at(5.0, 3.0), &BLACK.mix(0.5), true));
        assert!(matches!(half[..], [Item::Area { colour: Colour(128, 128, 128), .. }]), "{half:?}");
    }

    #[test]
    fn letters_stand_where_their_anchor_says() {
        let written = |style: TextStyle| {
            let items = items(|canvas| canvas.draw_text("room", &style, at(50.0, 25.0)));
            let [Item::Letters { start, size, upwards, .. }] = items[..] else { panic!("{items:?}") };
            assert!((size - 20.0).abs() < 1e-12);
            (start, upwards)
        };
        let wide = letters::width("room", 20.0);
        for (anchor, share) in [(Anchor::Start, 0.0), (Anchor::Middle, 0.5), (Anchor::End, 1.0)] {
            let style = lettering(20.0, Colour::BLACK, anchor);
            let ((x, y), upwards) = written(style.clone());
            assert!(
                !upwards && (x - 50.0 + share * wide).abs() < 1e-9 && (y - 25.0 - 20.0 * letters::MIDDLE).abs() < 1e-9
            );
            let ((x, y), upwards) = written(style.transform(FontTransform::Rotate270));
            assert!(
                upwards && (x - 50.0 - 20.0 * letters::MIDDLE).abs() < 1e-9 && (y - 25.0 - share * wide).abs() < 1e-9
            );
        }
        let base = |v_pos| written(lettering(20.0, Colour::BLACK, Anchor::Start).pos(Pos::new(HPos::Left, v_pos))).0.1;
        let [top, center, bottom] = [VPos::Top, VPos::Center, VPos::Bottom].map(base);
        assert!((top - center - 8.0).abs() < 1e-9 && (center - bottom - 8.0).abs() < 1e-9);
    }

    #[test]
    fn a_text_is_as_large_as_its_letters_and_none_stands_on_its_head() {
        let area = Canvas::new(100.0, 50.0).into_drawing_area();
        let style = lettering(20.0, Colour::BLACK, Anchor::Start);
        let (wide, high) = area.estimate_text_size("room", &style).expect("measured");
        assert_eq!((wide as i32, high as i32), (fine(letters::width("room", 20.0)), fine(16.0)));
        let turned = style.transform(FontTransform::Rotate180);
        let error = area.draw(&Text::new("room", (0, 0), turned)).expect_err("no such item");
        assert!(error.to_string().contains("stands on its head"), "{error}");
    }
}
