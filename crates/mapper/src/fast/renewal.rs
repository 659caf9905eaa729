//! Time passes for the fast map: [`crate::belief::renewal`] for tiles that a scan looks at, in single precision.
//!
//! A tile stands at the time at which it was last brought to a scan's. What a place of it was known to be does not depend on how often
//! that is done on the way, so that tiles nobody looks at cost nothing. A joint across the border of two tiles that stand at different
//! times is brought from the one end alone.

use grid::{GridSpec, Raster};
use sensor::Ray;
use sensor::in_lanes;
use sensor::lanes::{Lanes, each};

use crate::belief::renewal::{Elapsed, KINDS, Renewal};
use crate::fast::bounds::{bounded, possible};
use crate::fast::map::{Map, Tile};
use crate::fast::tiles::{Numbering, PATCH, SIDE, TILE, Tiles, split};
use crate::fast::walk::{Place, Walk};
use crate::memory::Held;

/// Units of a share: it is a whole number of them.
const UNITS: f32 = 65_535.0;

/// What is known of the kinds of the places of a tile: 8 bytes per cell.
#[derive(Debug, Clone)]
struct Shares {
    /// Time that the tile stands at, s.
    at_s: f64,
    /// `P(kind | E)` and `P(kind | not E)` of the second and third kind; the rest is of the first.
    of: [[[u16; TILE]; 2]; 2],
}

/// The kinds of the places of a map.
#[derive(Clone)]
pub(super) struct Changes {
    renewal: Renewal,
    /// `P(E)` of a place that is drawn again, and of two neighbours that are.
    prior: [f32; 2],
    shares: Tiles<Shares>,
    /// Time of the last scan, s; none before the first.
    now_s: Option<f64>,
    passing: Passing,
}

/// What some time does to a place, in single precision.
#[derive(Debug, Clone, Copy)]
struct Step {
    kept: [[f32; KINDS]; KINDS],
    /// Probability that a place of each kind is renewed.
    loss: [f32; KINDS],
    same_kind: f32,
    shares: [f32; KINDS],
}

impl Step {
    fn of(elapsed: &Elapsed) -> Self {
        let single = |values: [f64; KINDS]| values.map(|value| value as f32);
        Self {
            kept: elapsed.kept.map(single),
            loss: single(elapsed.survival.map(|survival| 1.0 - survival)),
            same_kind: elapsed.same_kind as f32,
            shares: single(elapsed.shares),
        }
    }
}

/// A tile for which time has passed: what its cells were, and with which probability they are renewed, if occupied and if free.
#[derive(Debug, Clone)]
struct Passed {
    tile: usize,
    step: Step,
    occupied: [f32; TILE],
    loss: [[f32; TILE]; 2],
}

/// Working memory: the tiles for which time passes now.
#[derive(Debug, Clone, Default)]
struct Passing {
    tiles: Vec<Passed>,
    /// How many of them there are now; the others are kept for the next scan.
    number: usize,
    /// The tiles that the last scan may move.
    reached: Vec<usize>,
    /// Of every tile of the map, its place among them, or [`STANDS`], or [`UNSEEN`].
    places: Vec<u32>,
}

/// A tile that stands at the time that it stood at.
const STANDS: u32 = u32::MAX - 1;

/// A tile of which nothing is known but the prior, which stands at any time.
const UNSEEN: u32 = u32::MAX;

/// One end of a row of edges: what its cells were, and with which probability they are renewed, if occupied and if free.
#[derive(Clone, Copy)]
struct End {
    occupied: Lanes<f32>,
    loss: [Lanes<f32>; 2],
}

impl Changes {
    /// Of an unseen map.
    pub(super) fn new(map: &Map, renewal: Renewal) -> Self {
        let share = |kind: usize| [(renewal.shares[kind] as f32 * UNITS + 0.5) as u16; TILE];
        let unseen = Shares { at_s: 0.0, of: [[share(1), share(2)]; 2] };
        let prior = map.of_unseen();
        let passing = Passing { places: vec![UNSEEN; map.numbering.tiles()], ..Passing::default() };
        Self { renewal, prior, shares: Tiles::new(map.numbering, unseen), now_s: None, passing }
    }

