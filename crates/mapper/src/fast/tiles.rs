//! A map in square tiles that are made when a reading moves one of their cells, so that memory follows what was seen. Copies of
//! a map share its tiles; one that writes to a shared tile takes a copy of that tile first.

use std::sync::Arc;

use grid::{GridSpec, Raster};
use sensor::lanes::{LANES, Lanes, each};

use crate::memory::Held;

/// A tile has so many cells along each side ...
const TILE_SIDE: usize = 16;

/// ... and so many cells.
pub(crate) const TILE: usize = TILE_SIDE * TILE_SIDE;

/// A patch, the unit of work, has so many cells along each side ...
pub(crate) const SIDE: usize = LANES;

/// ... and so many cells. Four patches are a tile, the unit of memory.
pub(crate) const PATCH: usize = SIDE * SIDE;

/// A square, over which a ray can leap at once, has so many cells along each side.
pub(crate) const SQUARE_SIDE: usize = 128;

/// Bits of a cell's place in its tile that belong to its column (0) and row (1), patch by patch.
const BITS: [u32; 2] = [0b0100_0111, 0b1011_1000];

/// How cells are numbered: tile by tile, in a tile patch by patch, and row by row within a patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Numbering {
    spec: GridSpec,
    /// Tiles along x and y.
    tiles: [usize; 2],
    per_tile_row: f64,
}

impl Numbering {
    /// Of the cells of a grid. What sticks out of it has numbers too.
    pub(crate) fn new(spec: GridSpec) -> Self {
        let tiles = [spec.width, spec.height].map(|cells| cells.div_ceil(TILE_SIDE));
        Self { spec, tiles, per_tile_row: 1.0 / tiles[0] as f64 }
    }

    /// The grid.
    pub(crate) fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// Number of tiles.
    pub(crate) fn tiles(&self) -> usize {
        self.tiles[0] * self.tiles[1]
    }

    /// Number of tiles along x and y.
    pub(crate) fn size(&self) -> [usize; 2] {
        self.tiles
    }

    /// Number of squares.
    pub(crate) fn squares(&self) -> usize {
        self.squares_along(0) * self.squares_along(1)
    }

    #[inline(always)]
    fn squares_along(&self, axis: usize) -> usize {
        self.tiles[axis].div_ceil(SQUARE_SIDE / TILE_SIDE)
    }

    /// Number of the square of the cell in a column and row.
    #[inline(always)]
    pub(crate) fn square_at(&self, [column, row]: [u32; 2]) -> usize {
        row as usize / SQUARE_SIDE * self.squares_along(0) + column as usize / SQUARE_SIDE
    }

    /// Number of a cell's square.
    pub(crate) fn square_of(&self, number: u32) -> usize {
        self.square_at(self.column_row(number).map(|at| at as u32))
    }

    /// Column and row of the first cell of a square.
    pub(crate) fn corner_of(&self, square: usize) -> [usize; 2] {
        let along = self.squares_along(0);
        [square % along, square / along].map(|at| at * SQUARE_SIDE)
    }

    /// Side of a tile, m.
    pub(crate) fn side_m(&self) -> f64 {
        TILE_SIDE as f64 * self.spec.cell_m
    }

    /// Place of a cell's tile along x and y, by its column and row.
    pub(crate) fn tile_of(&self, cell: [usize; 2]) -> [usize; 2] {
        cell.map(|at| at / TILE_SIDE)
    }

    /// The tiles to the left, to the right, below and above a tile, where there are such.
    pub(crate) fn beside(&self, tile: usize) -> [Option<usize>; 4] {
        let [width, height] = self.tiles;
        let (column, row) = (tile % width, tile / width);
        let place = |is_there: bool, tile: usize| is_there.then_some(tile);
        [
            place(column > 0, tile.wrapping_sub(1)),
            place(column + 1 < width, tile + 1),
            place(row > 0, tile.wrapping_sub(width)),
            place(row + 1 < height, tile + width),
        ]
    }

    /// Numbers of cells.
    #[inline(always)]
    pub(crate) fn lanes(&self, column: &Lanes<u32>, row: &Lanes<u32>) -> Lanes<u32> {
        each(|l| self.at([column[l], row[l]]))
    }

    /// Number of the cell in a column and row.
    #[inline(always)]
    pub(crate) fn at(&self, [column, row]: [u32; 2]) -> u32 {
        let tile = (row >> 4) * self.tiles[0] as u32 + (column >> 4);
        let patch = ((row & 8) << 4) | ((column & 8) << 3);
        (tile << 8) | patch | ((row & 7) << 3) | (column & 7)
    }

