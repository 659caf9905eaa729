//! The pairwise occupancy grid, and how the posteriors of a scan's rays become one map: Eqs. (11)-(20).

pub(crate) mod cell_set;
pub mod footprint;
pub(crate) mod grid;
pub(crate) mod joint;
pub(crate) mod lateral_edges;
pub(crate) mod moments;
pub(crate) mod posterior;
pub(crate) mod reconcile;
pub(crate) mod renewal;
