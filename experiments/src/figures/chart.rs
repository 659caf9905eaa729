//! Charts: lines, signs and intervals over a pair of axes, and sheets of them with one legend.

use std::cell::RefCell;
use std::ops::Range;
use std::rc::Rc;

use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::Shift;
use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::ranged1d::{LightPoints, Ranged};
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind};
use plotters::element::{EmptyElement, PathElement, Rectangle, Text};
use plotters::series::LineSeries;
use plotters::style::{Color, RGBColor, TRANSPARENT, WHITE};

pub use super::axis::Axis;
use super::backend::{Canvas, FINE, Missing, fine, lettering, place, shape};
use super::drawing::{Anchor, Dashes, Drawing};
use super::elements::{Line, Sign};
use super::ink::{Colour, FAINT, GRID, INK, LABEL, SMALL};
use super::legend::Legend;
use super::letters;
use super::paper::Paper;
use super::style::Style;
use super::window::Window;

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

/// Half the length of the bars that end an interval.
const CAP: f64 = 4.0;

const BAND: Colour = Colour(236, 240, 245);

/// Room about a chart: above it for the title, below it for its axis, and to its right.
const HEAD: f64 = 40.0;
const FOOT: f64 = 66.0;
pub(super) const RIGHT: f64 = 20.0;

/// What of the room to the left and below is a margin.
const BESIDE: f64 = 12.8;
const BELOW: f64 = 10.8;

/// Ticks with and without a label. Labels are two ticks from their axis.
const TICK: f64 = 6.0;
const SHORT: f64 = 4.0;

/// Width of the gap in an axis with a value apart.
const GAP: f64 = 8.0;

/// The narrowest that a chart may become, as a share of the width that it was made for.
const NARROWEST: f64 = 0.62;

/// A part of a sheet, and one with axes.
type Area = DrawingArea<Canvas, Shift>;
type Plot<'a> = ChartContext<'a, Canvas, Cartesian2d<Axis, Axis>>;

type Outcome = Result<(), DrawingAreaErrorKind<Missing>>;

/// Draws charts row by row, at most so many to a row, each about so large, with the legend of all below them.
pub fn sheet(charts: &[Chart], columns: usize, (width, height): (f64, f64), paper: &Paper) -> Drawing {
    let natural = columns.clamp(1, charts.len().max(1));
    let whole = paper.width(width * natural as f64);
    let columns = (1..=natural).rev().find(|k| whole / *k as f64 >= NARROWEST * width).unwrap_or(1);
    let rows = charts.len().div_ceil(columns).max(1);
    let legend = Legend::of(charts, whole);
    let top = height * rows as f64;
    let canvas = Rc::new(RefCell::new(Canvas::new(whole, top + legend.height())));
    let areas = DrawingArea::from(&canvas).split_vertically(fine(top)).0.split_evenly((rows, columns));
    let drawn = charts.iter().zip(areas).try_for_each(|(chart, area)| chart.draw(&area));
    drawn.expect("a drawing has an item for all that charts consist of");
    let mut drawing = canvas.replace(Canvas::new(0.0, 0.0)).drawing;
    legend.draw(&mut drawing, top);
    drawing
}

impl Chart {
    /// A chart with nothing to point out.
    pub fn new(title: &str, x: Axis, y: Axis, series: Vec<Series>) -> Self {
        Self { title: title.to_owned(), x, y, bands: Vec::new(), ends: Vec::new(), series }
    }

