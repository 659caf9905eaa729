//! Trajectories in the TUM format and its relatives, and relations, which are lines of eight numbers too.

use std::f64::consts::TAU;

use logs::trajectory::relations;
use logs::{Body, Log, Options, Trajectory};
use sensor::Pose;

use crate::message;

const PLACE: &str = "a.tum";

/// Poses are numbers, exist in the time span alone, come back when they are written, and place the scans of a log.
pub fn trajectory(data: &[u8]) {
    match relations::read(data, PLACE) {
        Ok(found) => {
            let numbers = |r: &relations::Relation| [r.from_s, r.to_s, r.motion.x_m, r.motion.y_m, r.motion.theta_rad];
            assert!(found.iter().flat_map(numbers).all(f64::is_finite));
        }
        Err(error) => message::check(&error, PLACE),
    }
    let found = match Trajectory::read(data, PLACE) {
        Ok(found) => found,
        Err(error) => return message::check(&error, PLACE),
    };
    let [first, last] = found.span_s();
    found.findings().iter().for_each(|finding| message::line(&finding.to_string()));
    assert!(first <= last && first.is_finite() && last.is_finite());
    assert!(found.pose(first.next_down()).is_none() && found.pose(last.next_up()).is_none());
    // Half of a subnormal number is rounded.
    let mut times = vec![first, (0.5 * first + 0.5 * last).clamp(first, last), last];
    times.dedup_by(|b, a| *b <= *a);
    let poses: Vec<Pose> = times.iter().map(|time| found.pose(*time).expect("within the time span")).collect();
    let lines = times.iter().zip(&poses).map(|(time_s, Pose { x_m, y_m, theta_rad })| {
        assert!([x_m, y_m, theta_rad].iter().all(|v| v.is_finite()));
        let (sin, cos) = (0.5 * theta_rad).sin_cos();
        format!("{time_s} {x_m} {y_m} 0 0 0 {sin} {cos}\n")
    });
    let text = "# time [s] x y z qx qy qz qw\n".to_owned() + &lines.collect::<String>();
    let again = Trajectory::read(text.as_bytes(), PLACE).expect("what was read is a trajectory");
    for (time_s, pose) in times.iter().zip(&poses) {
        let back = again.pose(*time_s).expect("within the time span");
        assert_eq!((back.x_m, back.y_m), (pose.x_m, pose.y_m));
        let turn_rad = (back.theta_rad - pose.theta_rad).abs() % TAU;
        assert!(turn_rad.min(TAU - turn_rad) < 1e-9, "{back:?} is not {pose:?}");
    }
    let log = format!("FLASER 1 2.0 0 0 0 0 0 0 {last} robot 0\nFLASER 1 2.0 0 0 0 0 0 0 {} robot 0\n", last + 1e9);
    for body in [Body::Sensor, Body::Robot] {
        let log = Log::carmen(log.as_bytes(), "a.log", &Options::default()).expect("a log");
        let mut log = log.along(found.clone(), body).expect("with times");
        let scan = log.next().expect("a scan within").expect("fine");
        assert_eq!((scan.pose.x_m, scan.pose.y_m), (poses[poses.len() - 1].x_m, poses[poses.len() - 1].y_m));
        assert!(log.next().is_none());
        // What is late for every trajectory is damaged.
        assert_eq!(log.report().outside_trajectory + log.report().damaged, 1);
    }
}
