//! The log and its maps as messages.

use super::outputs::Told;
use super::recording::{Recording, refused};
use crate::failure::Failure;
use crate::output::recording::{Recorder, START_S, topic};

/// Records every scan in use by the log's own clock, those kept back among them, and the maps at the end.
pub(super) fn record(recorder: &mut Recorder, recording: &Recording, told: &Told) -> Result<(), Failure> {
    let start_s = told.survey.report.start_s.max(START_S);
    let mut last_s = start_s;
    for scan in recording.scans()? {
        let scan = scan.map_err(refused)?;
        last_s = start_s + scan.time_s;
        recorder.scan(last_s, &scan, &**told.setup.sensors.of(&scan));
        recorder.pose("/pose", last_s, scan.pose);
    }
    for map in &told.maps.maps {
        recorder.map(&format!("/map/{}", topic(map.mapper)), last_s, &map.occupancy, &told.maps.seen);
    }
    Ok(())
}
