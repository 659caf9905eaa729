//! Charts: curves and marks over a pair of axes, each of which may be logarithmic.

use std::ops::Range;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::ink::{self, FAINT, INK};
pub use super::mark::Mark;
use super::{Area, png};
use crate::failure::Failure;

/// An axis.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// What is shown; of a logarithmic axis, above 0.
    pub range: Range<f64>,
    /// Whether equal ratios are equally long.
    pub logarithmic: bool,
}

impl Axis {
    /// An axis on which equal differences are equally long.
    pub fn linear(label: &str, range: Range<f64>) -> Self {
        Self { label: label.to_owned(), range, logarithmic: false }
    }

    /// An axis on which equal ratios are equally long; values outside its range lie on its border.
    pub fn logarithmic(label: &str, range: Range<f64>) -> Self {
        Self { label: label.to_owned(), range, logarithmic: true }
    }

    /// Where a value lies.
    fn at(&self, value: f64) -> f64 {
        let held = value.clamp(self.range.start, self.range.end);
        if self.logarithmic { libm::log10(held) } else { held }
    }

    fn ends(&self) -> Range<f64> {
        self.at(self.range.start)..self.at(self.range.end)
    }

    /// What stands at a tick.
    fn tick(&self, at: f64) -> String {
        if !self.logarithmic {
            return format!("{}", (at * 1e6).round() / 1e6);
        }
        if (at - at.round()).abs() > 1e-6 {
            return String::new();
        }
        let power = at.round() as i32;
        let value = libm::pow(10.0, f64::from(power));
        if (-3..4).contains(&power) { format!("{}", (value * 1e4).round() / 1e4) } else { format!("1e{power}") }
    }

    /// How many ticks to ask for: one per power of ten.
    fn ticks(&self) -> usize {
        let ends = self.ends();
        if self.logarithmic { (ends.end - ends.start).round().max(1.0) as usize + 1 } else { 7 }
    }
}

/// Points that belong together, in order of x.
#[derive(Debug, Clone)]
pub struct Series {
    /// Name in the legend; empty of what only guides the eye.
    pub name: String,
    /// Points; those without a value are left out.
    pub points: Vec<(f64, Option<f64>)>,
    /// How they are drawn.
    pub mark: Mark,
    /// In which colour.
    pub colour: RGBColor,
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
    /// What is drawn, the first at the bottom.
    pub series: Vec<Series>,
    /// Where the legend has room.
    pub legend: SeriesLabelPosition,
}

/// At most so many marks of a series: more would run together.
const MOST_MARKS: usize = 60;

/// Length of a series' line in the legend, px.
const LEGEND_PX: i32 = 28;

/// Between the dashes of a line, px.
const DASH_GAP_PX: i32 = 6;

const BAND: RGBColor = RGBColor(238, 242, 246);

/// Draws charts of the given size (px) side by side, and gives a PNG.
///
/// # Errors
/// A drawing that fails.
pub fn draw(charts: &[Chart], size: (u32, u32)) -> Result<Vec<u8>, Failure> {
    sheet(charts, charts.len(), size)
}

/// Draws charts of the given size (px) row by row, so many to a row, and gives a PNG.
///
/// # Errors
/// A drawing that fails.
pub fn sheet(charts: &[Chart], columns: usize, (width, height): (u32, u32)) -> Result<Vec<u8>, Failure> {
    let columns = columns.clamp(1, charts.len().max(1));
    let rows = charts.len().div_ceil(columns).max(1);
    png((width * columns as u32, height * rows as u32), |area| {
        let areas = area.split_evenly((rows, columns));
        areas.iter().zip(charts).try_for_each(|(area, chart)| chart.draw(area))
    })
}

