//! Regions and metrics of a world that moves against their definitions, read from the whole history of every cell.

use grid::{GridSpec, Raster};
use proptest::prelude::*;
use score::{Metric, Moving, MovingRegion, MovingScores, Region, ScoreError, Sight, Sightings};

const CELL_M: f64 = 0.1;

/// One cell: its static truth, for every scan whether a thing covers it and a look finds it, and what the map says in the end.
#[derive(Debug, Clone)]
struct Cell {
    still: Option<bool>,
    scans: Vec<(bool, bool)>,
    p: f64,
}

impl Cell {
    /// State at a scan, of a cell whose truth is known.
    fn state(&self, scan: usize) -> bool {
        self.still == Some(true) || self.scans[scan].0
    }

    fn occupied(&self) -> bool {
        self.state(self.scans.len() - 1)
    }

    /// Scans that looked at it.
    fn looks(&self) -> Vec<usize> {
        (0..self.scans.len()).filter(|&scan| self.scans[scan].1).collect()
    }

    /// Whether a look came after the last scan at which its state was another one.
    fn known(&self) -> bool {
        let same = |&scan: &usize| self.state(scan) == self.occupied();
        let run = (0..self.scans.len()).rev().take_while(same).last();
        self.still.is_some() && self.looks().iter().any(|look| run.is_some_and(|run| *look >= run))
    }

    fn swept(&self) -> bool {
        self.still == Some(false) && self.scans.iter().any(|scan| scan.0)
    }

    fn contains(&self, region: MovingRegion) -> bool {
        let states: Vec<bool> = self.looks().into_iter().map(|scan| self.state(scan)).collect();
        match region {
            MovingRegion::Static => self.known() && !self.swept(),
            MovingRegion::Swept => self.swept() && !self.occupied() && !states.is_empty(),
            MovingRegion::OccupiedNow => self.known() && self.swept() && self.occupied(),
            MovingRegion::Changed => self.known() && states.contains(&true) && states.contains(&false),
        }
    }

    fn right(&self) -> bool {
        if self.occupied() { self.p > 0.5 } else { self.p < 0.5 }
    }
}

/// Cells of a world, `width` in a row.
#[derive(Debug, Clone)]
struct World {
    width: usize,
    cells: Vec<Cell>,
}

impl World {
    fn spec(&self) -> GridSpec {
        let height = self.cells.len() / self.width;
        GridSpec { cell_m: CELL_M, origin_m: [-1.0, 0.5], width: self.width, height }
    }

    fn raster<T>(&self, of: impl Fn(&Cell) -> T) -> Raster<T> {
        Raster::new(self.spec(), self.cells.iter().map(of).collect())
    }

    fn moving(&self) -> Moving {
        let mut moving = Moving::new(&self.raster(|cell| cell.still));
        for scan in 0..self.cells[0].scans.len() {
            moving.moved(&self.raster(|cell| cell.scans[scan].0)).expect("valid");
            moving.looked(&self.raster(|cell| cell.scans[scan].1)).expect("valid");
        }
        moving
    }

    fn scores(&self) -> MovingScores {
        self.moving().scores(&self.raster(|cell| cell.p)).expect("valid")
    }

    /// The same world with another map.
    fn with_map(&self, p: impl Fn(&Cell) -> f64) -> Self {
        let of = |cell: &Cell| Cell { p: p(cell), ..cell.clone() };
        Self { width: self.width, cells: self.cells.iter().map(of).collect() }
    }

    fn of(&self, region: MovingRegion) -> Vec<&Cell> {
        self.cells.iter().filter(|cell| cell.contains(region)).collect()
    }

    /// Cells of the largest ghost, found by walking from every cell of one.
    fn ghost(&self) -> usize {
        let ghost = |at: usize| {
            let cell = &self.cells[at];
            cell.contains(MovingRegion::Changed) && !cell.occupied() && cell.p > 0.5
        };
        let spec = self.spec();
        let beside = |a: usize, b: usize| {
            let ((ax, ay), (bx, by)) = (spec.column_row(a), spec.column_row(b));
            ax.abs_diff(bx) + ay.abs_diff(by) == 1
        };
        let patch = |from: usize| {
            let mut patch = vec![from];
            while let Some(more) = (0..spec.cells())
                .find(|&next| ghost(next) && !patch.contains(&next) && patch.iter().any(|&at| beside(at, next)))
            {
                patch.push(more);
            }
            patch.len()
        };
        (0..spec.cells()).filter(|&at| ghost(at)).map(patch).max().unwrap_or(0)
    }
}

