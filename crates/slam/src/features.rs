//! Landmarks instead of a grid: from poses that are known ([`LandmarkMap`]), or with the way found together ([`FastSlam`]).

mod association;
mod beside;
mod fastslam;
mod known_poses;
mod landmark;
mod map;
mod options;
mod proposal;
mod tree;

pub(crate) use beside::{Beside, Landmarks};
pub use fastslam::{FastSlam, FeatureOutcome, PoseBelief};
pub use known_poses::LandmarkMap;
pub(crate) use known_poses::confirmed;
pub use landmark::{Expected, Landmark};
pub use map::Meant;
pub use options::{Association, FeatureOptions, FeatureOptionsError, FeatureProposal, Identity};

#[cfg(test)]
mod tests;
