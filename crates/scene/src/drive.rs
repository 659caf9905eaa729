//! Driving the route, by rapier: the robot is a kinematic character that stops at what it touches.

mod among;
pub(crate) mod course;
mod crowd;

use rapier2d_f64::control::{CharacterLength, KinematicCharacterController};
use rapier2d_f64::math::{Pose2, Rot2, Vec2};
use rapier2d_f64::parry::shape::TriMesh;
use rapier2d_f64::pipeline::PhysicsWorld;
use rapier2d_f64::prelude::{Ball, ColliderBuilder};
use sensor::Pose;

use crate::geometry::{distance, minus};
use crate::{Motion, Problem, Scene, SceneError, Shape, Stop, memory};
use course::{Course, Nobody};

/// What the robot keeps between itself and anything else, m.
pub(crate) const CLEARANCE_M: f64 = 1e-3;

/// More scans than this are taken for a mistake.
const MOST_SCANS: usize = 1_000_000;

/// Where the robot stood, and when.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimedPose {
    /// Time since the start, s.
    pub time_s: f64,
    /// Where the camera stood and looked.
    pub pose: Pose,
}

/// The poses from which scans are made.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// One pose per scan, in order of time.
    pub poses: Vec<TimedPose>,
    /// Every stage of the scene with the number of scans made when it ends.
    pub stage_ends: Vec<(String, usize)>,
    /// Where everything that moves was at each of these scans.
    pub motion: Motion,
}

/// Drives the scene's route: turns on the spot towards the next stop, then straight there, and stands as long as the stop
/// says, with a scan at the start, every scan interval, and at the end of each stage, from which the interval counts anew.
///
/// What moves is moved meanwhile: it gives way to the robot, and the robot stands where it does not. All of this follows
/// from the scene alone.
///
/// # Errors
/// [`Problem::Blocked`] where the robot touches an obstacle; [`Problem::Jammed`] where something that moves stays in its way;
/// [`Problem::TooLong`] and [`Problem::TooLongAmong`] for a drive without a sensible end.
pub fn drive(scene: &Scene) -> Result<Drive, SceneError> {
    refuse_endless(scene)?;
    if scene.moves() {
        return among::drive(scene);
    }
    let world = obstacles(scene);
    let robot = scene.robot;
    let mut course = Course::start(scene.waypoint_of(0).at_m, heading(scene, 1), robot.scan_interval_s);
    let mut stage_ends = Vec::new();
    for arrived in 1..=scene.stops.len() {
        // Stage ends come on arrival; the first stop is where the robot starts.
        if arrived > 1 {
            course.turn(heading(scene, arrived - 1), robot.turn_rate_rad_s, &mut Nobody);
            let to = scene.waypoint_of(arrived - 1).at_m;
            course.straight(to, robot.speed_m_s, |from, wish| {
                step(scene, &world, from, wish).map_err(|touch| blocked(scene, arrived - 1, &touch))
            })?;
        }
        course.stand(scene.stops[arrived - 1].wait_s, &mut Nobody);
        for stage in scene.stages.iter().filter(|stage| stage.stops == arrived) {
            course.scan_on_arrival(&mut Nobody);
            stage_ends.push((stage.name.clone(), course.poses().len()));
        }
    }
    Ok(Drive { poses: course.into_poses(), stage_ends, motion: Motion::default() })
}

/// Direction of the way to the given stop from the one before it, rad.
fn heading(scene: &Scene, stop: usize) -> f64 {
    let [x, y] = minus(scene.waypoint_of(stop).at_m, scene.waypoint_of(stop - 1).at_m);
    libm::atan2(y, x)
}

/// How long the route takes where nothing is in the way, s.
pub(crate) fn least_time_s(scene: &Scene) -> f64 {
    let robot = scene.robot;
    let mut time_s = scene.stops[0].wait_s;
    for stop in 1..scene.stops.len() {
        time_s += distance(scene.waypoint_of(stop - 1).at_m, scene.waypoint_of(stop).at_m) / robot.speed_m_s;
        time_s += scene.stops[stop].wait_s;
        if stop > 1 {
            time_s +=
                course::turn_between(heading(scene, stop - 1), heading(scene, stop)).abs() / robot.turn_rate_rad_s;
        }
    }
    time_s
}

