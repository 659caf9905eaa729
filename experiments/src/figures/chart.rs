//! Charts: lines, signs and intervals over a pair of axes, and sheets of them with one legend.

use std::ops::Range;

pub use super::axis::Axis;
use super::drawing::{Anchor, Drawing, Point};
use super::ink::{Colour, FAINT, GRID, INK, LABEL, SMALL};
use super::legend::Legend;
use super::letters;
use super::paper::Paper;
use super::style::Style;

/// A point of a series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct At {
    pub x: f64,
    pub y: f64,
    /// How surely `y` is known: the ends of its 95 % interval.
    pub interval: Option<(f64, f64)>,
}

/// Points that belong together, in order of x.
#[derive(Debug, Clone)]
pub struct Series {
    /// Name in the legend; empty of what only guides the eye.
    pub name: String,
    pub points: Vec<At>,
    pub style: Style,
}

impl Series {
    /// A series of points without intervals; those without a value are left out.
    pub fn new(name: &str, style: Style, points: impl IntoIterator<Item = (f64, Option<f64>)>) -> Self {
        let at = |(x, y): (f64, Option<f64>)| Some(At { x, y: y?, interval: None });
        Self { name: name.to_owned(), points: points.into_iter().filter_map(at).collect(), style }
    }
}

/// A chart.
#[derive(Debug, Clone)]
pub struct Chart {
    /// What stands above it.
    pub title: String,
    /// To the right.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// Ranges of x to point out, with their names.
    pub bands: Vec<(Range<f64>, String)>,
    /// Values of x at which something ends, with its name.
    pub ends: Vec<(f64, String)>,
    /// What is drawn, the first at the bottom.
    pub series: Vec<Series>,
}

/// More marks of a series than this would run together.
const MOST_MARKS: usize = 24;

/// Half the size of a sign, and of the ends of an interval.
pub(super) const SIGN: f64 = 6.5;
const CAP: f64 = 4.0;

const BAND: Colour = Colour(236, 240, 245);

/// Room about a chart: above it for the title, below it for its axis, and to its right.
const HEAD: f64 = 40.0;
const FOOT: f64 = 66.0;
pub(super) const RIGHT: f64 = 20.0;

/// The narrowest that a chart may become, as a share of the width that it was made for.
const NARROWEST: f64 = 0.62;

/// Draws charts row by row, at most so many to a row, each about so large, with the legend of all below them.
pub fn sheet(charts: &[Chart], columns: usize, (width, height): (f64, f64), paper: &Paper) -> Drawing {
    let natural = columns.clamp(1, charts.len().max(1));
    let whole = paper.width(width * natural as f64);
    let columns = (1..=natural).rev().find(|k| whole / *k as f64 >= NARROWEST * width).unwrap_or(1);
    let rows = charts.len().div_ceil(columns).max(1);
    let each = whole / columns as f64;
    let legend = Legend::of(charts, whole);
    let top = height * rows as f64;
    let mut drawing = Drawing::new(whole, top + legend.height());
    for (k, chart) in charts.iter().enumerate() {
        let corner = ((k % columns) as f64 * each, (k / columns) as f64 * height);
        chart.draw(&mut drawing, corner, (each, height));
    }
    legend.draw(&mut drawing, top);
    drawing
}

/// Where a chart's lines are.
struct Frame {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
}

impl Frame {
    fn at(&self, chart: &Chart, x: f64, y: f64) -> Point {
        (self.left + chart.x.share(x) * self.width, self.top + (1.0 - chart.y.share(y)) * self.height)
    }

    fn holds(&self, (x, y): Point) -> bool {
        let inside = |v: f64, from: f64, length: f64| (from - 0.5..=from + length + 0.5).contains(&v);
        inside(x, self.left, self.width) && inside(y, self.top, self.height)
    }

    /// The part of a straight line that is inside.
    fn clip(&self, from: Point, to: Point) -> Option<(Point, Point)> {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let (right, bottom) = (self.left + self.width, self.top + self.height);
        let sides = [(-dx, from.0 - self.left), (dx, right - from.0), (-dy, from.1 - self.top), (dy, bottom - from.1)];
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
}

impl Chart {
    /// A chart with nothing to point out.
    pub fn new(title: &str, x: Axis, y: Axis, series: Vec<Series>) -> Self {
        Self { title: title.to_owned(), x, y, bands: Vec::new(), ends: Vec::new(), series }
    }

