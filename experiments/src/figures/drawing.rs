//! A drawing: what there is to see, in units from the upper left corner, before it becomes pixels or SVG.

use super::ink::Colour;
use super::letters;

/// A place: to the right and down.
pub type Point = (f64, f64);

/// A picture in the making.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    pub width: f64,
    pub height: f64,
    /// From the bottom up.
    pub items: Vec<Item>,
}

/// Something to see.
#[derive(Debug, Clone, PartialEq)]
pub enum Item {
    /// A line through points, with round ends and corners.
    Line { points: Vec<Point>, stroke: Stroke },
    /// A polygon.
    Area { points: Vec<Point>, colour: Colour },
    /// A disc.
    Disc { centre: Point, radius: f64, colour: Colour },
    /// Letters on a base line that begins at a place, turned so that they run upwards or not.
    Letters { text: String, start: Point, size: f64, colour: Colour, upwards: bool },
    /// Coloured rectangles, all of one size, row by row from the top.
    Cells { corner: Point, size: Point, columns: usize, colours: Vec<Colour> },
}

/// How a line looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    pub colour: Colour,
    pub width: f64,
    pub dashes: Dashes,
}

/// How a line is broken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dashes {
    Solid,
    Dashed,
    Dotted,
}

impl Dashes {
    /// Lengths of a dash and of the gap behind it, in widths of the line; nothing of a line in one piece.
    pub fn lengths(self) -> Option<[f64; 2]> {
        match self {
            Self::Solid => None,
            Self::Dashed => Some([4.0, 3.0]),
            Self::Dotted => Some([0.01, 2.2]),
        }
    }
}

/// Where a text stands about its place, to the right and down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// It begins there.
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

impl Colour {
    /// A line of this colour in one piece.
    pub fn stroke(self, width: f64) -> Stroke {
        Stroke { colour: self, width, dashes: Dashes::Solid }
    }

    /// A broken line of this colour.
    pub fn dashed(self, width: f64) -> Stroke {
        Stroke { colour: self, width, dashes: Dashes::Dashed }
    }
}

impl Drawing {
    /// A white sheet of so many units.
    pub fn new(width: f64, height: f64) -> Self {
        Self { width, height, items: Vec::new() }
    }

    pub fn line(&mut self, points: impl IntoIterator<Item = Point>, stroke: Stroke) {
        let points: Vec<Point> = points.into_iter().collect();
        if !points.is_empty() {
            self.items.push(Item::Line { points, stroke });
        }
    }

    pub fn area(&mut self, points: impl IntoIterator<Item = Point>, colour: Colour) {
        self.items.push(Item::Area { points: points.into_iter().collect(), colour });
    }

    /// A filled rectangle between two corners.
    pub fn block(&mut self, (left, top): Point, (right, bottom): Point, colour: Colour) {
        self.area([(left, top), (right, top), (right, bottom), (left, bottom)], colour);
    }

    /// The outline of a rectangle between two corners.
    pub fn frame(&mut self, (left, top): Point, (right, bottom): Point, stroke: Stroke) {
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
        corners.windows(2).for_each(|side| self.line(side.to_vec(), stroke));
    }

    pub fn disc(&mut self, centre: Point, radius: f64, colour: Colour) {
        self.items.push(Item::Disc { centre, radius, colour });
    }

    /// A text whose small letters are as high above its place as below.
    pub fn text(&mut self, text: &str, (x, y): Point, size: f64, colour: Colour, anchor: Anchor) {
        let start = (x - anchor.share() * letters::width(text, size), y + letters::MIDDLE * size);
        self.items.push(Item::Letters { text: text.to_owned(), start, size, colour, upwards: false });
    }

    /// A text that runs upwards, about the middle of its length.
    pub fn upward_text(&mut self, text: &str, (x, y): Point, size: f64, colour: Colour) {
        let start = (x + letters::MIDDLE * size, y + 0.5 * letters::width(text, size));
        self.items.push(Item::Letters { text: text.to_owned(), start, size, colour, upwards: true });
    }

    /// A raster of colours, row by row from the top, in a rectangle.
    pub fn cells(&mut self, corner: Point, size: Point, columns: usize, colours: Vec<Colour>) {
        self.items.push(Item::Cells { corner, size, columns, colours });
    }
}

impl Anchor {
    fn share(self) -> f64 {
        match self {
            Self::Start => 0.0,
            Self::Middle => 0.5,
            Self::End => 1.0,
        }
    }
}
