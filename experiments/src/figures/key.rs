//! What the shades and signs of maps mean, and how long a metre is.

use super::axis;
use super::drawing::{Anchor, Drawing, Point};
use super::ink::{self, Colour, FAINT, INK, REGION, ROUTE, SMALL, THING, UNKNOWN};
use super::letters;
use super::panel::Panel;

/// How high a key is: the scale of shades, and signs below it.
pub const HEIGHT: f64 = 200.0;

/// A sign that a picture has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    Region,
    Robot,
    Thing,
    Route,
    UnknownTruth,
}

impl Sign {
    fn name(self) -> &'static str {
        match self {
            Self::Region => "named region",
            Self::Robot => "robot, and where it looks",
            Self::Thing => "what moves",
            Self::Route => "path of the sensor",
            Self::UnknownTruth => "truth not known",
        }
    }

    fn draw(self, drawing: &mut Drawing, (x, y): Point) {
        match self {
            Self::Region => {
                let at = |k: i32| {
                    let (sin, cos) = libm::sincos(f64::from(k) * std::f64::consts::TAU / 32.0);
                    (x + 9.0 * cos, y + 9.0 * sin)
                };
                drawing.line((0..=32).map(at), REGION.stroke(2.5));
            }
            Self::Robot => {
                drawing.disc((x - 2.0, y), 7.0, ROUTE);
                drawing.line([(x, y), (x + 13.0, y)], ROUTE.stroke(2.5));
            }
            Self::Thing => drawing.frame((x - 9.0, y - 7.0), (x + 9.0, y + 7.0), THING.stroke(2.5)),
            Self::Route => drawing.line([(x - 11.0, y), (x + 11.0, y)], ROUTE.stroke(3.0)),
            Self::UnknownTruth => {
                drawing.block((x - 10.0, y - 8.0), (x + 10.0, y + 8.0), UNKNOWN);
                drawing.frame((x - 10.0, y - 8.0), (x + 10.0, y + 8.0), FAINT.stroke(1.0));
            }
        }
    }
}

/// Draws the key of maps in a rectangle `width` wide: the scale of shades, a scale bar of the panel, and the signs.
pub fn draw(drawing: &mut Drawing, (x, y): Point, width: f64, panel: &Panel, prior: f64, signs: &[Sign]) {
    shades(drawing, (x, y), width.min(420.0), prior);
    let below = y + 116.0;
    let long = scale_bar(drawing, (x, below), panel, width);
    let mut at = (x + long + 30.0, below - 2.0);
    for sign in signs {
        let wide = 34.0 + letters::width(sign.name(), SMALL) + 26.0;
        if at.0 + wide > x + width + 26.0 {
            at = (x, at.1 + 34.0);
        }
        sign.draw(drawing, (at.0 + 13.0, at.1));
        drawing.text(sign.name(), (at.0 + 34.0, at.1), SMALL, INK, Anchor::Start);
        at.0 += wide;
    }
}

/// The shades of occupancies, evenly by log odds as in maps.
fn shades(drawing: &mut Drawing, (x, y): Point, width: f64, prior: f64) {
    const HIGH: f64 = 20.0;
    const ENDS: f64 = 4.6;
    let title = letters::cut("probability that a cell is occupied", SMALL, width);
    drawing.text(&title, (x, y + 10.0), SMALL, INK, Anchor::Start);
    let top = y + 26.0;
    let probability = |share: f64| 1.0 / (1.0 + libm::exp(ENDS * (1.0 - 2.0 * share)));
    let steps = 128;
    let colours: Vec<Colour> =
        (0..steps).map(|k| ink::occupancy(probability((k as f64 + 0.5) / steps as f64), prior)).collect();
    drawing.cells((x, top), (width, HIGH), steps, colours);
    drawing.frame((x, top), (x + width, top + HIGH), FAINT.stroke(1.0));
    let odds = |p: f64| libm::log(p / (1.0 - p));
    let place = |p: f64| x + width * (0.5 + 0.5 * (odds(p) / ENDS).clamp(-1.0, 1.0));
    for p in [0.01, 0.1, 0.5, 0.9, 0.99].into_iter().filter(|p| (place(*p) - place(prior)).abs() > 34.0) {
        tick(drawing, place(p), top + HIGH, &axis::short(p), (x, x + width));
    }
    let at = place(prior);
    drawing.line([(at, top - 4.0), (at, top + HIGH)], INK.stroke(1.5));
    tick(drawing, at, top + HIGH, &axis::short(prior), (x, x + width));
    drawing.text("never seen", (at, top + HIGH + 36.0), SMALL, FAINT, Anchor::Middle);
}

fn tick(drawing: &mut Drawing, at: f64, below: f64, label: &str, (from, to): (f64, f64)) {
    drawing.line([(at, below), (at, below + 5.0)], FAINT.stroke(1.5));
    let half = 0.5 * letters::width(label, SMALL);
    drawing.text(label, (at.clamp(from + half, to - half), below + 16.0), SMALL, INK, Anchor::Middle);
}

/// A bar of a round length, at most a third of the panel or of the room for it; gives its length with its label's.
pub fn scale_bar(drawing: &mut Drawing, (x, y): Point, panel: &Panel, room: f64) -> f64 {
    let most = panel.size().0.min(room) / 3.0 / panel.scale();
    let metres = axis::step(most * 0.4);
    let long = metres * panel.scale();
    let line = INK.stroke(2.0);
    drawing.line([(x, y), (x + long, y)], line);
    for end in [x, x + long] {
        drawing.line([(end, y - 5.0), (end, y + 5.0)], line);
    }
    let label = format!("{} m", axis::short(metres));
    drawing.text(&label, (x + long + 10.0, y), SMALL, INK, Anchor::Start);
    long + 10.0 + letters::width(&label, SMALL)
}