    /// A scan is taken at this time, s. Time that goes back stands still.
    pub(super) fn go_on(&mut self, time_s: f64) {
        self.now_s = Some(self.now_s.map_or(time_s, |last| last.max(time_s)));
    }

    /// Before the scan: brings the tiles that it may move to its time.
    pub(super) fn pass(&mut self, map: &mut Map, rays: &[Ray]) {
        let tiles = reached(&map.numbering, rays);
        self.select(map, tiles.iter().copied());
        self.passing.reached = tiles;
        pass(map, self);
    }

    /// After a scan: the tiles that it made stand at its time.
    pub(super) fn adopt(&mut self, map: &Map) {
        for tile in self.passing.reached.iter().copied().filter(|tile| map.is_made(*tile)) {
            if !self.shares.is_made(tile) {
                self.shares.make(tile).at_s = self.now_s.unwrap_or_default();
                self.passing.places[tile] = STANDS;
            }
        }
    }

    /// Brings the whole map to the time of the last scan.
    pub(super) fn pass_everywhere(&mut self, map: &mut Map) {
        self.select(map, 0..map.numbering.tiles());
        pass(map, self);
    }

    /// `P(E)` at the time of the last scan of the cells in a window of the grid that begins at the given column and row.
    pub(super) fn marginals(&self, map: &Map, from: [usize; 2], window: GridSpec) -> Raster<f64> {
        let now_s = self.now_s.unwrap_or_default();
        let loss = |tile: usize| {
            let late =
                self.shares.is_made(tile).then(|| now_s - self.shares.at(tile).at_s).filter(|seconds| *seconds > 0.0);
            late.map(|seconds| Step::of(&self.renewal.over(seconds)).loss)
        };
        let losses: Vec<Option<[f32; KINDS]>> = (0..map.numbering.tiles()).map(loss).collect();
        map.raster_by_number(from, window, |number, place| {
            let p = map.at(number).occupied[place];
            let Some(loss) = losses[number] else { return f64::from(p) };
            let of = &self.shares.at(number).of;
            let [lost, drawn] = [0, 1].map(|x| {
                let [second, third] = [0, 1].map(|k| f32::from(of[x][k][place]) * (1.0 / UNITS));
                loss[0] * (1.0 - second - third) + loss[1] * second + loss[2] * third
            });
            f64::from(after(p, lost, drawn, self.prior[0]))
        })
    }

    /// Those of the given tiles that stand at an earlier time, which is then that of all.
    fn select(&mut self, map: &Map, tiles: impl Iterator<Item = usize>) {
        let now_s = self.now_s.unwrap_or_default();
        for passed in &self.passing.tiles[..self.passing.number] {
            self.passing.places[passed.tile] = STANDS;
        }
        self.passing.number = 0;
        let mut last = (0.0f64, Step::of(&self.renewal.over(0.0)));
        for tile in tiles {
            // What nobody has seen stays as it was: its prior.
            if !self.shares.is_made(tile) {
                continue;
            }
            let shares = self.shares.make(tile);
            let seconds = now_s - shares.at_s;
            if seconds <= 0.0 {
                continue;
            }
            shares.at_s = now_s;
            if seconds.to_bits() != last.0.to_bits() {
                last = (seconds, Step::of(&self.renewal.over(seconds)));
            }
            let occupied = map.at(tile).occupied;
            let number = self.passing.number;
            if number == self.passing.tiles.len() {
                self.passing.tiles.push(Passed { tile, step: last.1, occupied, loss: [[0.0; TILE]; 2] });
            }
            let passed = &mut self.passing.tiles[number];
            (passed.tile, passed.step, passed.occupied) = (tile, last.1, occupied);
            (self.passing.places[tile], self.passing.number) = (number as u32, number + 1);
        }
    }
}