    fn draw(&self, drawing: &mut Drawing, corner: Point, (width, height): (f64, f64)) {
        let ticks = self.y.ticks(((height - HEAD - FOOT) / 62.0) as usize);
        let widest = ticks.iter().map(|tick| letters::width(&tick.label, SMALL)).fold(0.0, f64::max);
        let left = 16.0 + if self.y.label.is_empty() { 0.0 } else { 28.0 } + widest + 12.0;
        let named = self.series.iter().filter(|series| series.style.labelled && !series.points.is_empty());
        let right = named.map(|series| letters::width(&series.name, SMALL) + 12.0).fold(RIGHT, f64::max);
        let frame = Frame {
            left: corner.0 + left,
            top: corner.1 + HEAD,
            width: width - left - right,
            height: height - HEAD - FOOT,
        };
        let title = letters::cut(&self.title, LABEL, width - left);
        drawing.text(&title, (frame.left, corner.1 + 20.0), LABEL, INK, Anchor::Start);
        self.bands(drawing, &frame);
        self.axes(drawing, &frame, corner.0, &ticks);
        for (x, name) in &self.ends {
            let x = frame.left + self.x.share(*x) * frame.width;
            drawing.line([(x, frame.top), (x, frame.top + frame.height)], FAINT.dashed(1.5));
            drawing.text(name, (x, frame.top - 9.0), SMALL, FAINT, Anchor::Middle);
        }
        for (number, series) in self.series.iter().enumerate() {
            self.line(drawing, &frame, series, number);
        }
        self.names(drawing, &frame);
    }

    fn bands(&self, drawing: &mut Drawing, frame: &Frame) {
        for (range, name) in &self.bands {
            let [from, to] =
                [range.start, range.end].map(|x| frame.left + self.x.share(x).clamp(0.0, 1.0) * frame.width);
            drawing.block((from, frame.top), (to, frame.top + frame.height), BAND);
            drawing.text(name, (0.5 * (from + to), frame.top + 14.0), SMALL, FAINT, Anchor::Middle);
        }
    }

    fn axes(&self, drawing: &mut Drawing, frame: &Frame, outside: f64, ticks: &[super::axis::Tick]) {
        let (right, bottom) = (frame.left + frame.width, frame.top + frame.height);
        let line = FAINT.stroke(1.5);
        for tick in ticks {
            let y = frame.top + (1.0 - tick.at) * frame.height;
            if tick.label.is_empty() {
                drawing.line([(frame.left - 4.0, y), (frame.left, y)], line);
                continue;
            }
            drawing.line([(frame.left, y), (right, y)], GRID.stroke(1.0));
            drawing.line([(frame.left - 7.0, y), (frame.left, y)], line);
            drawing.text(&tick.label, (frame.left - 12.0, y), SMALL, INK, Anchor::End);
        }
        let room = (frame.width / 76.0) as usize;
        for tick in self.x.ticks(room) {
            let x = frame.left + tick.at * frame.width;
            let long = if tick.label.is_empty() { 4.0 } else { 7.0 };
            if !tick.label.is_empty() {
                drawing.line([(x, frame.top), (x, bottom)], GRID.stroke(1.0));
            }
            drawing.line([(x, bottom), (x, bottom + long)], line);
            drawing.text(&tick.label, (x, bottom + 19.0), SMALL, INK, Anchor::Middle);
        }
        drawing.line([(frame.left, frame.top), (frame.left, bottom)], line);
        let end = frame.left + self.x.scale_end() * frame.width;
        drawing.line([(frame.left, bottom), (end, bottom)], line);
        if self.x.apart.is_some() {
            // The axis is broken: what follows is no value of its scale.
            for x in [end, end + 8.0] {
                drawing.line([(x - 4.0, bottom + 7.0), (x + 4.0, bottom - 7.0)], line);
            }
            drawing.line([(end + 8.0, bottom), (right, bottom)], line);
        }
        drawing.text(&self.x.label, (frame.left + 0.5 * frame.width, bottom + 48.0), SMALL, INK, Anchor::Middle);
        drawing.upward_text(&self.y.label, (outside + 20.0, frame.top + 0.5 * frame.height), SMALL, INK);
    }

