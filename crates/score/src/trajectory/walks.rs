//! Walks for the tests of this folder.

use proptest::collection::{SizeRange, vec};
use proptest::prelude::*;

use super::{Pair, Pose};

/// Any pose of a building.
pub(super) fn pose() -> impl Strategy<Value = Pose> {
    (-50.0..50.0, -50.0..50.0, -7.0..7.0).prop_map(|(x_m, y_m, theta_rad)| Pose { x_m, y_m, theta_rad })
}

/// Paired poses, one each second.
pub(super) fn walk(length: impl Into<SizeRange>) -> impl Strategy<Value = Vec<Pair>> {
    vec((pose(), pose()), length).prop_map(|poses| {
        let pair = |(k, (estimate, reference)): (usize, (Pose, Pose))| Pair { time_s: k as f64, estimate, reference };
        poses.into_iter().enumerate().map(pair).collect()
    })
}
