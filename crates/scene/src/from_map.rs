//! Scene files made from a map or a floor plan.

mod text;

use std::path::{Path, PathBuf};

use grid::ros_map::{self, RosMapError};
use grid::{GridSpec, Raster};
use thiserror::Error;

use crate::file::plan::{THICKNESS_M, inside, walls};
use crate::survey::{Survey, SurveyError, SurveyOptions, survey};
use crate::{ErrorKind, FloorPlan, FloorPlanError, Scene, SceneError, drive, truth};

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
    /// There is no route.
    #[error("{}: {problem}", path.display())]
    Survey {
        /// The map or plan.
        path: PathBuf,
        /// Why.
        problem: SurveyError,
    },
    /// It lies too far away.
    #[error("{}: must lie within 1000000 m of the origin; correct its origin and resolution", .0.display())]
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
/// is checked and driven before it is returned.
///
/// # Errors
/// A map that cannot be read or in which the robot cannot move.
pub fn from_map(map: &Path, scene: &Path, options: &SurveyOptions) -> Result<MadeScene, MakeError> {
    let cells = ros_map::read(map)?.cells();
    made(map, scene, options, &cells, "map", Some(cells.spec()))
}

/// Makes a scene of the floor plan at `plan`, to be written to `scene`, as [`from_map`] does.
///
/// # Errors
/// A plan that cannot be read or in which the robot cannot move.
pub fn from_plan(plan: &Path, scene: &Path, options: &SurveyOptions) -> Result<MadeScene, MakeError> {
    let cells = plan_cells(&FloorPlan::load(plan)?);
    made(plan, scene, options, &cells, "plan", None)
}

fn made(
    source: &Path,
    scene: &Path,
    options: &SurveyOptions,
    cells: &Raster<Option<bool>>,
    table: &str,
    crop: Option<&GridSpec>,
) -> Result<MadeScene, MakeError> {
    let spec = cells.spec();
    let corners = [spec.corner(0), spec.corner(spec.cells() - 1)];
    if corners.iter().flatten().any(|v| v.abs() > METRES - 2.0 * spec.cell_m) {
        return Err(MakeError::Far(source.into()));
    }
    let survey = survey(cells, options).map_err(|problem| MakeError::Survey { path: source.into(), problem })?;
    let bounds_m = crop.and_then(|spec| around_floor(spec, &survey.floor));
    let text = text::written(source, scene, table, bounds_m, &survey, options);
    let checked = Scene::parse(&text, scene, None)?;
    let scans = drive(&checked)?.poses.len();
    Ok(MadeScene { text, survey, scans })
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
    for wall in walls(&plan.outline_m, THICKNESS_M) {
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
