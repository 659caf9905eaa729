//! A drawing as SVG: lines stay lines, letters are outlines of the bundled font, so that no other font steps in.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;

use super::drawing::{Drawing, Item, Point, Stroke};
use super::ink::Colour;
use super::raster::Pixels;
use super::{encode, letters};
use crate::failure::Failure;

/// The text of the file, where a unit is so many mm.
///
/// # Errors
/// A font that cannot be read.
pub(super) fn text(drawing: &Drawing, mm: f64) -> Result<String, Failure> {
    let (width, height) = (drawing.width, drawing.height);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}mm\" height=\"{}mm\" viewBox=\"0 0 {} {}\">\n",
        short(width * mm),
        short(height * mm),
        short(width),
        short(height)
    );
    text += &glyphs(drawing)?;
    let _ = writeln!(text, "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>");
    for item in &drawing.items {
        match item {
            Item::Line { points, stroke } => line(&mut text, points, *stroke),
            Item::Area { points, colour } => {
                let _ = writeln!(text, "<polygon points=\"{}\" fill=\"{}\"/>", path(points), hex(*colour));
            }
            Item::Disc { centre: (x, y), radius, colour } => {
                let [x, y, radius] = [*x, *y, *radius].map(short);
                let _ = writeln!(text, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{}\"/>", hex(*colour));
            }
            Item::Letters { text: written, start, size, colour, upwards } => {
                write_letters(&mut text, written, *start, (*size, *upwards), *colour);
            }
            Item::Cells { corner, size, columns, colours } => cells(&mut text, *corner, *size, *columns, colours)?,
        }
    }
    Ok(text + "</svg>\n")
}

/// Up to three decimals.
fn short(value: f64) -> String {
    let rounded = (value * 1000.0).round() / 1000.0;
    format!("{}", if rounded.abs() < 1e-9 { 0.0 } else { rounded })
}

fn hex(Colour(r, g, b): Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn path(points: &[Point]) -> String {
    points.iter().map(|(x, y)| format!("{},{}", short(*x), short(*y))).collect::<Vec<_>>().join(" ")
}

fn line(text: &mut String, points: &[Point], stroke: Stroke) {
    let dashes = stroke.dashes.lengths().map_or_else(String::new, |lengths| {
        let [dash, gap] = lengths.map(|length| short(length * stroke.width));
        format!(" stroke-dasharray=\"{dash} {gap}\"")
    });
    let _ = writeln!(
        text,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linecap=\"round\" \
         stroke-linejoin=\"round\"{dashes}/>",
        path(points),
        hex(stroke.colour),
        short(stroke.width)
    );
}

/// The outlines of all letters that are used, a thousand times as large as they are wide, with y downwards.
fn glyphs(drawing: &Drawing) -> Result<String, Failure> {
    let written = drawing.items.iter().filter_map(|item| match item {
        Item::Letters { text, .. } => Some(text),
        _ => None,
    });
    let used: BTreeSet<_> = written.flat_map(|text| letters::place(text).0).map(|placed| placed.glyph).collect();
    let mut text = "<defs>\n".to_owned();
    for glyph in used {
        let (mut path, mut last) = (String::new(), None);
        for curve in letters::outline(glyph)? {
            let put = |(x, y): Point| format!("{} {}", short(x * 1000.0), short(-y * 1000.0));
            if last != Some(curve.from) {
                let _ = write!(path, "M{}", put(curve.from));
            }
            let letter = ["L", "Q", "C"][curve.by.len().min(2)];
            let by = curve.by.iter().map(|point| put(*point) + " ").collect::<String>();
            let _ = write!(path, "{letter}{by}{}", put(curve.to));
            last = Some(curve.to);
        }
        let _ = writeln!(text, "<path id=\"g{}\" d=\"{path}\"/>", glyph.0);
    }
    Ok(text + "</defs>\n")
}

fn write_letters(text: &mut String, written: &str, (x, y): Point, (size, upwards): (f64, bool), colour: Colour) {
    let name = written.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
    let turn = if upwards { " rotate(-90)" } else { "" };
    let [x, y] = [x, y].map(short);
    let scale = (size * 1e3).round() / 1e6;
    let _ = write!(
        text,
        "<g role=\"img\" aria-label=\"{name}\" fill=\"{}\" transform=\"translate({x} {y}){turn} scale({scale})\">",
        hex(colour)
    );
    for placed in letters::place(written).0 {
        let _ = write!(text, "<use href=\"#g{}\" x=\"{}\"/>", placed.glyph.0, short(placed.at * 1000.0));
    }
    let _ = writeln!(text, "</g>");
}

fn cells(text: &mut String, corner: Point, size: Point, columns: usize, colours: &[Colour]) -> Result<(), Failure> {
    let pixels = Pixels { width: columns, height: colours.len() / columns.max(1), colours: colours.to_vec() };
    let [x, y, width, height] = [corner.0, corner.1, size.0, size.1].map(short);
    let _ = writeln!(
        text,
        "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
         style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{}\"/>",
        BASE64_STANDARD.encode(encode::png(&pixels, 200)?)
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::drawing::Anchor;
    use super::*;

    #[test]
    fn every_item_is_there_and_the_text_is_well_formed() {
        let mut drawing = Drawing::new(200.0, 100.0);
        drawing.line([(0.0, 0.0), (10.0, 5.0)], Colour::BLACK.dashed(2.0));
        drawing.block((1.0, 1.0), (5.0, 5.0), Colour(255, 0, 0));
        drawing.disc((7.0, 7.0), 2.5, Colour(0, 0, 255));
        drawing.text("a < \"b\" & c", (50.0, 50.0), 20.0, Colour::BLACK, Anchor::Middle);
        drawing.cells((0.0, 0.0), (20.0, 10.0), 2, vec![Colour::BLACK, Colour::WHITE]);
        let text = text(&drawing, 0.127).expect("written");
        assert!(text.contains("width=\"25.4mm\" height=\"12.7mm\" viewBox=\"0 0 200 100\""), "{text}");
        let mut reader = quick_xml::Reader::from_str(&text);
        let (mut names, mut depth) = (BTreeSet::new(), 0);
        loop {
            match reader.read_event().expect("well-formed") {
                quick_xml::events::Event::Start(tag) => {
                    depth += 1;
                    names.insert(tag.name().as_ref().to_owned());
                }
                quick_xml::events::Event::Empty(tag) => {
                    tag.attributes().for_each(|attribute| assert!(attribute.is_ok(), "{attribute:?}"));
                    names.insert(tag.name().as_ref().to_owned());
                }
                quick_xml::events::Event::End(_) => depth -= 1,
                quick_xml::events::Event::Eof => break,
                _ => {}
            }
        }
        assert_eq!(depth, 0);
        let expected = ["circle", "defs", "g", "image", "path", "polygon", "polyline", "rect", "svg", "use"];
        assert_eq!(names.into_iter().collect::<Vec<_>>(), expected);
    }
}