    fn draw(&self, area: &Area) -> Outcome {
        let (width, height) = area.dim_in_pixel();
        let (width, height) = (f64::from(width) / FINE, f64::from(height) / FINE);
        let labels = ((height - HEAD - FOOT) / 62.0) as usize;
        let widest = self.y.ticks(labels).iter().map(|tick| letters::width(&tick.label, SMALL)).fold(0.0, f64::max);
        let left = 16.0 + if self.y.label.is_empty() { 0.0 } else { 28.0 } + widest + 2.0 * TICK;
        let named = self.series.iter().filter(|series| series.style.labelled && !series.points.is_empty());
        let right = named.map(|series| letters::width(&series.name, SMALL) + 12.0).fold(RIGHT, f64::max);
        // Lines need room more than their names do.
        let right = right.min(0.5 * (width - left)).max(RIGHT);
        let title = letters::cut(&self.title, LABEL, width - left);
        area.draw_text(&title, &lettering(LABEL, INK, Anchor::Start), (fine(left), fine(0.5 * HEAD)))?;
        let mut plot = ChartBuilder::on(area)
            .margin_top(fine(HEAD))
            .margin_bottom(fine(BELOW))
            .margin_left(fine(BESIDE))
            .margin_right(fine(right))
            .x_label_area_size(fine(FOOT - BELOW))
            .y_label_area_size(fine(left - BESIDE))
            .build_cartesian_2d(self.x.clone(), self.y.clone())?;
        self.bands(&mut plot)?;
        self.axes(&mut plot, [((width - left - right) / 76.0) as usize, labels])?;
        self.gap(&plot, area)?;
        self.ends(&mut plot)?;
        for (number, series) in self.series.iter().enumerate() {
            self.series(&mut plot, series, number)?;
        }
        self.names(&plot, area, right - 12.0)
    }

    /// Where values are shown, as shares of the axes.
    fn window(&self) -> Window {
        Window::new((0.0, 0.0), (1.0, 1.0))
    }

    fn shares(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (self.x.share(x), self.y.share(y))
    }

    fn shows(&self, x: f64, y: f64) -> bool {
        self.window().holds(self.shares((x, y)))
    }

    fn bands(&self, plot: &mut Plot) -> Outcome {
        let (low, high) = (self.y.range.start, self.y.range.end);
        let style = lettering(SMALL, FAINT, Anchor::Middle);
        for (Range { start, end }, name) in &self.bands {
            plot.draw_series([Rectangle::new([(*start, low), (*end, high)], RGBColor::from(BAND).filled())])?;
            let [from, to] = [start, end].map(|x| self.x.share(*x).clamp(0.0, 1.0));
            let name = Text::new(name.clone(), (0, fine(14.0)), style.clone());
            plot.draw_series([EmptyElement::at((self.x.value(0.5 * (from + to)), high)) + name])?;
        }
        Ok(())
    }

    /// The mesh and the axes, with room for so many labels.
    fn axes(&self, plot: &mut Plot, labels: [usize; 2]) -> Outcome {
        let axis = FAINT.stroke(1.5);
        plot.configure_mesh()
            .x_labels(labels[0])
            .y_labels(labels[1])
            .bold_line_style(shape(GRID.stroke(1.0)))
            .light_line_style(TRANSPARENT)
            .axis_style(shape(axis))
            .set_all_tick_mark_size(fine(TICK))
            .label_style(lettering(SMALL, INK, Anchor::Middle))
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .draw()?;
        let (left, bottom) = (self.x.range.start, self.y.range.start);
        let light = |axis: &Axis, labels: usize| axis.key_points(LightPoints::new(labels, usize::MAX));
        let tick = |at: (f64, f64), to: (i32, i32)| EmptyElement::at(at) + PathElement::new([(0, 0), to], shape(axis));
        let below = light(&self.x, labels[0]).into_iter().map(|x| tick((x, bottom), (0, fine(SHORT))));
        let beside = light(&self.y, labels[1]).into_iter().map(|y| tick((left, y), (-fine(SHORT), 0)));
        plot.draw_series(below.chain(beside))?;
        Ok(())
    }

