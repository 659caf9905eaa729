//! A filter on a recording.

use sensor::Pose;
use slam::features::{FastSlam, FeatureOptionsError, FeatureProposal, Landmark, LandmarkMap, Meant, PoseBelief};

use super::filter::Filter;
use super::options::FeaturesOptions;
use super::source::Recording;
use crate::failure::Failure;

/// What a filter found.
pub(super) struct Found {
    /// A pose for every scan.
    pub(super) way: Vec<Pose>,
    pub(super) landmarks: Vec<Landmark>,
    pub(super) meant: Vec<Vec<Meant>>,
    /// Empty where poses are known.
    pub(super) beliefs: Vec<PoseBelief>,
}

/// Runs a filter over all scans of a recording that serves it; `step` is called once a scan.
pub(super) fn track(
    filter: Filter,
    recording: &Recording,
    options: &FeaturesOptions,
    seed: u64,
    step: impl Fn(),
) -> Result<Found, Failure> {
    let refused = |error: FeatureOptionsError| Failure::BadInput(error.to_string());
    let proposal = match filter {
        Filter::KnownPoses => {
            let mut map = LandmarkMap::new(recording.camera, options.association()).map_err(refused)?;
            let (mut way, mut meant) = (Vec::new(), Vec::new());
            for scan in &recording.scans {
                let pose = scan.pose.unwrap_or_default();
                meant.push(map.take(pose, &scan.readings));
                way.push(pose);
                step();
            }
            return Ok(Found { way, landmarks: map.confirmed(), meant, beliefs: Vec::new() });
        }
        Filter::Fastslam1 => FeatureProposal::Odometry,
        Filter::Fastslam2 => FeatureProposal::Latest,
    };
    let particles = options.particle_filter(proposal, seed);
    let mut filter = FastSlam::new(recording.camera, options.noise(), particles).map_err(refused)?;
    for scan in &recording.scans {
        filter.take(scan, scan.odometry.unwrap_or_default());
        step();
    }
    let outcome = filter.finish();
    Ok(Found { way: outcome.way, landmarks: outcome.landmarks, meant: outcome.meant, beliefs: outcome.beliefs })
}
