//! Lettering in the bundled font: how wide a text is, and its outlines.

use std::sync::OnceLock;

use ab_glyph::{Font as _, FontRef, GlyphId, OutlineCurve};

use crate::failure::Failure;

/// How far the middle of the small letters lies above the base line, in sizes of the letters.
pub const MIDDLE: f64 = 0.27;

/// A letter in its place: how far its base point is from the start of the text, in sizes.
pub struct Placed {
    pub glyph: GlyphId,
    pub at: f64,
}

fn font() -> Option<&'static FontRef<'static>> {
    static FONT: OnceLock<Option<FontRef<'static>>> = OnceLock::new();
    let bytes = include_bytes!("../../fonts/OpenSans-Regular.ttf");
    FONT.get_or_init(|| FontRef::try_from_slice(bytes).ok()).as_ref()
}

fn per_size(units: f32) -> f64 {
    f64::from(units) / font().and_then(|font| font.units_per_em()).map_or(1.0, f64::from)
}

/// The letters of a text, with its kerning, and its width in sizes.
pub fn place(text: &str) -> (Vec<Placed>, f64) {
    let Some(font) = font() else { return (Vec::new(), 0.0) };
    let (mut at, mut former, mut placed) = (0.0, None, Vec::new());
    for letter in text.chars() {
        let glyph = font.glyph_id(letter);
        at += former.map_or(0.0, |former| per_size(font.kern_unscaled(former, glyph)));
        placed.push(Placed { glyph, at });
        at += per_size(font.h_advance_unscaled(glyph));
        former = Some(glyph);
    }
    (placed, at)
}

/// How wide a text is.
pub fn width(text: &str, size: f64) -> f64 {
    place(text).1 * size
}

/// A text cut where it would be wider than there is room for.
pub fn cut(text: &str, size: f64, room: f64) -> String {
    let mut shown = text.to_owned();
    while width(&shown, size) > room && shown.chars().count() > 2 {
        shown.truncate(shown.trim_end_matches('…').char_indices().next_back().map_or(0, |(last, _)| last));
        shown.push('…');
    }
    shown
}

/// The outline of a letter in sizes, to the right and up; nothing of a blank.
///
/// # Errors
/// A font that cannot be read.
pub fn outline(glyph: GlyphId) -> Result<Vec<Curve>, Failure> {
    let font = font().ok_or_else(|| Failure::internal("the bundled font cannot be read"))?;
    let point = |p: ab_glyph::Point| (per_size(p.x), per_size(p.y));
    let curve = |curve: &OutlineCurve| match *curve {
        OutlineCurve::Line(a, b) => Curve { from: point(a), by: vec![], to: point(b) },
        OutlineCurve::Quad(a, b, c) => Curve { from: point(a), by: vec![point(b)], to: point(c) },
        OutlineCurve::Cubic(a, b, c, d) => Curve { from: point(a), by: vec![point(b), point(c)], to: point(d) },
    };
    Ok(font.outline(glyph).map(|outline| outline.curves.iter().map(curve).collect()).unwrap_or_default())
}

/// A piece of an outline, with the control points of a Bézier curve.
pub struct Curve {
    pub from: (f64, f64),
    pub by: Vec<(f64, f64)>,
    pub to: (f64, f64),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blank_is_wide_and_letters_are_kerned() {
        let [together, apart] = ["Aroom", "A room"].map(|text| width(text, 20.0));
        assert!(apart > together + 4.0, "{together} {apart}");
        assert!(width("AV", 20.0) < width("A", 20.0) + width("V", 20.0) - 0.3);
    }

    #[test]
    fn a_text_is_cut_where_the_room_ends() {
        assert_eq!(cut("visibility", 20.0, 1000.0), "visibility");
        let shown = cut("visibility-lateral", 20.0, 80.0);
        assert!(shown.ends_with('…') && width(&shown, 20.0) <= 80.0, "{shown}");
    }

    #[test]
    fn every_letter_that_pictures_use_is_in_the_font() {
        for letter in "abcXYZ019.,:;-+()[]/%²µ·–…−×≥σ°".chars() {
            assert!(font().expect("readable").glyph_id(letter).0 != 0, "{letter}");
        }
    }
}
