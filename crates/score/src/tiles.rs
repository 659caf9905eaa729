//! Two maps of one world: their difference, and how sure it is, by a bootstrap of tiles.

use grid::{GridSpec, Raster};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

use crate::judged::judged;
use crate::tally::Tally;
use crate::{Interval, Metric, RESAMPLES, ScoreError, Scorer, Scores};

/// Every interval is drawn from the same stream: maps with as many tiles share their luck.
const SEED: u64 = 1989;

/// With fewer tiles no interval is given: there is hardly anything to draw from.
pub const FEWEST_TILES: usize = 6;

/// Side of the tiles, m, unless that would be more than [`MOST_TILES`]: errors of neighbouring cells go together over the size of
/// furniture.
const SIDE_M: f64 = 1.0;

/// More tiles only cost time.
const MOST_TILES: f64 = 400.0;

/// A world cut into square tiles, whose cells are taken together since neighbours err together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tiles {
    spec: GridSpec,
    /// Cells along the side of a tile.
    side: usize,
}

/// A metric of one map minus that of another, over the same cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TiledDifference {
    /// Name of the metric.
    pub metric: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Ours minus theirs; `None` where either is not defined.
    pub difference: Option<f64>,
    /// Where the difference lies with 95 % coverage, over worlds whose tiles are like those of this one. `None` of what is no sum
    /// over cells (`ece`, `auc`), and of fewer than [`FEWEST_TILES`] tiles.
    pub interval: Option<Interval>,
    /// Tiles with cells to judge.
    pub tiles: usize,
}

impl Tiles {
    /// Tiles of about 1 m, or larger ones where these would be more than 400.
    pub fn of(spec: &GridSpec) -> Self {
        let area = spec.cells() as f64 * spec.cell_area_m2();
        let side_m = SIDE_M.max((area / MOST_TILES).sqrt());
        Self { spec: *spec, side: ((side_m / spec.cell_m).round() as usize).max(1) }
    }

    /// Side of a tile, m.
    pub fn side_m(&self) -> f64 {
        self.side as f64 * self.spec.cell_m
    }

    /// Every metric of `ours` minus that of `theirs` over the known cells of `mask`.
    ///
    /// Intervals are percentile intervals of a bootstrap (Efron 1979) whose members are tiles, a block bootstrap in two
    /// dimensions (Künsch 1989; Hall 1985): both maps are scored anew on as many tiles, drawn with replacement and the same for both.
    /// They know of one world alone, and are not adjusted for the number of metrics.
    ///
    /// # Errors
    /// Rasters of different geometry; a cell that holds no probability.
    pub fn differences(
        &self,
        scorer: &Scorer,
        ours: &Raster<f64>,
        theirs: &Raster<f64>,
        mask: &Raster<bool>,
    ) -> Result<Vec<TiledDifference>, ScoreError> {
        let whole = [scorer.scores(ours, mask)?.metrics(), scorer.scores(theirs, mask)?.metrics()];
        let tiles = [self.tallies(scorer, ours, mask)?, self.tallies(scorer, theirs, mask)?];
        let pairs: Vec<(&Tally, &Tally)> = tiles[0].iter().zip(&tiles[1]).filter(|(own, _)| own.cells() > 0).collect();
        let drawn = if pairs.len() < FEWEST_TILES { Vec::new() } else { self.drawn(&pairs) };
        let difference = |k: usize| {
            let [own, other] = [whole[0][k], whole[1][k]];
            let difference = own.value.zip(other.value).map(|(own, other)| own - other);
            let interval = difference.and_then(|_| interval(drawn.iter().filter_map(|values| values[k]).collect()));
            TiledDifference { metric: own.name, unit: own.unit, difference, interval, tiles: pairs.len() }
        };
        Ok((0..whole[0].len()).map(difference).collect())
    }

    /// The tally of every tile.
    fn tallies(&self, scorer: &Scorer, map: &Raster<f64>, mask: &Raster<bool>) -> Result<Vec<Tally>, ScoreError> {
        let across = self.spec.width.div_ceil(self.side);
        let mut tallies = vec![Tally::default(); across * self.spec.height.div_ceil(self.side)];
        for j in judged(map, scorer.truth, mask)? {
            let (column, row) = self.spec.column_row(j.cell);
            tallies[row / self.side * across + column / self.side].add(j, scorer.surface[j.cell]);
        }
        Ok(tallies.iter().map(Tally::settled).collect())
    }

    /// Ours minus theirs of every metric, in every resample.
    fn drawn(&self, pairs: &[(&Tally, &Tally)]) -> Vec<[Option<f64>; Scores::COUNT]> {
        let mut rng = ChaCha8Rng::seed_from_u64(SEED);
        let none = |name| Metric { name, value: None, unit: "1", support: 0 };
        let area = self.spec.cell_area_m2();
        let values = |tally: &Tally| tally.scores(area, none("ece"), none("auc")).metrics().map(|m| m.value);
        let resample = |_| {
            let (mut own, mut other) = (Tally::default(), Tally::default());
            for _ in 0..pairs.len() {
                let pair = pairs[((u64::from(rng.next_u32()) * pairs.len() as u64) >> 32) as usize];
                own.merge(pair.0);
                other.merge(pair.1);
            }
            let (own, other) = (values(&own), values(&other));
            std::array::from_fn(|k| own[k].zip(other[k]).map(|(own, other)| own - other))
        };
        (0..RESAMPLES).map(resample).collect()
    }
}

