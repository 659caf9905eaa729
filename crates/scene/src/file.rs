//! From a scene file to a [`Scene`]: the one door at which everything is checked.

mod beside;
mod bounds;
pub(crate) mod camera;
mod cells;
pub(crate) mod edit;
mod family;
mod fit;
pub mod limits;
mod map;
mod obstacles;
pub(crate) mod plan;
mod points;
mod polygon;
mod regions;
mod route;

use std::path::Path;

use strict::Table;

pub(crate) use family::is_family;

use crate::{Problem, Scene, SceneError};

const KEYS: [&str; 17] = [
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
    "camera",
    "sensor",
    "robot",
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
        let file = path.display().to_string();
        let (source, document) = strict::open(text, &file)?;
        checked(&Table::new(&source, "the scene", 0, document.get_ref()), path, cell_m)
    }
}

/// Checks a scene file's table.
fn checked(root: &Table, path: &Path, cell_m: Option<f64>) -> Result<Scene, SceneError> {
    if root.get("generate").is_some() {
        return Err(SceneError::at(root.place_of("generate"), Problem::IsFamily));
    }
    root.only(&KEYS)?;

    let name = root.name("name")?;
    let description = root.text("description")?.unwrap_or_default();
    if root.get("map").is_some() && root.get("plan").is_some() {
        return Err(SceneError::at(root.place_of("plan"), Problem::MapAndPlan));
    }
    let map = map::read(root, path)?;
    let plan = plan::read(root, path)?;
    let extent_m = map.as_ref().map(|map| map.extent_m()).or(plan.as_ref().map(|plan| plan.extent_m()));
    let bounds_m = bounds::read(root, extent_m)?;
    let grid = cells::read(root, bounds_m, cell_m, map.as_ref().map_or(cells::DEFAULT_M, |map| map.cell_m()))?;
    let warnings = map.as_ref().map(|map| map.warnings()).or(plan.as_ref().map(|plan| plan.warnings()));
    let (known, mut obstacles) = match (map, plan) {
        (Some(map), _) => (Some(map.known()), map.obstacles(bounds_m)),
        (_, Some(plan)) => (Some(plan.known(&grid)), plan.obstacles(bounds_m)),
        _ => (None, Vec::new()),
    };
    obstacles.extend(obstacles::read(root, bounds_m)?);
    let robot = camera::robot(root)?;
    let waypoints = route::waypoints(root, bounds_m)?;
    fit::room_for_robot(root, &waypoints, &obstacles, &robot)?;
    let stops = route::stops(root, &waypoints)?;
    let stages = route::stages(root, &waypoints, &stops)?;
    let regions = regions::read(root, bounds_m)?;
    let camera = camera::camera(root)?;
    let matcher = camera::matcher(root)?;
    Ok(Scene {
        name,
        description,
        layout: None,
        bounds_m,
        grid,
        obstacles,
        known,
        waypoints,
        stops,
        stages,
        regions,
        camera,
        matcher,
        robot,
        warnings: warnings.unwrap_or_default(),
    })
}

#[cfg(test)]
mod tests;
