//! What makes one doubt where a map lies: rows in the wrong order, an origin that is half a cell off.

use grid::{CellsToCells, Frame, NoMemory, Raster};

use crate::align::nudge;

/// Cells that are looked at for a flip, about.
const LOOKS: usize = 200_000;

/// Side of the middle part of the truth in which an offset is looked for, cells.
const PART: usize = 400;

/// A map that errs by less is not taken for flipped, mean squared error.
const GOOD: f64 = 0.01;

/// A flip by which the correlation with the truth grows by as much, to at least [`ALIKE`], is one, however sure the map is.
const GROWS: f64 = 0.1;

/// See [`GROWS`].
const ALIKE: f64 = 0.4;

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

/// Looks for the two doubts: a flip that halves the error at least, or that lessens it and by which map and truth are much more
/// alike; and an offset of half a cell of the map in either direction or both.
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

/// Sums over the cells of which map and truth both know something.
#[derive(Clone, Copy, Default)]
struct Sums {
    cells: f64,
    share: f64,
    occupied: f64,
    both: f64,
    squared_share: f64,
    squared_error: f64,
}

impl Sums {
    fn add(&mut self, share: f64, occupied: bool) {
        let truth = f64::from(u8::from(occupied));
        self.cells += 1.0;
        self.share += share;
        self.occupied += truth;
        self.both += share * truth;
        self.squared_share += share * share;
        self.squared_error += (share - truth) * (share - truth);
    }

    /// Mean squared error; infinite over no cell.
    fn error(&self) -> f64 {
        if self.cells > 0.0 { self.squared_error / self.cells } else { f64::INFINITY }
    }

    /// Pearson's correlation; none where either is the same everywhere.
    fn correlation(&self) -> f64 {
        let n = self.cells;
        let (of_map, of_truth) =
            (n * self.squared_share - self.share * self.share, n * self.occupied - self.occupied * self.occupied);
        let common = n * self.both - self.share * self.occupied;
        if of_map > 1e-9 * n * n && of_truth > 0.0 { common / libm::sqrt(of_map * of_truth) } else { f64::NAN }
    }
}

/// The flip by which the map agrees much better, if one does.
fn flip(map: &Raster<Option<f32>>, to_map: &CellsToCells, truth: &Raster<Option<bool>>) -> Option<Suspicion> {
    let (spec, known) = (map.spec(), truth.spec());
    let [width, height] = [spec.width as f64, spec.height as f64];
    let at = |[u, v]: [f64; 2]| {
        let inside = u >= 0.0 && v >= 0.0 && u < width && v < height;
        inside.then(|| map[spec.index(u as usize, v as usize)])?
    };
    let mut sums = [Sums::default(); 4];
    // No divisor of a row's length, so that all columns are looked at.
    let step = (known.cells() / LOOKS).max(1);
    let step = if known.width.is_multiple_of(step) && step > 1 { step + 1 } else { step };
    for cell in (0..known.cells()).step_by(step) {
        let Some(occupied) = truth[cell] else { continue };
        let (column, row) = known.column_row(cell);
        let [u, v] = to_map.of([column as f64 + 0.5, row as f64 + 0.5]);
        for (k, point) in [[u, v], [u, height - v], [width - u, v], [width - u, height - v]].into_iter().enumerate() {
            if let Some(share) = at(point) {
                sums[k].add(f64::from(share), occupied);
            }
        }
    }
    let error = |k: usize| sums[k].error();
    let best = (1..4).min_by(|a, b| error(*a).total_cmp(&error(*b)))?;
    let enough = 2.0 * sums[best].cells > sums[0].cells && error(0) > GOOD;
    let [as_it_is, flipped] = [0, best].map(|k| sums[k].correlation());
    let alike = error(best) < error(0) && flipped > ALIKE && flipped > as_it_is + GROWS;
    (enough && (alike || error(best) < 0.5 * error(0))).then(|| Suspicion::Flipped {
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

    /// A map of which much is missing, and of which nothing is sure: flipped, its error is not halved.
    fn poor(cell: usize, occupied: bool) -> Option<f32> {
        let lot = cell.wrapping_mul(2_654_435_761) % 97;
        (lot > 30).then(|| if occupied && lot > 50 { 0.55 } else { 0.1 + lot as f32 / 400.0 })
    }

    #[test]
    fn a_flip_of_a_poor_map_is_named_too() {
        let (truth, onto) = room();
        let spec = onto.spec;
        let map = |flipped: bool| {
            let cell = |cell: usize| {
                let (column, row) = spec.column_row(cell);
                let from = if flipped { spec.index(column, spec.height - 1 - row) } else { cell };
                poor(from, truth[from] == Some(true))
            };
            Raster::new(spec, (0..spec.cells()).map(cell).collect())
        };
        assert_eq!(suspicion((&map(false), &onto), (&truth, &onto)).expect("memory"), None);
        match suspicion((&map(true), &onto), (&truth, &onto)).expect("memory") {
            Some(Suspicion::Flipped { rows: true, columns: false, error, flipped }) => {
                assert!(flipped > 0.5 * error && flipped < error, "{flipped} {error}");
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn an_offset_is_not_taken_for_a_flip() {
        let (truth, onto) = room();
        let map = Raster::new(onto.spec, (0..onto.spec.cells()).map(|k| poor(k, truth[k] == Some(true))).collect());
        for k in 0..169 {
            let shift = [k % 13, k / 13].map(|step| 0.1 * f64::from(step - 6) * 1.37);
            let from = onto.moved([0.0; 2], shift, 0.0);
            let found = suspicion((&map, &from), (&truth, &onto)).expect("memory");
            assert!(!matches!(found, Some(Suspicion::Flipped { .. })), "{found:?} {shift:?}");
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