/// Estimates the number of scans, so that a slip of the pen is not simulated for hours.
fn refuse_endless(scene: &Scene) -> Result<(), SceneError> {
    let time_s = least_time_s(scene);
    if scene.moves() && time_s > among::LONGEST_S {
        return Err(invalid(&scene.stops[0], Problem::TooLongAmong { limit_s: among::LONGEST_S }));
    }
    let scans = time_s / scene.robot.scan_interval_s + scene.stages.len() as f64 + 1.0;
    let columns = scene.camera.columns;
    let things = scene.movers.len() + scene.doors.len() + scene.chairs.len();
    let per_scan = columns as u64 * memory::BYTES_PER_RAY + things as u64 * memory::BYTES_PER_THING;
    let bytes = scans * per_scan as f64;
    let available = memory::available();
    if scans <= MOST_SCANS as f64 && bytes <= available as f64 {
        return Ok(());
    }
    let problem = Problem::TooLong { scans, columns, limit: MOST_SCANS, available };
    Err(invalid(&scene.stops[0], problem))
}

fn invalid(stop: &Stop, problem: Problem) -> SceneError {
    SceneError::at(stop.place.clone(), problem)
}

/// The obstacles as colliders; `user_data` is the obstacle's index.
fn obstacles(scene: &Scene) -> PhysicsWorld {
    let mut world = PhysicsWorld::new();
    for (index, obstacle) in scene.obstacles.iter().enumerate() {
        for collider in colliders(&obstacle.shape) {
            world.insert_collider(collider.user_data(index as u128), None);
        }
    }
    // Nothing is found before the first step.
    world.step();
    world
}

fn colliders(shape: &Shape) -> Vec<ColliderBuilder> {
    let pose = |at: &[f64; 2], rotation| Pose2::from_parts(Vec2::from_array(*at), rotation);
    match shape {
        Shape::Box { center_m, half_m: [w, h], axis } => {
            let turned = pose(center_m, Rot2 { re: axis[0], im: axis[1] });
            vec![ColliderBuilder::cuboid(*w, *h).position(turned)]
        }
        Shape::Disc { center_m, radius_m } => {
            vec![ColliderBuilder::ball(*radius_m).position(pose(center_m, Rot2::identity()))]
        }
        Shape::Polygon { points_m } => {
            let corners: Vec<Vec2> = points_m.iter().map(|p| Vec2::from_array(*p)).collect();
            match TriMesh::from_polygon(corners.clone()) {
                Some(mesh) => mesh.triangles().map(|t| ColliderBuilder::triangle(t.a, t.b, t.c)).collect(),
                // Where ears cannot be cut off (slivers), the sides alone hold the robot, which starts outside.
                None => (0..corners.len())
                    .map(|k| ColliderBuilder::segment(corners[k], corners[(k + 1) % corners.len()]))
                    .collect(),
            }
        }
    }
}

/// What stopped the robot, and where.
struct Touch {
    at: [f64; 2],
    obstacle: usize,
}

/// Moves the robot by `wish` (m) or until it touches something. No sliding along it: the robot
/// follows its route or says why it cannot.
fn step(scene: &Scene, world: &PhysicsWorld, from: [f64; 2], wish: [f64; 2]) -> Result<[f64; 2], Touch> {
    let controller = KinematicCharacterController {
        offset: CharacterLength::Absolute(CLEARANCE_M),
        slide: false,
        autostep: None,
        snap_to_ground: None,
        ..KinematicCharacterController::default()
    };
    let mut touched = None;
    let moved = controller.move_shape(
        scene.robot.scan_interval_s,
        &world.query_pipeline(),
        &Ball::new(scene.robot.radius_m),
        &Pose2::from_translation(Vec2::from_array(from)),
        Vec2::from_array(wish),
        |collision| touched = touched.or(Some(collision.handle)),
    );
    let at = [from[0] + moved.translation.x, from[1] + moved.translation.y];
    match touched.and_then(|handle| world.colliders.get(handle)) {
        Some(collider) => Err(Touch { at, obstacle: collider.user_data as usize }),
        None => Ok(at),
    }
}

fn blocked(scene: &Scene, stop: usize, touch: &Touch) -> SceneError {
    let name = |stop| scene.waypoint_of(stop).name.clone();
    let problem = Problem::Blocked {
        from: name(stop - 1),
        to: name(stop),
        at: touch.at,
        obstacle: scene.obstacles[touch.obstacle].origin.to_string(),
        needed_m: scene.robot.radius_m + CLEARANCE_M,
        spare_m: CLEARANCE_M,
    };
    invalid(&scene.stops[stop], problem)
}

#[cfg(test)]
mod tests;
