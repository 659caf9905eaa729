//! Scene files made from a map or a floor plan.

mod text;

use std::path::{Path, PathBuf};

use grid::ros_map::{self, RosMapError};
use grid::{GridSpec, Raster};
use strict::{ErrorKind, Place};
use thiserror::Error;

use crate::enclosure::{Enclosure, enclosure};
use crate::file::plan::{THICKNESS_M, inside, walls};
use crate::floor_plan::{FloorPlan, FloorPlanError};
use crate::survey::{Progress, Survey, SurveyError, SurveyOptions, Watch, survey_watched};
use crate::{Scene, SceneError, Warning, World, drive, truth};

/// Cells on which the route through a floor plan is planned, m: half of the usual, so that doors lose little.
const PLAN_CELL_M: f64 = 0.025;

/// More cells than this are made larger, in a floor plan.
const MOST_PLAN_CELLS: f64 = 2e7;

/// What is drawn around the floor, so that the walls are there, m.
const RIM_M: f64 = 0.5;

/// Nothing is farther away, m; as in scene files.
const METRES: f64 = 1e6;

/// A scene file in the making.
#[derive(Debug, Clone, PartialEq)]
pub struct MadeScene {
    /// The file, ready to write.
    pub text: String,
    /// Its route and what is seen from it.
    pub survey: Survey,
    /// Scans of the drive.
    pub scans: usize,
    /// Free, occupied and unknown cells of the map, or of the plan as it was surveyed.
    pub cells: [usize; 3],
    /// What the rays of the drive end on.
    pub enclosure: Enclosure,
    /// What is suspicious about map and route, nothing where all is well.
    pub warnings: Vec<Warning>,
}

/// Why there is no scene.
#[derive(Debug, Error)]
pub enum MakeError {
    /// The map cannot be read.
    #[error("{0}")]
    Map(#[from] RosMapError),
    /// The floor plan cannot be read.
    #[error("{0}")]
    Plan(#[from] FloorPlanError),
    /// The map's rows leave the x axis.
    #[error(
        "{place}: origin angle = {yaw_rad}: must be 0, since cells lie along x and y; `convert {} STRAIGHT.yaml --origin {},{},0` keeps its cells and lays its rows along x", map.display(), origin_m[0], origin_m[1]
    )]
    Turned {
        /// Where the angle stands.
        place: Place,
        /// The map's YAML file.
        map: PathBuf,
        /// The angle, rad.
        yaw_rad: f64,
        /// The map's lower-left corner, m.
        origin_m: [f64; 2],
    },
    /// There is no route.
    #[error("{}: {problem}", path.display())]
    Survey {
        /// The map or plan.
        path: PathBuf,
        /// Why.
        problem: SurveyError,
    },
    /// It is too large.
    #[error("{}: reaches more than 1000000 m; correct its resolution", .0.display())]
    Far(PathBuf),
    /// The scene is none that can be driven: too large for the memory, or too long.
    #[error("{0}")]
    Scene(#[from] SceneError),
}

impl MakeError {
    /// What the error comes from.
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Map(RosMapError::Unreadable { source, .. })
            | Self::Plan(FloorPlanError::Unreadable { source, .. }) => ErrorKind::of(source),
            Self::Scene(error) => error.kind(),
            _ => ErrorKind::BadInput,
        }
    }
}

/// Makes a scene of the ROS map at `map`, to be written to `scene`: the map's name in it is relative to there. The scene
/// is checked and driven before it is returned; `progress` is told how far the work is.
///
/// A map that lies more than 1,000,000 m away, as in projected coordinates, gets an origin of its own in the scene.
///
/// # Errors
/// A map that cannot be read, is turned, or in which the robot cannot move.
pub fn from_map(map: &Path, scene: &Path, options: &SurveyOptions, progress: Watch) -> Result<MadeScene, MakeError> {
    let read = ros_map::read(map)?;
    let mut warnings: Vec<Warning> = read.warnings.iter().cloned().map(Warning::Map).collect();
    let place = |of: fn(&ros_map::Places) -> &Place| {
        let whole = Place { file: map.display().to_string(), line: 1, column: 1 };
        read.places.as_ref().map_or(whole, |places| of(places).clone())
    };
    if read.is_turned() {
        let (yaw_rad, origin_m) = (read.yaw_rad, read.spec.origin_m);
        return Err(MakeError::Turned { place: place(|places| &places.yaw), map: map.into(), yaw_rad, origin_m });
    }
    let cells = read.cells();
    let count = |state: Option<bool>| cells.values().iter().filter(|&&cell| cell == state).count();
    let [free, occupied, unknown] = [Some(false), Some(true), None].map(count);
    if occupied == 0 && free > 0 {
        let problem = SurveyError::NoOccupied { cells: cells.spec().cells(), free, unknown };
        return Err(MakeError::Survey { path: map.into(), problem });
    }
    let mut source = Source { path: map, table: "map", cells, crop: true, moved: false };
    let mut options = *options;
    if !too_far(source.cells.spec()) {
        return made(&source, scene, &options, warnings, progress);
    }
    let origin_m = read.spec.origin_m;
    warnings.push(Warning::Far { place: place(|places| &places.origin), origin_m });
    source.move_to_origin();
    options.start_m = options.start_m.map(|at| [at[0] - origin_m[0], at[1] - origin_m[1]]);
    made(&source, scene, &options, warnings, progress).map_err(|error| at_home(error, origin_m))
}