    /// Number of a cell.
    pub(crate) fn number(&self, column: usize, row: usize) -> u32 {
        self.at([column as u32, row as u32])
    }

    /// Number of a cell from its index in the grid.
    pub(crate) fn of(&self, cell: usize) -> u32 {
        let (column, row) = self.spec.column_row(cell);
        self.number(column, row)
    }

    /// Column and row of a cell.
    pub(crate) fn column_row(&self, number: u32) -> [usize; 2] {
        let (tile, place) = split(number);
        // Exact as long as there are fewer than 2^31 tiles, and far faster than a division of whole numbers.
        let row = ((tile as f64 + 0.5) * self.per_tile_row) as usize;
        let column = tile - row * self.tiles[0];
        let inside = |place: usize| ((place >> 3) & 8) | (place & 7);
        [column * TILE_SIDE + inside(place), row * TILE_SIDE + inside((place >> 1) & 0x40 | (place >> 3) & 7)]
    }

    /// The next cell along x (0) or y (1), if there is one, be it one that sticks out of the grid.
    #[inline(always)]
    pub(crate) fn after(&self, number: u32, axis: usize) -> Option<u32> {
        let bits = BITS[axis];
        if number & bits == bits {
            let across = [1, self.tiles[0]][axis];
            let (tile, _) = split(number);
            let last = if axis == 0 { self.column_row(number)[0] / TILE_SIDE } else { tile / self.tiles[0] };
            return (last + 1 < self.tiles[axis]).then(|| number - bits + (across * TILE) as u32);
        }
        Some(((number | !bits).wrapping_add(1) & bits) | (number & !bits))
    }

    /// The cell before along x (0) or y (1), if there is one.
    #[inline(always)]
    pub(crate) fn before(&self, number: u32, axis: usize) -> Option<u32> {
        let bits = BITS[axis];
        if number & bits == 0 {
            let across = [1, self.tiles[0]][axis] * TILE;
            let first = self.column_row(number)[axis] == 0;
            return (!first).then(|| number + bits - across as u32);
        }
        Some(((number & bits).wrapping_sub(1) & bits) | (number & !bits))
    }
}

/// A cell's tile, and its place in it.
#[inline(always)]
pub(crate) fn split(number: u32) -> (usize, usize) {
    (number as usize / TILE, number as usize % TILE)
}

/// The tiles of a map; those that were not made yet are all the same. A clone copies no tile: it shares all of them until either
/// map writes to one.
#[derive(Clone)]
pub(crate) struct Tiles<T> {
    pub(crate) numbering: Numbering,
    tiles: Vec<Arc<T>>,
    /// What stands in the place of a tile that was not made yet.
    unseen: Arc<T>,
}

impl<T: Clone> Tiles<T> {
    /// No tile.
    pub(crate) fn new(numbering: Numbering, unseen: T) -> Self {
        let unseen = Arc::new(unseen);
        Self { numbering, tiles: vec![Arc::clone(&unseen); numbering.tiles()], unseen }
    }

    /// A tile as it is.
    #[inline(always)]
    pub(crate) fn at(&self, tile: usize) -> &T {
        &self.tiles[tile]
    }

    /// A tile as it is made.
    pub(crate) fn template(&self) -> &T {
        &self.unseen
    }

    /// Whether a tile was made.
    #[inline(always)]
    pub(crate) fn is_made(&self, tile: usize) -> bool {
        self.was_made(&self.tiles[tile])
    }

    #[inline(always)]
    fn was_made(&self, tile: &Arc<T>) -> bool {
        !Arc::ptr_eq(tile, &self.unseen)
    }

    /// A tile to be changed, made where it is missing, and copied first where another map has it too.
    #[inline(always)]
    pub(crate) fn make(&mut self, tile: usize) -> &mut T {
        Arc::make_mut(&mut self.tiles[tile])
    }

    /// A raster of the cells in a window of the grid that begins at the given column and row, by their values.
    pub(crate) fn raster<V>(&self, from: [usize; 2], window: GridSpec, value: impl Fn(&T, usize) -> V) -> Raster<V> {
        self.raster_by_number(from, window, |tile, place| value(self.at(tile), place))
    }

    /// The same from the number of a cell's tile and its place in it.
    pub(crate) fn raster_by_number<V>(
        &self,
        from: [usize; 2],
        window: GridSpec,
        value: impl Fn(usize, usize) -> V,
    ) -> Raster<V> {
        let cells = (0..window.height).flat_map(|row| (0..window.width).map(move |column| (column, row)));
        let at = |(column, row)| {
            let (tile, place) = split(self.numbering.number(from[0] + column, from[1] + row));
            value(tile, place)
        };
        Raster::new(window, cells.map(at).collect())
    }

