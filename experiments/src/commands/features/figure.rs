//! Landmarks with their ellipses, and the ways.

use score::trajectory;
use sensor::Pose;

use super::scores::placed;
use super::source::Recording;
use super::track::Found;
use crate::figures::drawing::Anchor;
use crate::figures::ink::{self, Colour, FAINT, INK, LABEL, LINES, REGION, ROUTE};
use crate::figures::key;
use crate::figures::panel::Panel;
use crate::figures::{Drawing, Paper};

const GAP: f64 = 14.0;
const HEAD: f64 = 34.0;
const FOOT: f64 = 40.0;
const WIDTH: f64 = 1428.0;

/// Ellipses hold a landmark with this probability: `e' P^-1 e` up to the chi-squared quantile of two degrees of freedom.
const SQUARE: f64 = 5.991;

/// Draws everything in the frame of the source.
pub(super) fn draw(recording: &Recording, found: &Found, name: &str, paper: &Paper) -> Drawing {
    let landmarks: Vec<_> = found
        .landmarks
        .iter()
        .map(|landmark| placed(landmark, &recording.camera, trajectory::Pose::default()))
        .collect();
    let way = |of: &dyn Fn(usize) -> Option<Pose>| -> Vec<[f64; 2]> {
        (0..recording.scans.len()).filter_map(|scan| of(scan).map(|pose| pose.position_m())).collect()
    };
    let ways = [
        ("odometry", FAINT, way(&|scan| recording.scans[scan].odometry)),
        ("truth", LINES[3], way(&|scan| recording.scans[scan].pose)),
        (name, ROUTE, way(&|scan| found.way.get(scan).copied())),
    ];
    let shown: Vec<[f64; 2]> =
        found.way.iter().map(|pose| pose.position_m()).chain(landmarks.iter().map(|l| l.at_m)).collect();
    let spec = recording.grid(&shown);
    let room = paper.width(WIDTH) - 2.0 * GAP;
    let panel = Panel::whole(spec, room, paper).at(GAP, HEAD);
    let (width, height) = panel.size();
    let mut drawing = Drawing::new(room + 2.0 * GAP, HEAD + height + FOOT + GAP);
    let truth = |cell: usize| recording.ground.as_ref().and_then(|ground| ground[cell]);
    panel.fill(&mut drawing, |cell| match truth(cell) {
        Some(true) => Colour::BLACK.towards(Colour::WHITE, 0.6),
        Some(false) => Colour::WHITE,
        None if recording.ground.is_none() => Colour::WHITE,
        None => ink::truth(None),
    });
    for feature in recording.features_m.iter().flatten().filter(|at| panel.holds(**at)) {
        let (x, y) = panel.place(*feature);
        drawing.line([(x - 5.0, y), (x + 5.0, y)], INK.stroke(1.5));
        drawing.line([(x, y - 5.0), (x, y + 5.0)], INK.stroke(1.5));
    }
    for (_, colour, way) in &ways {
        // Odometry may lead away from what is shown.
        way.chunk_by(|a, b| panel.holds(*a) && panel.holds(*b))
            .filter(|part| part.len() > 1)
            .for_each(|part| panel.path(&mut drawing, part, *colour));
    }
    for landmark in landmarks.iter().filter(|landmark| panel.holds(landmark.at_m)) {
        drawing.disc(panel.place(landmark.at_m), 3.5, REGION);
        let outline = ellipse(landmark.at_m, landmark.covariance);
        outline
            .chunk_by(|a, b| panel.holds(*a) && panel.holds(*b))
            .filter(|part| part.len() > 1)
            .for_each(|part| drawing.line(part.iter().map(|at| panel.place(*at)), REGION.stroke(1.5)));
    }
    let mut x = GAP;
    let mut entry = |drawing: &mut Drawing, text: &str, colour: Colour| {
        drawing.line([(x, 0.5 * HEAD), (x + 30.0, 0.5 * HEAD)], colour.stroke(4.0));
        drawing.text(text, (x + 38.0, 0.5 * HEAD), LABEL, INK, Anchor::Start);
        x += 70.0 + crate::figures::letters::width(text, LABEL);
    };
    for (text, colour, way) in &ways {
        if !way.is_empty() {
            entry(&mut drawing, text, *colour);
        }
    }
    entry(&mut drawing, "landmarks, 95 %", REGION);
    key::scale_bar(&mut drawing, (GAP, HEAD + height + 0.5 * FOOT), &panel, width);
    drawing
}

/// Points on the ellipse of probability 0.95, closed.
fn ellipse(at_m: [f64; 2], p: [[f64; 2]; 2]) -> Vec<[f64; 2]> {
    // The Cholesky factor takes the circle to it.
    let a = libm::sqrt(p[0][0]);
    let b = p[0][1] / a;
    let c = libm::sqrt((p[1][1] - b * b).max(0.0));
    let radius = libm::sqrt(SQUARE);
    let point = |k: usize| {
        let (sin, cos) = libm::sincos(k as f64 * std::f64::consts::TAU / 48.0);
        [at_m[0] + radius * a * cos, at_m[1] + radius * (b * cos + c * sin)]
    };
    (0..=48).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ellipse_has_one_mahalanobis_distance() {
        let p = [[0.09, 0.02], [0.02, 0.04]];
        let determinant = p[0][0] * p[1][1] - p[0][1] * p[1][0];
        for at in ellipse([1.0, 2.0], p) {
            let e = [at[0] - 1.0, at[1] - 2.0];
            let square = (p[1][1] * e[0] * e[0] - 2.0 * p[0][1] * e[0] * e[1] + p[0][0] * e[1] * e[1]) / determinant;
            assert!((square - SQUARE).abs() < 1e-9, "{square}");
        }
    }
}
