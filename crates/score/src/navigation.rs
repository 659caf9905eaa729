//! Which map may I drive on: pairs of places that a robot can drive between, planned on a map and driven in the world.
//!
//! The pairs follow from the truth alone, so that all maps of a world are asked for the same drives. A place is free
//! where the robot's disc clears every cell that is not known to be free ([`grid::clear`]); two places are a pair where a
//! way over such cells joins them. On a map the same search runs over what the map takes for free; whether the plan can
//! really be driven says the caller, who has the exact geometry.

mod errands;
mod planning;
mod plans;

pub use errands::{APART_M, GOALS};
pub use planning::{NeverSeen, Planning};
pub use plans::{Navigation, Plan};