    /// The gap in an axis before a value apart: what follows is no value of its scale.
    fn gap(&self, plot: &Plot, area: &Area) -> Outcome {
        if self.x.apart.is_none() {
            return Ok(());
        }
        let (x, y) = plot.plotting_area().get_pixel_range();
        let end = x.start + (self.x.scale_end() * f64::from(x.end - x.start)).round() as i32;
        let screen = area.use_screen_coord();
        let ends = [(end, y.end - fine(2.0)), (end + fine(GAP), y.end + fine(2.0))];
        screen.draw(&Rectangle::new(ends, WHITE.filled()))?;
        for x in [end, end + fine(GAP)] {
            let slash = [(x - fine(4.0), y.end + fine(7.0)), (x + fine(4.0), y.end - fine(7.0))];
            screen.draw(&PathElement::new(slash, shape(FAINT.stroke(1.5))))?;
        }
        Ok(())
    }

    fn ends(&self, plot: &mut Plot) -> Outcome {
        let style = lettering(SMALL, FAINT, Anchor::Middle);
        let (low, high) = (self.y.range.start, self.y.range.end);
        for (x, name) in self.ends.iter().filter(|(x, _)| self.shows(*x, low)) {
            plot.draw_series([Line { points: vec![(*x, low), (*x, high)], stroke: FAINT.dashed(1.5) }])?;
            let name = Text::new(name.clone(), (0, fine(-9.0)), style.clone());
            plot.draw_series([EmptyElement::at((*x, high)) + name])?;
        }
        Ok(())
    }

    fn series(&self, plot: &mut Plot, series: &Series, number: usize) -> Outcome {
        let Style { stroke, shape: sign, .. } = series.style;
        for line in self.pieces(series) {
            match stroke.dashes {
                Dashes::Solid => plot.draw_series(LineSeries::new(line, shape(stroke)))?,
                Dashes::Dashed | Dashes::Dotted => plot.draw_series([Line { points: line, stroke }])?,
            };
        }
        let thin = shape(stroke.colour.stroke(1.5));
        for at in &series.points {
            let Some((low, high)) = at.interval else { continue };
            let ends = [(at.x, low), (at.x, high)];
            let [below, above] = ends.map(|end| self.shares(end));
            if self.window().clip(below, above).is_none() {
                continue;
            }
            plot.draw_series([PathElement::new(ends, thin)])?;
            // Where the scale ends before the interval does, no bar says that it ends.
            let cap = |end| EmptyElement::at(end) + PathElement::new([(-fine(CAP), 0), (fine(CAP), 0)], thin);
            plot.draw_series(ends.into_iter().filter(|(x, y)| self.shows(*x, *y)).map(cap))?;
        }
        let Some(sign) = sign else { return Ok(()) };
        let every = series.points.len().div_ceil(MOST_MARKS).max(1);
        // Where not every point has a sign, those of lines that run together stand beside each other.
        let first = number * every / self.series.len().max(1);
        let signed = series.points.iter().skip(first).step_by(every).filter(|at| self.shows(at.x, at.y));
        plot.draw_series(signed.map(|at| Sign { at: (at.x, at.y), shape: sign, colour: stroke.colour }))?;
        Ok(())
    }

    /// The pieces of a line that are shown; none across the gap of the axis.
    fn pieces(&self, series: &Series) -> Vec<Vec<(f64, f64)>> {
        let apart = |x: f64| self.x.apart.as_ref().is_some_and(|(apart, _)| x >= *apart);
        let line = series.points.iter().map(|at| (at.x, at.y)).filter(|(x, y)| !apart(*x) && y.is_finite());
        let pieces = self.window().pieces(&line.map(|at| self.shares(at)).collect::<Vec<_>>());
        let values = |(x, y): (f64, f64)| (self.x.value(x), self.y.value(y));
        pieces.into_iter().map(|piece| piece.into_iter().map(values).collect()).collect()
    }

