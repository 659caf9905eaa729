//! `[plan]`: a floor plan, as walls along its outline. What is outside is not known.

use std::path::{Path, PathBuf};

use grid::{GridSpec, Raster};

use strict::{Limit, Table};

use super::beside;
use super::findings::Findings;
use super::obstacles::texture;
use crate::floor_plan::FloorPlan;
use crate::geometry::{distance, sides};
use crate::{Obstacle, Origin, Problem, SceneError, SeenBy, Shape, Warning};

/// Thickness of the walls where the file says none, m.
pub(crate) const THICKNESS_M: f64 = 0.02;

const THICKNESS: Limit = Limit {
    min: 1e-3,
    max: 10.0,
    bound: "a length in m, 0.001 to 10",
    remedy: "give the thickness of the walls along the outline, such as 0.02",
};

/// A floor plan and what the scene file says of it.
pub(super) struct Plan {
    plan: FloorPlan,
    thickness_m: f64,
    texture: f64,
    line: usize,
    path: PathBuf,
}

/// Reads the floor plan that `[plan]` names, from the folder of the scene file at `scene`.
pub(super) fn read(root: &Table, scene: &Path, found: &mut Findings) -> Result<Option<Plan>, SceneError> {
    let Some(table) = root.section("plan")? else { return Ok(None) };
    found.only(&table, &["file", "thickness", "texture"]);
    let texture = found.take(texture(&table)).unwrap_or_default();
    let thickness_m = found.take(table.optional_number("thickness", &THICKNESS)).flatten().unwrap_or(THICKNESS_M);
    let Some(value) = table.get("file") else {
        return Err(table.missing("file", "`file = \"plans/....json\"`").into());
    };
    let name = beside::name(&table, value, "the name of a floor plan's JSON file")?;
    let path = scene.parent().unwrap_or(Path::new("")).join(name);
    let plan = FloorPlan::load(&path).map_err(|error| SceneError::at(table.place_of("file"), Problem::Plan(error)))?;
    Ok(Some(Plan { plan, thickness_m, texture, line: table.place().line, path }))
}

impl Plan {
    /// The walls reach half their thickness beyond the outline.
    pub(super) fn extent_m(&self) -> [[f64; 2]; 2] {
        let [min, max] = self.plan.extent_m();
        [min.map(|v| v - 0.5 * self.thickness_m), max.map(|v| v + 0.5 * self.thickness_m)]
    }

    /// What is suspicious about the plan.
    pub(super) fn warnings(&self) -> Vec<Warning> {
        self.plan.warning(&self.path).into_iter().collect()
    }

    /// Whether the centre of each cell lies inside the outline.
    pub(super) fn known(&self, spec: &GridSpec) -> Raster<bool> {
        inside(&self.plan.outline_m, spec)
    }

    /// The walls whose middles lie within `bounds`.
    pub(super) fn obstacles(&self, bounds: [[f64; 2]; 2]) -> Vec<Obstacle> {
        let walls = walls(&self.plan, self.thickness_m).into_iter().enumerate();
        let within = |at: [f64; 2]| (0..2).all(|k| bounds[0][k] <= at[k] && at[k] <= bounds[1][k]);
        let walls = walls.filter(|(_, wall)| matches!(wall, Shape::Box { center_m, .. } if within(*center_m)));
        let obstacle = |(k, shape)| {
            let origin = Origin { kind: "plan wall", number: k + 1, line: self.line };
            Obstacle { shape, texture: self.texture, seen_by: SeenBy::ALL, origin }
        };
        walls.map(obstacle).collect()
    }
}

/// A wall along every side and partition, half its thickness longer at both ends, so that neighbours overlap at their corner.
pub(crate) fn walls(plan: &FloorPlan, thickness_m: f64) -> Vec<Shape> {
    let wall = |(a, b): ([f64; 2], [f64; 2])| {
        let length = distance(a, b);
        let half = 0.5 * thickness_m;
        Shape::Box {
            center_m: [0, 1].map(|k| 0.5 * (a[k] + b[k])),
            half_m: [0.5 * length + half, half],
            axis: [0, 1].map(|k| (b[k] - a[k]) / length),
        }
    };
    sides(&plan.outline_m).chain(plan.partitions_m.iter().map(|&[a, b]| (a, b))).map(wall).collect()
}

