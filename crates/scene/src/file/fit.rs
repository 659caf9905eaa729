//! Whether things fit: the cells in memory, the robot at its waypoints.

use grid::GridSpec;

use crate::drive::CLEARANCE_M;
use crate::{Obstacle, Problem, Robot, SceneError, Waypoint, memory};

use super::table::Table;

/// The cells that cover the bounds, if memory holds what is kept per cell.
pub(super) fn grid([min, max]: [[f64; 2]; 2], cell_m: f64, element: &str) -> Result<GridSpec, Problem> {
    let element = element.to_owned();
    let spec = GridSpec::covering(min, max, cell_m).map_err(|source| Problem::Grid {
        element: element.clone(),
        cell_m,
        source,
    })?;
    let cells = spec.cells();
    let (bytes, available) = (cells as u64 * memory::BYTES_PER_CELL, memory::available());
    if bytes > available {
        let (columns, rows) = (spec.width, spec.height);
        return Err(Problem::Memory { element, cell_m, columns, rows, cells, bytes, available });
    }
    Ok(spec)
}

/// Refuses waypoints at which the robot would touch an obstacle.
pub(super) fn room_for_robot(
    root: &Table,
    waypoints: &[Waypoint],
    obstacles: &[Obstacle],
    robot: &Robot,
) -> Result<(), SceneError> {
    let needed_m = robot.radius_m + CLEARANCE_M;
    let section = root.section("waypoints")?;
    for Waypoint { name, at_m } in waypoints {
        let Some((obstacle, distance_m)) = nearest(obstacles, *at_m).filter(|(_, d)| *d < needed_m) else { continue };
        let offset = section.as_ref().map_or(0, |table| table.offset_of(name));
        let problem = Problem::NoRoom {
            name: name.clone(),
            at: *at_m,
            obstacle: obstacle.origin.to_string(),
            distance_m,
            needed_m,
            spare_m: CLEARANCE_M,
        };
        return Err(root.source().error(offset, problem));
    }
    Ok(())
}

fn nearest(obstacles: &[Obstacle], at: [f64; 2]) -> Option<(&Obstacle, f64)> {
    let distances = obstacles.iter().map(|o| (o, o.shape.distance_m(at)));
    distances.min_by(|(_, a), (_, b)| a.total_cmp(b))
}
