//! Where a disc fits between cells, exactly for square cells.

use crate::{GridSpec, Raster};

/// Taken off the distance that centres keep, in cells, so that rounding refuses none that is just wide enough.
pub const ROUNDING: f64 = 1e-6;

/// The cells whose centres keep `needed_m` from every cell of `solid` and from the border, to [`ROUNDING`]: where a
/// disc of that radius, above 0, stands clear. O(cells).
///
/// The distance to solid cells along each column comes first, then every row is a union of intervals.
pub fn clear(solid: &Raster<bool>, needed_m: f64) -> Raster<bool> {
    let spec = *solid.spec();
    let GridSpec { width, .. } = spec;
    let needed = needed_m / spec.cell_m;
    let steps = to_solid_along_columns(solid);
    let reach = |steps: u32| disc_reach(needed, f64::from(steps));
    let beside = reach(0).unwrap_or(0);
    let mut clear = Raster::filled(spec, false);
    let mut change = vec![0i64; width + 1];
    for (steps, clear) in steps.chunks_exact(width).zip(clear.values_mut().chunks_exact_mut(width)) {
        change.fill(0);
        let mut block = |from: usize, to: usize| {
            change[from.min(width)] += 1;
            change[to.min(width)] -= 1;
        };
        block(0, beside);
        block(width.saturating_sub(beside), width);
        for (column, &steps) in steps.iter().enumerate() {
            if let Some(reach) = reach(steps) {
                block(column.saturating_sub(reach), (column + 1).saturating_add(reach));
            }
        }
        let mut over = 0;
        for (clear, change) in clear.iter_mut().zip(&change) {
            over += change;
            *clear = over == 0;
        }
    }
    clear
}

/// How many columns to either side a disc about the centre of a cell covers a part of, in the row so many `rows` above or below, to
/// [`ROUNDING`]; none where it ends before. `radius` in cells.
pub fn disc_reach(radius: f64, rows: f64) -> Option<usize> {
    let gap = (rows - 0.5).max(0.0);
    (gap < radius).then(|| ((0.5 + (radius * radius - gap * gap).sqrt() - ROUNDING).ceil() - 1.0) as usize)
}

/// Steps from every cell to the nearest solid one of its column, or to the border.
fn to_solid_along_columns(solid: &Raster<bool>) -> Vec<u32> {
    let GridSpec { width, height, .. } = *solid.spec();
    let mut steps = vec![0u32; solid.values().len()];
    let mut nearest = vec![0u32; width];
    for row in 0..height {
        for (column, nearest) in nearest.iter_mut().enumerate() {
            let cell = row * width + column;
            *nearest = if solid[cell] { 0 } else { *nearest + 1 };
            steps[cell] = *nearest;
        }
    }
    nearest.fill(0);
    for row in (0..height).rev() {
        for (column, nearest) in nearest.iter_mut().enumerate() {
            let cell = row * width + column;
            *nearest = if solid[cell] { 0 } else { *nearest + 1 };
            steps[cell] = steps[cell].min(*nearest);
        }
    }
    steps
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The least distance of a cell's centre to a solid cell or the border, in cells, by looking at all of them.
    fn room(solid: &Raster<bool>, cell: usize) -> f64 {
        let spec = solid.spec();
        let at = |cell| <[usize; 2]>::from(spec.column_row(cell)).map(|v| v as f64);
        let [x, y] = at(cell);
        let border =
            [x, y, spec.width as f64 - 1.0 - x, spec.height as f64 - 1.0 - y].into_iter().fold(f64::MAX, f64::min);
        let gap = |other: usize| {
            let [dx, dy] = [0, 1].map(|k| ((at(other)[k] - at(cell)[k]).abs() - 0.5).max(0.0));
            libm::hypot(dx, dy)
        };
        (0..spec.cells()).filter(|&other| solid[other]).map(gap).fold(border + 0.5, f64::min)
    }

    proptest! {
        #[test]
        fn it_is_what_looking_at_every_pair_of_cells_finds(
            (width, solid) in (1usize..14, 1usize..14).prop_flat_map(|(width, height)| {
                (Just(width), prop::collection::vec(prop::bool::weighted(0.08), width * height))
            }),
            needed in 0.01f64..4.0,
            cell_m in prop::sample::select(vec![0.05, 1.0, 3.0]),
        ) {
            let spec = GridSpec { cell_m, origin_m: [-2.0, 0.7], width, height: solid.len() / width };
            let solid = Raster::new(spec, solid);
            let clear = clear(&solid, needed * cell_m);
            for cell in 0..spec.cells() {
                let room = room(&solid, cell);
                prop_assume!((room - needed).abs() > 2.0 * ROUNDING);
                prop_assert_eq!(clear[cell], room > needed, "cell {} has {}", cell, room);
            }
        }
    }

    #[test]
    fn just_wide_enough_is_enough() {
        let spec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: 3, height: 3 };
        let open = Raster::filled(spec, false);
        let fits = |needed_m| clear(&open, needed_m).values().iter().filter(|clear| **clear).count();
        assert_eq!([0.05, 0.0501, 0.15, 0.1501].map(fits), [9, 1, 1, 0]);
    }
}
