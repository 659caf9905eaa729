//! Differences with their intervals: a row per mapper from the best to the worst, a panel per metric.

use super::plan::REFERENCE;
use super::rows::{Difference, Rows};
use super::sheets::{ALL, OBSERVABLE, interval};
use crate::figures::axis::Axis;
use crate::figures::drawing::{Anchor, Point};
use crate::figures::ink::{Colour, FAINT, GRID, INK, LABEL, SMALL};
use crate::figures::{Drawing, Paper, letters};
use crate::worlds::criteria::{Criterion, criterion};

/// How a verdict looks: told apart by shape, and by colours that every eye tells apart.
#[derive(Clone, Copy)]
struct Look {
    word: &'static str,
    colour: Colour,
    sign: Sign,
}

#[derive(Clone, Copy)]
enum Sign {
    /// A triangle to the left, where less is.
    Left,
    /// A triangle to the right.
    Right,
    Disc,
    /// A square with nothing in it.
    Hollow,
}

const BETTER: Look = Look { word: "better", colour: Colour(0, 114, 178), sign: Sign::Left };
const WORSE: Look = Look { word: "worse", colour: Colour(190, 75, 0), sign: Sign::Right };
const EQUIVALENT: Look = Look { word: "equivalent", colour: Colour(60, 60, 60), sign: Sign::Disc };
const UNDECIDED: Look = Look { word: "undecided", colour: Colour(130, 130, 130), sign: Sign::Hollow };

/// A row, what stands above and below the rows, the numbers beside the scale of a panel, and the gap behind them.
const ROW: f64 = 28.0;
const HEAD: f64 = 46.0;
const FOOT: f64 = 118.0;
const NUMBERS: f64 = 232.0;
const GAP: f64 = 26.0;

/// Width of the picture, and the narrowest scale.
const WIDTH: f64 = 1400.0;
const SCALE: f64 = 140.0;

/// Draws the differences of all mappers over all worlds by the given metrics, sorted by the first of them.
pub fn draw(rows: &Rows, mappers: &[&str], metrics: &[&str], paper: &Paper) -> Drawing {
    let of = |mapper: &str, metric: &str| rows.difference(ALL, OBSERVABLE, mapper, metric);
    let first = metrics.first().copied().unwrap_or_default();
    let mut names: Vec<&str> = mappers.iter().copied().filter(|mapper| of(mapper, first).is_some()).collect();
    let by = |name: &str| of(name, first).and_then(|d| d.difference).unwrap_or(f64::INFINITY);
    names.sort_by(|a, b| by(a).total_cmp(&by(b)));
    let left = names.iter().map(|name| letters::width(name, SMALL)).fold(0.0, f64::max) + 26.0;
    let room = (paper.width(WIDTH) - left) / metrics.len().max(1) as f64;
    // Numbers stand beside the scale where there is room.
    let numbers = if room - NUMBERS - GAP >= SCALE { NUMBERS } else { 0.0 };
    let scale = (room - numbers - GAP).max(SCALE);
    let bottom = HEAD + ROW * names.len() as f64;
    let whole = left + metrics.len() as f64 * (scale + numbers + GAP);
    let mut drawing = Drawing::new(whole, bottom + FOOT);
    for (k, name) in names.iter().enumerate() {
        let y = middle(k);
        if k % 2 == 0 {
            drawing.block((0.0, y - 0.5 * ROW), (whole, y + 0.5 * ROW), Colour(246, 247, 249));
        }
        drawing.text(name, (left - 14.0, y), SMALL, INK, Anchor::End);
    }
    for (column, metric) in metrics.iter().enumerate() {
        let Some(criterion) = criterion(metric) else { continue };
        let differences: Vec<Option<&Difference>> = names.iter().map(|name| of(name, metric)).collect();
        let at = left + column as f64 * (scale + numbers + GAP);
        panel(&mut drawing, criterion, &differences, (at, scale), numbers > 0.0);
    }
    key(&mut drawing, (left, bottom + FOOT - 24.0));
    drawing
}

fn middle(row: usize) -> f64 {
    HEAD + ROW * (row as f64 + 0.5)
}

