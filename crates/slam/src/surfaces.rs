//! Where readings ended: the surfaces that scans are matched to.

use std::ops::Range;
use std::sync::Arc;

use grid::GridSpec;

/// A tile has so many cells along each side.
const SIDE: usize = 16;

/// What ended in a cell.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Spot {
    /// How many readings.
    ends: u32,
    /// Their mean place in the cell, as shares of its side.
    mean: [f32; 2],
}

/// The mean place of the readings that ended in each cell, as GMapping keeps it (`PointAccumulator` of openslam_gmapping): a wall is
/// known to a part of a cell. 12 bytes per cell of the tiles in which a reading ended; a clone shares all tiles until one of the two
/// writes.
#[derive(Debug, Clone)]
pub struct Surfaces {
    spec: GridSpec,
    tiles_across: usize,
    tiles: Vec<Option<Arc<[Spot; SIDE * SIDE]>>>,
}

impl Surfaces {
    /// None yet, over the cells of a grid.
    pub fn new(spec: GridSpec) -> Self {
        let [tiles_across, tiles_up] = [spec.width, spec.height].map(|cells| cells.div_ceil(SIDE));
        Self { spec, tiles_across, tiles: vec![None; tiles_across * tiles_up] }
    }

    /// The cells.
    pub fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// A reading ended at a place, m; outside the grid it is left out.
    pub fn add(&mut self, at_m: [f64; 2]) {
        let Some(cell) = self.spec.locate(at_m) else { return };
        let (column, row) = self.spec.column_row(cell);
        let within = |k: usize, index: usize| (at_m[k] - self.spec.origin_m[k]) / self.spec.cell_m - index as f64;
        let place = [within(0, column) as f32, within(1, row) as f32];
        let slot = &mut self.tiles[(row / SIDE) * self.tiles_across + column / SIDE];
        let tile = Arc::make_mut(slot.get_or_insert_with(|| Arc::new([Spot::default(); SIDE * SIDE])));
        let spot = &mut tile[(row % SIDE) * SIDE + column % SIDE];
        spot.ends = spot.ends.saturating_add(1);
        for (mean, place) in spot.mean.iter_mut().zip(place) {
            *mean += (place - *mean) / spot.ends as f32;
        }
    }

    /// The cells of a window of columns and rows in which readings ended, with the mean place of these, m.
    pub fn each(&self, columns: Range<usize>, rows: Range<usize>, mut take: impl FnMut(usize, usize, [f64; 2])) {
        let columns = columns.start..columns.end.min(self.spec.width);
        let rows = rows.start..rows.end.min(self.spec.height);
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        for tile_row in rows.start / SIDE..rows.end.div_ceil(SIDE) {
            for tile_column in columns.start / SIDE..columns.end.div_ceil(SIDE) {
                let Some(tile) = &self.tiles[tile_row * self.tiles_across + tile_column] else { continue };
                for (place, spot) in tile.iter().enumerate().filter(|(_, spot)| spot.ends > 0) {
                    let (column, row) = (tile_column * SIDE + place % SIDE, tile_row * SIDE + place / SIDE);
                    if columns.contains(&column) && rows.contains(&row) {
                        let at = |k: usize, index: usize| {
                            self.spec.origin_m[k] + self.spec.cell_m * (index as f64 + f64::from(spot.mean[k]))
                        };
                        take(column, row, [at(0, column), at(1, row)]);
                    }
                }
            }
        }
    }

    /// Memory, bytes: of a tile that several share, each holds its share.
    pub fn bytes(&self) -> usize {
        let tile = size_of::<[Spot; SIDE * SIDE]>() + 2 * size_of::<usize>();
        let shares = self.tiles.iter().flatten().map(|shared| tile / Arc::strong_count(shared));
        self.tiles.capacity() * size_of::<Option<Arc<[Spot; SIDE * SIDE]>>>() + shares.sum::<usize>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    type Lists = BTreeMap<(usize, usize), Vec<[f64; 2]>>;

    fn all(surfaces: &Surfaces) -> BTreeMap<(usize, usize), [f64; 2]> {
        let mut found = BTreeMap::new();
        surfaces.each(0..usize::MAX, 0..usize::MAX, |column, row, at| {
            found.insert((column, row), at);
        });
        found
    }

    proptest! {
        #[test]
        fn they_are_the_means_of_lists_and_copies_go_on_by_themselves(
            ends in prop::collection::vec((-0.5f64..4.0, -0.5f64..3.0, any::<bool>()), 1..80),
        ) {
            let spec = GridSpec { cell_m: 0.1, origin_m: [-0.2, 0.1], width: 37, height: 25 };
            let mut lists: [Lists; 2] = Default::default();
            let mut kept = Surfaces::new(spec);
            let mut copy = None::<Surfaces>;
            for (k, (x, y, to_copy)) in ends.iter().enumerate() {
                if k == ends.len() / 2 {
                    (copy, lists[1]) = (Some(kept.clone()), lists[0].clone());
                }
                let which = usize::from(*to_copy && copy.is_some());
                if let Some(cell) = spec.locate([*x, *y]) {
                    lists[which].entry(spec.column_row(cell)).or_default().push([*x, *y]);
                }
                if which == 1 { copy.as_mut().expect("made").add([*x, *y]) } else { kept.add([*x, *y]) }
            }
            for (surfaces, lists) in [Some(&kept), copy.as_ref()].into_iter().flatten().zip(&lists) {
                let found = all(surfaces);
                prop_assert_eq!(found.keys().collect::<Vec<_>>(), lists.keys().collect::<Vec<_>>());
                for (cell, list) in lists {
                    for k in 0..2 {
                        let mean = list.iter().map(|at| at[k]).sum::<f64>() / list.len() as f64;
                        prop_assert!((found[cell][k] - mean).abs() < 1e-5);
                    }
                }
            }
        }
    }
}
