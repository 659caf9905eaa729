//! From a scene file to a [`Scene`]: the one door at which everything is checked.

mod beside;
mod bounds;
pub(crate) mod camera;
mod cells;
mod chairs;
mod doors;
pub(crate) mod edit;
mod family;
mod findings;
mod fit;
mod late;
pub mod limits;
mod map;
mod movers;
mod obstacles;
mod odometry;
pub(crate) mod plan;
mod points;
mod polygon;
mod regions;
mod room_to_move;
mod route;
pub(crate) mod sensors;

use std::path::Path;

use grid::{GridSpec, Raster};
use strict::Table;

use self::bounds::Extent;
pub(crate) use self::family::is_family;
use self::findings::Findings;
use crate::{Obstacle, Problem, Scene, SceneError, Warning};

const KEYS: [&str; 22] = [
    "name",
    "description",
    "bounds",
    "grid",
    "wall",
    "box",
    "disc",
    "polygon",
    "map",
    "plan",
    "waypoints",
    "route",
    "stage",
    "region",
    "mover",
    "door",
    "chair",
    "motion_seed",
    "camera",
    "sensor",
    "robot",
    "odometry",
];

impl Scene {
    /// Reads and checks the scene file at `path`. `cell_m` replaces the file's cell size (m).
    ///
    /// # Errors
    /// A file that cannot be read, and the first problem with its content.
    pub fn load(path: &Path, cell_m: Option<f64>) -> Result<Self, SceneError> {
        Self::parse(&strict::read(path)?, path, cell_m)
    }

    /// Checks the scene that `text` describes. `path` is named in messages, and a map is looked
    /// for from its folder; `cell_m` replaces the file's cell size (m).
    ///
    /// # Errors
    /// The first problem with the text.
    pub fn parse(text: &str, path: &Path, cell_m: Option<f64>) -> Result<Self, SceneError> {
        Self::examine(text, path, cell_m).map_err(strict::first)
    }

    /// As [`parse`](Self::parse), for those who would rather mend all of a file at once.
    ///
    /// # Errors
    /// Every problem with the text, at least one; not what would only follow from another.
    pub fn examine(text: &str, path: &Path, cell_m: Option<f64>) -> Result<Self, Vec<SceneError>> {
        let file = path.display().to_string();
        let (source, document) = strict::open(text, &file).map_err(|error| vec![error.into()])?;
        let mut found = Findings::default();
        let scene = checked(&Table::new(&source, "the scene", 0, document.get_ref()), path, cell_m, &mut found);
        found.or(scene)
    }
}

/// Checks a scene file's table.
fn checked(root: &Table, path: &Path, cell_m: Option<f64>, found: &mut Findings) -> Option<Scene> {
    if root.get("generate").is_some() {
        found.add(SceneError::at(root.place_of("generate"), Problem::IsFamily));
        return None;
    }
    found.only(root, &KEYS);
    let name = found.take(root.name("name"));
    let description = found.take(root.text("description")).flatten().unwrap_or_default();
    let ground = ground(root, path, found);
    let bounds = bounds::read(root, ground.extent(), found);
    let grid = cells::read(root, bounds, cell_m, ground.cell_m(), found);
    let within = bounds.unwrap_or(bounds::ENDLESS);
    let (known, warnings) = (grid.as_ref().and_then(|grid| ground.known(grid)), ground.warnings());
    let mut obstacles = bounds.map(|bounds| ground.obstacles(bounds)).unwrap_or_default();
    obstacles.extend(obstacles::read(root, within, found));
    let robot = camera::robot(root, found);
    let waypoints = route::waypoints(root, within, found);
    if let Some(waypoints) = waypoints.as_ref().filter(|_| found.count() == 0) {
        fit::room_for_robot(root, waypoints, &obstacles, &robot, found);
    }
    let stops = route::stops(root, waypoints.as_deref(), found);
    let stages = route::stages(root, waypoints.as_deref(), stops.as_deref(), found);
    let regions = regions::read(root, within, found);
    let movers = movers::read(root, waypoints.as_deref(), found);
    let (doors, chairs) = (doors::read(root, &stages, found), chairs::read(root, &stages, found));
    let motion_seed = found.take(root.optional_whole("motion_seed", &limits::SEED)).flatten().unwrap_or(0);
    let camera = camera::camera(root, found);
    let matcher = camera::matcher(root, found);
    let sensors = sensors::read(root, robot.radius_m, found);
    let odometry = odometry::read(root, found);
    let mut scene = Scene {
        name: name?,
        description,
        layout: None,
        bounds_m: bounds?,
        grid: grid?,
        obstacles,
        known,
        waypoints: waypoints?,
        stops: stops?,
        stages,
        regions,
        movers,
        doors,
        chairs,
        motion_seed,
        camera,
        matcher,
        sensors,
        robot,
        odometry,
        warnings,
    };
    if found.count() == 0 {
        room_to_move::check(root, &scene, found);
        scene.warnings.extend(late::warnings(root, &scene));
    }
    Some(scene)
}

/// What a scene stands on.
enum Ground {
    /// Nothing but its own obstacles.
    Bare,
    /// A map that a robot built.
    Map(Box<map::Map>),
    /// A floor plan.
    Plan(plan::Plan),
    /// A map or plan that cannot be used.
    Refused,
}

/// The map or the plan that a scene names.
fn ground(root: &Table, path: &Path, found: &mut Findings) -> Ground {
    if root.get("map").is_some() && root.get("plan").is_some() {
        found.add(SceneError::at(root.place_of("plan"), Problem::MapAndPlan));
        return Ground::Refused;
    }
    let (map, plan) = (map::read(root, path, found), plan::read(root, path, found));
    match (found.take(map), found.take(plan)) {
        (None, _) | (_, None) => Ground::Refused,
        (Some(Some(map)), _) => Ground::Map(Box::new(map)),
        (_, Some(Some(plan))) => Ground::Plan(plan),
        _ => Ground::Bare,
    }
}

impl Ground {
    fn extent(&self) -> Extent {
        match self {
            Self::Bare => Extent::None,
            Self::Map(map) => Extent::Known(map.extent_m()),
            Self::Plan(plan) => Extent::Known(plan.extent_m()),
            Self::Refused => Extent::Refused,
        }
    }

    /// The cell size where the file gives none, m.
    fn cell_m(&self) -> f64 {
        if let Self::Map(map) = self { map.cell_m() } else { cells::DEFAULT_M }
    }

    fn warnings(&self) -> Vec<Warning> {
        match self {
            Self::Map(map) => map.warnings(),
            Self::Plan(plan) => plan.warnings(),
            Self::Bare | Self::Refused => Vec::new(),
        }
    }

    fn known(&self, grid: &GridSpec) -> Option<Raster<bool>> {
        match self {
            Self::Map(map) => Some(map.known()),
            Self::Plan(plan) => Some(plan.known(grid)),
            Self::Bare | Self::Refused => None,
        }
    }

    fn obstacles(&self, bounds_m: [[f64; 2]; 2]) -> Vec<Obstacle> {
        match self {
            Self::Map(map) => map.obstacles(bounds_m),
            Self::Plan(plan) => plan.obstacles(bounds_m),
            Self::Bare | Self::Refused => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests;
