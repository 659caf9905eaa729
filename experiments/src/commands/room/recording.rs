//! The drive as messages.

use super::outputs::Outcome;
use crate::output::recording::{Recorder, START_S, topic};

/// Records the first seed: scans with the pose that mappers are told, the true pose, and truth and maps at the end of every stage.
pub(super) fn record(recorder: &mut Recorder, outcome: &Outcome) {
    let Outcome { ground, trials, stages, .. } = outcome;
    let first = &trials[0];
    let camera = ground.scene.matcher.stereo;
    recorder.truth("/truth", START_S, &ground.truth_after(1));
    for (number, (simulated, timed)) in first.simulation.scans.iter().zip(&ground.drive.poses).enumerate() {
        let time_s = START_S + simulated.scan.time_s;
        for scan in simulated.together() {
            match scan.sensor.checked_sub(1) {
                None => recorder.scan(time_s, &scan, &camera),
                Some(beside) => recorder.scan(time_s, &scan, &*ground.scene.sensors[beside].device.model()),
            }
        }
        recorder.pose("/pose", time_s, simulated.scan.pose);
        recorder.pose("/truth/pose", time_s, timed.pose);
        if let Some(odometry) = simulated.odometry {
            recorder.pose("/odometry/pose", time_s, odometry);
        }
        for (k, _) in stages.iter().enumerate().filter(|(_, stage)| stage.scans == number + 1) {
            if ground.moves() {
                recorder.truth("/truth", time_s, &ground.truth_after(number + 1));
            }
            for run in &first.runs {
                let map = &run.stages[k];
                if map.fault.is_none() {
                    let topic = format!("/map/{}", topic(run.mapper));
                    recorder.map(&topic, time_s, &map.occupancy, &first.reached[k]);
                }
            }
        }
    }
}
