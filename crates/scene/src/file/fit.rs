//! Whether the robot fits at its waypoints.

use strict::Table;

use super::findings::Findings;
use crate::drive::CLEARANCE_M;
use crate::{Obstacle, Problem, Robot, SceneError, Waypoint};

/// Refuses waypoints at which the robot would touch an obstacle.
pub(super) fn room_for_robot(
    root: &Table,
    waypoints: &[Waypoint],
    obstacles: &[Obstacle],
    robot: &Robot,
    found: &mut Findings,
) {
    let needed_m = robot.radius_m + CLEARANCE_M;
    let section = root.section("waypoints").ok().flatten();
    for Waypoint { name, at_m } in waypoints {
        let Some((obstacle, distance_m)) = nearest(obstacles, *at_m).filter(|(_, d)| *d < needed_m) else { continue };
        let place = section.as_ref().map_or_else(|| root.place(), |table| table.place_of(name));
        let problem = Problem::NoRoom {
            name: name.clone(),
            at: *at_m,
            obstacle: obstacle.origin.to_string(),
            distance_m,
            needed_m,
            spare_m: CLEARANCE_M,
        };
        found.add(SceneError::at(place, problem));
    }
}

fn nearest(obstacles: &[Obstacle], at: [f64; 2]) -> Option<(&Obstacle, f64)> {
    let distances = obstacles.iter().map(|o| (o, o.shape.distance_m(at)));
    distances.min_by(|(_, a), (_, b)| a.total_cmp(b))
}