fn panel(
    drawing: &mut Drawing,
    criterion: &Criterion,
    differences: &[Option<&Difference>],
    (left, scale): (f64, f64),
    numbers: bool,
) {
    let ends = differences.iter().flatten().flat_map(|d| [d.low, d.high]).flatten();
    let (least, most) = ends.fold((0.0f64, 0.0f64), |(a, b), v| (a.min(v), b.max(v)));
    let margin = 0.04 * (most - least).max(1e-9);
    let unit = if criterion.unit == "1" { String::new() } else { format!(", {}", criterion.unit) };
    let axis = Axis::linear(&format!("{} minus {REFERENCE}{unit}", criterion.title), least - margin..most + margin);
    let at = |value: f64| left + axis.share(value) * scale;
    drawing.text(criterion.title, (left, 0.5 * HEAD), LABEL, INK, Anchor::Start);
    let bottom = HEAD + ROW * differences.len() as f64;
    if let Some((_, margin)) = criterion.judged {
        let [from, to] = [-margin, margin].map(|v| at(v).clamp(left, left + scale));
        drawing.block((from, HEAD), (to, bottom), Colour(226, 230, 236));
    }
    for tick in axis.ticks((scale / 62.0) as usize) {
        let x = left + tick.at * scale;
        drawing.line([(x, HEAD), (x, bottom)], GRID.stroke(1.0));
        drawing.line([(x, bottom), (x, bottom + 7.0)], FAINT.stroke(1.5));
        drawing.text(&tick.label, (x, bottom + 19.0), SMALL, INK, Anchor::Middle);
    }
    drawing.line([(left, bottom), (left + scale, bottom)], FAINT.stroke(1.5));
    drawing.line([(at(0.0), HEAD), (at(0.0), bottom)], INK.stroke(1.5));
    drawing.text(&axis.label, (left + 0.5 * scale, bottom + 48.0), SMALL, INK, Anchor::Middle);
    for (k, d) in differences.iter().enumerate() {
        let Some(d) = d else { continue };
        let (look, y) = (look(d), middle(k));
        if let (Some(value), Some(low), Some(high)) = (d.difference, d.low, d.high) {
            drawing.line([(at(low), y), (at(high), y)], look.colour.stroke(3.0));
            look.draw(drawing, (at(value), y));
        }
        if numbers {
            drawing.text(&interval(d, criterion.decimals), (left + scale + 12.0, y), SMALL, look.colour, Anchor::Start);
        }
    }
}

fn look(d: &Difference) -> Look {
    match d.verdict.as_deref() {
        Some("better") => BETTER,
        Some("worse") => WORSE,
        Some("equivalent") => EQUIVALENT,
        _ => UNDECIDED,
    }
}

impl Look {
    fn draw(self, drawing: &mut Drawing, (x, y): Point) {
        const REACH: f64 = 7.0;
        let pointing =
            |side: f64| [(x + side * REACH, y), (x - side * REACH, y - REACH), (x - side * REACH, y + REACH)];
        match self.sign {
            Sign::Left => drawing.area(pointing(-1.0), self.colour),
            Sign::Right => drawing.area(pointing(1.0), self.colour),
            Sign::Disc => drawing.disc((x, y), 6.5, self.colour),
            Sign::Hollow => {
                drawing.block((x - 6.0, y - 6.0), (x + 6.0, y + 6.0), Colour::WHITE);
                drawing.frame((x - 6.0, y - 6.0), (x + 6.0, y + 6.0), self.colour.stroke(2.0));
            }
        }
    }
}

/// What the signs and the band mean.
fn key(drawing: &mut Drawing, (left, y): Point) {
    let mut x = left;
    for look in [BETTER, EQUIVALENT, UNDECIDED, WORSE] {
        look.draw(drawing, (x + 8.0, y));
        drawing.text(look.word, (x + 22.0, y), SMALL, look.colour, Anchor::Start);
        x += 22.0 + letters::width(look.word, SMALL) + 30.0;
    }
    let text = "margin of equivalence";
    if x + 40.0 + letters::width(text, SMALL) < drawing.width {
        drawing.block((x, y - 9.0), (x + 24.0, y + 9.0), Colour(226, 230, 236));
        drawing.text(text, (x + 32.0, y), SMALL, INK, Anchor::Start);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::drawing::Item;

    fn row(mapper: &str, difference: f64, verdict: &str) -> Difference {
        Difference {
            scope: ALL.to_owned(),
            region: OBSERVABLE.to_owned(),
            metric: "log_loss".to_owned(),
            mapper: mapper.to_owned(),
            pairs: Some(9),
            difference: Some(difference),
            low: Some(difference - 0.01),
            high: Some(difference + 0.01),
            p_holm: None,
            rank_biserial: None,
            cohen_dz: None,
            verdict: Some(verdict.to_owned()),
        }
    }

    #[test]
    fn rows_are_sorted_and_verdicts_told_apart() {
        let differences = vec![row("far", 0.3, "worse"), row("even", 0.001, "equivalent"), row("near", -0.1, "better")];
        let rows = Rows { differences, ..Rows::default() };
        let drawing = draw(&rows, &["far", "even", "near"], &["log_loss"], &Paper::default());
        let written = drawing.items.iter().filter_map(|item| match item {
            Item::Letters { text, start, colour, .. } => Some((text.as_str(), start.1, *colour)),
            _ => None,
        });
        let written: Vec<_> = written.collect();
        let y = |name: &str| written.iter().find(|(text, ..)| *text == name).expect(name).1;
        assert!(y("near") < y("even") && y("even") < y("far"));
        let shade = |start: &str| written.iter().find(|(text, ..)| text.starts_with(start)).expect(start).2;
        assert_eq!([shade("+0.300"), shade("-0.100")], [WORSE.colour, BETTER.colour]);
        assert!(
            written.iter().any(|(text, ..)| text.contains("nats/cell"))
                && written.iter().any(|(text, ..)| *text == "0.2")
        );
    }
}
