//! Ground truth: which cells are really occupied.

use grid::{GridSpec, Raster};

use crate::geometry::{distance, outline_contains, segment_meets_rectangle, sides};
use crate::{Drive, Obstacle, Scene, Shape};

/// Cells are tested this much smaller on every side, m: what only touches a cell does not occupy it.
const TOUCH_M: f64 = 1e-9;

/// The occupied cells of a scene, rastered from its shapes.
///
/// A cell is occupied, `Some(true)`, if an obstacle covers any part of it, however small; touching
/// its side is not covering. Other cells are `Some(false)`, or `None` where the scene comes from a
/// map that does not know the cell's centre: nobody can score what is there.
pub fn truth(scene: &Scene) -> Raster<Option<bool>> {
    let mut truth = free(scene);
    for obstacle in &scene.obstacles {
        occupy(&mut truth, &obstacle.shape);
    }
    truth
}

/// The cells of which moving things cover any part at a scan of a drive, counted from 0, by the rule of [`truth`].
///
/// What is occupied at that moment is what is occupied in `truth` or covered here.
///
/// # Panics
/// If there is no such scan.
pub fn covered_at(scene: &Scene, drive: &Drive, scan: usize) -> Raster<bool> {
    assert!(scan < drive.poses.len(), "scan {scan} of {}", drive.poses.len());
    let mut covered = Raster::filled(scene.grid, false);
    if !drive.motion.is_empty() {
        for (_, shape) in drive.motion.shapes_at(scan) {
            set_covered(&mut covered, shape, true);
        }
    }
    covered
}

/// The cells whose centres an obstacle covers, and which are known, as in [`truth`].
///
/// This samples the world: the occupied share and the correlation of cells are the world's own at any cell
/// size, while in [`truth`] obstacles grow with the cells.
pub fn truth_at_centres(scene: &Scene) -> Raster<Option<bool>> {
    let mut truth = free(scene);
    for Obstacle { shape, .. } in &scene.obstacles {
        let [columns, rows] = span(&scene.grid, shape);
        for cell in rows.flat_map(|row| columns.clone().map(move |column| scene.grid.index(column, row))) {
            if shape.distance_m(scene.grid.centre(cell)) <= 0.0 {
                truth[cell] = Some(true);
            }
        }
    }
    truth
}

/// Every cell free, or not known.
fn free(scene: &Scene) -> Raster<Option<bool>> {
    let mut truth = Raster::filled(scene.grid, Some(false));
    if let Some(known) = &scene.known {
        for cell in 0..scene.grid.cells() {
            let there = known.spec().locate(scene.grid.centre(cell));
            if !there.is_some_and(|there| known[there]) {
                truth[cell] = None;
            }
        }
    }
    truth
}

/// Sets the cells that a shape covers.
pub(crate) fn occupy(truth: &mut Raster<Option<bool>>, shape: &Shape) {
    set_covered(truth, shape, Some(true));
}

/// Sets the cells that a shape covers to a value.
fn set_covered<T: Copy>(raster: &mut Raster<T>, shape: &Shape, value: T) {
    let spec = *raster.spec();
    let corners = shape.corners_m();
    let [columns, rows] = span(&spec, shape);
    for row in rows {
        for column in columns.clone() {
            let cell = spec.index(column, row);
            let min = spec.corner(cell).map(|v| v + TOUCH_M);
            let max = spec.corner(cell).map(|v| v + spec.cell_m - TOUCH_M);
            if covers(shape, &corners, min, max) {
                raster[cell] = value;
            }
        }
    }
}

/// Columns and rows of the cells that the shape's extent meets.
fn span(spec: &GridSpec, shape: &Shape) -> [std::ops::Range<usize>; 2] {
    let [low, high] = shape.extent_m();
    [0, 1].map(|k| {
        let limit = [spec.width, spec.height][k] as f64;
        let at = |v: f64| ((v - spec.origin_m[k]) / spec.cell_m).floor();
        // One cell more on either side: rounding may put a border one cell off.
        let from = (at(low[k]) - 1.0).clamp(0.0, limit);
        let to = (at(high[k]) + 2.0).clamp(0.0, limit);
        from as usize..to as usize
    })
}

/// Whether a shape has a point in the rectangle from `min` to `max`, exactly but for rounding.
fn covers(shape: &Shape, corners: &[[f64; 2]], min: [f64; 2], max: [f64; 2]) -> bool {
    match shape {
        Shape::Disc { center_m, radius_m } => {
            let nearest = [0, 1].map(|k| center_m[k].clamp(min[k], max[k]));
            distance(nearest, *center_m) < *radius_m
        }
        // Either the outline enters the rectangle, or it goes round it, or it stays clear of it.
        Shape::Box { .. } | Shape::Polygon { .. } => {
            sides(corners).any(|(a, b)| segment_meets_rectangle(a, b, min, max)) || outline_contains(corners, min)
        }
    }
}

#[cfg(test)]
mod tests;