    /// The pieces of a line that are inside the frame; none across a break of the axis.
    fn pieces(&self, frame: &Frame, series: &Series) -> Vec<Vec<Point>> {
        let mut pieces: Vec<Vec<Point>> = Vec::new();
        let apart = |at: &At| self.x.apart.as_ref().is_some_and(|(apart, _)| at.x >= *apart);
        for pair in series.points.windows(2).filter(|pair| !apart(&pair[1])) {
            let [from, to] = [pair[0], pair[1]].map(|at| frame.at(self, at.x, at.y));
            let Some((from, to)) = frame.clip(from, to) else { continue };
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

    fn line(&self, drawing: &mut Drawing, frame: &Frame, series: &Series, number: usize) {
        let Style { stroke, shape, .. } = series.style;
        for piece in self.pieces(frame, series) {
            drawing.line(piece, stroke);
        }
        let thin = stroke.colour.stroke(1.5);
        for at in &series.points {
            let Some((low, high)) = at.interval else { continue };
            let ends = (frame.at(self, at.x, low), frame.at(self, at.x, high));
            let Some(((x, low), (_, high))) = frame.clip(ends.0, ends.1) else { continue };
            drawing.line([(x, low), (x, high)], thin);
            for y in [low, high] {
                drawing.line([(x - CAP, y), (x + CAP, y)], thin);
            }
        }
        let Some(shape) = shape else { return };
        let points = &series.points;
        let every = points.len().div_ceil(MOST_MARKS).max(1);
        // Where not every point has a sign, those of lines that run together stand beside each other.
        let first = number * every / self.series.len().max(1);
        for at in points.iter().skip(first).step_by(every) {
            let place = frame.at(self, at.x, at.y);
            if frame.holds(place) {
                shape.draw(drawing, place, SIGN, stroke.colour);
            }
        }
    }

    /// Names at the ends of the lines that have no colour of their own, none upon another.
    fn names(&self, drawing: &mut Drawing, frame: &Frame) {
        let end = |series: &Series| {
            let at = series.points.iter().rev().map(|at| frame.at(self, at.x, at.y)).find(|at| frame.holds(*at))?;
            Some((at.1, series.name.clone()))
        };
        let mut ends: Vec<(f64, String)> =
            self.series.iter().filter(|series| series.style.labelled).filter_map(end).collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut free = frame.top - 10.0;
        for (y, name) in ends {
            let y = y.max(free);
            drawing.text(&name, (frame.left + frame.width + 8.0, y), SMALL, FAINT, Anchor::Start);
            free = y + SMALL;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::drawing::Item;

    fn chart(points: &[(f64, f64)]) -> Chart {
        let series = |name: &str| Series::new(name, Style::numbered(0), points.iter().map(|&(x, y)| (x, Some(y))));
        let [x, y] = [Axis::linear("x, m", 0.0..10.0), Axis::linear("y, m", 0.0..1.0)];
        Chart::new("title", x, y, vec![series("one"), series("two")])
    }

    fn texts(drawing: &Drawing) -> Vec<String> {
        let text = |item: &'_ Item| if let Item::Letters { text, .. } = item { Some(text.clone()) } else { None };
        drawing.items.iter().filter_map(text).collect()
    }

    #[test]
    fn a_line_ends_where_the_frame_does_and_no_sign_stands_outside() {
        let drawing = sheet(&[chart(&[(1.0, 0.5), (5.0, 3.0)])], 1, (600.0, 400.0), &Paper::default());
        let top = HEAD - 0.5;
        let blue = |item: &&Item| matches!(item, Item::Line { stroke, .. } if (stroke.width - 2.5).abs() < 1e-9);
        let highest = drawing.items.iter().filter(blue).flat_map(|item| match item {
            Item::Line { points, .. } => points.clone(),
            _ => Vec::new(),
        });
        assert!(highest.map(|p| p.1).fold(f64::INFINITY, f64::min) >= top);
        let discs = drawing.items.iter().filter(|item| matches!(item, Item::Disc { .. })).count();
        assert_eq!(discs, 2 * 2 + 2 * 2, "a disc with its rim at one point of either series, and in the legend");
    }

    #[test]
    fn a_narrow_paper_has_charts_below_each_other_with_letters_as_large() {
        let charts = [chart(&[(0.0, 0.0), (1.0, 1.0)]), chart(&[(0.0, 0.0), (1.0, 1.0)])];
        let narrow = Paper { width_mm: Some(85.0), ..Paper::default() };
        let [wide, narrow] = [Paper::default(), narrow].map(|paper| sheet(&charts, 2, (700.0, 500.0), &paper));
        assert!(wide.width > 1399.0 && narrow.width < 670.0 && narrow.height > 1000.0);
        let sizes = |drawing: &Drawing| {
            drawing
                .items
                .iter()
                .map(|i| if let Item::Letters { size, .. } = i { *size } else { 99.0 })
                .fold(99.0, f64::min)
        };
        assert!((sizes(&wide) - sizes(&narrow)).abs() < 1e-12);
    }

    #[test]
    fn names_stand_once_in_the_legend_and_axes_have_their_labels() {
        let charts = [chart(&[(0.0, 0.0), (1.0, 1.0)]), chart(&[(0.0, 0.0), (1.0, 1.0)])];
        let drawing = sheet(&charts, 2, (700.0, 500.0), &Paper::default());
        let texts = texts(&drawing);
        let count = |text: &str| texts.iter().filter(|other| **other == text).count();
        assert_eq!(["one", "two", "x, m", "y, m", "title"].map(count), [1, 1, 2, 2, 2]);
    }

    #[test]
    fn no_line_leads_to_a_value_apart() {
        let mut apart = chart(&[(1.0, 0.2), (5.0, 0.3), (1000.0, 0.4)]);
        apart.x.apart = Some((1000.0, "all".to_owned()));
        let frame = Frame { left: 0.0, top: 0.0, width: 100.0, height: 100.0 };
        let pieces = apart.pieces(&frame, &apart.series[0]);
        assert_eq!(pieces.iter().map(Vec::len).collect::<Vec<_>>(), [2]);
    }
}
