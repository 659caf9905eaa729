//! Patches in which a reading can move nothing: rays leap over them.
//!
//! Up to some range before its reading, the likelihood `c` of a kernel is the same for all chords. Whatever is hit there, a cell
//! has the posterior `P'(E) = P(E) c / Z`, so that one of at most [`SETTLED`] moves by no more than that, as long as `c` is not
//! more than the evidence `Z`. What lies farther learns from such cells only how likely the ray was to pass: by the hazard of
//! each, of which a patch knows the mean, and a [square](super::squares) that of its patches.

use sensor::lanes::{LANES, Lanes, each};
use sensor::{Ray, ReadingKernel};

use crate::fast::budget::{LEAPT, SETTLED};
use crate::fast::inputs::Inputs;
use crate::fast::map::Map;
use crate::fast::passage::Passage;
use crate::fast::squares::Squares;
use crate::fast::tiles::{SIDE, SQUARE_SIDE};
use crate::fast::walk::{Crossing, Place, Walk};

/// Fewer cells are not worth it.
const FEWEST: u32 = 2 * SIDE as u32;

/// Cells that a ray has leapt over.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leap {
    /// The cell behind them, still in a settled patch.
    pub(super) landing: Place,
    /// Their number.
    pub(super) cells: u32,
    /// Sum of their `P(E_{j+1} | not E_j)`.
    pub(super) hazard: f32,
}

/// The leap from a cell over settled patches, and squares of them, up to a range (m) that the last of them does not exceed; none over few cells.
pub(super) fn leap(map: &Map, squares: Option<&Squares>, ray: &Ray, from: Place, until_m: f64) -> Option<Leap> {
    let (mut cells, mut hazard, mut landing) = (0, 0.0f32, from);
    let mut walk = Walk::new(&map.numbering, ray.origin_m, ray.direction, from);
    loop {
        let at = walk.place.at;
        let within = |crossing: Crossing| Some((crossing, crossing.next.filter(|_| crossing.exit <= until_m)?));
        let of_square = squares.and_then(|squares| squares.settled(at));
        let wide = of_square.and_then(|square| Some((square.onset, within(walk.crossing::<SQUARE_SIDE>())?)));
        let narrow = || {
            let patch = map.summary(map.numbering.at(at));
            Some((patch.onset, within((patch.most <= SETTLED).then(|| walk.crossing::<SIDE>())?)?))
        };
        let Some((onset, (crossing, next))) = wide.or_else(narrow) else { break };
        cells += crossing.cells;
        hazard += crossing.cells as f32 * onset;
        landing = crossing.last;
        walk.place = next;
    }
    (cells >= FEWEST).then(|| Leap { landing, cells: cells - 1, hazard })
}

/// Where rays may leap, and have leapt.
#[derive(Default)]
pub(super) struct Leaps {
    /// Ranges between which the likelihood is flat, m.
    pub(super) flat_m: Lanes<[f64; 2]>,
    /// The likelihood there.
    pub(super) likelihood: Lanes<f32>,
    /// Probability that a ray ends in cells leapt over.
    pub(super) hit: Lanes<f32>,
    /// Their number.
    pub(super) cells: Lanes<u32>,
    /// The cells leapt over by rays of these lanes.
    pub(super) passages: Vec<(usize, Passage)>,
}

impl Leaps {
    /// Rays with these readings, on their starts; none may leap where that is not `wanted`.
    pub(super) fn start(&mut self, inputs: &Inputs, kernel: &dyn ReadingKernel, wanted: bool) {
        self.passages.clear();
        (self.hit, self.cells, self.flat_m) = ([0.0; LANES], [0; LANES], [[0.0; 2]; LANES]);
        if !wanted || inputs.others.is_some() {
            return;
        }
        self.flat_m = std::array::from_fn(|l| kernel.constant_between(l));
        let middle = each(|l| {
            let [from_m, until_m] = self.flat_m[l];
            if from_m < until_m { 0.5 * (from_m + until_m.min(from_m + 1.0)) } else { 0.0 }
        });
        let mut likelihood = [[0.0; LANES]];
        kernel.likelihood(&[middle; 2], &mut likelihood);
        [self.likelihood] = likelihood;
    }

    /// Whether what a ray leapt over was as good as settled, given the evidence for its reading.
    pub(super) fn hold(&self, l: usize, evidence: f32) -> bool {
        self.cells[l] == 0 || self.likelihood[l] <= evidence && self.hit[l] * self.likelihood[l] <= LEAPT * evidence
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::prior::Continuity;
    use crate::fast::tiles::{PATCH, TILE, split};
    use crate::model::Model;
    use grid::GridSpec;
    use proptest::prelude::*;
    use sensor::Stereo;
    use std::sync::Arc;

    /// A map of 3 x 2 squares, the last of them cut off by the border, of which all is settled but one cell.
    fn settled(seen: [usize; 2]) -> (Map, Squares) {
        let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 320, height: 200 };
        let mut map = Map::unseen(&Model::new(grid, Arc::new(Stereo::default())));
        for row in 0..grid.height {
            for column in 0..grid.width {
                let number = map.numbering.number(column, row);
                let p = if [column, row] == seen { 0.5 } else { 1e-6 * (1 + (column + row) % 3) as f32 };
                let (tile, place) = split(number);
                let tile = map.make(tile);
                (tile.occupied[place], tile.both[0][place], tile.both[1][place]) = (p, 0.0, 0.0);
            }
        }
        let patches = (0..map.numbering.tiles() * TILE / PATCH).map(|patch| (patch * PATCH) as u32);
        patches.for_each(|cell| map.summarise_patch(cell, Continuity::Kept));
        let mut squares = Squares::unseen(&map);
        assert!([[0, 0], [200, 100], [319, 199]].iter().all(|at| squares.settled(*at).is_none()), "unseen");
        squares.summarise(&map, &[0, 1, 2, 3, 4, 5]);
        (map, squares)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]
        /// Over squares, a leap has the cells and the landing of one over patches, and a hazard that is a mean as well.
        #[test]
        fn squares_are_patches(
            x in 0.0f64..16.0, y in 0.0f64..10.0, angle in -4.0f64..4.0, until_m in 0.0f64..20.0,
            column in 0usize..320, row in 0usize..200,
        ) {
            let (map, squares) = settled([column, row]);
            let (square, whole) = (map.numbering.square_of(map.numbering.number(column, row)), squares.settled([0, 0]));
            prop_assert_eq!(whole.is_none(), square == 0);
            let ray = Ray { origin_m: [x, y], direction: [angle.cos(), angle.sin()], bearing_rad: 0.0, reading: None };
            let from = Place { at: [(x / 0.05) as u32, (y / 0.05) as u32], entered: 0.0 };
            let [wide, narrow] = [Some(&squares), None].map(|squares| leap(&map, squares, &ray, from, until_m));
            prop_assert_eq!(wide.map(|leap| (leap.landing, leap.cells)), narrow.map(|leap| (leap.landing, leap.cells)));
            if let (Some(wide), Some(narrow)) = (wide, narrow) {
                prop_assert!((wide.hazard / narrow.hazard - 1.0).abs() < 0.02, "{} {}", wide.hazard, narrow.hazard);
            }
        }
    }
}