impl Chart {
    fn draw(&self, area: &Area) -> Result<(), Failure> {
        let (x, y) = (self.x.ends(), self.y.ends());
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, ink::letters(ink::TITLE, &INK))
            .margin(16)
            .margin_right(28)
            .x_label_area_size(52)
            .y_label_area_size(84)
            .build_cartesian_2d(x, y.clone())
            .map_err(Failure::internal)?;
        for (range, name) in &self.bands {
            let corners = [(self.x.at(range.start), y.start), (self.x.at(range.end), y.end)];
            chart.draw_series([Rectangle::new(corners, BAND.filled())]).map_err(Failure::internal)?;
            let style = ink::letters(ink::LABEL - 2, &FAINT).pos(Pos::new(HPos::Center, VPos::Top));
            let middle = 0.5 * (corners[0].0 + corners[1].0);
            let below = y.end - 0.015 * (y.end - y.start);
            chart.draw_series([Text::new(name.clone(), (middle, below), style)]).map_err(Failure::internal)?;
        }
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(226, 226, 226))
            .axis_style(FAINT)
            .label_style(ink::letters(ink::LABEL, &INK))
            .x_labels(self.x.ticks())
            .y_labels(self.y.ticks())
            .x_label_formatter(&|at| self.x.tick(*at))
            .y_label_formatter(&|at| self.y.tick(*at))
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .draw()
            .map_err(Failure::internal)?;
        for series in &self.series {
            let points: Vec<(f64, f64)> =
                series.points.iter().filter_map(|&(x, y)| Some((self.x.at(x), self.y.at(y?)))).collect();
            let (mark, colour) = (series.mark, series.colour);
            let line = mark.line(colour);
            let drawn = if mark == Mark::Dashes {
                chart.draw_series(DashedLineSeries::new(points.clone(), 8, DASH_GAP_PX, line))
            } else {
                chart.draw_series(LineSeries::new(points.clone(), line))
            };
            let drawn = drawn.map_err(Failure::internal)?;
            if !series.name.is_empty() {
                drawn.label(&series.name).legend(move |at| {
                    let gap = if mark == Mark::Dashes { DASH_GAP_PX / 2 } else { 0 };
                    let part = |from: i32, to: i32| PathElement::new(vec![(from, 0), (to, 0)], mark.line(colour));
                    let [left, right] = [part(-LEGEND_PX / 2, -gap), part(gap, LEGEND_PX / 2)];
                    let [first, second] = mark.strokes(colour);
                    let centre = EmptyElement::at((at.0 + LEGEND_PX / 2, at.1));
                    centre + left + right + first + second + mark.ring((0, 0), colour)
                });
            }
            if mark.at_points() {
                let every = points.len().div_ceil(MOST_MARKS).max(1);
                let marked = points.iter().skip(every / 2).step_by(every);
                let signs = marked.map(|&at| {
                    let [first, second] = mark.strokes(colour);
                    EmptyElement::at(at) + first + second + mark.ring((0, 0), colour)
                });
                chart.draw_series(signs).map_err(Failure::internal)?;
            }
        }
        if self.series.iter().filter(|series| !series.name.is_empty()).count() < 2 {
            return Ok(()); // the title says what it is
        }
        chart
            .configure_series_labels()
            .position(self.legend.clone())
            .margin(12)
            .legend_area_size(LEGEND_PX + 8)
            .label_font(ink::letters(ink::LABEL - 2, &INK))
            .background_style(WHITE.mix(0.9))
            .border_style(FAINT)
            .draw()
            .map_err(Failure::internal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_of_a_logarithmic_axis_are_powers_of_ten() {
        let axis = Axis::logarithmic("", 1e-5..10.0);
        assert_eq!(axis.ticks(), 7);
        let shown: Vec<String> = [-5.0, -3.0, -0.5, 0.0, 1.0].map(|at| axis.tick(at)).to_vec();
        assert_eq!(shown, ["1e-5", "0.001", "", "1", "10"]);
        assert!((axis.at(0.01) + 2.0).abs() < 1e-12);
        assert!((axis.at(0.0) + 5.0).abs() < 1e-12 && (axis.at(1e9) - 1.0).abs() < 1e-12, "held within");
    }

    #[test]
    fn ticks_of_a_linear_axis_have_no_rounding_noise() {
        let axis = Axis::linear("", 0.0..1.0);
        assert_eq!([0.1 + 0.2, 1.0].map(|at| axis.tick(at)), ["0.3", "1"]);
    }
}
