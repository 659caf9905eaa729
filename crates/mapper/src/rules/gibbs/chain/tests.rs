use std::sync::Arc;

use rand::SeedableRng as _;
use sensor::{Pose, Scan, Stereo};

use super::*;
use crate::model::Model;
use crate::ray::worth::Reading;
use crate::rules::gibbs::field::{BlockField, PATTERNS};
use crate::rules::gibbs::rays::Rays;
use crate::rules::readings::Readings;

/// Rays from everywhere over a map.
fn readings(spec: GridSpec, rays: u32) -> Readings {
    let model = Model::new(spec, Arc::new(Stereo { disparity_sigma: 3.0, ..Stereo::default() }));
    let mut readings = Readings::new(&model);
    for i in 0..rays {
        let turn = f64::from(i);
        let [x, y] = [spec.width, spec.height].map(|cells| 0.5 * spec.cell_m * cells as f64);
        let pose = Pose { x_m: x + 0.9 * x * turn.sin(), y_m: y + 0.9 * y * (1.7 * turn).cos(), theta_rad: 2.4 * turn };
        let reading = 10.0 + 25.0 * (3.1 * turn).sin().abs();
        readings.add(&Scan { sensor: 0, time_s: 0.0, pose, bearings_rad: vec![0.0], readings: vec![Some(reading)] });
    }
    readings
}

/// A field without any symmetry.
fn field() -> BlockField {
    BlockField::new((0..PATTERNS).map(|pattern| 0.7 * (12.9898 * pattern as f64).sin()).collect())
}

const READING: Reading = Reading { weight: 0.6, leak: 0.1 };

/// `ln posterior` from the map alone: first occupied cells are looked for, and blocks cell by cell.
fn log_posterior(spec: &GridSpec, rays: &Rays, field: &BlockField, occupied: &[bool]) -> f64 {
    let first = |ray: usize| rays.span(ray).find(|&entry| occupied[rays.cell(entry)]).unwrap_or(rays.span(ray).end);
    let of_rays: f64 = (0..rays.count()).map(|ray| rays.value(ray, first(ray))).sum();
    let of_blocks = (0..spec.cells()).map(|centre| {
        let (column, row) = spec.column_row(centre);
        let pattern = (0..9).filter(|bit| {
            let x = (column + bit % 3).saturating_sub(1).min(spec.width - 1);
            let y = (row + bit / 3).saturating_sub(1).min(spec.height - 1);
            occupied[spec.index(x, y)]
        });
        field.weight(pattern.map(|bit| 1 << bit).sum())
    });
    of_rays + of_blocks.sum::<f64>()
}

/// Flips, swaps and flips of many cells say what the posterior of the map then is, also after hundreds of them without a recount.
#[test]
fn changes_are_those_of_the_posterior() {
    let spec = GridSpec { cell_m: 0.2, origin_m: [0.0; 2], width: 7, height: 5 };
    let (readings, field) = (readings(spec, 60), field());
    let rays = Rays::new(&readings, spec.cells(), READING);
    let mut walk = Walk::new(spec, &rays, &field, vec![false; spec.cells()]);
    let at = |map: &[bool]| log_posterior(&spec, &rays, &field, map);
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let (mut swaps, mut boxes, mut mixed) = (0, 0, 0);
    for step in 0..3000 {
        let before = at(walk.occupied());
        assert!((walk.log_posterior() - before).abs() < 1e-8, "step {step}");
        let mut map = walk.occupied().to_vec();
        let cell = rng.random_range(0..spec.cells());
        map[cell] ^= true;
        assert!((walk.change(cell) - (at(&map) - before)).abs() < 1e-8, "step {step}: flip");
        let other = beside(&spec, cell, rng.random_range(0..8))
            .filter(|&other| walk.occupied()[other] != walk.occupied()[cell]);
        if let Some(other) = other {
            map[other] ^= true;
            assert!((walk.swap_change(cell, other) - (at(&map) - before)).abs() < 1e-8, "step {step}: swap");
            swaps += 1;
        }
        // Any cells, alike or not, in any order.
        let cells: Vec<usize> = (0..spec.cells()).filter(|_| rng.random::<f64>() < 0.15).collect();
        let mut map = walk.occupied().to_vec();
        cells.iter().for_each(|&cell| map[cell] ^= true);
        assert!((walk.change_of(&cells) - (at(&map) - before)).abs() < 1e-8, "step {step}: {cells:?}");
        let is_alike = cells.iter().all(|&cell| walk.occupied()[cell] == walk.occupied()[cells[0]]);
        *if is_alike { &mut boxes } else { &mut mixed } += 1;
        walk.flip(cell);
    }
    assert!(swaps > 500 && boxes > 100 && mixed > 1000, "{swaps} swaps, {boxes} alike, {mixed} not");
}