    /// Names at the ends of the lines that have no colour of their own, none upon another and none wider than the room.
    fn names(&self, plot: &Plot, area: &Area, room: f64) -> Outcome {
        let end = |series: &'_ Series| {
            let last = series.points.iter().rev().find(|at| self.shows(at.x, at.y))?;
            Some((place(plot.backend_coord(&(last.x, last.y))).1, letters::cut(&series.name, SMALL, room)))
        };
        let named = self.series.iter().filter(|series| series.style.labelled);
        let mut ends: Vec<(f64, String)> = named.filter_map(end).collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (x, y) = plot.plotting_area().get_pixel_range();
        let screen = area.use_screen_coord();
        let mut free = place((0, y.start)).1 - 10.0;
        for (y, name) in ends {
            let y = y.max(free);
            screen.draw(&Text::new(name, (x.end + fine(8.0), fine(y)), lettering(SMALL, FAINT, Anchor::Start)))?;
            free = y + SMALL;
        }
        Ok(())
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
        let highest = highest.map(|p| p.1).fold(f64::INFINITY, f64::min);
        assert!((top..HEAD + 0.5).contains(&highest), "{highest}");
        let discs = drawing.items.iter().filter(|item| matches!(item, Item::Disc { .. })).count();
        assert_eq!(discs, 2 * 2 + 2 * 2, "a disc with its rim at one point of either series, and in the legend");
    }

    #[test]
    fn a_line_keeps_its_slope_where_it_leaves_the_frame() {
        let mut chart = chart(&[(1.0, 0.5), (5.0, 3.0), (6.0, f64::INFINITY)]);
        let pieces = chart.pieces(&chart.series[0]);
        let (from, to) = (pieces[0][0], pieces[0][1]);
        let near = |(x, y): (f64, f64), (u, v): (f64, f64)| (x - u).abs() + (y - v).abs() < 1e-9;
        assert!(pieces.len() == 1 && near(from, (1.0, 0.5)) && near(to, (1.8, 1.0)), "{pieces:?}");
        chart.y = Axis::logarithmic("y, m", 0.1..1.0);
        let (x, y) = chart.pieces(&chart.series[0])[0][1];
        assert!(near((x, y), (1.0 + 4.0 * libm::log(2.0) / libm::log(6.0), 1.0)), "{x} {y}");
    }

    #[test]
    fn an_interval_has_bars_where_it_ends_within_the_scale() {
        let bars = |low: f64, high: f64| {
            let mut chart = chart(&[(5.0, 0.5)]);
            chart.series.truncate(1);
            chart.series[0].points[0].interval = Some((low, high));
            let drawing = sheet(&[chart], 1, (600.0, 400.0), &Paper::default());
            let colour = Style::numbered(0).stroke.colour;
            let of = |item: &&Item| matches!(item, Item::Line { stroke, .. } if stroke.colour == colour);
            drawing.items.iter().filter(of).count()
        };
        assert_eq!([bars(0.4, 0.6), bars(0.4, 2.0), bars(-1.0, f64::INFINITY), bars(1.5, 2.0)], [3, 2, 1, 0]);
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
    fn a_narrow_chart_has_room_for_its_lines_beside_long_names() {
        let mut narrow = chart(&[(0.0, 0.0), (5.0, 1.0)]);
        for series in &mut narrow.series {
            series.style.labelled = true;
            series.name += " of a mapper with a long name";
        }
        let paper = Paper { width_mm: Some(60.0), ..Paper::default() };
        let drawing = sheet(&[narrow.clone(), narrow], 2, (350.0, 340.0), &paper);
        let line = |item: &'_ Item| match item {
            Item::Line { points, stroke } if (stroke.width - 2.5).abs() < 1e-9 => Some(points[1].0 - points[0].0),
            _ => None,
        };
        let lengths: Vec<f64> = drawing.items.iter().filter_map(line).collect();
        assert!(lengths.iter().all(|length| *length > 20.0), "{lengths:?}");
        assert!(texts(&drawing).iter().any(|text| text.starts_with("one") && text.ends_with('…')));
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
        let drawing = sheet(&[apart], 1, (600.0, 400.0), &Paper::default());
        let lines = drawing.items.iter().filter_map(|item| match item {
            Item::Line { points, stroke } if (stroke.width - 2.5).abs() < 1e-9 => Some(points.len()),
            _ => None,
        });
        assert_eq!(lines.collect::<Vec<_>>(), [2, 2, 2, 2], "two lines, and two in the legend");
    }
}
