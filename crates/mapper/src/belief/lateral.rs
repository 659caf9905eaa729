//! Continuity across rays: what the paper's method leaves out.
//!
//! The paper's chain correlates cells *along* a ray. Across rays, edges that no ray runs along count for nothing or for their
//! old state, so that two rays that hit the same wall a hand apart do not learn from each other. [`Lateral`] adds that, in two places:
//!
//! | step | what | where |
//! |---|---|---|
//! | before the rays | the hits of neighbouring rays are a chain over bearings, which gives each ray what the others measured of its end | `ray/bearing_chain` |
//! | after the rays | edges on no ray take part in the least squares with what Jeffrey's rule makes of their joint | `pairs/lateral_edges` |
//!
//! The rest is the paper's: the chain along each ray, and the least squares between them.

use crate::belief::prior::Prior;

/// What is assumed of continuity across rays, and how strongly. [`Lateral::default`] is fitted on the tuning scenes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lateral {
    /// Whether the end of a ray depends on the readings of the rays beside it.
    pub rays: bool,
    /// Whether edges on no ray take part with what their ends have learnt.
    pub edges: bool,
    /// Weight of what an edge on no ray takes over from either of its ends, against 1 of a ray along an edge.
    pub learnt: f64,
    /// Weight of what such an edge was before the scan.
    pub before: f64,
}

impl Default for Lateral {
    fn default() -> Self {
        Self { rays: true, edges: true, learnt: 3.0, before: 1.5 }
    }
}

impl Lateral {
    /// Rays alone.
    pub const RAYS: Self = Self { rays: true, edges: false, learnt: 0.0, before: 1.0 };
    /// Edges alone.
    pub const EDGES: Self = Self { rays: false, edges: true, learnt: 3.0, before: 1.5 };
}

/// What a scan teaches goes so far across the rays by edges alone, m ...
const REACH_M: f64 = 0.1;

/// ... and so many cells at least and at most.
const HOPS: [usize; 2] = [2, 8];

/// Surfaces go on for this share of an obstacle's length ...
const SEEN: f64 = 0.5;

/// ... and longer by a cell, since one that is covered in part is occupied. Obstacles of this length, m, are those of the
/// paper's prior.
const OBSTACLE_M: f64 = 0.4;

impl Lateral {
    /// The prior of the cells. A camera sees the faces of obstacles, not all of them: along a ray, what is seen to be
    /// occupied is half as long. Cells of side `cell_m` (m) make it longer by as much as they are larger than those of
    /// the paper.
    pub fn prior(&self, prior: &Prior, cell_m: f64) -> Prior {
        let share = (SEEN + (cell_m - Prior::REFERENCE_M) / OBSTACLE_M).clamp(0.5 * SEEN, 1.0);
        Prior { correlation: libm::pow(prior.correlation, 1.0 / share), ..*prior }
    }

    /// How many cells far edges carry what a scan teaches.
    pub(crate) fn hops(&self, cell_m: f64) -> usize {
        ((REACH_M / cell_m).round() as usize).clamp(HOPS[0], HOPS[1])
    }
}