/// Probability of going from one map to another by a step that accepts with the chance that a draw is below something.
fn goes(walk: &mut Walk, change: f64, step: impl Fn(&mut Walk, f64)) -> (Vec<bool>, f64) {
    step(walk, 0.0);
    (walk.occupied().to_vec(), libm::exp(change.min(0.0)))
}

/// Every step from every map of 2 x 2 cells is in detailed balance with the posterior, to the last digits.
#[test]
fn every_step_is_in_detailed_balance() {
    let spec = GridSpec { cell_m: 0.5, origin_m: [0.0; 2], width: 2, height: 2 };
    let (readings, field) = (readings(spec, 12), field());
    let rays = Rays::new(&readings, spec.cells(), READING);
    let maps: Vec<Vec<bool>> = (0..16).map(|map| (0..4).map(|cell| map >> cell & 1 == 1).collect()).collect();
    let number = |map: &[bool]| maps.iter().position(|known| known == map).expect("one of all");
    let weights: Vec<f64> = maps.iter().map(|map| log_posterior(&spec, &rays, &field, map).exp()).collect();
    let total: f64 = weights.iter().sum();
    let walk = |map: &[bool]| Walk::new(spec, &rays, &field, map.to_vec());
    let mut steps: Vec<Vec<(usize, f64)>> = Vec::new();
    for cell in 0..4 {
        let flip = |map: &Vec<bool>| {
            let p = occupied(&walk(map), cell);
            let mut other = map.clone();
            other[cell] ^= true;
            (number(&other), if other[cell] { p } else { 1.0 - p })
        };
        steps.push(maps.iter().map(flip).collect());
        for other in (0..4).filter(|other| *other != cell) {
            let swap = |map: &Vec<bool>| {
                let mut walk = walk(map);
                let change = if map[cell] == map[other] { 0.0 } else { walk.swap_change(cell, other) };
                let (to, p) = goes(&mut walk, change, |walk, draw| try_swap(walk, cell, other, draw));
                (number(&to), p)
            };
            steps.push(maps.iter().map(swap).collect());
        }
    }
    for most in [0.5, MOST] {
        for cells in [&[0, 1][..], &[0, 2], &[2, 3], &[0, 1, 2, 3]] {
            let flip = |map: &Vec<bool>| {
                let mut walk = walk(map);
                let change = walk.change_of(cells);
                let (to, p) = goes(&mut walk, change, |walk, draw| try_flip(walk, cells, most, draw));
                (number(&to), p)
            };
            steps.push(maps.iter().map(flip).collect());
        }
    }
    let mut moved = 0;
    for (kind, step) in steps.iter().enumerate() {
        let mut after = [0.0; 16];
        for (from, &(to, p)) in step.iter().enumerate() {
            let (back, q) = step[to];
            moved += usize::from(to != from);
            assert!(to == from || back == from, "step {kind} from {from} comes back");
            assert!((weights[from] * p - weights[to] * q).abs() < 1e-12 * total, "step {kind} from {from} to {to}");
            after[to] += weights[from] * p;
            after[from] += weights[from] * (1.0 - p);
        }
        let worst = after.iter().zip(&weights).map(|(now, was)| (now - was).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-12 * total, "step {kind} leaves the posterior as it is");
    }
    assert!(moved > 150, "{moved}");
}