/// The tiles that rays cross, and those beside them, since a scan moves the edges to these too; in the order of their numbers.
fn reached(numbering: &Numbering, rays: &[Ray]) -> Vec<usize> {
    let mut is_reached = vec![false; numbering.tiles()];
    for ray in rays {
        let Some(start) = numbering.spec().locate(ray.origin_m) else { continue };
        let at = numbering.column_row(numbering.of(start)).map(|k| k as u32);
        let mut walk = Walk::new(numbering, ray.origin_m, ray.direction, Place { at, entered: 0.0 });
        loop {
            is_reached[split(numbering.at(walk.place.at)).0] = true;
            let Some(next) = walk.crossing().next else { break };
            walk.place = next;
        }
    }
    let crossed: Vec<usize> = (0..is_reached.len()).filter(|tile| is_reached[*tile]).collect();
    for (tile, beside) in crossed.iter().flat_map(|tile| numbering.beside(*tile).map(|beside| (tile, beside))) {
        is_reached[beside.unwrap_or(*tile)] = true;
    }
    (0..is_reached.len()).filter(|tile| is_reached[*tile]).collect()
}

in_lanes! {
    /// Lets time pass for the tiles that are selected: first their places, then the edges of these.
    fn pass<'a>(map: &'a mut Map, changes: &'a mut Changes) {
        places_and_edges(map, changes);
    }
}

#[inline(always)]
fn places_and_edges(map: &mut Map, changes: &mut Changes) {
    let Changes { prior: [prior, both], shares, passing, .. } = changes;
    for passed in &mut passing.tiles[..passing.number] {
        let (tile, shares) = (map.make(passed.tile), shares.make(passed.tile));
        for row in (0..TILE).step_by(SIDE) {
            places(passed, row, *prior, tile, shares);
        }
    }
    let drawn = [*prior, *both];
    for number in 0..passing.number {
        let Passed { tile, step, .. } = passing.tiles[number];
        let first = (tile * TILE) as u32;
        for patch in (first..first + TILE as u32).step_by(PATCH) {
            edges_within(map, passing, patch, &step, drawn);
            edges_from_before(map, passing, patch, &step, drawn);
        }
        map.summarise(tile);
    }
}

/// `P(E)` of a place that is renewed with the probability `lost` if it is occupied, and `drawn` if it is free.
#[inline(always)]
fn after(p: f32, lost: f32, drawn: f32, prior: f32) -> f32 {
    bounded(p - p * lost + prior * (p * lost + (1.0 - p) * drawn))
}

/// A row of places after some time.
#[inline(always)]
fn places(passed: &mut Passed, row: usize, prior: f32, tile: &mut Tile, shares: &mut Shares) {
    let step = &passed.step;
    let p: Lanes<f32> = each(|c| passed.occupied[row + c]);
    let not_p = each(|c| 1.0 - p[c]);
    // P(kind | E), P(kind | not E).
    let kinds = [kinds(&shares.of[0], row), kinds(&shares.of[1], row)];
    let (lost, drawn) = (weighted(&step.loss, &kinds[0]), weighted(&step.loss, &kinds[1]));
    passed.loss[0][row..row + SIDE].copy_from_slice(&lost);
    passed.loss[1][row..row + SIDE].copy_from_slice(&drawn);
    let after = each(|c| after(p[c], lost[c], drawn[c], prior));
    tile.occupied[row..row + SIDE].copy_from_slice(&after);
    let noise = dither(passed.tile, row, shares.at_s);
    for k in 1..KINDS {
        let (left_e, left_f) = (weighted(&step.kept[k], &kinds[0]), weighted(&step.kept[k], &kinds[1]));
        let (left_e, left_f) = (each(|c| p[c] * left_e[c]), each(|c| not_p[c] * left_f[c]));
        let was = each(|c| p[c] * kinds[0][k][c] + not_p[c] * kinds[1][k][c]);
        let is = each(|c| step.same_kind * was[c] + (1.0 - step.same_kind) * step.shares[k]);
        let renewed = each(|c| more(is[c] - left_e[c] - left_f[c], 0.0));
        let occupied = each(|c| (left_e[c] + prior * renewed[c]) / after[c]);
        let free = each(|c| (left_f[c] + (1.0 - prior) * renewed[c]) / (1.0 - after[c]));
        for (x, share) in [occupied, free].iter().enumerate() {
            let shift = 8 * (2 * x + k - 1) as u32;
            let up = each(|c| ((noise[c] >> shift) & 255) as i32 as f32 * (1.0 / 256.0));
            let units = each(|c| whole(share[c] * UNITS + up[c]));
            shares.of[x][k - 1][row..row + SIDE].copy_from_slice(&units);
        }
    }
}

