//! Worlds made to have a given prior.

use grid::{GridSpec, Raster};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;

/// A mosaic whose rows and columns are two-state Markov chains with occupied share `occupancy` and
/// `correlation` between neighbouring cells: exactly the law `c(d) = exp(-d / l)`.
///
/// Lines across the whole map part neighbouring columns, and neighbouring rows, with probability `1 - correlation` each; every
/// rectangle between lines is occupied with probability `occupancy`. Two cells of a row are alike if no
/// line parts them, and independent otherwise. A map one cell high is the Markov chain itself.
pub(crate) fn mosaic(spec: GridSpec, occupancy: f64, correlation: f64, seed: u64) -> Raster<Option<bool>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let [columns, rows] = [spec.width, spec.height].map(|cells| {
        let mut part = 0;
        let parts: Vec<usize> = (0..cells)
            .map(|cell| {
                part += usize::from(cell > 0 && rng.random::<f64>() >= correlation);
                part
            })
            .collect();
        parts
    });
    let across = columns.last().map_or(0, |last| last + 1);
    let up = rows.last().map_or(0, |last| last + 1);
    let filled: Vec<bool> = (0..across * up).map(|_| rng.random::<f64>() < occupancy).collect();
    let cell = |index| {
        let (column, row) = spec.column_row(index);
        Some(filled[rows[row] * across + columns[column]])
    };
    Raster::new(spec, (0..spec.cells()).map(cell).collect())
}
