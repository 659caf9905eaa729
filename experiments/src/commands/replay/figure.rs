//! The maps of a log, side by side.

use grid::Raster;
use plotters::prelude::*;

use crate::failure::Failure;
use crate::figures::ink::{self, INK, ROUTE};
use crate::figures::panel::Panel;
use crate::figures::png;

/// What the picture shows.
pub(super) const CAPTION: &str =
    "Maps from the same scans. White is free, black occupied, grey never seen; blue is where the sensor went.";

const GAP: u32 = 14;
const HEAD: u32 = 34;

/// Width of a map, px, and that of two beside each other.
const WIDTHS: [usize; 2] = [1400, 900];

/// Draws maps by name, two in a row unless they are wide, with the path of the sensor (m).
///
/// # Errors
/// A drawing that fails.
pub(super) fn draw(
    maps: &[(&str, &Raster<f64>)],
    seen: &Raster<bool>,
    prior: f64,
    path: &[[f64; 2]],
) -> Result<Vec<u8>, Failure> {
    let Some((_, first)) = maps.first() else { return png((1, 1), |_| Ok(())) };
    let spec = *first.spec();
    let columns = if maps.len() > 1 && spec.width < 2 * spec.height { 2 } else { 1 };
    let panel = Panel::whole(spec, WIDTHS[columns - 1]);
    let (width, height) = panel.size();
    let rows = maps.len().div_ceil(columns) as u32;
    let size = (GAP + columns as u32 * (width + GAP), GAP + rows * (height + HEAD + GAP));
    png(size, |area| {
        for (k, (name, map)) in maps.iter().enumerate() {
            let (column, row) = ((k % columns) as u32, (k / columns) as u32);
            let (x, y) = (GAP + column * (width + GAP), GAP + row * (height + HEAD + GAP));
            let title = Text::new(*name, (x as i32, y as i32 + 6), ink::letters(ink::TITLE, &INK));
            area.draw(&title).map_err(Failure::internal)?;
            let panel = panel.at(x, y + HEAD);
            panel.fill(area, |cell| ink::occupancy(if seen[cell] { map[cell] } else { prior }, prior))?;
            panel.path(area, path, ROUTE)?;
        }
        Ok(())
    })
}