/// `P(kind | E)`, or `P(kind | not E)`, of a row of places.
#[inline(always)]
fn kinds(of: &[[u16; TILE]; 2], row: usize) -> [Lanes<f32>; KINDS] {
    let second = each(|c| f32::from(of[0][row + c]) * (1.0 / UNITS));
    let third = each(|c| f32::from(of[1][row + c]) * (1.0 / UNITS));
    [each(|c| 1.0 - second[c] - third[c]), second, third]
}

/// A sum over kinds.
#[inline(always)]
fn weighted(by: &[f32; KINDS], of: &[Lanes<f32>; KINDS]) -> Lanes<f32> {
    each(|c| by[0] * of[0][c] + by[1] * of[1][c] + by[2] * of[2][c])
}

/// The larger, without a care for what is no number.
#[inline(always)]
fn more(x: f32, y: f32) -> f32 {
    if x > y { x } else { y }
}

/// The smaller.
#[inline(always)]
fn less(x: f32, y: f32) -> f32 {
    if x < y { x } else { y }
}

/// The whole part of a number of units, from 0 to below 65,536, by the low bits of a number so large that it has no others.
#[inline(always)]
fn whole(units: f32) -> u16 {
    const WHOLE: f32 = 12_582_912.0; // 3 times 2^22
    let units = if units < UNITS { units } else { UNITS };
    ((units - 0.5 + WHOLE).to_bits() & 0xffff) as u16
}

/// Four numbers of 8 bits for each cell of a row, by which shares are rounded: to the one or the other side as often as keeps their mean,
/// since what a short time adds is less than a unit.
#[inline(always)]
fn dither(tile: usize, row: usize, at_s: f64) -> Lanes<u32> {
    let time = at_s.to_bits();
    let seed = (time ^ (time >> 32)) as u32 ^ ((tile * TILE + row) as u32).wrapping_mul(0x9e37_79b9);
    each(|c| {
        let mixed = (seed ^ (c as u32).wrapping_mul(0x85eb_ca6b)).wrapping_mul(0xc2b2_ae35);
        let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x27d4_eb2f);
        mixed ^ (mixed >> 13)
    })
}

impl Passing {
    /// The cells from `from` on, each `stride` behind the one before, at one end of edges; the other end passes through `step`.
    #[inline(always)]
    fn end(&self, map: &Map, from: u32, stride: usize, step: &Step) -> End {
        let number = from;
        let (tile, from) = split(from);
        match self.places[tile] {
            STANDS => End { occupied: map.line(number, stride), loss: [[0.0; SIDE]; 2] },
            UNSEEN => {
                let loss =
                    step.loss[0] * step.shares[0] + step.loss[1] * step.shares[1] + step.loss[2] * step.shares[2];
                End { occupied: map.line(number, stride), loss: [[loss; SIDE]; 2] }
            }
            place => {
                let passed = &self.tiles[place as usize];
                End {
                    occupied: each(|k| passed.occupied[from + k * stride]),
                    loss: [each(|k| passed.loss[0][from + k * stride]), each(|k| passed.loss[1][from + k * stride])],
                }
            }
        }
    }
}