/// The cells whose centres lie inside an outline: row by row, between every other crossing of its sides.
pub(crate) fn inside(outline_m: &[[f64; 2]], spec: &GridSpec) -> Raster<bool> {
    let mut inside = Raster::filled(*spec, false);
    for row in 0..spec.height {
        let y = spec.centre(spec.index(0, row))[1];
        let crossed = sides(outline_m).filter(|(a, b)| (a[1] > y) != (b[1] > y));
        let mut crossings: Vec<f64> = crossed.map(|(a, b)| a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])).collect();
        crossings.sort_by(f64::total_cmp);
        for column in 0..spec.width {
            let cell = spec.index(column, row);
            let left = crossings.partition_point(|&x| x < spec.centre(cell)[0]);
            inside[cell] = left % 2 == 1;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::outline_contains;
    use crate::{Scene, World, drive, truth};

    /// An L of 6 m by 4 m with a slanted side.
    const L: &str = "{\"verts\": [[0, 0], [6, 0], [6, 1.5], [2.5, 2], [2.2, 4], [0, 4]]}";

    const SCENE: &str = "name = \"l\"\nplan = { file = \"l.json\" }\nwaypoints = { A = [0.5, 3.5], B = [1.0, 1.0], C = [5.5, 0.75] }\nroute.stops = [\"A\", \"B\", \"C\"]\n";

    fn scene(more: &str) -> Result<Scene, SceneError> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("l.json"), L).expect("written");
        Scene::parse(&format!("{SCENE}{more}"), &folder.path().join("l.toml"), None)
    }

    #[test]
    fn the_outside_is_not_scored_and_no_ray_leaves() {
        let scene = scene("").expect("valid");
        assert_eq!(scene.bounds_m, [[-0.01; 2], [6.01, 4.01]]);
        let points = [[0.0, 0.0], [6.0, 0.0], [6.0, 1.5], [2.5, 2.0], [2.2, 4.0], [0.0, 4.0]];
        let truth = truth(&scene);
        let (mut free, mut excluded) = (0, 0);
        for cell in 0..scene.grid.cells() {
            match truth[cell] {
                Some(true) => {}
                state => {
                    assert_eq!(state.is_some(), outline_contains(&points, scene.grid.centre(cell)), "cell {cell}");
                    free += usize::from(state.is_some());
                    excluded += usize::from(state.is_none());
                }
            }
        }
        assert!(free > 4000 && excluded > 2000, "{free} {excluded}");
        let (world, drive) = (World::new(&scene), drive(&scene).expect("a free way"));
        for at in &drive.poses {
            for k in 0..360 {
                let (from, direction) = (at.pose.position_m(), at.pose.direction(f64::from(k).to_radians()));
                let hit = world.cast(from, direction).expect("a closed plan");
                let end = [0, 1].map(|a| from[a] + hit.range_m * direction[a]);
                assert!(sides(&points).any(|(a, b)| crate::geometry::segment_distance(end, a, b) < 0.02), "{end:?}");
            }
        }
    }

    #[test]
    fn what_is_wrong_with_a_plan_is_said_at_its_place() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("l.json"), L.replace("[6, 0]", "[6, x]")).expect("written");
        let message = |text: &str| {
            Scene::parse(text, &folder.path().join("l.toml"), None).map(|_| ()).expect_err("refused").to_string()
        };
        let damaged = message(SCENE);
        assert!(
            damaged.contains("l.toml:2:17: [plan]: ") && damaged.contains("l.json:1:24: expected value"),
            "{damaged}"
        );
        let twice = message(&format!("{SCENE}map = {{ file = \"m.yaml\" }}\n"));
        assert!(twice.contains("[plan] beside [map]"), "{twice}");
        let thick = message(&SCENE.replace("\"l.json\"", "\"l.json\", thickness = 0"));
        assert!(thick.contains("thickness = 0: must be a length in m, 0.001 to 10"), "{thick}");
    }
}
