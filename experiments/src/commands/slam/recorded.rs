//! What was found as messages.

use super::outputs::Told;
use crate::output::recording::{Recorder, START_S, topic};

/// Records every scan from the pose that was found for it, that by odometry, the true poses where they are known, and the map at the end.
pub(super) fn record(recorder: &mut Recorder, told: &Told) {
    let after_s = START_S - told.scans[0].clock_s.min(START_S);
    let mut truth = told.references.truth.iter().flatten().peekable();
    let mut last_s = START_S;
    for (taken, (_, pose)) in told.scans.iter().zip(&told.outcome.trajectory) {
        last_s = taken.clock_s + after_s;
        while let Some(stamped) = truth.next_if(|stamped| stamped.time_s <= taken.clock_s) {
            let pose = stamped.pose;
            let pose = sensor::Pose { x_m: pose.x_m, y_m: pose.y_m, theta_rad: pose.theta_rad };
            recorder.pose("/truth/pose", stamped.time_s + after_s, pose);
        }
        for mounted in taken.mounted() {
            let scan = mounted.scan_from(*pose);
            recorder.scan(last_s, &scan, &**told.model.sensors.of(&scan));
        }
        recorder.pose("/pose", last_s, *pose);
        recorder.pose("/odometry/pose", last_s, taken.odometry);
    }
    recorder.map(&format!("/map/{}", topic(told.entry.name)), last_s, told.map, told.seen);
}
