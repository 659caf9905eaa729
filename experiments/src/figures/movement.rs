//! The regions of a world that moves, at the end of every stage.

use score::MovingRegion;

use super::drawing::{Anchor, Drawing, Point};
use super::ink::{Colour, FAINT, INK, LABEL, ROUTE, SMALL, THING, UNKNOWN};
use super::key;
use super::letters;
use super::maps::panel_width;
use super::panel::Panel;
use super::paper::Paper;
use crate::worlds::ground::Ground;
use crate::worlds::run::{Stage, Trial};

/// What the picture shows.
pub const CAPTION: &str = "What maps of a world that moves are judged by, a panel per stage: where nothing that moves has been (white, and walls black), what was covered \
    and is free now, what is covered now; darker where looks have found a change. The rest no look has found as it is now.";

const GAP: f64 = 14.0;
const HEAD: f64 = 34.0;
const ROW: f64 = 34.0;

/// What was covered and is free now.
const SWEPT: Colour = Colour(144, 202, 249);

/// Draws the regions of one trial, a panel per stage; nothing but the legend of a world at rest.
pub fn draw(ground: &Ground, trial: &Trial, stages: &[Stage], paper: &Paper) -> Drawing {
    let panel = Panel::whole(ground.scene.grid, panel_width(stages.len(), paper), paper);
    let (width, height) = panel.size();
    let whole = GAP + stages.len().max(1) as f64 * (width + GAP);
    let entries = places(whole - 2.0 * GAP);
    let rows = entries.last().map_or(0.0, |(_, (_, y))| y + ROW);
    let below = HEAD + height + GAP;
    let mut drawing = Drawing::new(whole, below + ROW + rows + GAP);
    for (column, (stage, regions)) in stages.iter().zip(&trial.moving).enumerate() {
        let x = GAP + column as f64 * (width + GAP);
        let title = letters::cut(&format!("({}) {}", stage.name, stage.label), LABEL, width);
        drawing.text(&title, (x, 0.5 * HEAD), LABEL, INK, Anchor::Start);
        let panel = panel.at(x, HEAD);
        panel.fill(&mut drawing, |cell| colour(regions[cell], ground.still()[cell] == Some(true)));
        let here = ground.drive.poses.get(stage.scans.wrapping_sub(1));
        if let Some(timed) = here.filter(|timed| panel.holds(timed.pose.position_m())) {
            panel.robot(&mut drawing, &timed.pose, ground.scene.robot.radius_m, ROUTE);
        }
    }
    key::scale_bar(&mut drawing, (GAP, below + 0.5 * ROW), &panel, whole - 2.0 * GAP);
    for ((name, colour), (x, y)) in entries {
        let (x, y) = (GAP + x, below + ROW + y + 0.5 * ROW);
        drawing.block((x, y - 8.0), (x + 20.0, y + 8.0), colour);
        drawing.frame((x, y - 8.0), (x + 20.0, y + 8.0), FAINT.stroke(1.0));
        drawing.text(name, (x + 28.0, y), SMALL, INK, Anchor::Start);
    }
    drawing
}

/// What a cell of these regions looks like.
fn colour(bits: u8, wall: bool) -> Colour {
    let has =
        |region: MovingRegion| MovingRegion::ALL.iter().position(|r| *r == region).is_some_and(|k| bits >> k & 1 == 1);
    let plain = if has(MovingRegion::OccupiedNow) {
        THING.towards(Colour::WHITE, 0.45)
    } else if has(MovingRegion::Swept) {
        SWEPT
    } else if has(MovingRegion::Static) {
        return if wall { Colour::BLACK } else { Colour::WHITE };
    } else {
        return UNKNOWN;
    };
    if has(MovingRegion::Changed) { plain.towards(Colour::BLACK, 0.45) } else { plain }
}

/// The entries of the legend with their colours, and where they stand in so much room.
fn places(room: f64) -> Vec<((&'static str, Colour), Point)> {
    let bit = |regions: &[MovingRegion]| -> u8 {
        let place = |region: &MovingRegion| MovingRegion::ALL.iter().position(|r| r == region).unwrap_or(0);
        regions.iter().map(|region| 1 << place(region)).sum()
    };
    let entries = [
        ("static, free", colour(bit(&[MovingRegion::Static]), false)),
        ("static, a wall", colour(bit(&[MovingRegion::Static]), true)),
        ("swept", colour(bit(&[MovingRegion::Swept]), false)),
        ("swept, changed", colour(bit(&[MovingRegion::Swept, MovingRegion::Changed]), false)),
        ("occupied now", colour(bit(&[MovingRegion::OccupiedNow]), false)),
        ("occupied now, changed", colour(bit(&[MovingRegion::OccupiedNow, MovingRegion::Changed]), false)),
        ("not found as it is now", colour(0, false)),
    ];
    let mut at = (0.0, 0.0);
    let place = |(name, colour): (&'static str, Colour)| {
        let wide = 28.0 + letters::width(name, SMALL) + 26.0;
        if at.0 > 0.0 && at.0 + wide > room + 26.0 {
            at = (0.0, at.1 + ROW);
        }
        let here = at;
        at.0 += wide;
        ((name, colour), here)
    };
    entries.map(place).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_regions_look_alike() {
        let entries = places(1000.0);
        for (k, ((name, one), _)) in entries.iter().enumerate() {
            for ((other, two), _) in &entries[k + 1..] {
                assert!(one.off(*two) > 1200, "{name} and {other}");
            }
        }
        let (wide, narrow) = (places(2000.0), places(200.0));
        assert!(wide.iter().all(|(_, (_, y))| y.abs() < 1e-9) && narrow.last().is_some_and(|(_, (_, y))| *y > ROW));
    }
}
