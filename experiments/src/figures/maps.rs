//! The maps of every mapper at every stage, and the truth: the paper's Figures 13 and 14.

use super::drawing::{Anchor, Drawing};
use super::ink::{self, INK, LABEL};
use super::key::{self, Sign};
use super::letters;
use super::panel::Panel;
use super::paper::Paper;
use crate::worlds::ground::Ground;
use crate::worlds::run::{Stage, Trial};

/// What the picture shows.
pub const CAPTION: &str = "Maps from the same readings (compare Figures 13 and 14): the truth above, then a row per mapper and a \
    column per stage. White is free, black occupied, light grey never seen; orange marks regions, blue the robot, violet what moves.";

/// A panel's width at most, and that of a sheet of panels that are narrower.
pub(super) const PANEL: f64 = 440.0;
const SHEET: f64 = 1400.0;

/// The narrowest panel of a sheet as wide as it likes to be.
const NARROWEST: f64 = 300.0;

const GAP: f64 = 14.0;
const HEAD: f64 = 34.0;

/// Room for the names of mappers, which run upwards.
const SIDE: f64 = 34.0;

/// Draws the maps of one trial.
pub fn draw(ground: &Ground, trial: &Trial, stages: &[Stage], paper: &Paper) -> Drawing {
    let width = panel_width(stages.len(), paper);
    sheet(ground, trial, stages, Panel::whole(ground.scene.grid, width, paper))
}

/// How wide a panel may be on a sheet with so many to a row.
pub(super) fn panel_width(columns: usize, paper: &Paper) -> f64 {
    let columns = columns.max(1) as f64;
    let each = |whole: f64| (whole - SIDE - GAP - columns * GAP) / columns;
    if paper.width_mm.is_some() { each(paper.width(SHEET)).max(60.0) } else { each(SHEET).clamp(NARROWEST, PANEL) }
}

/// A table of panels: the truth with the key, then a row per mapper and a column per stage.
pub(super) fn sheet(ground: &Ground, trial: &Trial, stages: &[Stage], panel: Panel) -> Drawing {
    let (width, height) = panel.size();
    let columns = stages.len().max(1) as f64;
    let whole = SIDE + columns * (width + GAP) + GAP;
    // The key stands beside the truth where there is room, and otherwise below it.
    let beside = whole - (SIDE + width + 4.0 * GAP) - GAP;
    let fits = beside >= 320.0 && height >= key::HEIGHT;
    let first = HEAD + height + if fits { 0.0 } else { GAP + key::HEIGHT };
    let top = first + 2.0 * GAP;
    let row_top = |row: usize| top + HEAD + row as f64 * (height + GAP);
    let mut drawing = Drawing::new(whole, row_top(trial.runs.len()));
    let d = &mut drawing;
    d.text("truth", (SIDE, 0.5 * HEAD), LABEL, INK, Anchor::Start);
    let truth = panel.at(SIDE, HEAD);
    truth.fill(d, |cell| ink::truth(ground.truth[cell]));
    regions(d, ground, &truth);
    things(d, ground, ground.scans(), &truth);
    let (corner, room) = if fits {
        ((SIDE + width + 4.0 * GAP, HEAD + 0.5 * (height - key::HEIGHT)), beside)
    } else {
        ((SIDE, HEAD + height + GAP), whole - SIDE - GAP)
    };
    key::draw(d, corner, room, &panel, ground.prior, &signs(ground));
    for (column, stage) in stages.iter().enumerate() {
        let x = SIDE + column as f64 * (width + GAP);
        let title = letters::cut(&format!("({}) {}", stage.name, stage.label), LABEL, width);
        d.text(&title, (x, top + 0.5 * HEAD), LABEL, INK, Anchor::Start);
        for (row, run) in trial.runs.iter().enumerate() {
            let y = row_top(row);
            if column == 0 {
                let name = letters::cut(run.mapper, LABEL, height);
                d.upward_text(&name, (0.5 * SIDE - 2.0, y + 0.5 * height), LABEL, INK);
            }
            map(d, ground, trial, (row, column), stage, &panel.at(x, y));
        }
    }
    drawing
}

fn signs(ground: &Ground) -> Vec<Sign> {
    let regions = (!ground.scene.regions.is_empty()).then_some(Sign::Region);
    let unknown = ground.truth.values().iter().any(Option::is_none).then_some(Sign::UnknownTruth);
    let things = ground.moves().then_some(Sign::Thing);
    [regions, Some(Sign::Robot), things, unknown].into_iter().flatten().collect()
}

/// The map of a mapper (`row`) at a stage (`column`); grey where no ray has been.
fn map(
    drawing: &mut Drawing,
    ground: &Ground,
    trial: &Trial,
    (row, column): (usize, usize),
    stage: &Stage,
    panel: &Panel,
) {
    let (occupancy, reached) = (&trial.runs[row].stages[column].occupancy, &trial.reached[column]);
    let shown = |cell: usize| if reached[cell] { occupancy[cell] } else { ground.prior };
    panel.fill(drawing, |cell| ink::occupancy(shown(cell), ground.prior));
    regions(drawing, ground, panel);
    things(drawing, ground, stage.scans, panel);
    let here = ground.drive.poses.get(stage.scans.wrapping_sub(1));
    if let Some(timed) = here.filter(|timed| panel.holds(timed.pose.position_m())) {
        panel.robot(drawing, &timed.pose, ground.scene.robot.radius_m, ink::ROUTE);
    }
}

/// What moves, as it stood at the last of so many scans.
fn things(drawing: &mut Drawing, ground: &Ground, scans: usize, panel: &Panel) {
    if let Some(scan) = scans.checked_sub(1).filter(|_| ground.moves()) {
        panel.things(drawing, ground.drive.motion.shapes_at(scan).map(|(_, shape)| shape));
    }
}

fn regions(drawing: &mut Drawing, ground: &Ground, panel: &Panel) {
    let inside = ground.scene.regions.iter().filter(|region| panel.shows(region));
    inside.for_each(|region| panel.outline(drawing, region));
}