fn world() -> impl Strategy<Value = World> {
    (1usize..7, 1usize..6, 1usize..9, 0.0f64..1.0, 0.0f64..1.0, 0.0f64..1.0).prop_flat_map(
        |(width, height, scans, walls, things, looks)| {
            let still = prop::option::weighted(0.9, prop::bool::weighted(walls * walls));
            let scan = (prop::bool::weighted(things), prop::bool::weighted(looks));
            let p = prop_oneof![prop::sample::select(vec![0.0, 0.5, 1.0]), 0.0f64..=1.0];
            let cell =
                (still, prop::collection::vec(scan, scans), p).prop_map(|(still, scans, p)| Cell { still, scans, p });
            prop::collection::vec(cell, width * height).prop_map(move |cells| World { width, cells })
        },
    )
}

fn agree(metric: Metric, value: Option<f64>, support: usize) -> bool {
    let same = match (metric.value, value) {
        (Some(found), Some(expected)) => (found - expected).abs() < 1e-12,
        (found, expected) => found.is_none() && expected.is_none(),
    };
    same && metric.support == support
}

fn share(cells: &[&Cell], of: impl Fn(&Cell) -> bool) -> Option<f64> {
    (!cells.is_empty()).then(|| cells.iter().filter(|cell| of(cell)).count() as f64 / cells.len() as f64)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn regions_and_truth_equal_their_definitions(world in world()) {
        let moving = world.moving();
        for (at, cell) in world.cells.iter().enumerate() {
            prop_assert_eq!(moving.truth()[at], cell.still.map(|_| cell.occupied()));
            for region in MovingRegion::ALL {
                prop_assert_eq!(moving.contains(region, at), cell.contains(region), "{:?} {:?}", region, cell);
                prop_assert_eq!(moving.mask(region)[at], cell.contains(region));
            }
            let parts = [MovingRegion::Static, MovingRegion::Swept, MovingRegion::OccupiedNow];
            let inside = parts.iter().filter(|part| cell.contains(**part)).count();
            prop_assert!(inside <= 1 && inside >= usize::from(cell.known()), "{:?}", cell);
        }
    }

    #[test]
    fn every_metric_equals_its_definition(world in world()) {
        let scores = world.scores();
        let [still, swept] = [MovingRegion::Static, MovingRegion::Swept].map(|region| world.of(region));
        let [right_still, right_swept] = [&still, &swept].map(|cells| share(cells, Cell::right));
        let harmonic = right_still.zip(right_swept).map(|(s, d)| if s * d > 0.0 { 2.0 / (1.0 / s + 1.0 / d) } else { 0.0 });
        let trail = share(&swept, |cell| cell.p > 0.5).map(|s| s * swept.len() as f64 * CELL_M * CELL_M);
        let free = world.of(MovingRegion::Changed).into_iter().filter(|cell| !cell.occupied()).count();
        let ghost = (free > 0).then(|| world.ghost() as f64 * CELL_M * CELL_M);
        for (metric, name, unit, value, support) in [
            (scores.static_accuracy, "static_accuracy", "1", right_still, still.len()),
            (scores.dynamic_accuracy, "dynamic_accuracy", "1", right_swept, swept.len()),
            (scores.harmonic_accuracy, "harmonic_accuracy", "1", harmonic, still.len() + swept.len()),
            (scores.trail_area, "trail_area", "m²", trail, swept.len()),
            (scores.ghost_area, "ghost_area", "m²", ghost, free),
        ] {
            prop_assert_eq!((metric.name, metric.unit), (name, unit));
            prop_assert!(agree(metric, value, support), "{:?} is not {:?} of {}", metric, value, support);
        }
    }

    /// What no look has found says nothing of a map, nor does what has come since the last look.
    #[test]
    fn cells_that_are_not_scored_do_not_matter(world in world(), other in 0.0f64..=1.0) {
        let changed = world.with_map(|cell| if cell.known() || cell.contains(MovingRegion::Swept) { cell.p } else { other });
        prop_assert_eq!(world.scores(), changed.scores());
    }

    #[test]
    fn perfect_inverted_and_undecided_maps(world in world()) {
        let truth = |cell: &Cell| if cell.occupied() { 1.0 } else { 0.0 };
        let values = |map: &World| {
            let s = map.scores();
            [s.static_accuracy, s.dynamic_accuracy, s.harmonic_accuracy, s.trail_area, s.ghost_area]
        };
        for (map, share, taken) in [
            (world.with_map(truth), 1.0, false),
            (world.with_map(|cell| 1.0 - truth(cell)), 0.0, true),
            (world.with_map(|_| 0.5), 0.0, false),
        ] {
            let [still, swept, harmonic, trail, ghost] = values(&map);
            for metric in [still, swept, harmonic] {
                prop_assert!(metric.value.is_none_or(|v| (v - share).abs() < 1e-15), "{:?}", metric);
            }
            let all = if taken { swept.support as f64 * CELL_M * CELL_M } else { 0.0 };
            prop_assert!(trail.value.is_none_or(|v| (v - all).abs() < 1e-12), "{:?}", trail);
            prop_assert!(ghost.value.is_none_or(|v| (v > 0.0) == taken), "{:?}", ghost);
        }
        // A map that never says anything but "free" has no trail, and is right of nothing that stands.
        let [still, swept, ..] = values(&world.with_map(|_| 0.1));
        prop_assert!(swept.value.is_none_or(|v| (v - 1.0).abs() < 1e-15));
        let walls = world.of(MovingRegion::Static).iter().filter(|cell| cell.occupied()).count();
        prop_assert!(still.value.is_none_or(|v| ((1.0 - v) * still.support as f64 - walls as f64).abs() < 1e-9));
    }

    /// The sightings of a whole drive, told of every move, know the same cells as the looks of its scans.
    #[test]
    fn the_known_cells_are_the_observable_ones(
        walls in prop::collection::vec(prop::option::weighted(0.95, prop::bool::weighted(0.1)), 36),
        scans in prop::collection::vec((prop::collection::vec(prop::bool::weighted(0.1), 36), prop::collection::vec((0usize..36, 0usize..4), 0..6)), 1..8),
    ) {
        let spec = GridSpec { cell_m: CELL_M, origin_m: [0.0, 0.0], width: 6, height: 6 };
        let still = Raster::new(spec, walls);
        let (mut moving, mut seen) = (Moving::new(&still), Sightings::new(&still));
        for (covered, rays) in scans {
            moving.moved(&Raster::new(spec, covered)).expect("valid");
            seen.set_truth(moving.truth()).expect("valid");
            let mut scan = Sightings::new(moving.truth());
            for (cell, way) in rays {
                let sight = cast(moving.truth(), cell, [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]][way]);
                seen.add(&sight);
                scan.add(&sight);
            }
            moving.looked(&scan.mask(Region::Observable)).expect("valid");
        }
        for cell in 0..spec.cells() {
            let [is_static, swept, occupied_now] =
                [MovingRegion::Static, MovingRegion::Swept, MovingRegion::OccupiedNow].map(|r| moving.contains(r, cell));
            let wall = still[cell] == Some(true);
            prop_assert_eq!(occupied_now || is_static && wall, seen.contains(Region::Surface, cell));
            prop_assert!(!(seen.contains(Region::Visible, cell) && !(is_static || swept)));
            prop_assert!(!is_static || seen.contains(Region::Observable, cell));
            prop_assert!(!swept || seen.looks()[cell] > 0);
        }
    }
}