/// A shift goes one of four ways by chance, and what it does one way the opposite way undoes: all boxes of 3 x 2 cells, whatever may be filled.
#[test]
fn shifts_are_in_detailed_balance() {
    let spec = GridSpec { cell_m: 0.5, origin_m: [0.0; 2], width: 3, height: 2 };
    let (readings, field) = (readings(spec, 12), field());
    let rays = Rays::new(&readings, spec.cells(), READING);
    let maps: Vec<Vec<bool>> = (0..64).map(|map| (0..6).map(|cell| map >> cell & 1 == 1).collect()).collect();
    let number = |map: &[bool]| maps.iter().position(|known| known == map).expect("one of all");
    let weights: Vec<f64> = maps.iter().map(|map| log_posterior(&spec, &rays, &field, map).exp()).collect();
    let total: f64 = weights.iter().sum();
    let mut moved = [0; 2];
    for (place, (limit, most)) in [(0, 3, 2), (0, 2, 2), (1, 2, 2), (3, 3, 1), (1, 1, 2)]
        .into_iter()
        .flat_map(|place| [1.5, MOST].into_iter().enumerate().map(move |limit| (place, limit)))
    {
        let place = Place { at: place.0, width: place.1, height: place.2 };
        let mut goes_to = vec![[0.0; 64]; 64];
        for (from, map) in maps.iter().enumerate() {
            for to in Direction::ALL {
                let mut walk = Walk::new(spec, &rays, &field, map.clone());
                let mut cells = Vec::new();
                place.shifted(&spec, walk.occupied(), to, &mut cells);
                let change = walk.change_of(&cells);
                let (after, p) = goes(&mut walk, change, |walk, draw| try_shift(walk, &cells, most, draw));
                goes_to[from][number(&after)] += 0.25 * p;
                moved[limit] += usize::from(after != *map);
            }
        }
        for from in 0..64 {
            for to in (0..64).filter(|to| *to != from) {
                let [there, back] = [weights[from] * goes_to[from][to], weights[to] * goes_to[to][from]];
                assert!((there - back).abs() < 1e-12 * total, "{place:?} from {from} to {to}: {there} {back}");
            }
        }
    }
    assert!(moved[1] > 500 && moved[0] < moved[1] && moved[0] > 50, "the limit forbids some: {moved:?}");
}

/// Contents of a box move on by one and come in again on the other side; nothing else moves.
#[test]
fn shifts_move_all_that_is_in_a_box() {
    let spec = GridSpec { cell_m: 0.5, origin_m: [0.0; 2], width: 5, height: 4 };
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let mut cells = Vec::new();
    for _ in 0..500 {
        let map: Vec<bool> = (0..20).map(|_| rng.random::<f64>() < 0.5).collect();
        let Some(place) = Place::to_shift(&spec, &mut rng) else { continue };
        let (column, row) = spec.column_row(place.at);
        for (to, opposite, [dx, dy]) in [
            (Direction::Right, Direction::Left, [1, 0]),
            (Direction::Left, Direction::Right, [place.width - 1, 0]),
            (Direction::Up, Direction::Down, [0, 1]),
            (Direction::Down, Direction::Up, [0, place.height - 1]),
        ] {
            let mut expected = map.clone();
            for (x, y) in (0..place.width).flat_map(|x| (0..place.height).map(move |y| (x, y))) {
                let there = spec.index(column + (x + dx) % place.width, row + (y + dy) % place.height);
                expected[there] = map[spec.index(column + x, row + y)];
            }
            place.shifted(&spec, &map, to, &mut cells);
            let mut moved = map.clone();
            cells.iter().for_each(|&cell| moved[cell] ^= true);
            assert_eq!(moved, expected, "{place:?} {to:?}");
            place.shifted(&spec, &moved, opposite, &mut cells);
            cells.iter().for_each(|&cell| moved[cell] ^= true);
            assert_eq!(moved, map, "{place:?} {opposite:?} after {to:?}");
        }
    }
}
