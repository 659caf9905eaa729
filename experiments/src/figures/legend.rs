//! The legend of a sheet of charts: every name once, below all of them.

use super::chart::{Chart, RIGHT};
use super::drawing::{Anchor, Drawing, Point};
use super::elements::SIGN;
use super::ink::{INK, SMALL};
use super::letters;
use super::style::Style;

/// Length of a line, and height of a row.
const SAMPLE: f64 = 44.0;
const ROW: f64 = 30.0;

/// Rows of entries.
pub(super) struct Legend(Vec<Vec<Entry>>);

struct Entry {
    /// Where it begins.
    x: f64,
    name: String,
    style: Style,
}

impl Legend {
    /// The names of all charts in the order in which they first stand there; nothing where there is nothing to tell apart.
    pub(super) fn of(charts: &[Chart], width: f64) -> Self {
        let mut entries: Vec<(&str, Style)> = Vec::new();
        let drawn = charts.iter().flat_map(|chart| &chart.series).filter(|series| !series.points.is_empty());
        for series in drawn.filter(|series| !series.name.is_empty()) {
            if !entries.iter().any(|(name, _)| *name == series.name) {
                entries.push((&series.name, series.style));
            }
        }
        if entries.len() < 2 {
            return Self(Vec::new());
        }
        let (mut rows, mut x) = (vec![Vec::new()], RIGHT);
        for (name, style) in entries {
            let wide = SAMPLE + 8.0 + letters::width(name, SMALL) + 28.0;
            if x + wide > width && x > RIGHT {
                rows.push(Vec::new());
                x = RIGHT;
            }
            if let Some(row) = rows.last_mut() {
                row.push(Entry { x, name: name.to_owned(), style });
            }
            x += wide;
        }
        Self(rows)
    }

    pub(super) fn height(&self) -> f64 {
        if self.0.is_empty() { 0.0 } else { ROW * self.0.len() as f64 + 12.0 }
    }

    pub(super) fn draw(&self, drawing: &mut Drawing, top: f64) {
        for (row, entries) in self.0.iter().enumerate() {
            let y = top + ROW * (row as f64 + 0.5);
            for Entry { x, name, style } in entries {
                sample(drawing, (*x, y), *style);
                drawing.text(name, (x + SAMPLE + 8.0, y), SMALL, INK, Anchor::Start);
            }
        }
    }
}

/// A piece of a line with its sign.
fn sample(drawing: &mut Drawing, (x, y): Point, style: Style) {
    drawing.line([(x, y), (x + SAMPLE, y)], style.stroke);
    if let Some(shape) = style.shape {
        shape.draw(drawing, (x + 0.5 * SAMPLE, y), SIGN, style.stroke.colour);
    }
}
