//! The cells that a metric runs over.

use grid::Raster;

use crate::ScoreError;
use crate::error::{probabilities, same_cells};

/// One cell that is inside the mask and whose truth is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Judged {
    /// Index of the cell.
    pub(crate) cell: usize,
    /// What the map says: probability of being occupied.
    pub(crate) p: f64,
    /// What is true.
    pub(crate) occupied: bool,
}

/// The cells of `mask` whose truth is known, in index order, without allocation.
pub(crate) fn judged(
    map: &Raster<f64>,
    truth: &Raster<Option<bool>>,
    mask: &Raster<bool>,
) -> Result<impl Iterator<Item = Judged>, ScoreError> {
    same_cells("map", map.spec(), truth.spec())?;
    same_cells("mask", mask.spec(), truth.spec())?;
    probabilities(map)?;
    let cells = map.values().iter().zip(truth.values()).zip(mask.values()).enumerate();
    Ok(cells.filter_map(|(cell, ((&p, &truth), &inside))| {
        let occupied = truth.filter(|_| inside)?;
        Some(Judged { cell, p, occupied })
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::GridSpec;

    #[test]
    fn only_known_cells_inside_the_mask_in_index_order() {
        let spec = GridSpec { cell_m: 1.0, origin_m: [0.0; 2], width: 5, height: 1 };
        let map = Raster::new(spec, vec![0.1, 0.2, 0.3, 0.4, 0.5]);
        let truth = Raster::new(spec, vec![Some(true), None, Some(false), Some(true), Some(false)]);
        let mask = Raster::new(spec, vec![true, true, true, false, true]);
        let cells: Vec<_> = judged(&map, &truth, &mask).expect("valid").map(|j| (j.cell, j.p, j.occupied)).collect();
        assert_eq!(cells, [(0, 0.1, true), (2, 0.3, false), (4, 0.5, false)]);
    }

    #[test]
    fn the_differing_raster_is_named() {
        let spec = GridSpec { cell_m: 1.0, origin_m: [0.0; 2], width: 5, height: 1 };
        let wide = GridSpec { width: 6, ..spec };
        let truth = Raster::filled(spec, Some(true));
        let name = |map: GridSpec, mask: GridSpec| match judged(
            &Raster::filled(map, 0.5),
            &truth,
            &Raster::filled(mask, true),
        ) {
            Err(ScoreError::Geometry { what, .. }) => what,
            _ => "none",
        };
        assert_eq!((name(wide, spec), name(spec, wide), name(spec, spec)), ("map", "mask", "none"));
    }
}