/// The error in the map's own coordinates, in which the start was given.
fn at_home(error: MakeError, [x, y]: [f64; 2]) -> MakeError {
    match error {
        MakeError::Survey { path, problem: SurveyError::Start { x_m, y_m, nearest } } => {
            let nearest = [nearest[0] + x, nearest[1] + y];
            MakeError::Survey { path, problem: SurveyError::Start { x_m: x_m + x, y_m: y_m + y, nearest } }
        }
        other => other,
    }
}

/// Makes a scene of the floor plan at `plan`, to be written to `scene`, as [`from_map`] does.
///
/// # Errors
/// A plan that cannot be read or in which the robot cannot move.
pub fn from_plan(plan: &Path, scene: &Path, options: &SurveyOptions, progress: Watch) -> Result<MadeScene, MakeError> {
    progress(Progress { step: "reading the plan", done: 0, of: 1 });
    let read = FloorPlan::load(plan)?;
    let warnings = read.warning(plan).into_iter().collect();
    let source = Source { path: plan, table: "plan", cells: plan_cells(&read), crop: false, moved: false };
    made(&source, scene, options, warnings, progress)
}

/// What a scene is made from.
struct Source<'a> {
    path: &'a Path,
    /// The table of the scene file that names it.
    table: &'a str,
    cells: Raster<Option<bool>>,
    /// Whether the scene holds the part around the floor alone.
    crop: bool,
    /// Whether its lower-left corner was moved to the origin.
    moved: bool,
}

impl Source<'_> {
    fn move_to_origin(&mut self) {
        let spec = GridSpec { origin_m: [0.0; 2], ..*self.cells.spec() };
        self.cells = Raster::new(spec, self.cells.values().to_vec());
        self.moved = true;
    }
}

fn too_far(spec: &GridSpec) -> bool {
    let corners = [spec.corner(0), spec.corner(spec.cells() - 1)];
    corners.iter().flatten().any(|v| v.abs() > METRES - 2.0 * spec.cell_m)
}

fn made(
    source: &Source,
    scene: &Path,
    options: &SurveyOptions,
    mut warnings: Vec<Warning>,
    progress: Watch,
) -> Result<MadeScene, MakeError> {
    let spec = source.cells.spec();
    if too_far(spec) {
        return Err(MakeError::Far(source.path.into()));
    }
    let none = |problem| MakeError::Survey { path: source.path.into(), problem };
    let survey = survey_watched(&source.cells, options, progress).map_err(none)?;
    let count = |state: Option<bool>| source.cells.values().iter().filter(|&&cell| cell == state).count();
    let cells = [Some(false), Some(true), None].map(count);
    let bounds_m = if source.crop { around_floor(spec, &survey.floor) } else { None };
    let place = text::Origin { source: source.path, table: source.table, moved: source.moved, bounds_m };
    let text = text::written(&place, scene, &survey, options);
    progress(Progress { step: "driving", done: 0, of: 1 });
    let checked = Scene::parse(&text, scene, None)?;
    let drive = drive(&checked)?;
    let enclosure = enclosure(&checked, &World::new(&checked), &drive);
    warnings.extend(enclosure.warning(source.path));
    Ok(MadeScene { text, survey, scans: drive.poses.len(), cells, enclosure, warnings })
}

/// The plan in cells: occupied where a wall covers any part, free inside, unknown outside.
fn plan_cells(plan: &FloorPlan) -> Raster<Option<bool>> {
    let [min, max] = plan.extent_m().map(|corner| corner);
    let (min, max) = (min.map(|v| v - THICKNESS_M), max.map(|v| v + THICKNESS_M));
    let area = (max[0] - min[0]) * (max[1] - min[1]);
    let cell_m = PLAN_CELL_M.max((area / MOST_PLAN_CELLS).sqrt());
    let size = [0, 1].map(|k| ((max[k] - min[k]) / cell_m).ceil().max(1.0) as usize);
    let spec = GridSpec { cell_m, origin_m: min, width: size[0], height: size[1] };
    let mut cells = inside(&plan.outline_m, &spec).map(|&inside| inside.then_some(false));
    for wall in walls(plan, THICKNESS_M) {
        truth::occupy(&mut cells, &wall);
    }
    cells
}

/// The smallest rectangle of cells with the floor and its walls, m; nothing if that is the whole map.
fn around_floor(spec: &GridSpec, floor: &Raster<bool>) -> Option<[[f64; 2]; 2]> {
    let rim = (RIM_M / spec.cell_m).ceil() as usize;
    let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
    for cell in (0..spec.cells()).filter(|&cell| floor[cell]) {
        let at = <[usize; 2]>::from(spec.column_row(cell));
        for k in 0..2 {
            (low[k], high[k]) = (low[k].min(at[k]), high[k].max(at[k] + 1));
        }
    }
    let size = [spec.width, spec.height];
    let (low, high) = (low.map(|v| v.saturating_sub(rim)), [0, 1].map(|k| (high[k] + rim).min(size[k])));
    let corner = |at: [usize; 2]| [0, 1].map(|k| spec.origin_m[k] + at[k] as f64 * spec.cell_m);
    (low != [0; 2] || high != size).then(|| [corner(low), corner(high)])
}

#[cfg(test)]
mod tests;
