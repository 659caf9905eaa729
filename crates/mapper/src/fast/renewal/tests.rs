use super::*;
use crate::belief::renewal::Place as Belief;
use crate::fast::bounds::{bounded, possible};
use crate::fast::tiles::split;
use crate::model::Model;
use crate::pairs::joint::{Joint, bounds};
use crate::pairs::renewal::both_after;
use proptest::prelude::*;
use sensor::Stereo;
use std::sync::Arc;

/// A map of random beliefs, of which some tiles stand at an earlier time than others.
fn random(map: &mut Map, changes: &mut Changes, value: &mut impl FnMut() -> f64) {
    for tile in 0..map.numbering.tiles() {
        let (cells, shares) = (map.make(tile), changes.shares.make(tile));
        shares.at_s = (3.0 * value()).floor();
        changes.passing.places[tile] = STANDS;
        for place in 0..TILE {
            cells.occupied[place] = bounded(value() as f32);
            for x in 0..2 {
                let [second, third] = [0.5 * value(), 0.5 * value()];
                shares.of[x][0][place] = (second * f64::from(UNITS)) as u16;
                shares.of[x][1][place] = (third * f64::from(UNITS)) as u16;
            }
        }
    }
    for cell in 0..map.numbering.tiles() as u32 * TILE as u32 {
        for axis in 0..2 {
            let Some(other) = map.numbering.after(cell, axis) else { continue };
            let (low, high) = bounds(map.occupied(cell).into(), map.occupied(other).into());
            let (tile, place) = split(cell);
            let both = possible(map.occupied(cell), map.occupied(other), (low + value() * (high - low)) as f32);
            map.make(tile).both[axis][place] = both;
        }
    }
}

fn belief(map: &Map, changes: &Changes, cell: u32) -> Belief {
    let (tile, place) = split(cell);
    let kinds = changes.shares.at(tile).of.map(|of| {
        let [second, third] = of.map(|share| f64::from(share[place]) / f64::from(UNITS));
        [1.0 - second - third, second, third]
    });
    Belief { occupied: map.occupied(cell).into(), kinds }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn every_place_and_edge_is_that_of_double_precision(
        seed: u64, size in prop::array::uniform2(1usize..40), occupancy in 0.01f64..0.6, rate in 0.0f64..3.0, now_s in 0.0f64..9.0,
    ) {
        let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: size[0], height: size[1] };
        let mut model = Model::new(grid, Arc::new(Stereo::default()));
        model.prior.occupancy = occupancy;
        let renewal = Renewal { rates_per_s: [0.01, 0.1, rate], shares: [0.7, 0.2, 0.1], turnover_per_s: 0.05, step_s: 0.0 };
        let mut map = Map::unseen(&model);
        let mut changes = Changes::new(&map, renewal);
        let mut state = seed;
        let mut value = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        random(&mut map, &mut changes, &mut value);
        let (before, standing) = (map.clone(), changes.clone());
        changes.now_s = Some(now_s);
        let read = changes.marginals(&map, [0, 0], grid);
        changes.pass_everywhere(&mut map);
        let prior = map.of_unseen().map(f64::from);
        let elapsed = |cell: u32| renewal.over(now_s - standing.shares.at(split(cell).0).at_s);
        for cell in (0..grid.cells()).map(|cell| map.numbering.of(cell)) {
            let was = belief(&before, &standing, cell);
            let expected = elapsed(cell).place(&was, prior[0]);
            let found = belief(&map, &changes, cell);
            let [column, row] = map.numbering.column_row(cell);
            prop_assert!((found.occupied - expected.occupied).abs() < 2e-6);
            prop_assert_eq!(read[grid.index(column, row)].to_bits(), found.occupied.to_bits());
            let rest = found.kinds.iter().flatten().zip(expected.kinds.iter().flatten());
            prop_assert!(rest.clone().all(|(a, b)| (a - b).abs() < 4e-5), "{found:?} {expected:?}");
            for axis in 0..2 {
                let Some(other) = map.numbering.after(cell, axis) else { continue };
                let to = belief(&before, &standing, other);
                let joint = Joint::new(was.occupied, to.occupied, before.both(cell, axis).into());
                let survival = [(cell, was), (other, to)].map(|(cell, of)| of.kinds.map(|k| elapsed(cell).survival(&k)));
                let expected = both_after(&joint, survival, prior[0], prior[1]);
                let found = f64::from(map.both(cell, axis));
                prop_assert!((found - expected).abs() < 4e-6, "{found} {expected}");
            }
        }
    }
}
