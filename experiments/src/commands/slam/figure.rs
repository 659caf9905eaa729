//! The map, with where the robot went.

use grid::Raster;

use crate::figures::drawing::Anchor;
use crate::figures::ink::{self, FAINT, INK, LABEL, LINES, ROUTE};
use crate::figures::key::{self, Sign};
use crate::figures::panel::Panel;
use crate::figures::{Drawing, Paper};

const GAP: f64 = 14.0;
const HEAD: f64 = 34.0;
const WIDTH: f64 = 1428.0;

/// What the picture shows.
pub(super) const CAPTION: &str =
    "The map at the end, with the way that was found, the odometry, and the true way where it is known.";

/// Ways in the map's frame, m.
pub(super) struct Ways<'a> {
    pub(super) found: &'a [[f64; 2]],
    pub(super) odometry: &'a [[f64; 2]],
    pub(super) truth: &'a [[f64; 2]],
}

/// Draws the map with the ways and the key.
pub(super) fn draw(map: &Raster<f64>, seen: &Raster<bool>, prior: f64, ways: &Ways, paper: &Paper) -> Drawing {
    let room = paper.width(WIDTH) - 2.0 * GAP;
    let panel = Panel::whole(*map.spec(), room, paper);
    let (_, height) = panel.size();
    let mut drawing = Drawing::new(room + 2.0 * GAP, HEAD + 2.0 * GAP + height + key::HEIGHT);
    let names = [("odometry", FAINT, ways.odometry), ("truth", LINES[3], ways.truth), ("slam", ROUTE, ways.found)];
    let mut x = GAP;
    for (name, colour, _) in names.iter().filter(|(_, _, way)| !way.is_empty()) {
        drawing.line([(x, 0.5 * HEAD), (x + 30.0, 0.5 * HEAD)], colour.stroke(4.0));
        drawing.text(name, (x + 38.0, 0.5 * HEAD), LABEL, INK, Anchor::Start);
        x += 190.0;
    }
    let panel = panel.at(GAP, HEAD);
    panel.fill(&mut drawing, |cell| ink::occupancy(if seen[cell] { map[cell] } else { prior }, prior));
    for (_, colour, way) in names {
        // The odometry may lead away from the map.
        way.chunk_by(|a, b| panel.holds(*a) && panel.holds(*b))
            .filter(|part| part.len() > 1)
            .for_each(|part| panel.path(&mut drawing, part, colour));
    }
    let whole = drawing.width - 2.0 * GAP;
    key::draw(&mut drawing, (GAP, HEAD + height + 2.0 * GAP), whole, &panel, prior, &[Sign::Route]);
    drawing
}
