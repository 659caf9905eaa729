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

/// A robot that has stood before people for so long, s, goes back so far, m, and lets them pass for so long, s: they may have no
/// other way out.
const BACK_AFTER_S: f64 = 10.0;
const BACK_M: f64 = 0.8;
const HOLD_S: f64 = 4.0;

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

/// A leg of the route among what moves.
struct Leg {
    direction: [f64; 2],
    length_m: f64,
    /// How far along it the robot is, and how far it has been, m.
    gone_m: f64,
    farthest_m: f64,
    /// How long it has come no farther, s, and before what it stands.
    stood_s: f64,
    before: Option<usize>,
    /// It goes back before it has stood for so long, s; what is left of that, m; and then stands for so long, s.
    back_at_s: f64,
    back_m: f64,
    hold_s: f64,
}

/// Drives straight to a stop, and stands while something that moves is in the way.
fn straight(scene: &Scene, stop: usize, course: &mut Course, crowd: &mut Crowd) -> Result<(), SceneError> {
    let (from, to, robot) = (course.at_m(), scene.waypoint_of(stop).at_m, scene.robot);
    let length_m = distance(from, to);
    let mut leg = Leg {
        direction: minus(to, from).map(|v| v / length_m),
        length_m,
        gone_m: 0.0,
        farthest_m: 0.0,
        stood_s: 0.0,
        before: None,
        back_at_s: BACK_AFTER_S,
        back_m: 0.0,
        hold_s: 0.0,
    };
    while length_m - leg.gone_m > THERE_M {
        let now_s = course.time_s();
        let left_s = (length_m - leg.gone_m) / robot.speed_m_s;
        let next_s = (now_s + left_s.min(STEP_S)).min(course.due_s().max(now_s));
        let touched = leg.step(next_s - now_s, robot.speed_m_s, scene.movers.len(), crowd);
        let on = length_m - leg.gone_m > THERE_M;
        let at = if on { [0, 1].map(|k| from[k] + leg.gone_m * leg.direction[k]) } else { to };
        crowd.put(at);
        if let Some(obstacle) = touched {
            return Err(blocked(scene, stop, &Touch { at, obstacle }));
        }
        crowd.until(next_s);
        course.move_on(next_s, at, crowd);
        if let Some(thing) = leg.before.filter(|_| leg.stood_s > robot.patience_s) {
            return Err(jammed(scene, stop, at, thing));
        }
        refuse_endless(scene, course)?;
    }
    Ok(())
}

impl Leg {
    /// A step of `dt_s`: on, or back from people who find no way past, or none. An obstacle that it touches on its way on.
    fn step(&mut self, dt_s: f64, speed_m_s: f64, people: usize, crowd: &mut Crowd) -> Option<usize> {
        self.stood_s += dt_s;
        if self.back_m > 0.0 {
            crowd.expect(None, 0.0, 0.0);
            let (moved_m, who) = crowd.drive(self.direction.map(|v| -v), (speed_m_s * dt_s).min(self.back_m));
            self.gone_m -= moved_m;
            self.back_m = if who.is_some() { 0.0 } else { self.back_m - moved_m };
            return None;
        }
        if self.hold_s > 0.0 {
            crowd.expect(None, 0.0, 0.0);
            self.hold_s -= dt_s;
            return None;
        }
        let left_m = self.length_m - self.gone_m;
        crowd.expect(Some(self.direction), left_m, self.stood_s);
        let wish_m = (speed_m_s * dt_s).min(left_m);
        let (moved_m, who) = crowd.drive(self.direction, wish_m);
        self.gone_m += moved_m;
        if self.gone_m > self.farthest_m + STANDS_M.min(0.5 * wish_m) {
            (self.farthest_m, self.stood_s, self.before, self.back_at_s) = (self.gone_m, 0.0, None, BACK_AFTER_S);
        }
        match who {
            Some(Who::Obstacle(obstacle)) => return Some(obstacle),
            Some(Who::Thing(thing)) => {
                self.before = Some(thing);
                if thing < people && self.stood_s > self.back_at_s {
                    // Farther every time.
                    let times = libm::floor(self.stood_s / BACK_AFTER_S);
                    (self.back_m, self.hold_s) = ((BACK_M * times).min(self.gone_m), HOLD_S);
                    self.back_at_s = self.stood_s + BACK_AFTER_S;
                }
            }
            Some(Who::Robot) | None => {}
        }
        None
    }
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
