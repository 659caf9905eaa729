//! Differences with their intervals: a row per mapper, a panel per metric.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::rows::{Difference, Rows};
use super::sheets::{ALL, OBSERVABLE, interval};
use crate::failure::Failure;
use crate::figures::ink::{self, FAINT, INK};
use crate::figures::{Area, png};
use crate::worlds::criteria::criterion;

const BETTER: RGBColor = RGBColor(0, 128, 96);
const WORSE: RGBColor = RGBColor(190, 60, 30);

/// Pixels: a row, what stands above and below the rows, names, numbers, and the scale of a panel.
const ROW: i32 = 30;
const HEAD: i32 = 64;
const FOOT: i32 = 24;
const NAMES: i32 = 230;
const NUMBERS: i32 = 250;
const SCALE: i32 = 300;
const GAP: i32 = 30;

/// Draws the differences of all mappers over all worlds by the given metrics.
///
/// # Errors
/// A drawing that fails.
pub fn draw(rows: &Rows, mappers: &[&str], metrics: &[&str]) -> Result<Vec<u8>, Failure> {
    let panels: Vec<Vec<&Difference>> = metrics
        .iter()
        .map(|metric| mappers.iter().filter_map(|m| rows.difference(ALL, OBSERVABLE, m, metric)).collect())
        .collect();
    let names: Vec<&str> = panels.first().into_iter().flatten().map(|d| d.mapper.as_str()).collect();
    let panel = SCALE + NUMBERS + GAP;
    let size = (NAMES + panel * metrics.len() as i32, HEAD + ROW * names.len() as i32 + FOOT);
    png((size.0 as u32, size.1 as u32), |area| {
        for (k, name) in names.iter().enumerate() {
            write(area, name, (NAMES - 12, middle(k)), HPos::Right, &INK)?;
        }
        for (column, (metric, differences)) in metrics.iter().zip(&panels).enumerate() {
            draw_panel(area, metric, differences, NAMES + panel * column as i32)?;
        }
        Ok(())
    })
}

fn middle(row: usize) -> i32 {
    HEAD + ROW * row as i32 + ROW / 2
}

fn draw_panel(area: &Area, metric: &str, differences: &[&Difference], left: i32) -> Result<(), Failure> {
    let Some(criterion) = criterion(metric) else { return Ok(()) };
    let ends = differences.iter().flat_map(|d| [d.low, d.high]).flatten();
    let (least, most) = ends.fold((0.0f64, 0.0f64), |(a, b), v| (a.min(v), b.max(v)));
    let width = (most - least).max(1e-9);
    let at = |value: f64| left + (f64::from(SCALE) * (value - least) / width).round() as i32;
    let unit = if criterion.unit == "1" { String::new() } else { format!(", {}", criterion.unit) };
    write(area, &format!("{}{unit}", criterion.title), (left, 20), HPos::Left, &INK)?;
    let bottom = middle(differences.len()) - ROW / 2;
    line(area, [(at(0.0), HEAD - 10), (at(0.0), bottom)], FAINT, 1)?;
    write(area, "0", (at(0.0), HEAD - 20), HPos::Center, &FAINT)?;
    for (k, d) in differences.iter().enumerate() {
        let colour = match d.verdict.as_deref() {
            Some("better") => BETTER,
            Some("worse") => WORSE,
            _ => FAINT,
        };
        let y = middle(k);
        if let (Some(value), Some(low), Some(high)) = (d.difference, d.low, d.high) {
            line(area, [(at(low), y), (at(high), y)], colour, 3)?;
            area.draw(&Circle::new((at(value), y), 5, colour.filled())).map_err(Failure::internal)?;
        }
        write(area, &interval(d, criterion.decimals), (left + SCALE + 16, y), HPos::Left, &colour)?;
    }
    Ok(())
}

fn line(area: &Area, ends: [(i32, i32); 2], colour: RGBColor, width: u32) -> Result<(), Failure> {
    area.draw(&PathElement::new(ends.to_vec(), colour.stroke_width(width))).map_err(Failure::internal)
}

fn write(area: &Area, text: &str, at: (i32, i32), side: HPos, colour: &RGBColor) -> Result<(), Failure> {
    let style = ink::letters(ink::LABEL, colour).pos(Pos::new(side, VPos::Center));
    // Centred are the letters with the room below them: without it they would stand too high.
    area.draw(&Text::new(text.to_owned(), (at.0, at.1 + 3), style)).map_err(Failure::internal)
}
