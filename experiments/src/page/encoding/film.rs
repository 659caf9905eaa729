//! Rasters of bytes, one after the other: what changes from one to the next, where, and by how much.

use super::coder::{Coder, Decoder, Encoder, Model};
use super::number::Numbers;

/// Parts of the range of values that are told apart when a change is guessed.
const ZONES: usize = 8;

/// Longest change, bits.
const LENGTH: usize = 8;

/// The rasters of a film.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    /// Cells in a row.
    pub(super) width: usize,
    /// Cells of a raster.
    pub(super) cells: usize,
    /// Number of values, at most 256.
    pub(super) values: usize,
    /// What every cell is before the first raster.
    pub(super) start: u8,
}

/// The rasters as bytes.
pub(super) fn packed(frames: &[Vec<u8>], shape: Shape) -> Vec<u8> {
    let mut encoder = Encoder::new();
    film(&mut encoder, &mut frames.to_vec(), shape);
    encoder.finish()
}

/// The rasters that were packed.
pub(super) fn unpacked(bytes: &[u8], frames: usize, shape: Shape) -> Vec<Vec<u8>> {
    let mut film_of = vec![vec![shape.start; shape.cells]; frames];
    film(&mut Decoder::new(bytes), &mut film_of, shape);
    film_of
}

/// What is known of a cell's changes so far.
#[derive(Debug, Clone, Copy, Default)]
struct Change {
    /// Whether it changed in the raster that is coded, and in the one before.
    now: bool,
    before: bool,
    /// How it changed last: not yet, up, down.
    last: usize,
}

struct Models {
    bounds: Numbers,
    changes: [[Model; ZONES]; 16],
    down: [[Model; 3]; ZONES],
    longer: [[Model; LENGTH]; 2],
    bits: [[Model; LENGTH]; LENGTH],
}

fn film(coder: &mut impl Coder, frames: &mut [Vec<u8>], shape: Shape) {
    let model = Model::default();
    let mut models = Models {
        bounds: Numbers::default(),
        changes: [[model; ZONES]; 16],
        down: [[model; 3]; ZONES],
        longer: [[model; LENGTH]; 2],
        bits: [[model; LENGTH]; LENGTH],
    };
    let mut former = vec![shape.start; shape.cells];
    let mut changes = vec![Change::default(); shape.cells];
    for frame in frames {
        let bounds = bounds(frame, &former, shape.width).map(|bound| models.bounds.code(coder, bound as i32) as usize);
        let [left, right, bottom, top] = bounds;
        for change in &mut changes {
            (change.before, change.now) = (change.now, false);
        }
        for row in bottom..top {
            for column in left..right {
                let cell = row * shape.width + column;
                let was = former[cell];
                frame[cell] = models.cell(coder, &mut changes, cell, column, shape, (was, frame[cell]));
                former[cell] = frame[cell];
            }
        }
        frame.copy_from_slice(&former);
    }
}

/// The rectangle that holds all changes: first column, column behind the last, and the same of rows. Of a raster without
/// any, nothing.
fn bounds(frame: &[u8], former: &[u8], width: usize) -> [usize; 4] {
    let mut found: Option<[usize; 4]> = None;
    for cell in (0..frame.len()).filter(|cell| frame[*cell] != former[*cell]) {
        let (column, row) = (cell % width, cell / width);
        let [left, right, bottom, _] = found.unwrap_or([column, column, row, row]);
        found = Some([left.min(column), right.max(column + 1), bottom, row + 1]);
    }
    found.unwrap_or_default()
}

impl Models {
    /// Codes a cell that was one value and is another.
    fn cell(
        &mut self,
        coder: &mut impl Coder,
        changes: &mut [Change],
        cell: usize,
        column: usize,
        shape: Shape,
        (was, is): (u8, u8),
    ) -> u8 {
        let zone = usize::from(was) * ZONES / shape.values;
        let now = |cell: usize| usize::from(changes[cell].now);
        let left = if column > 0 { now(cell - 1) } else { 0 };
        let below = if cell >= shape.width { now(cell - shape.width) } else { 0 };
        let side = if cell >= shape.width && column + 1 < shape.width { now(cell - shape.width + 1) } else { 0 };
        let context = 8 * left + 4 * below + 2 * side + usize::from(changes[cell].before);
        if !coder.bit(&mut self.changes[context][zone], is != was) {
            return was;
        }
        let down = coder.bit(&mut self.down[zone][changes[cell].last], is < was);
        changes[cell] = Change { now: true, last: 1 + usize::from(down), ..changes[cell] };
        let size = u32::from(is.abs_diff(was));
        let told = size.checked_ilog2().unwrap_or(0) as usize;
        let mut length = 0;
        while length + 1 < LENGTH && coder.bit(&mut self.longer[usize::from(down)][length], length < told) {
            length += 1;
        }
        let mut found = 1u32;
        for place in (0..length).rev() {
            found = found << 1 | u32::from(coder.bit(&mut self.bits[length][place], size >> place & 1 == 1));
        }
        if down { was.wrapping_sub(found as u8) } else { was.wrapping_add(found as u8) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn films_come_back(
            (width, frames) in (1usize..6, 1usize..5).prop_flat_map(|(width, rows)| (
                Just(width), prop::collection::vec(prop::collection::vec(any::<u8>(), width * rows), 0..6),
            )),
            start: u8, values in 1usize..=256, still: bool,
        ) {
            let cells = frames.first().map_or(0, Vec::len);
            let shape = Shape { width, cells, values, start: start.min((values - 1) as u8) };
            let value = |v: &u8| (usize::from(*v) % values) as u8;
            let mut frames: Vec<Vec<u8>> = frames.iter().map(|frame| frame.iter().map(value).collect()).collect();
            if still && frames.len() > 1 {
                frames[1] = frames[0].clone();
            }
            prop_assert_eq!(unpacked(&packed(&frames, shape), frames.len(), shape), frames);
        }
    }

    #[test]
    fn what_does_not_change_takes_no_room() {
        let shape = Shape { width: 200, cells: 32_000, values: 181, start: 46 };
        let frames = vec![vec![46u8; 32_000]; 290];
        assert!(packed(&frames, shape).len() < 60);
        let box_of = |k: usize| (0..32_000).map(|cell| 46 + u8::from(cell % 200 < k)).collect::<Vec<u8>>();
        let moving: Vec<Vec<u8>> = (0..200).map(box_of).collect();
        assert!(packed(&moving, shape).len() < 3000);
    }
}
