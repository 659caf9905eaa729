//! What cannot be scored.

use grid::{GridSpec, Raster};
use thiserror::Error;

/// Why a map cannot be scored.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ScoreError {
    /// A cell of the map holds no probability.
    #[error(
        "occupancy probability {value} in cell {cell} (column {column}, row {row}) is not within 0 to 1: \
         give every cell a probability, cells the map knows nothing of their prior"
    )]
    Probability {
        /// What the cell holds.
        value: f64,
        /// Index of the first such cell.
        cell: usize,
        /// Its column, from the left.
        column: usize,
        /// Its row, from the lowest.
        row: usize,
    },
    /// Two rasters do not cover the same cells.
    #[error(
        "the {what} has {}, the truth has {}: resample one of them, rasters are compared cell by cell",
        describe(found),
        describe(expected)
    )]
    Geometry {
        /// Which raster differs from the truth.
        what: &'static str,
        /// Its cells.
        found: GridSpec,
        /// The truth's cells.
        expected: GridSpec,
    },
    /// A cell of a covariate, such as its range, is not a number.
    #[error(
        "the covariate is not a number in cell {cell} (column {column}, row {row}): use infinity where it has no bound"
    )]
    Covariate {
        /// Index of the first such cell.
        cell: usize,
        /// Its column, from the left.
        column: usize,
        /// Its row, from the lowest.
        row: usize,
    },
    /// Edges that make no bins.
    #[error("bin edges {edges:?} do not rise: give at least two, each above the one before")]
    Edges {
        /// The edges.
        edges: Vec<f64>,
    },
}

fn describe(spec: &GridSpec) -> String {
    let GridSpec { cell_m, origin_m: [x, y], width, height } = spec;
    format!("{width} x {height} cells of {cell_m} m from ({x}, {y}) m")
}

/// Refuses a raster whose cells are not those of the truth.
pub(crate) fn same_cells(what: &'static str, found: &GridSpec, truth: &GridSpec) -> Result<(), ScoreError> {
    if found == truth { Ok(()) } else { Err(ScoreError::Geometry { what, found: *found, expected: *truth }) }
}

/// Refuses a map in which any cell, scored or not, holds no probability: whether a map is accepted
/// must not depend on the region.
pub(crate) fn probabilities(map: &Raster<f64>) -> Result<(), ScoreError> {
    let Some(cell) = map.values().iter().position(|p| !(0.0..=1.0).contains(p)) else { return Ok(()) };
    let (column, row) = map.spec().column_row(cell);
    Err(ScoreError::Probability { value: map[cell], cell, column, row })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEC: GridSpec = GridSpec { cell_m: 0.05, origin_m: [-1.0, 2.0], width: 3, height: 2 };

    #[test]
    fn the_first_cell_without_a_probability_is_named() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e-300, 1.0 + f64::EPSILON, -1.0] {
            let mut map = Raster::filled(SPEC, 0.5);
            map[4] = bad;
            map[5] = bad;
            let message = probabilities(&map).expect_err("refused").to_string();
            assert!(message.contains(&format!("{bad} in cell 4 (column 1, row 1)")), "{message}");
        }
    }

    #[test]
    fn the_bounds_themselves_are_probabilities() {
        assert_eq!(probabilities(&Raster::new(SPEC, vec![0.0, 1.0, -0.0, 0.5, 1e-308, 1.0])), Ok(()));
    }

    #[test]
    fn any_difference_in_geometry_is_refused_with_both_sides() {
        let others = [
            GridSpec { cell_m: 0.1, ..SPEC },
            GridSpec { origin_m: [-1.0, 2.5], ..SPEC },
            GridSpec { width: 2, height: 3, ..SPEC },
        ];
        for other in others {
            assert!(same_cells("mask", &other, &SPEC).is_err(), "{other:?}");
        }
        assert_eq!(
            same_cells("mask", &others[2], &SPEC).expect_err("refused").to_string(),
            "the mask has 2 x 3 cells of 0.05 m from (-1, 2) m, the truth has 3 x 2 cells of 0.05 m from (-1, 2) m: \
             resample one of them, rasters are compared cell by cell"
        );
        assert_eq!(same_cells("mask", &SPEC, &SPEC), Ok(()));
    }
}
