//! The map of the fast mapper, in single precision.

use grid::{GridSpec, Raster};
use sensor::in_lanes;
use sensor::lanes::{Lanes, each};

use crate::belief::prior::Continuity;
use crate::fast::bounds::bounded;
use crate::fast::budget::SETTLED;
use crate::fast::sums::Sums;
use crate::fast::tiles::{Numbering, PATCH, SIDE, TILE, Tiles, split};
use crate::model::Model;
use crate::pairs::grid::PairwiseGrid;
use crate::pairs::joint::bounds;

/// A tile of the map: 12 bytes per cell, and 8 per patch.
#[derive(Debug, Clone)]
pub(super) struct Tile {
    /// `P(E_i)`.
    pub(super) occupied: [f32; TILE],
    /// `P(E_i, E_j)` with the right and the upper neighbour; not used where cells are independent.
    pub(super) both: [[f32; TILE]; 2],
    summaries: [Summary; TILE / PATCH],
}

in_lanes! {
    /// Brings up to date what is known of patches whose cells have moved.
    pub(super) fn summarise<'a>(map: &'a mut Map, sums: &'a Sums, continuity: Continuity) {
        sums.sheets().for_each(|sheet| map.summarise_patch((sums.patch(sheet) * PATCH) as u32, continuity));
    }
}

/// What a ray needs to know of a patch to leap over it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Summary {
    /// The largest `P(E)` of its cells.
    pub(super) most: f32,
    /// Mean of `P(E_{j+1} | not E_j)` over the edges between them.
    pub(super) onset: f32,
}

impl Summary {
    #[inline(always)]
    fn of(tile: &Tile, from: usize, continuity: Continuity) -> Self {
        let row = |cells: &[f32; TILE], r: usize| -> Lanes<f32> { each(|c| cells[from + r * SIDE + c]) };
        let mut most = [0.0; SIDE];
        for r in 0..SIDE {
            let p = row(&tile.occupied, r);
            most = each(|c| if p[c] > most[c] { p[c] } else { most[c] });
        }
        let most = most.into_iter().fold(0.0, f32::max);
        // Of no other patch it is asked.
        if most > SETTLED {
            return Self { most, onset: 1.0 };
        }
        let mut sum = [0.0; SIDE];
        for r in 0..SIDE {
            let p = row(&tile.occupied, r);
            let right = each(|c| p[(c + 1) % SIDE]);
            let above = row(&tile.occupied, (r + 1) % SIDE);
            for (axis, q) in [right, above].iter().enumerate() {
                let both = match continuity {
                    Continuity::Kept => row(&tile.both[axis], r),
                    Continuity::Ignored => each(|c| p[c] * q[c]),
                };
                let inside = each(|c| if [c, r][axis] + 1 < SIDE { 1.0 } else { 0.0 });
                sum = each(|c| sum[c] + inside[c] * ((q[c] - both[c]) / (1.0 - p[c])));
            }
        }
        Self { most, onset: sum.into_iter().sum::<f32>() / (2 * SIDE * (SIDE - 1)) as f32 }
    }
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
        let summaries = [Summary { most: occupied, onset: occupied }; TILE / PATCH];
        let unseen = Tile { occupied: [occupied; TILE], both: [[pair.both[0] as f32; TILE]; 2], summaries };
        Self::new(Numbering::new(model.grid), unseen)
    }

    /// `P(E_i)` of an unseen cell, and `P(E_i, E_j)` of two.
    pub(super) fn of_unseen(&self) -> [f32; 2] {
        [self.template().occupied[0], self.template().both[0][0]]
    }

    /// `P(E_i)` of cells from a number on, each `stride` behind the one before, in one patch.
    #[inline(always)]
    pub(super) fn line(&self, from: u32, stride: usize) -> Lanes<f32> {
        let (tile, from) = split(from);
        let occupied = &self.at(tile).occupied;
        each(|k| occupied[from + k * stride])
    }

    /// Brings up to date what is known of the patch of a cell.
    #[inline(always)]
    pub(super) fn summarise_patch(&mut self, cell: u32, continuity: Continuity) {
        let (tile, place) = split(cell);
        let tile = self.make(tile);
        tile.summaries[place / PATCH] = Summary::of(tile, place / PATCH * PATCH, continuity);
    }

    /// Brings up to date what is known of the patches of a tile whose cells have moved.
    #[inline(always)]
    pub(super) fn summarise(&mut self, tile: usize) {
        let tile = self.make(tile);
        for patch in 0..TILE / PATCH {
            tile.summaries[patch] = Summary::of(tile, patch * PATCH, Continuity::Kept);
        }
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

    /// What a ray needs to know of the patch of a cell.
    #[inline(always)]
    pub(super) fn summary(&self, cell: u32) -> Summary {
        let (tile, place) = split(cell);
        self.at(tile).summaries[place / PATCH]
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
