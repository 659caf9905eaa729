//! How drives are planned on a map.

use serde::{Deserialize, Serialize};

use crate::threshold::HELD_OCCUPIED;

/// How many drives are planned, for which robot, and what of a map they keep off.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Planning {
    /// Pairs of places; nothing is planned where it is 0.
    pub pairs: usize,
    /// Radius of the robot's disc, m, above 0.
    pub robot_radius_m: f64,
    /// A cell with a greater probability is an obstacle.
    pub threshold: f64,
    /// What cells are of which the map knows nothing, whatever their probability.
    pub never_seen: NeverSeen,
}

/// What a cell is to the planner of which the map knows nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NeverSeen {
    /// An obstacle: what a drive then runs into, the map had seen and lost, or never found.
    #[default]
    Occupied,
    /// Free, as Nav2's planners take it unless told otherwise (`allow_unknown`): most collisions are then with what no map
    /// of these readings could know of.
    Free,
}

impl Default for Planning {
    fn default() -> Self {
        Self { pairs: 200, robot_radius_m: 0.2, threshold: HELD_OCCUPIED, never_seen: NeverSeen::default() }
    }
}
