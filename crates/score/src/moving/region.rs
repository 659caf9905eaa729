//! The parts of a map of a world that moves.

use serde::Serialize;

/// A part of the map of a world in which things move, by geometry and looks alone, as [`Region`](crate::Region).
///
/// All but [`Swept`](Self::Swept) hold only cells that a look has found in their present state: of what has come since, no map can know. That what
/// moves will go on, a map can know. No cell is in two of the first three.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MovingRegion {
    /// No moving thing has covered it at any scan so far; free, or a wall.
    Static,
    /// Some moving thing has covered it at a scan so far; free now, whether or not anybody has looked since. Some look has found it, in whatever state: of the
    /// others a map says what it says of everything.
    Swept,
    /// A moving thing covers it now.
    OccupiedNow,
    /// Some look so far has found another state than the look before it: where maps have been given evidence of both.
    Changed,
}

impl MovingRegion {
    /// Every region, in the order of tables.
    pub const ALL: [Self; 4] = [Self::Static, Self::Swept, Self::OccupiedNow, Self::Changed];

    /// Name, as in tables and files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Static => "static",
            Self::Swept => "swept",
            Self::OccupiedNow => "occupied-now",
            Self::Changed => "changed",
        }
    }
}
