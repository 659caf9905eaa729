//! What the rays of a scan read.

use sensor::SensorModel;

use crate::belief::prior::Continuity;
use crate::fast::map::Map;
use crate::fast::squares::Squares;
use crate::ray::bearing_chain::BearingChain;

/// What the rays of a scan read: the map before it, and the mapper's model.
pub(super) struct Inputs<'a> {
    pub(super) map: &'a Map,
    /// What is known of its squares; none where time passes for it, in which nothing stays settled.
    pub(super) squares: Option<&'a Squares>,
    pub(super) continuity: Continuity,
    pub(super) sensor: &'a dyn SensorModel,
    /// `u0` of an unseen world.
    pub(super) onset: f64,
    /// What other rays of the scan make of the end of each.
    pub(super) others: Option<&'a BearingChain>,
    /// How many cells across the rays a scan is carried by edges on no ray; 0 without lateral edges.
    pub(super) hops: usize,
}
