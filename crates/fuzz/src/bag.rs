//! Bags of ROS 1 and ROS 2, from container to scans.

use std::sync::Arc;

use logs::bag::{BagOptions, Contents, Drive, PoseSource};
use logs::{Log, LogError, Options, Report};

use crate::log::{PLACE, read};
use crate::message;

/// A bag in any container. Every message is a scan, skipped or damaged; scans are as those of any log.
pub fn bag(data: &[u8]) {
    let Some(drive) = opened(data) else { return };
    let options = Options { damaged_share: 1.0, ..Options::default() };
    let Some(found) = read(Log::of_drive(&drive, &options)) else { return };
    let Report { lines, scans, damaged, skipped, .. } = &found.report;
    assert_eq!(*lines, scans + damaged + skipped.values().sum::<u64>(), "{:?}", found.report);
}

/// The drive that a bag leaves no choice about, or with the first of what there is to choose.
fn opened(data: &[u8]) -> Option<Arc<Drive>> {
    let open = |options: &BagOptions| {
        Drive::read(data.to_vec(), PLACE, options).inspect_err(|error| message::check(error, PLACE))
    };
    match open(&BagOptions::default()) {
        Ok(drive) => Some(drive),
        Err(LogError::Undecided { contents, .. }) => open(&first(&contents)).ok(),
        Err(_) => None,
    }
}

fn first(contents: &Contents) -> BagOptions {
    let pose = contents.poses.first().map_or(PoseSource::Odometry, |pose| PoseSource::named(&pose.option));
    BagOptions { scans: contents.scans.iter().take(1).cloned().collect(), pose, rows: 2, ..BagOptions::default() }
}
