//! The tiles that a scan may move.

use sensor::Ray;

use crate::fast::tiles::Numbering;
use crate::memory::Held;

/// The tiles that rays cross, and those beside them, since a scan moves the edges to these too; in the order of their numbers.
#[derive(Debug, Clone, Default)]
pub(super) struct Reached {
    tiles: Vec<usize>,
    /// Of every tile of the map, whether it is among them.
    is_among: Vec<bool>,
}

impl Reached {
    /// The tiles.
    pub(super) fn tiles(&self) -> &[usize] {
        &self.tiles
    }

    /// The tiles of other rays.
    pub(super) fn renew(&mut self, numbering: &Numbering, rays: impl Iterator<Item = Ray>) {
        self.is_among.resize(numbering.tiles(), false);
        self.tiles.drain(..).for_each(|tile| self.is_among[tile] = false);
        rays.for_each(|ray| self.cross(numbering, &ray));
        for number in 0..self.tiles.len() {
            numbering.beside(self.tiles[number]).into_iter().flatten().for_each(|tile| self.add(tile));
        }
        self.tiles.sort_unstable();
    }

    fn add(&mut self, tile: usize) {
        if !std::mem::replace(&mut self.is_among[tile], true) {
            self.tiles.push(tile);
        }
    }

    /// Adds the tiles that a ray crosses (Amanatides and Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", 1987). Where it touches
    /// the corner of a tile, rounding may leave that out: of its cells it can move the one in the corner alone, which lies between
    /// tiles that it crosses, and it is beside these.
    fn cross(&mut self, numbering: &Numbering, ray: &Ray) {
        let Some(start) = numbering.spec().locate(ray.origin_m) else { return };
        let (column, row) = numbering.spec().column_row(start);
        let mut at = numbering.tile_of([column, row]);
        let tiles = numbering.size();
        let axes = [0, 1].map(|k| {
            let (side, direction) = (numbering.side_m(), ray.direction[k]);
            let behind = at[k] + usize::from(direction > 0.0);
            let border = numbering.spec().origin_m[k] + behind as f64 * side;
            match direction == 0.0 {
                true => [f64::INFINITY, f64::INFINITY],
                false => [(border - ray.origin_m[k]) / direction, side / direction.abs()],
            }
        });
        let mut ranges = axes.map(|[first, _]| first);
        loop {
            self.add(at[1] * tiles[0] + at[0]);
            let k = usize::from(ranges[1] < ranges[0]);
            ranges[k] += axes[k][1];
            at[k] = if ray.direction[k] > 0.0 { at[k] + 1 } else { at[k].wrapping_sub(1) };
            if at[k] >= tiles[k] {
                return;
            }
        }
    }
}

impl Held for Reached {
    fn held(&self) -> usize {
        self.tiles.held() + self.is_among.held()
    }
}

#[cfg(test)]
mod tests {
    use grid::GridSpec;
    use proptest::prelude::*;

    use super::*;
    use crate::fast::tiles::{SIDE, split};
    use crate::fast::walk::{Place, Walk};

    proptest! {
        /// Of every cell on a ray, the tile and those of its neighbours.
        #[test]
        fn all_tiles_are_there_in_which_a_ray_or_an_edge_of_it_lies(
            size in prop::array::uniform2(1usize..200), from in prop::array::uniform2(0.0f64..1.0), turns in prop::collection::vec(0i32..64, 1..5),
        ) {
            let spec = GridSpec { cell_m: 0.5, origin_m: [-1.0, 2.0], width: size[0], height: size[1] };
            let numbering = Numbering::new(spec);
            // Some through corners of tiles.
            let snapped = |k: usize| spec.origin_m[k] + (from[k] * 4.0).round() / 4.0 * (size[k] - 1) as f64 * 0.5;
            let origin_m = [0, 1].map(snapped);
            let ray = |turn: &i32| {
                let bearing_rad = f64::from(*turn) * std::f64::consts::TAU / 64.0;
                Ray { origin_m, direction: [bearing_rad.cos(), bearing_rad.sin()], bearing_rad, reading: None }
            };
            let rays: Vec<Ray> = turns.iter().map(ray).collect();
            let mut reached = Reached::default();
            reached.renew(&numbering, rays[..1].iter().copied());
            reached.renew(&numbering, rays.iter().copied());
            let tiles = reached.tiles();
            prop_assert!(tiles.is_sorted() && tiles.iter().all(|tile| *tile < numbering.tiles()));
            for ray in &rays {
                let start = spec.column_row(spec.locate(ray.origin_m).expect("inside"));
                let mut walk = Walk::new(&numbering, ray.origin_m, ray.direction, Place { at: [start.0 as u32, start.1 as u32], entered: 0.0 });
                loop {
                    let crossing = walk.crossing::<SIDE>();
                    for at in [walk.place.at, crossing.last.at] {
                        let cell = numbering.at(at);
                        let beside = (0..2).flat_map(|axis| [numbering.after(cell, axis), numbering.before(cell, axis)]);
                        for cell in beside.flatten().chain([cell]) {
                            prop_assert!(tiles.binary_search(&split(cell).0).is_ok(), "{at:?}");
                        }
                    }
                    let Some(next) = crossing.next else { break };
                    walk.place = next;
                }
            }
        }
    }
}
