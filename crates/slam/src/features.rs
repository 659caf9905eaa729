//! Landmarks instead of a grid: from poses that are known ([`LandmarkMap`]), or with the way found together ([`FastSlam`]).

mod association;
mod fastslam;
mod known_poses;
mod landmark;
mod map;
mod options;
mod proposal;
mod tree;

pub use fastslam::{FastSlam, FeatureOutcome, PoseBelief};
pub use known_poses::LandmarkMap;
pub use landmark::{Expected, Landmark};
pub use map::Meant;
pub use options::{Association, FeatureOptions, FeatureOptionsError, FeatureProposal, Identity};

#[cfg(test)]
mod tests;
