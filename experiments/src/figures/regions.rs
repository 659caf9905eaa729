//! The named regions from close by, cell by cell.

use super::drawing::Drawing;
use super::maps::{panel_width, sheet};
use super::panel::Panel;
use super::paper::Paper;
use crate::worlds::ground::Ground;
use crate::worlds::run::{Stage, Trial};

/// What the picture shows.
pub const CAPTION: &str = "The first named region from close by, cell by cell: does free space seen from near survive doubtful \
    readings from afar?";

/// Space around the region, m.
const AROUND_M: f64 = 0.6;

/// Draws the surroundings of the scene's first region in every map of one trial.
pub fn draw(ground: &Ground, trial: &Trial, stages: &[Stage], paper: &Paper) -> Drawing {
    let [min, max] = ground.scene.regions[0].area.extent_m();
    let around = [min.map(|v| v - AROUND_M), max.map(|v| v + AROUND_M)];
    let width = 0.75 * panel_width(stages.len(), paper);
    sheet(ground, trial, stages, Panel::around(ground.scene.grid, around, width, paper))
}
