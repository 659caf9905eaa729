//! The map of the fast mapper, in single precision.

use grid::{GridSpec, Raster};

use crate::belief::prior::Continuity;
use crate::fast::bounds::bounded;
use crate::fast::tiles::{Numbering, TILE, Tiles, split};
use crate::model::Model;
use crate::pairs::grid::PairwiseGrid;
use crate::pairs::joint::bounds;

/// A tile of the map: 12 bytes per cell.
#[derive(Debug, Clone)]
pub(super) struct Tile {
    /// `P(E_i)`.
    pub(super) occupied: [f32; TILE],
    /// `P(E_i, E_j)` with the right and the upper neighbour; not used where cells are independent.
    pub(super) both: [[f32; TILE]; 2],
}

/// The map.
pub(super) type Map = Tiles<Tile>;

/// A joint that single precision allows may miss the bounds of double precision by a last digit: by no more than this.
const REPAIRED: f64 = 1e-6;

impl Map {
    /// The unseen map.
    pub(super) fn unseen(model: &Model) -> Self {
        let pair = PairwiseGrid::prior(GridSpec { width: 2, height: 1, ..model.grid }, &model.prior);
        let occupied = bounded(pair.marginal[0] as f32);
        let unseen = Tile { occupied: [occupied; TILE], both: [[pair.both[0] as f32; TILE]; 2] };
        Self::new(Numbering::new(model.grid), unseen)
    }

    /// `P(E_i)`.
    #[inline(always)]
    pub(super) fn occupied(&self, cell: u32) -> f32 {
        let (tile, place) = split(cell);
        self.at(tile).occupied[place]
    }

    /// `P(E_i, E_j)` with the right (0) or the upper (1) neighbour, as it is held.
    #[inline(always)]
    pub(super) fn both(&self, cell: u32, axis: usize) -> f32 {
        let (tile, place) = split(cell);
        self.at(tile).both[axis][place]
    }

    /// `P(E_i)`, `P(E_j)` and `P(E_i, E_j)` of a cell and its right (0) or upper (1) neighbour, in double precision.
    pub(super) fn pair(&self, [low, high]: [u32; 2], axis: usize, continuity: Continuity) -> [f64; 3] {
        let [p, q] = [low, high].map(|cell| f64::from(self.occupied(cell)));
        let both = match continuity {
            Continuity::Kept => f64::from(self.both(low, axis)),
            Continuity::Ignored => p * q,
        };
        [p, q, both]
    }

    /// `P(E_i)` of all cells of the grid.
    pub(super) fn marginals(&self) -> Raster<f64> {
        self.raster([0, 0], *self.numbering.spec(), |tile, place| f64::from(tile.occupied[place]))
    }

    /// The map in double precision.
    ///
    /// # Panics
    /// If a joint is farther than 1e-6 from what its marginals allow.
    pub(super) fn pairs(&self, continuity: Continuity) -> PairwiseGrid {
        let (numbering, spec) = (&self.numbering, *self.numbering.spec());
        let marginal = self.marginals();
        let mut both = vec![0.0; 2 * spec.cells()];
        for cell in 0..spec.cells() {
            for n in spec.neighbours(cell).filter(|n| n.cell > cell) {
                let [p, q, held] = self.pair([cell, n.cell].map(|cell| numbering.of(cell)), n.edge % 2, continuity);
                let (low, high) = bounds(p, q);
                both[n.edge] = held.clamp(low, high);
                let repaired = (both[n.edge] - held).abs();
                assert!(repaired <= REPAIRED, "edge {}: joint {held} is not in {low} ..= {high}", n.edge);
            }
        }
        PairwiseGrid { marginal, both }
    }
}
