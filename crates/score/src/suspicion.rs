//! What makes one doubt where a map lies: rows in the wrong order, an origin that is half a cell off.

use grid::{CellsToCells, Frame, NoMemory, Raster};

use crate::align::nudge;

/// Cells that are looked at for a flip, about.
const LOOKS: usize = 200_000;

/// Side of the middle part of the truth in which an offset is looked for, cells.
const PART: usize = 400;

/// A map that errs by less is not taken for flipped, mean squared error.
const GOOD: f64 = 0.01;

/// How near to half a cell an offset must be, cells.
const NEAR: f64 = 0.1;

/// A doubt about where a map lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Suspicion {
    /// The map agrees better upside down, or mirrored.
    Flipped {
        /// Whether its rows run the other way.
        rows: bool,
        /// Whether its columns do.
        columns: bool,
        /// Mean squared error as it is.
        error: f64,
        /// And flipped.
        flipped: f64,
    },
    /// The map lies half a cell off.
    HalfCell {
        /// Columns and rows by which it should be moved, in cells of the truth.
        cells: [f64; 2],
    },
}

/// Looks for the two doubts: a flip that halves the error at least, and an offset of half a cell of the map in either direction or both.
///
/// # Errors
/// Memory that the system does not give.
pub fn suspicion(
    (map, from): (&Raster<Option<f32>>, &Frame),
    (truth, onto): (&Raster<Option<bool>>, &Frame),
) -> Result<Option<Suspicion>, NoMemory> {
    if let Some(flip) = flip(map, &onto.cells_to(from), truth) {
        return Ok(Some(flip));
    }
    let (part, frame) = middle(truth, onto);
    let Some(cells) = nudge((map, from), (&part, &frame))? else { return Ok(None) };
    let half = 0.5 * (from.spec.cell_m / onto.spec.cell_m).min(1.0);
    let is_half = |cells: f64| (cells.abs() - half).abs() < NEAR;
    let plain = |cells: f64| is_half(cells) || cells.abs() < NEAR;
    let off = cells.into_iter().all(plain) && cells.into_iter().any(is_half);
    Ok(off.then_some(Suspicion::HalfCell { cells }))
}

/// The flip that halves the error, if one does.
fn flip(map: &Raster<Option<f32>>, to_map: &CellsToCells, truth: &Raster<Option<bool>>) -> Option<Suspicion> {
    let (spec, known) = (map.spec(), truth.spec());
    let [width, height] = [spec.width as f64, spec.height as f64];
    let at = |[u, v]: [f64; 2]| {
        let inside = u >= 0.0 && v >= 0.0 && u < width && v < height;
        inside.then(|| map[spec.index(u as usize, v as usize)])?
    };
    let (mut sums, mut counts) = ([0.0_f64; 4], [0_usize; 4]);
    // No divisor of a row's length, so that all columns are looked at.
    let step = (known.cells() / LOOKS).max(1);
    let step = if known.width.is_multiple_of(step) && step > 1 { step + 1 } else { step };
    for cell in (0..known.cells()).step_by(step) {
        let Some(occupied) = truth[cell] else { continue };
        let (column, row) = known.column_row(cell);
        let [u, v] = to_map.of([column as f64 + 0.5, row as f64 + 0.5]);
        for (k, point) in [[u, v], [u, height - v], [width - u, v], [width - u, height - v]].into_iter().enumerate() {
            if let Some(share) = at(point) {
                let error = f64::from(share) - f64::from(u8::from(occupied));
                sums[k] += error * error;
                counts[k] += 1;
            }
        }
    }
    let error = |k: usize| if counts[k] > 0 { sums[k] / counts[k] as f64 } else { f64::INFINITY };
    let best = (1..4).min_by(|a, b| error(*a).total_cmp(&error(*b)))?;
    let enough = 2 * counts[best] > counts[0];
    (enough && error(0) > GOOD && error(best) < 0.5 * error(0)).then(|| Suspicion::Flipped {
        rows: best != 2,
        columns: best != 1,
        error: error(0),
        flipped: error(best),
    })
}

/// The middle of a truth that is large.
fn middle(truth: &Raster<Option<bool>>, onto: &Frame) -> (Raster<Option<bool>>, Frame) {
    let spec = truth.spec();
    let size = [spec.width, spec.height].map(|n| n.min(PART));
    let first = [(spec.width - size[0]) / 2, (spec.height - size[1]) / 2];
    let origin_m = onto.to_world(first.map(|n| n as f64));
    let part = grid::GridSpec { origin_m, width: size[0], height: size[1], ..*spec };
    let rows = (first[1]..first[1] + size[1]).map(|row| spec.index(first[0], row));
    let cells = rows.flat_map(|start| &truth.values()[start..start + size[0]]).copied().collect();
    (Raster::new(part, cells), Frame { spec: part, yaw_rad: onto.yaw_rad })
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::GridSpec;

    /// A room with walls and boxes that no mirror leaves as they are.
    fn room() -> (Raster<Option<bool>>, Frame) {
        let spec = GridSpec { cell_m: 0.1, origin_m: [1.0, -2.0], width: 60, height: 40 };
        let occupied = |cell: usize| {
            let (x, y) = spec.column_row(cell);
            let wall = x < 2 || y < 2 || x >= 58 || y >= 38;
            let boxes = [(5..17, 6..30), (30..36, 3..11), (40..55, 25..29)];
            wall || boxes.iter().any(|(columns, rows)| columns.contains(&x) && rows.contains(&y))
        };
        (Raster::new(spec, (0..spec.cells()).map(|cell| Some(occupied(cell))).collect()), Frame::straight(spec))
    }

    fn found(change: impl Fn(usize, usize) -> (usize, usize), shift: [f64; 2]) -> Option<Suspicion> {
        let (truth, onto) = room();
        let spec = onto.spec;
        let cell = |cell: usize| {
            let (column, row) = spec.column_row(cell);
            let (column, row) = change(column, row);
            truth[spec.index(column, row)].map(|occupied| if occupied { 0.9 } else { 0.1 })
        };
        let map = Raster::new(spec, (0..spec.cells()).map(cell).collect());
        let from = onto.moved([0.0; 2], shift.map(|cells| cells * spec.cell_m), 0.0);
        suspicion((&map, &from), (&truth, &onto)).expect("memory")
    }

    #[test]
    fn flips_are_named_and_a_map_as_it_should_be_is_not() {
        assert_eq!(found(|x, y| (x, y), [0.0; 2]), None);
        assert_eq!(found(|x, y| (x, y), [0.2, -0.3]), None);
        for (mirrored, expected) in [
            (found(|x, y| (x, 39 - y), [0.0; 2]), (true, false)),
            (found(|x, y| (59 - x, y), [0.0; 2]), (false, true)),
            (found(|x, y| (59 - x, 39 - y), [0.0; 2]), (true, true)),
        ] {
            match mirrored {
                Some(Suspicion::Flipped { rows, columns, error, flipped }) => {
                    assert_eq!((rows, columns), expected);
                    assert!(flipped < 0.5 * error);
                }
                other => panic!("{other:?}, not {expected:?}"),
            }
        }
    }

    #[test]
    fn half_a_cell_is_named_in_the_direction_to_move() {
        for shift in [[0.5, 0.5], [-0.5, 0.0], [0.0, 0.5]] {
            match found(|x, y| (x, y), shift) {
                Some(Suspicion::HalfCell { cells }) => {
                    assert!((0..2).all(|k| (cells[k] + shift[k]).abs() < 0.1), "{cells:?} {shift:?}");
                }
                other => panic!("{other:?} of {shift:?}"),
            }
        }
    }
}
