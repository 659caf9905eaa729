//! Driving among what moves.

use super::course::{Course, Others as _};
use super::crowd::{Crowd, STEP_S, Who};
use super::{Drive, MOST_SCANS, Touch, blocked, heading, invalid};
use crate::geometry::{distance, minus};
use crate::{Problem, Scene, SceneError};

/// A longer drive, s, takes too many steps.
pub(super) const LONGEST_S: f64 = 36_000.0;

/// A robot that gets on by less in a step, m, stands.
const STANDS_M: f64 = 1e-6;

/// What is left of a leg when the robot is there, m.
const THERE_M: f64 = 1e-9;

/// As [`drive`](super::drive()), in a scene in which something moves.
pub(super) fn drive(scene: &Scene) -> Result<Drive, SceneError> {
    let robot = scene.robot;
    let mut crowd = Crowd::of(scene);
    let mut course = Course::start(scene.waypoint_of(0).at_m, heading(scene, 1), robot.scan_interval_s);
    crowd.scanned();
    let mut stage_ends = Vec::new();
    for arrived in 1..=scene.stops.len() {
        if arrived > 1 {
            let theta_rad = heading(scene, arrived - 1);
            let (sin, cos) = libm::sincos(theta_rad);
            crowd.expect(Some([cos, sin]), distance(course.at_m(), scene.waypoint_of(arrived - 1).at_m), 0.0);
            course.turn(theta_rad, robot.turn_rate_rad_s, &mut crowd);
            straight(scene, arrived - 1, &mut course, &mut crowd)?;
        }
        crowd.expect(None, 0.0, 0.0);
        course.stand(scene.stops[arrived - 1].wait_s, &mut crowd);
        for stage in scene.stages.iter().filter(|stage| stage.stops == arrived) {
            course.scan_on_arrival(&mut crowd);
            stage_ends.push((stage.name.clone(), course.poses().len()));
            crowd.stage_ended();
        }
    }
    Ok(Drive { poses: course.into_poses(), stage_ends, motion: crowd.into_motion() })
}

/// Drives straight to a stop, and stands while something that moves is in the way.
fn straight(scene: &Scene, stop: usize, course: &mut Course, crowd: &mut Crowd) -> Result<(), SceneError> {
    let (from, to, robot) = (course.at_m(), scene.waypoint_of(stop).at_m, scene.robot);
    let length_m = distance(from, to);
    let direction = minus(to, from).map(|v| v / length_m);
    let (mut gone_m, mut stood_s) = (0.0, 0.0);
    while length_m - gone_m > THERE_M {
        let left_m = length_m - gone_m;
        let now_s = course.time_s();
        let next_s = (now_s + (left_m / robot.speed_m_s).min(STEP_S)).min(course.due_s().max(now_s));
        let wish_m = (robot.speed_m_s * (next_s - now_s)).min(left_m);
        crowd.expect(Some(direction), left_m, stood_s);
        let (moved_m, who) = crowd.drive(direction, wish_m);
        gone_m += moved_m;
        let at = if length_m - gone_m > THERE_M { [0, 1].map(|k| from[k] + gone_m * direction[k]) } else { to };
        crowd.put(at);
        if let Some(Who::Obstacle(obstacle)) = who {
            return Err(blocked(scene, stop, &Touch { at, obstacle }));
        }
        crowd.until(next_s);
        course.move_on(next_s, at, crowd);
        stood_s = if moved_m > STANDS_M.min(0.5 * wish_m) { 0.0 } else { stood_s + (next_s - now_s) };
        if let Some(Who::Thing(thing)) = who.filter(|_| stood_s > robot.patience_s) {
            return Err(jammed(scene, stop, at, thing));
        }
        refuse_endless(scene, course)?;
    }
    Ok(())
}

/// Waiting can make a drive longer than its route told.
fn refuse_endless(scene: &Scene, course: &Course) -> Result<(), SceneError> {
    if course.time_s() <= LONGEST_S && course.poses().len() <= MOST_SCANS {
        return Ok(());
    }
    Err(invalid(&scene.stops[0], Problem::TooLongAmong { limit_s: LONGEST_S }))
}

fn jammed(scene: &Scene, stop: usize, at: [f64; 2], thing: usize) -> SceneError {
    let name = |stop| scene.waypoint_of(stop).name.clone();
    let movers = scene.movers.iter().map(|m| &m.origin);
    let mut origins = movers.chain(scene.doors.iter().map(|d| &d.origin)).chain(scene.chairs.iter().map(|c| &c.origin));
    let problem = Problem::Jammed {
        from: name(stop - 1),
        to: name(stop),
        at,
        thing: origins.nth(thing).map(ToString::to_string).unwrap_or_default(),
        patience_s: scene.robot.patience_s,
    };
    invalid(&scene.stops[stop], problem)
}
