//! The maps of a log, side by side.

use grid::Raster;

use crate::figures::drawing::Anchor;
use crate::figures::ink::{self, INK, LABEL, ROUTE};
use crate::figures::key::{self, Sign};
use crate::figures::panel::Panel;
use crate::figures::{Drawing, Paper};

/// What the picture shows.
pub(super) const CAPTION: &str =
    "Maps from the same scans. White is free, black occupied, grey never seen; blue is where the sensor went.";

const GAP: f64 = 14.0;
const HEAD: f64 = 34.0;

/// Width of a picture of one map or of wide ones, and of one with two in a row.
const WIDTHS: [f64; 2] = [1428.0, 1842.0];

/// Draws maps by name, two in a row unless they are wide, with the path of the sensor (m) and the key.
pub(super) fn draw(
    maps: &[(&str, &Raster<f64>)],
    seen: &Raster<bool>,
    prior: f64,
    path: &[[f64; 2]],
    paper: &Paper,
) -> Drawing {
    let Some((_, first)) = maps.first() else { return Drawing::new(1.0, 1.0) };
    let spec = *first.spec();
    let columns = if maps.len() > 1 && spec.width < 2 * spec.height { 2 } else { 1 };
    let room = (paper.width(WIDTHS[columns - 1]) - GAP) / columns as f64 - GAP;
    let panel = Panel::whole(spec, room, paper);
    let (width, height) = panel.size();
    let rows = maps.len().div_ceil(columns) as f64;
    let foot = GAP + rows * (height + HEAD + GAP);
    let mut drawing = Drawing::new(GAP + columns as f64 * (width + GAP), foot + key::HEIGHT);
    for (k, (name, map)) in maps.iter().enumerate() {
        let (column, row) = ((k % columns) as f64, (k / columns) as f64);
        let (x, y) = (GAP + column * (width + GAP), GAP + row * (height + HEAD + GAP));
        drawing.text(name, (x, y + 0.5 * HEAD), LABEL, INK, Anchor::Start);
        let panel = panel.at(x, y + HEAD);
        panel.fill(&mut drawing, |cell| ink::occupancy(if seen[cell] { map[cell] } else { prior }, prior));
        panel.path(&mut drawing, path, ROUTE);
    }
    let whole = drawing.width - 2.0 * GAP;
    key::draw(&mut drawing, (GAP, foot + GAP), whole, &panel, prior, &[Sign::Route]);
    drawing
}