/// A ray from the middle of a cell along an axis, which stops at the first occupied cell.
fn cast(truth: &Raster<Option<bool>>, from: usize, direction: [f64; 2]) -> Sight {
    let spec = truth.spec();
    let origin_m = spec.centre(from);
    let at = |k: usize| [0, 1].map(|axis| origin_m[axis] + direction[axis] * k as f64 * CELL_M);
    let hit = (0..6).find(|&k| spec.locate(at(k)).is_some_and(|cell| truth[cell] == Some(true)));
    let range_m = hit.map(|k| (k as f64 - 0.5).max(0.0) * CELL_M);
    Sight { origin_m, direction, range_m }
}

#[test]
fn nothing_to_judge_is_no_value() {
    let world = World { width: 1, cells: vec![Cell { still: Some(false), scans: vec![(true, false)], p: 0.9 }] };
    for (region, metric) in world.scores().by_region() {
        assert_eq!((metric.value, metric.support), (None, 0), "{region} {}", metric.name);
    }
    // A world in which nothing has moved has static cells and no others.
    let still = World { width: 1, cells: vec![Cell { still: Some(false), scans: vec![(false, true)], p: 0.1 }] };
    let [(_, accuracy), others @ ..] = still.scores().by_region();
    assert_eq!((accuracy.value, accuracy.support), (Some(1.0), 1));
    assert!(others.iter().all(|(_, metric)| metric.value.is_none()), "{others:?}");
}

#[test]
fn what_cannot_be_scored_is_refused() {
    let world = World { width: 1, cells: vec![Cell { still: Some(false), scans: vec![(true, true)], p: 0.9 }] };
    let moving = world.moving();
    let broken = moving.scores(&world.raster(|_| f64::NAN)).expect_err("refused");
    assert!(matches!(broken, ScoreError::Probability { cell: 0, .. }), "{broken}");
    let wide = Raster::filled(GridSpec { width: 2, ..world.spec() }, 0.1);
    assert!(matches!(moving.scores(&wide), Err(ScoreError::Geometry { what: "map", .. })));
}
