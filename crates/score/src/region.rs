//! The parts of a map that are scored apart.

use serde::Serialize;

/// A part of the map, defined by what noise-free rays cross: by geometry, never by a mapper's
/// output, so that all mappers are judged on the same cells. Cells whose truth is not known belong
/// to no region.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Region {
    /// Truly free cells that some ray crossed before its hit.
    Visible,
    /// Truly occupied cells that some ray hit first.
    Surface,
    /// Cells within [`SHELL_DEPTH_M`](crate::SHELL_DEPTH_M) behind a surface along a ray, that are
    /// neither visible nor surface for any ray.
    Shell,
    /// The rest of the known cells.
    Hidden,
    /// Visible and surface together.
    Observable,
    /// Every known cell.
    All,
}

impl Region {
    /// Every region, in the order of tables. The first four share out the known cells.
    pub const ALL: [Self; 6] = [Self::Visible, Self::Surface, Self::Shell, Self::Hidden, Self::Observable, Self::All];

    /// Name, as in tables and files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Visible => "visible",
            Self::Surface => "surface",
            Self::Shell => "shell",
            Self::Hidden => "hidden",
            Self::Observable => "observable",
            Self::All => "all",
        }
    }
}
