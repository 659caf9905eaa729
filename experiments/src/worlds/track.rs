//! Poses as the scores of trajectories take them.

use score::trajectory::{self, Stamped};
use sensor::Pose;

/// A pose and its time.
pub fn stamped(time_s: f64, pose: Pose) -> Stamped {
    Stamped { time_s, pose: plain(pose) }
}

/// A pose as scores take it.
pub fn plain(pose: Pose) -> trajectory::Pose {
    trajectory::Pose { x_m: pose.x_m, y_m: pose.y_m, theta_rad: pose.theta_rad }
}