/// The edges of a patch to the right and to the upper neighbours.
#[inline(always)]
fn edges_within(map: &mut Map, passing: &Passing, patch: u32, step: &Step, drawn: [f32; 2]) {
    let (tile, from) = split(patch);
    let last = (SIDE - 1) as u32;
    let right = match map.numbering.after(patch + last, 0) {
        Some(after) => (passing.end(map, after, SIDE, step), map.line(after, SIDE)),
        None => NOTHING,
    };
    let above = match map.numbering.after(patch + last * SIDE as u32, 1) {
        Some(after) => (passing.end(map, after, 1, step), map.line(after, 1)),
        None => NOTHING,
    };
    let mut row = (passing.end(map, patch, 1, step), map.line(patch, 1));
    for r in 0..SIDE {
        let next = match r + 1 < SIDE {
            true => {
                let next = patch + ((r + 1) * SIDE) as u32;
                (passing.end(map, next, 1, step), map.line(next, 1))
            }
            false => above,
        };
        let (here, now) = &row;
        let beside = End {
            occupied: along(&here.occupied, right.0.occupied[r]),
            loss: [along(&here.loss[0], right.0.loss[0][r]), along(&here.loss[1], right.0.loss[1][r])],
        };
        let [to_right, to_above] = &mut map.make(tile).both;
        edges(to_right, from + r * SIDE, [here, &beside], [now, &along(now, right.1[r])], drawn);
        edges(to_above, from + r * SIDE, [here, &next.0], [now, &next.1], drawn);
        row = next;
    }
}

/// Beyond the border of the grid: edges to there are not read.
const NOTHING: (End, Lanes<f32>) = (End { occupied: [0.5; SIDE], loss: [[0.0; SIDE]; 2] }, [0.5; SIDE]);

/// A row moved to the left, with what comes from its right.
#[inline(always)]
fn along(row: &Lanes<f32>, last: f32) -> Lanes<f32> {
    each(|c| if c + 1 < SIDE { row[(c + 1) % SIDE] } else { last })
}

/// The edges into a patch from those before it, where these stand still.
#[inline(always)]
fn edges_from_before(map: &mut Map, passing: &Passing, patch: u32, step: &Step, drawn: [f32; 2]) {
    for axis in 0..2 {
        let Some(before) = map.numbering.before(patch, axis) else { continue };
        let (tile, from) = split(before);
        if passing.places[tile] != STANDS {
            continue;
        }
        let stride = [SIDE, 1][axis];
        let ends = [passing.end(map, before, stride, step), passing.end(map, patch, stride, step)];
        let now = [map.line(before, stride), map.line(patch, stride)];
        let all = &mut map.make(tile).both[axis];
        let mut both = [0.0; TILE];
        (0..SIDE).for_each(|k| both[k] = all[from + k * stride]);
        edges(&mut both, 0, [&ends[0], &ends[1]], [&now[0], &now[1]], drawn);
        (0..SIDE).for_each(|k| all[from + k * stride] = both[k]);
    }
}

/// A row of edges after some time, from what their ends were and are: [`crate::pairs::renewal::both_after`].
#[inline(always)]
fn edges(joints: &mut [f32; TILE], from: usize, was: [&End; 2], is: [&Lanes<f32>; 2], [prior, both]: [f32; 2]) {
    let [first, second] = was;
    let ee: Lanes<f32> = each(|c| joints[from + c]);
    let ef = each(|c| more(first.occupied[c] - ee[c], 0.0));
    let fe = each(|c| more(second.occupied[c] - ee[c], 0.0));
    let ff = each(|c| more(1.0 - ee[c] - ef[c] - fe[c], 0.0));
    let ([a, not_a], [b, not_b]) = (&first.loss, &second.loss);
    let neither = each(|c| ee[c] * (1.0 - more(a[c], b[c])));
    let one = each(|c| {
        ee[c] * (more(a[c], b[c]) - less(a[c], b[c]))
            + ef[c] * more(not_b[c] - a[c], 0.0)
            + fe[c] * more(not_a[c] - b[c], 0.0)
    });
    let together = each(|c| {
        ee[c] * less(a[c], b[c])
            + ef[c] * less(a[c], not_b[c])
            + fe[c] * less(not_a[c], b[c])
            + ff[c] * less(not_a[c], not_b[c])
    });
    for c in 0..SIDE {
        joints[from + c] = possible(is[0][c], is[1][c], neither[c] + prior * one[c] + both * together[c]);
    }
}

impl Held for Changes {
    fn held(&self) -> usize {
        self.shares.held() + self.passing.tiles.held() + self.passing.reached.held() + self.passing.places.held()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::renewal::Place as Belief;
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
            let renewal = Renewal { rates_per_s: [0.01, 0.1, rate], shares: [0.7, 0.2, 0.1], turnover_per_s: 0.05 };
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
}
