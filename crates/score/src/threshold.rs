//! The probabilities at which a map is taken at its word.
//!
//! All comparisons are strict: a cell exactly at a threshold is on the undecided side.

/// Below this a cell is held free. A planner's usual limit for "drive here" (ROS maps: 0.196), and
/// twice the prior of 0.1, so that the prior itself counts as free: where that must not pass for
/// knowledge, as in [`Retention`](crate::Retention), the cell must also have been seen.
pub const HELD_FREE: f64 = 0.2;

/// Above this a cell is held occupied: the map thinks an obstacle likelier than none.
pub const HELD_OCCUPIED: f64 = 0.5;

/// Above this a cell of a saved map is occupied to ROS (`occupied_thresh` of `map_server`, as its savers write it).
pub const SAVED_OCCUPIED: f64 = 0.65;

/// Above this the map has decided for an obstacle: the mirror image of [`HELD_FREE`].
pub const DECIDED_OCCUPIED: f64 = 0.8;

/// Log loss clips probabilities to `CLIP ..= 1 - CLIP`, so that one wrong certainty costs 9.2 nats
/// and not infinity: otherwise a single cell would decide the mean over thousands. It lies below
/// the clamps that mappers use (0.12 .. 0.97 and the like), which are therefore scored as they are.
pub const CLIP: f64 = 1e-4;
