//! Whether what moves has room: at its start, along its route, in its swing.

use strict::{Place, Table};

use super::bounds::within;
use super::findings::Findings;
use crate::drive::CLEARANCE_M;
use crate::{Behaviour, Door, Mover, Problem, Repeat, Scene, SceneError, Shape, gap};

/// The leaf of a door is tried in steps of this angle, rad: a leaf of one metre then moves by 4 mm.
const STEP_RAD: f64 = 0.004;

/// Refuses what stands or would go where something else is.
pub(super) fn check(root: &Table, scene: &Scene, found: &mut Findings) {
    let before = found.count();
    let places = |kind| root.list(kind).unwrap_or_default();
    let (movers, doors, chairs) = (places("mover"), places("door"), places("chair"));
    for (mover, table) in scene.movers.iter().zip(&movers) {
        ways(scene, mover, table, found);
    }
    for (door, table) in scene.doors.iter().zip(&doors) {
        swing(scene, door, table, found);
    }
    for (chair, table) in scene.chairs.iter().zip(&chairs) {
        let goes = chair.moves.iter().map(|m| (goes(&m.shape), &m.shape));
        let starts = std::iter::once(("starts".to_owned(), &chair.shape));
        for (what, shape) in starts.chain(goes) {
            let element = || table.element();
            found.take(within(shape.extent_m(), scene.bounds_m, element).map_err(|p| SceneError::at(table.place(), p)));
            clear(scene, table, &what, shape, found);
        }
    }
    if found.count() == before {
        let tables = movers.iter().chain(&doors).chain(&chairs);
        apart(scene, tables.map(|table| (table.element(), table.place())).collect(), found);
    }
}

fn goes(shape: &Shape) -> String {
    let [low, high] = shape.extent_m();
    let at = [0, 1].map(|k| crate::error::metres(&(0.5 * (low[k] + high[k]))));
    format!("goes to [{}, {}]", at[0], at[1])
}

/// Refuses a shape nearer than the clearance to an obstacle, at the nearest.
fn clear(scene: &Scene, table: &Table, what: &str, shape: &Shape, found: &mut Findings) {
    let distances = scene.obstacles.iter().map(|o| (gap::between(shape, &o.shape), o));
    let Some((distance_m, obstacle)) = distances.min_by(|(a, _), (b, _)| a.total_cmp(b)) else { return };
    if distance_m < CLEARANCE_M {
        let (other, place) = (obstacle.origin.to_string(), table.place());
        found.add(touches(table.element(), what, other, distance_m, place));
    }
}

fn touches(element: String, what: &str, other: String, distance_m: f64, place: Place) -> SceneError {
    SceneError::at(place, Problem::Touches { element, what: what.to_owned(), other, distance_m, needed_m: CLEARANCE_M })
}

/// Refuses ways that leave the bounds or come too near to an obstacle.
fn ways(scene: &Scene, mover: &Mover, table: &Table, found: &mut Findings) {
    let reach_m = mover.reach_m();
    let needed_m = reach_m + CLEARANCE_M;
    let points = match &mover.behaviour {
        Behaviour::Route { points_m, repeat, .. } => {
            let back = points_m.first().filter(|_| *repeat == Repeat::Loop && points_m.len() > 2);
            points_m.iter().chain(back).copied().collect()
        }
        Behaviour::Follower { .. } | Behaviour::Loiterer { .. } => vec![mover.start_m],
    };
    for &[x, y] in &points {
        let extent = [[x - reach_m, y - reach_m], [x + reach_m, y + reach_m]];
        found.take(within(extent, scene.bounds_m, || table.element()).map_err(|p| SceneError::at(table.place(), p)));
    }
    let start = [mover.start_m, mover.start_m];
    let legs = std::iter::once(start).chain(points.windows(2).map(|leg| [leg[0], leg[1]]));
    for [from, to] in legs {
        let distances = scene.obstacles.iter().map(|o| (o.shape.segment_distance_m(from, to), o));
        let Some((distance_m, obstacle)) = distances.min_by(|(a, _), (b, _)| a.total_cmp(b)) else { return };
        if distance_m < needed_m {
            let (element, other) = (table.element(), obstacle.origin.to_string());
            let spare_m = CLEARANCE_M;
            let problem = Problem::WayThrough { element, from, to, other, distance_m, needed_m, spare_m };
            found.add(SceneError::at(table.place_of("route"), problem));
            return;
        }
    }
}

/// Refuses a leaf that leaves the bounds or touches an obstacle on its way.
fn swing(scene: &Scene, door: &Door, table: &Table, found: &mut Findings) {
    let reach_m = libm::hypot(door.length_m, door.thickness_m);
    let near: Vec<_> = scene.obstacles.iter().filter(|o| o.shape.distance_m(door.hinge_m) < reach_m).collect();
    let sweep = door.open_rad - door.closed_rad;
    let steps = (sweep.abs() * door.length_m.max(1.0) / STEP_RAD).ceil().max(1.0) as usize;
    for k in 0..=steps {
        let angle = door.closed_rad + sweep * k as f64 / steps as f64;
        let leaf = door.leaf(angle);
        let element = || table.element();
        if let Err(problem) = within(leaf.extent_m(), scene.bounds_m, element) {
            found.add(SceneError::at(table.place(), problem));
            return;
        }
        let distances = near.iter().map(|o| (gap::between(&leaf, &o.shape), o));
        let Some((distance_m, obstacle)) = distances.min_by(|(a, _), (b, _)| a.total_cmp(b)) else { continue };
        if distance_m < CLEARANCE_M {
            let what = format!("its leaf at {:.1} degrees is", angle.to_degrees());
            found.add(touches(table.element(), &what, obstacle.origin.to_string(), distance_m, table.place()));
            return;
        }
    }
}

/// Refuses things that start in each other or in the robot.
fn apart(scene: &Scene, tables: Vec<(String, Place)>, found: &mut Findings) {
    let robot = Shape::Disc { center_m: scene.waypoint_of(0).at_m, radius_m: scene.robot.radius_m };
    let mut placed = vec![(robot, "the robot at its start".to_owned())];
    let movers = scene.movers.iter().map(|m| (m.shape_at(m.start_m), m.origin.to_string()));
    let doors = scene.doors.iter().map(|d| (d.leaf(d.angle_at_start(scene.motion_seed)), d.origin.to_string()));
    let chairs = scene.chairs.iter().map(|c| (c.shape.clone(), c.origin.to_string()));
    for ((shape, name), (element, place)) in movers.chain(doors).chain(chairs).zip(tables) {
        for (other, other_name) in placed.iter().filter(|(other, _)| near(&shape, other)) {
            let distance_m = gap::between(&shape, other);
            if distance_m < CLEARANCE_M {
                found.add(touches(element, "starts", other_name.clone(), distance_m, place));
                break;
            }
        }
        placed.push((shape, name));
    }
}

/// Whether two shapes may be nearer to each other than the clearance, by their extents.
fn near(a: &Shape, b: &Shape) -> bool {
    let (a, b) = (a.extent_m(), b.extent_m());
    (0..2).all(|k| a[0][k] - b[1][k] < CLEARANCE_M && b[0][k] - a[1][k] < CLEARANCE_M)
}
