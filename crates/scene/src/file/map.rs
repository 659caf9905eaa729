//! `[map]`: a map that a robot built, as boxes.

use std::path::Path;

use grid::Raster;
use grid::ros_map::{self, RosMap};

use strict::Table;

use super::beside;
use super::findings::Findings;
use super::obstacles::texture;
use super::points::{METRES, point};
use crate::boxes::boxes;
use crate::{Obstacle, Origin, Problem, SceneError, SeenBy, Warning};

/// A map and what the scene file says of it.
pub(super) struct Map {
    map: RosMap,
    texture: f64,
    line: usize,
}

/// Reads the map that `[map]` names, from the folder of the scene file at `scene`.
pub(super) fn read(root: &Table, scene: &Path, found: &mut Findings) -> Result<Option<Map>, SceneError> {
    let Some(table) = root.section("map")? else { return Ok(None) };
    found.only(&table, &["file", "texture", "origin"]);
    let texture = found.take(texture(&table)).unwrap_or_default();
    let Some(value) = table.get("file") else { return Err(table.missing("file", "`file = \"maps/....yaml\"`").into()) };
    let refused = |bound: &str, remedy: &str| table.refuse("file", value, bound, remedy);
    let name = beside::name(&table, value, "the name of a map's YAML file")?;
    let path = scene.parent().unwrap_or(Path::new("")).join(name);
    let map = ros_map::read(&path).map_err(|error| SceneError::at(table.place_of("file"), Problem::Map(error)))?;
    let mut map = map;
    if table.get("origin").is_some() {
        map.spec.origin_m = point(&table, "origin")?;
        map.occupancy = Raster::new(map.spec, map.occupancy.values().to_vec());
    }
    if map.is_turned() {
        let bound = format!("a map whose origin has the angle 0, not {}", map.yaw_rad);
        let remedy = "`convert MAP.yaml STRAIGHT.yaml --origin X,Y,0` keeps its cells and lays its rows along x";
        return Err(refused(&bound, remedy).into());
    }
    let map = Map { map, texture, line: table.place().line };
    if map.extent_m().iter().flatten().any(|v| v.abs() > METRES) {
        return Err(refused(
            "a map within 1000000 m of the origin",
            "put it elsewhere with `origin = [0.0, 0.0]` in [map], or correct its origin and resolution",
        )
        .into());
    }
    Ok(Some(map))
}

impl Map {
    pub(super) fn cell_m(&self) -> f64 {
        self.map.spec.cell_m
    }

    pub(super) fn extent_m(&self) -> [[f64; 2]; 2] {
        let spec = &self.map.spec;
        let size = [spec.width, spec.height].map(|n| n as f64 * spec.cell_m);
        [spec.origin_m, [spec.origin_m[0] + size[0], spec.origin_m[1] + size[1]]]
    }

    /// What is suspicious about the map.
    pub(super) fn warnings(&self) -> Vec<Warning> {
        self.map.warnings.iter().cloned().map(Warning::Map).collect()
    }

    /// Whether the map knows what is in its cells.
    pub(super) fn known(&self) -> Raster<bool> {
        self.map.cells().map(Option::is_some)
    }

    /// The occupied cells whose centres lie within `bounds`, merged into boxes.
    pub(super) fn obstacles(&self, [min, max]: [[f64; 2]; 2]) -> Vec<Obstacle> {
        let (spec, cells) = (self.map.spec, self.map.cells());
        let inside = |cell| (0..2).all(|k| min[k] <= spec.centre(cell)[k] && spec.centre(cell)[k] <= max[k]);
        let occupied = (0..spec.cells()).map(|cell| cells[cell] == Some(true) && inside(cell)).collect();
        let origin = |k: usize| Origin { kind: "map box", number: k + 1, line: self.line };
        let shapes = boxes(&Raster::new(spec, occupied)).into_iter().enumerate();
        shapes
            .map(|(k, shape)| Obstacle { shape, texture: self.texture, seen_by: SeenBy::ALL, origin: origin(k) })
            .collect()
    }
}
