//! Time passes for the fast map: [`crate::belief::renewal`] for tiles that a scan looks at, in single precision.
//!
//! A tile stands at the time at which it was last brought to a scan's. What a place of it was known to be does not depend on how often
//! that is done on the way, so that tiles nobody looks at cost nothing. A joint across the border of two tiles that stand at different
//! times is brought from the one end alone.

mod reached;
mod step;

use grid::{GridSpec, Raster};
use sensor::Ray;

use crate::belief::renewal::{KINDS, Renewal};
use crate::fast::map::Map;
use crate::fast::renewal::reached::Reached;
use crate::fast::renewal::step::{Passed, Passing, STANDS, Step, UNSEEN, after, pass};
use crate::fast::tiles::{TILE, Tiles};
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
    /// The tiles that the last scan may move.
    reached: Reached,
    passing: Passing,
}

impl Changes {
    /// Of an unseen map.
    pub(super) fn new(map: &Map, renewal: Renewal) -> Self {
        let share = |kind: usize| [(renewal.shares[kind] as f32 * UNITS + 0.5) as u16; TILE];
        let unseen = Shares { at_s: 0.0, of: [[share(1), share(2)]; 2] };
        let prior = map.of_unseen();
        let passing = Passing { places: vec![UNSEEN; map.numbering.tiles()], ..Passing::default() };
        Self {
            renewal,
            prior,
            shares: Tiles::new(map.numbering, unseen),
            now_s: None,
            reached: Reached::default(),
            passing,
        }
    }

    /// A scan is taken at this time, s.
    pub(super) fn go_on(&mut self, time_s: f64) {
        self.now_s = Some(self.renewal.stands_at(time_s, self.now_s));
    }

    /// Before the scan: brings the tiles that it may move to its time.
    pub(super) fn pass(&mut self, map: &mut Map, rays: impl Iterator<Item = Ray>) {
        let mut reached = std::mem::take(&mut self.reached);
        reached.renew(&map.numbering, rays);
        self.select(map, reached.tiles().iter().copied());
        self.reached = reached;
        pass(map, self);
    }

    /// After a scan: the tiles that it made stand at its time.
    pub(super) fn adopt(&mut self, map: &Map) {
        for tile in self.reached.tiles().iter().copied().filter(|tile| map.is_made(*tile)) {
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
        let mut steps = Steps::of(&self.renewal);
        let loss = |tile: usize| {
            let late =
                self.shares.is_made(tile).then(|| now_s - self.shares.at(tile).at_s).filter(|seconds| *seconds > 0.0);
            late.map(|seconds| steps.over(seconds).loss)
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
        let mut steps = Steps::of(&self.renewal);
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
            let step = steps.over(seconds);
            let occupied = map.at(tile).occupied;
            let number = self.passing.number;
            if number == self.passing.tiles.len() {
                self.passing.tiles.push(Passed { tile, step, occupied, loss: [[0.0; TILE]; 2] });
            }
            let passed = &mut self.passing.tiles[number];
            (passed.tile, passed.step, passed.occupied) = (tile, step, occupied);
            (self.passing.places[tile], self.passing.number) = (number as u32, number + 1);
        }
    }
}

/// What times do to a place, one after the other: the last is kept, since many tiles stand at the same.
struct Steps<'a> {
    renewal: &'a Renewal,
    last: Option<(f64, Step)>,
}

impl<'a> Steps<'a> {
    fn of(renewal: &'a Renewal) -> Self {
        Self { renewal, last: None }
    }

    fn over(&mut self, seconds: f64) -> Step {
        match self.last {
            Some((last_s, step)) if last_s.to_bits() == seconds.to_bits() => step,
            _ => self.last.insert((seconds, Step::of(&self.renewal.over(seconds)))).1,
        }
    }
}

impl Held for Changes {
    fn held(&self) -> usize {
        self.shares.held() + self.passing.tiles.held() + self.reached.held() + self.passing.places.held()
    }
}

#[cfg(test)]
mod tests;