/// The percentile interval; nothing where most resamples gave no value.
fn interval(values: Vec<f64>) -> Option<Interval> {
    (2 * values.len() >= RESAMPLES).then(|| Interval::percentile(values))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uniform(rng: &mut ChaCha8Rng) -> f64 {
        f64::from(rng.next_u32()) / 4_294_967_296.0
    }

    /// A world of so many metres, in cells of 0.1 m.
    fn world(metres: usize, rng: &mut ChaCha8Rng) -> Raster<Option<bool>> {
        let spec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: 10 * metres, height: 10 * metres };
        Raster::new(spec, (0..spec.cells()).map(|_| Some(uniform(rng) < 0.3)).collect())
    }

    #[test]
    fn a_map_does_not_differ_from_itself_and_exchange_changes_the_sign() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let truth = world(4, &mut rng);
        let all = truth.map(|_| true);
        let scorer = Scorer::new(&truth, &all).expect("valid");
        let maps = [(); 2].map(|()| truth.map(|_| uniform(&mut rng)));
        let tiles = Tiles::of(truth.spec());
        let differences = |a: usize, b: usize| tiles.differences(&scorer, &maps[a], &maps[b], &all).expect("valid");
        for same in differences(0, 0) {
            assert_eq!(same.difference, Some(0.0), "{same:?}");
            let interval = same.interval.map(|i| (i.low, i.high));
            let none = ["ece", "auc"].contains(&same.metric);
            assert_eq!(interval, if none { None } else { Some((0.0, 0.0)) }, "{same:?}");
        }
        for (one, other) in differences(0, 1).iter().zip(differences(1, 0)) {
            assert_eq!(one.difference.map(f64::to_bits), other.difference.map(|d| (0.0 - d).to_bits()));
            assert_eq!(one.tiles, 16);
        }
    }

    #[test]
    fn few_tiles_and_empty_ones() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let truth = world(3, &mut rng);
        let all = truth.map(|_| true);
        let scorer = Scorer::new(&truth, &all).expect("valid");
        let [ours, theirs] = [(); 2].map(|()| truth.map(|_| uniform(&mut rng)));
        let tiles = Tiles::of(truth.spec());
        assert!((tiles.side_m() - 1.0).abs() < 1e-12);
        // The lowest metre alone: three tiles.
        let spec = *truth.spec();
        let low = Raster::new(spec, (0..spec.cells()).map(|cell| spec.column_row(cell).1 < 10).collect());
        let differences = tiles.differences(&scorer, &ours, &theirs, &low).expect("valid");
        assert!(differences.iter().all(|d| d.tiles == 3 && d.difference.is_some() && d.interval.is_none()));
    }

    #[test]
    fn tiles_grow_with_the_world() {
        let spec = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 4000, height: 4000 };
        assert!((Tiles::of(&spec).side_m() - 10.0).abs() < 1e-9);
        let coarse = GridSpec { cell_m: 3.0, origin_m: [0.0; 2], width: 4, height: 4 };
        assert!((Tiles::of(&coarse).side_m() - 3.0).abs() < 1e-12, "a tile has at least one cell");
    }

    #[test]
    fn the_interval_holds_the_difference_of_worlds_about_as_often_as_it_says() {
        // Errors that go together over tiles of 1 m: theirs is worse by 0.02 in the mean, by a tile's own luck.
        let mut held = 0;
        let trials = 100;
        for trial in 0..trials {
            let mut rng = ChaCha8Rng::seed_from_u64(1000 + trial);
            let truth = world(6, &mut rng);
            let all = truth.map(|_| true);
            let scorer = Scorer::new(&truth, &all).expect("valid");
            let luck: Vec<f64> = (0..36).map(|_| 0.3 + 0.4 * uniform(&mut rng)).collect();
            let spec = *truth.spec();
            let tile = |cell: usize| {
                let (column, row) = spec.column_row(cell);
                row / 10 * 6 + column / 10
            };
            let right = |cell: usize, by: f64| if truth[cell] == Some(true) { 1.0 - by } else { by };
            let ours = Raster::new(spec, (0..spec.cells()).map(|cell| right(cell, luck[tile(cell)])).collect());
            let theirs = Raster::new(spec, (0..spec.cells()).map(|cell| right(cell, 0.5)).collect());
            let differences = Tiles::of(&spec).differences(&scorer, &ours, &theirs, &all).expect("valid");
            // E (0.3 + 0.4 U)^2 - 0.25 = 0.25 + 0.16 / 12 - 0.25.
            let brier = differences[1].interval.expect("36 tiles");
            held += usize::from((brier.low..=brier.high).contains(&(0.16 / 12.0)));
        }
        assert!((86..=100).contains(&held), "held in {held} of {trials}");
    }
}
