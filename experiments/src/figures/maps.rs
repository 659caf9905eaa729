//! The maps of every mapper at every stage beside the truth: the paper's Figures 13 and 14.

use plotters::prelude::*;

use super::ink::{self, INK};
use super::panel::Panel;
use super::{Area, png};
use crate::failure::Failure;
use crate::worlds::run::{Ground, Stage, Trial};

/// What the picture shows.
pub const CAPTION: &str = "Maps from the same readings (compare Figures 13 and 14): a row per mapper, a column per stage, the truth on \
    the left. White is free, black occupied, grey never seen; orange marks regions, blue the robot.";

const WIDTH: usize = 440;
const GAP: u32 = 14;
const HEAD: u32 = 34;

/// Draws the maps of one trial.
///
/// # Errors
/// A drawing that fails.
pub fn draw(ground: &Ground, trial: &Trial, stages: &[Stage]) -> Result<Vec<u8>, Failure> {
    let panel = Panel::whole(ground.scene.grid, WIDTH);
    sheet(ground, trial, stages, panel)
}

/// A table of panels: a row per mapper; the truth and every stage as columns.
pub(super) fn sheet(ground: &Ground, trial: &Trial, stages: &[Stage], panel: Panel) -> Result<Vec<u8>, Failure> {
    let (width, height) = panel.size();
    let columns = 1 + stages.len() as u32;
    let rows = trial.runs.len() as u32;
    let size = (GAP + columns * (width + GAP), GAP + rows * (height + HEAD + GAP));
    png(size, |area| {
        for (row, run) in trial.runs.iter().enumerate() {
            let y = GAP + row as u32 * (height + HEAD + GAP);
            let place = |column: usize| (GAP + column as u32 * (width + GAP), y);
            let truth = panel.at(place(0).0, y + HEAD);
            title(area, place(0), width, "truth")?;
            truth.fill(area, |cell| ink::truth(ground.truth[cell]))?;
            regions(area, ground, &truth)?;
            for (column, stage) in stages.iter().enumerate() {
                let at = place(column + 1);
                title(area, at, width, &format!("{} ({}) {}", run.mapper, stage.name, stage.label))?;
                map(area, ground, trial, (row, column), stage, &panel.at(at.0, y + HEAD))?;
            }
        }
        Ok(())
    })
}

/// A title, cut where the next panel begins.
fn title(area: &Area, (x, y): (u32, u32), width: u32, text: &str) -> Result<(), Failure> {
    let style = ink::letters(ink::TITLE, &INK);
    let fits = |text: &str| style.font.box_size(text).map_or(true, |(needed, _)| needed <= width);
    let mut shown = text.to_owned();
    while !fits(&shown) && shown.chars().count() > 2 {
        shown.truncate(shown.trim_end_matches('…').char_indices().next_back().map_or(0, |(last, _)| last));
        shown.push('…');
    }
    area.draw(&Text::new(shown, (x as i32, y as i32 + 6), style)).map_err(Failure::internal)
}

/// The map of a mapper (`row`) at a stage (`column`); grey where no ray has been.
fn map(
    area: &Area,
    ground: &Ground,
    trial: &Trial,
    (row, column): (usize, usize),
    stage: &Stage,
    panel: &Panel,
) -> Result<(), Failure> {
    let (occupancy, reached) = (&trial.runs[row].stages[column].occupancy, &trial.reached[column]);
    let shown = |cell: usize| if reached[cell] { occupancy[cell] } else { ground.prior };
    panel.fill(area, |cell| ink::occupancy(shown(cell), ground.prior))?;
    regions(area, ground, panel)?;
    match ground.drive.poses.get(stage.scans.wrapping_sub(1)) {
        Some(timed) if panel.holds(timed.pose.position_m()) => {
            panel.robot(area, &timed.pose, ground.scene.robot.radius_m, ink::ROUTE)
        }
        _ => Ok(()),
    }
}

fn regions(area: &Area, ground: &Ground, panel: &Panel) -> Result<(), Failure> {
    let mut inside = ground.scene.regions.iter().filter(|region| panel.shows(region));
    inside.try_for_each(|region| panel.outline(area, region, true))
}