    /// The smallest window with all tiles that were made: its first column and row, and where it is.
    pub(crate) fn seen(&self) -> Option<([usize; 2], GridSpec)> {
        let spec = self.numbering.spec;
        let made = self.tiles.iter().enumerate().filter(|(_, tile)| self.was_made(tile));
        let places = made.map(|(tile, _)| self.numbering.column_row((tile * TILE) as u32));
        let bounds = |[low, high]: [[usize; 2]; 2], at: [usize; 2]| {
            [[0, 1].map(|k| low[k].min(at[k])), [0, 1].map(|k| high[k].max(at[k] + TILE_SIDE))]
        };
        let [from, until] = places.fold([[usize::MAX; 2], [0; 2]], bounds);
        if until == [0; 2] {
            return None;
        }
        let [width, height] = [0, 1].map(|k| until[k].min([spec.width, spec.height][k]) - from[k]);
        let origin_m = [0, 1].map(|k| spec.origin_m[k] + from[k] as f64 * spec.cell_m);
        Some((from, GridSpec { origin_m, width, height, ..spec }))
    }
}

/// What a shared tile takes beside its cells: two counts of who holds it.
const COUNTS: usize = 2 * size_of::<usize>();

/// Of a tile that several maps share, each holds its share.
impl<T> Held for Tiles<T> {
    fn held(&self) -> usize {
        let shares = self
            .tiles
            .iter()
            .filter(|tile| !Arc::ptr_eq(tile, &self.unseen))
            .map(|tile| (size_of::<T>() + COUNTS) / Arc::strong_count(tile));
        self.tiles.held() + shares.sum::<usize>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn spec(width: usize, height: usize) -> GridSpec {
        GridSpec { cell_m: 0.5, origin_m: [-1.0, 2.0], width, height }
    }

    proptest! {
        #[test]
        fn numbers_are_places(width in 1usize..90, height in 1usize..90) {
            let spec = spec(width, height);
            let numbering = Numbering::new(spec);
            let mut taken = std::collections::HashSet::new();
            for cell in 0..spec.cells() {
                let (column, row) = spec.column_row(cell);
                let number = numbering.of(cell);
                let (tile, _) = split(number);
                prop_assert!(taken.insert(number) && tile < numbering.tiles(), "{number}");
                prop_assert_eq!(numbering.column_row(number), [column, row]);
                for n in spec.neighbours(cell).filter(|n| n.cell > cell) {
                    let (other, axis) = (numbering.of(n.cell), n.edge % 2);
                    prop_assert_eq!(numbering.after(number, axis), Some(other));
                    prop_assert_eq!(numbering.before(other, axis), Some(number));
                }
            }
            for number in 0..(numbering.tiles() * TILE) as u32 {
                let at = numbering.column_row(number);
                prop_assert_eq!(numbering.number(at[0], at[1]), number);
                for (axis, at) in at.into_iter().enumerate() {
                    let last = numbering.tiles[axis] * TILE_SIDE - 1;
                    prop_assert_eq!(numbering.after(number, axis).is_none(), at == last);
                    prop_assert_eq!(numbering.before(number, axis).is_none(), at == 0);
                }
            }
        }

        #[test]
        fn they_hold_what_a_raster_holds(
            width in 1usize..90, height in 1usize..90, writes in prop::collection::vec((0usize..8100, any::<u16>()), 0..60),
        ) {
            let spec = spec(width, height);
            let mut tiles = Tiles::new(Numbering::new(spec), [7; TILE]);
            let mut raster = Raster::filled(spec, 7);
            prop_assert_eq!(tiles.seen(), None);
            for (cell, value) in writes {
                let cell = cell % spec.cells();
                let (tile, place) = split(tiles.numbering.of(cell));
                tiles.make(tile)[place] = value;
                raster[cell] = value;
                let (from, window) = tiles.seen().expect("something was written");
                let (column, row) = spec.column_row(cell);
                prop_assert!((from[0]..from[0] + window.width).contains(&column) && (from[1]..from[1] + window.height).contains(&row));
            }
            prop_assert_eq!(tiles.raster([0, 0], spec, |tile, place| tile[place]), raster.clone());
            if let Some((from, window)) = tiles.seen() {
                let part = tiles.raster(from, window, |tile, place| tile[place]);
                for cell in 0..window.cells() {
                    prop_assert_eq!(part[cell], raster[spec.locate(window.centre(cell)).expect("inside")]);
                }
            }
        }
    }
}
