//! The named regions from close by, cell by cell.

use super::maps::sheet;
use super::panel::Panel;
use crate::failure::Failure;
use crate::worlds::run::Stage;
use crate::worlds::run::{Ground, Trial};

/// What the picture shows.
pub const CAPTION: &str = "The first named region from close by, cell by cell: does free space seen from near survive doubtful \
    readings from afar?";

/// Space around the region, m.
const AROUND_M: f64 = 0.6;

const WIDTH: usize = 440;

/// Draws the surroundings of the scene's first region in every map of one trial.
///
/// # Errors
/// A drawing that fails.
pub fn draw(ground: &Ground, trial: &Trial, stages: &[Stage]) -> Result<Vec<u8>, Failure> {
    let [min, max] = ground.scene.regions[0].area.extent_m();
    let around = [min.map(|v| v - AROUND_M), max.map(|v| v + AROUND_M)];
    sheet(ground, trial, stages, Panel::around(ground.scene.grid, around, WIDTH))
}
