//! Times against sizes.

use super::fit;

/// What is varied, everything else being the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Against {
    /// Cells of one ray that ends in the last of them; the time of the ray.
    CellsPerRay,
    /// Rays of a scan over the same angle; the time of the scan.
    RaysPerScan,
    /// Cells of a square map about the same scan; the time of the scan.
    MapCells,
    /// Scans of a drive; the time of all.
    Scans,
}

/// The sizes that are measured, rising.
#[derive(Debug, Clone)]
pub struct Sizes {
    /// Of [`Against::CellsPerRay`].
    pub cells_per_ray: Vec<usize>,
    /// Of [`Against::RaysPerScan`].
    pub rays_per_scan: Vec<usize>,
    /// Of [`Against::MapCells`]: the map is the square that comes nearest.
    pub map_cells: Vec<usize>,
    /// Of [`Against::Scans`], at most [`SCANS`](super::super::hall::SCANS).
    pub scans: Vec<usize>,
}

/// Times of one mapper.
#[derive(Debug, Clone)]
pub struct Curve {
    /// Name of the mapper.
    pub mapper: &'static str,
    /// What was varied.
    pub against: Against,
    /// Size, and least time of all repeats, s.
    pub points: Vec<(f64, f64)>,
}

impl Against {
    /// All of them, in the order of tables.
    pub const ALL: [Self; 4] = [Self::CellsPerRay, Self::RaysPerScan, Self::MapCells, Self::Scans];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::CellsPerRay => "cells_per_ray",
            Self::RaysPerScan => "rays_per_scan",
            Self::MapCells => "map_cells",
            Self::Scans => "scans",
        }
    }
}

impl Default for Sizes {
    fn default() -> Self {
        Self {
            cells_per_ray: vec![100, 300, 1_000, 3_000, 10_000],
            rays_per_scan: vec![50, 100, 200, 400, 800, 1_600, 3_200],
            map_cells: vec![10_000, 100_000, 1_000_000, 10_000_000],
            scans: vec![45, 90, 180, 360],
        }
    }
}

impl Curve {
    /// The exponent of the power law through the points.
    pub fn exponent(&self) -> Option<f64> {
        fit::exponent(&self.points)
    }
}
