//! `[map]`: a map that a robot built, as boxes.

use std::path::Path;

use grid::Raster;
use grid::ros_map::{self, RosMap};

use strict::Table;

use super::beside;
use super::obstacles::texture;
use super::points::{METRES, point};
use crate::{Obstacle, Origin, Problem, SceneError, Shape, Warning};

/// A map and what the scene file says of it.
pub(super) struct Map {
    map: RosMap,
    texture: f64,
    line: usize,
}

/// Reads the map that `[map]` names, from the folder of the scene file at `scene`.
pub(super) fn read(root: &Table, scene: &Path) -> Result<Option<Map>, SceneError> {
    let Some(table) = root.section("map")? else { return Ok(None) };
    table.only(&["file", "texture", "origin"])?;
    let texture = texture(&table)?;
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
        let rectangles = merged(&Raster::new(spec, occupied));
        let boxes = rectangles.iter().enumerate().map(|(k, r)| {
            let corner = |at: [usize; 2]| [0, 1].map(|a| spec.origin_m[a] + at[a] as f64 * spec.cell_m);
            let (low, high) = (corner(r.low), corner(r.high));
            let center_m = [0, 1].map(|a| 0.5 * (low[a] + high[a]));
            let half_m = [0, 1].map(|a| 0.5 * (high[a] - low[a]));
            let origin = Origin { kind: "map box", number: k + 1, line: self.line };
            Obstacle { shape: Shape::Box { center_m, half_m, axis: [1.0, 0.0] }, texture: self.texture, origin }
        });
        boxes.collect()
    }
}

/// A rectangle of cells: columns and rows from `low` up to but without `high`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Rectangle {
    low: [usize; 2],
    high: [usize; 2],
}

/// Covers the set cells with disjoint rectangles: from every cell not yet covered, row by row, as
/// far right as the run goes and then as far up as that run repeats. Not the fewest, but few.
fn merged(set: &Raster<bool>) -> Vec<Rectangle> {
    let spec = *set.spec();
    let mut left = set.clone();
    let mut rectangles = Vec::new();
    for cell in 0..spec.cells() {
        if !left[cell] {
            continue;
        }
        let (column, row) = spec.column_row(cell);
        let end = (column..spec.width).find(|&c| !left[spec.index(c, row)]).unwrap_or(spec.width);
        let full = |r: usize, left: &Raster<bool>| (column..end).all(|c| left[spec.index(c, r)]);
        let top = (row + 1..spec.height).find(|&r| !full(r, &left)).unwrap_or(spec.height);
        for r in row..top {
            let start = spec.index(column, r);
            left.values_mut()[start..start + (end - column)].fill(false);
        }
        rectangles.push(Rectangle { low: [column, row], high: [end, top] });
    }
    rectangles
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::GridSpec;
    use proptest::prelude::*;

    fn raster(width: usize, cells: Vec<bool>) -> Raster<bool> {
        let height = cells.len() / width;
        Raster::new(GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width, height }, cells)
    }

    #[test]
    fn a_full_map_is_one_rectangle_and_an_empty_one_none() {
        assert_eq!(merged(&raster(4, vec![true; 12])), [Rectangle { low: [0, 0], high: [4, 3] }]);
        assert_eq!(merged(&raster(4, vec![false; 12])), []);
    }

    proptest! {
        #[test]
        fn the_rectangles_cover_the_set_cells_once_and_no_other(cells in prop::collection::vec(prop::bool::weighted(0.7), 48)) {
            let set = raster(8, cells);
            let mut times = vec![0; 48];
            for r in merged(&set) {
                for row in r.low[1]..r.high[1] {
                    for column in r.low[0]..r.high[0] {
                        times[row * 8 + column] += 1;
                    }
                }
            }
            let expected: Vec<i32> = set.values().iter().map(|&v| i32::from(v)).collect();
            prop_assert_eq!(times, expected);
        }
    }
}
