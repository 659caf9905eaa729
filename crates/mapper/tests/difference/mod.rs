//! How far two maps are apart.

use mapper::PairwiseGrid;

/// Largest difference of any marginal or joint.
pub(crate) fn difference(a: &PairwiseGrid, b: &PairwiseGrid) -> f64 {
    let spec = *a.spec();
    let mut largest = 0.0f64;
    for cell in 0..spec.cells() {
        for n in spec.neighbours(cell) {
            let (x, y) = (a.joint(cell, n.cell), b.joint(cell, n.cell));
            for (x, y) in [(x.ee, y.ee), (x.ef, y.ef), (x.fe, y.fe), (x.ff, y.ff)] {
                largest = largest.max((x - y).abs());
            }
        }
        largest = largest.max((a.marginals()[cell] - b.marginals()[cell]).abs());
    }
    largest
}
