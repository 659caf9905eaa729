//! What a way is scored by.

/// Every metric there is.
pub(super) const METRICS: [&str; 11] = [
    "ate",
    "ate_rotation",
    "rpe_1m",
    "rpe_1m_rotation",
    "relations",
    "relations_rotation",
    "relations_loops",
    "relations_loops_rotation",
    "relations_others",
    "relations_others_rotation",
    "nees",
];
