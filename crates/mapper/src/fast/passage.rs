//! How far a ray moves cells, and which it passes.

use crate::fast::walk::Place;

/// How far a ray moves cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reach {
    /// The last of them.
    pub(super) last: Place,
    /// Range at which it leaves that, m.
    pub(super) end_m: f64,
    /// Whether it reaches the border of the map.
    pub(super) whole: bool,
}

impl Reach {
    /// Of a ray that passes no cell behind those that were added.
    pub(super) const NOWHERE: Self = Self { last: Place { at: [0; 2], entered: 0.0 }, end_m: 0.0, whole: true };
}

/// Cells that a ray passes without moving them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Passage {
    /// Number of the ray.
    pub(super) ray: u32,
    /// Where it begins.
    pub(super) from: Place,
    /// Whether it passes this cell too, or the ones behind it alone.
    pub(super) with_first: bool,
    /// The cell before that and the edge between them; none where the ray begins.
    pub(super) before: Option<[u32; 2]>,
    /// Number of the last cell; none where it passes all up to `until_m`.
    pub(super) last: Option<u32>,
    /// Range at which it enters no more cells, m.
    pub(super) until_m: f64,
}
