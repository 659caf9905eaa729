//! What ways and landmarks are scored by.

use super::drives::NAMES;

/// Every metric there is.
pub(super) const METRICS: [&str; 20] = [
    "ate",
    "ate_rotation",
    "rpe_1m",
    "rpe_1m_rotation",
    "nees_median",
    "within_95",
    "landmarks",
    "landmark_error",
    "landmarks_within_95",
    "false_landmarks",
    "missed_landmarks",
    "features_seen",
    "wrong_associations",
    "failed_matches_taken",
    NAMES[0][0],
    NAMES[0][1],
    NAMES[0][2],
    NAMES[1][0],
    NAMES[1][1],
    NAMES[1][2],
];
