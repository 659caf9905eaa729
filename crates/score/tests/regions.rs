//! Regions against a second way to find them: every ray cut with every cell's square.

use grid::{GridSpec, Raster};
use proptest::prelude::*;
use score::{NUDGE_M, Region, SHELL_DEPTH_M, Sight, Sightings};

const CELL_M: f64 = 0.07;

/// The ranges at which a ray is inside the square of a cell, if it meets it (slab method).
fn chord(spec: &GridSpec, cell: usize, origin: [f64; 2], direction: [f64; 2]) -> Option<(f64, f64)> {
    let low = spec.corner(cell);
    let (mut enter, mut exit) = (0.0f64, f64::INFINITY);
    for axis in 0..2 {
        let ends = [low[axis], low[axis] + spec.cell_m].map(|line| (line - origin[axis]) / direction[axis]);
        enter = enter.max(ends[0].min(ends[1]));
        exit = exit.min(ends[0].max(ends[1]));
    }
    (enter < exit).then_some((enter, exit))
}

/// The regions by definition, with obstacles that fill their cells exactly.
#[derive(Clone)]
struct Slow {
    truth: Raster<Option<bool>>,
    visible: Raster<bool>,
    surface: Raster<bool>,
    behind: Raster<bool>,
    looks: Raster<u32>,
    nearest_m: Raster<f64>,
}

impl Slow {
    fn new(truth: &Raster<Option<bool>>) -> Self {
        let none = truth.map(|_| false);
        let looks = truth.map(|_| 0);
        let nearest_m = truth.map(|_| f64::INFINITY);
        Self { truth: truth.clone(), visible: none.clone(), surface: none.clone(), behind: none, looks, nearest_m }
    }

    /// Casts one ray and marks what it sees. `None` where a chord is about as short as what counts
    /// as touching, or the shell about as deep, so that rounding decides.
    fn add(&mut self, origin: [f64; 2], direction: [f64; 2]) -> Option<Sight> {
        let spec = *self.truth.spec();
        let chords: Vec<_> =
            (0..spec.cells()).filter_map(|c| chord(&spec, c, origin, direction).map(|(a, b)| (c, a, b))).collect();
        let hit = chords.iter().filter(|c| self.truth[c.0] == Some(true)).min_by(|a, b| a.1.total_cmp(&b.1));
        let range = hit.map_or(f64::INFINITY, |hit| hit.1);
        let end = range + SHELL_DEPTH_M;
        let clear = |length: f64| length <= 0.0 || length > 10.0 * NUDGE_M;
        if !chords.iter().all(|&(_, a, b)| clear(b - a) && clear(end - a) && (clear(b - range) || b <= range + 1e-12)) {
            return None;
        }
        for &(cell, enter, exit) in &chords {
            if exit.min(range) - enter > NUDGE_M {
                self.looks[cell] += 1;
                self.nearest_m[cell] = self.nearest_m[cell].min(enter);
                self.visible[cell] |= self.truth[cell] == Some(false);
            } else if enter > range && exit.min(end) - enter > NUDGE_M {
                self.behind[cell] = true;
            }
        }
        if let Some(&(cell, enter, _)) = hit {
            self.surface[cell] = true;
            self.looks[cell] += 1;
            self.nearest_m[cell] = self.nearest_m[cell].min(enter);
        }
        Some(Sight { origin_m: origin, direction, range_m: hit.map(|hit| hit.1) })
    }

    fn contains(&self, region: Region, cell: usize) -> bool {
        let known = self.truth[cell].is_some();
        let observable = self.visible[cell] || self.surface[cell];
        match region {
            Region::Visible => self.visible[cell],
            Region::Surface => self.surface[cell],
            Region::Observable => observable,
            Region::Shell => known && !observable && self.behind[cell],
            Region::Hidden => known && !observable && !self.behind[cell],
            Region::All => known,
        }
    }
}

fn world() -> impl Strategy<Value = Raster<Option<bool>>> {
    (1usize..14, 1usize..14, 0.0f64..0.4).prop_flat_map(|(width, height, occupied)| {
        let spec = GridSpec { cell_m: CELL_M, origin_m: [-0.3, 0.2], width, height };
        let cell = prop::option::weighted(0.95, prop::bool::weighted(occupied));
        prop::collection::vec(cell, width * height).prop_map(move |cells| Raster::new(spec, cells))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_000))]

    #[test]
    fn equal_to_cutting_every_ray_with_every_cell(
        truth in world(), rays in prop::collection::vec((0.0f64..1.0, 0.0f64..1.0, 0.0f64..std::f64::consts::TAU), 1..12),
    ) {
        let spec = *truth.spec();
        let (mut slow, mut sightings) = (Slow::new(&truth), Sightings::new(&truth));
        let mut cast = 0;
        for (x, y, angle) in rays {
            let origin = [
                spec.origin_m[0] + x * spec.width as f64 * CELL_M,
                spec.origin_m[1] + y * spec.height as f64 * CELL_M,
            ];
            if let Some(sight) = slow.add(origin, [angle.cos(), angle.sin()]) {
                sightings.add(&sight);
                cast += 1;
            }
        }
        prop_assume!(cast > 0);
        prop_assert_eq!(sightings.hits_without_surface(), 0);
        prop_assert_eq!(sightings.looks(), &slow.looks);
        for (cell, (found, expected)) in sightings.nearest_m().values().iter().zip(slow.nearest_m.values()).enumerate() {
            let same = (found.is_infinite() && expected.is_infinite()) || (found - expected).abs() < 1e-12;
            prop_assert!(same, "cell {} entered at {} m and not {} m", cell, found, expected);
        }
        for region in Region::ALL {
            let mask = sightings.mask(region);
            for cell in 0..spec.cells() {
                prop_assert_eq!(mask[cell], slow.contains(region, cell), "{:?} cell {}", region, cell);
            }
        }
    }

    /// From a lattice of starts along a lattice of directions, hits lie on grid lines and corners,
    /// and some rays run along walls: whatever rounding decides, no cell may be in a region it
    /// cannot be in.
    #[test]
    fn rays_along_grid_lines_keep_the_regions_apart(
        truth in world(), rays in prop::collection::vec((0usize..13, 0usize..13, 0usize..8, 0usize..12), 1..12),
    ) {
        let spec = *truth.spec();
        let mut sightings = Sightings::new(&truth);
        for (column, row, eighth, cells) in rays {
            let h = std::f64::consts::FRAC_1_SQRT_2;
            let direction = [[1.0, 0.0], [h, h], [0.0, 1.0], [-h, h], [-1.0, 0.0], [-h, -h], [0.0, -1.0], [h, -h]][eighth];
            let step = if eighth % 2 == 0 { CELL_M } else { CELL_M / h };
            let origin_m = [spec.origin_m[0] + column as f64 * CELL_M, spec.origin_m[1] + row as f64 * CELL_M];
            sightings.add(&Sight { origin_m, direction, range_m: (cells < 11).then_some(cells as f64 * step) });
        }
        for (cell, &known) in truth.values().iter().enumerate() {
            let inside = |region| sightings.contains(region, cell);
            let parts = [Region::Visible, Region::Surface, Region::Shell, Region::Hidden];
            prop_assert_eq!(parts.iter().filter(|r| inside(**r)).count(), usize::from(known.is_some()));
            prop_assert!(!inside(Region::Visible) || known == Some(false));
            prop_assert!(!inside(Region::Surface) || known == Some(true));
            prop_assert!(!inside(Region::Observable) || sightings.looks()[cell] > 0);
            prop_assert_eq!(sightings.nearest_m()[cell].is_finite(), sightings.looks()[cell] > 0);
        }
    }

    #[test]
    fn the_order_of_the_rays_does_not_matter(truth in world(), angles in prop::collection::vec(0.0f64..std::f64::consts::TAU, 1..12)) {
        let spec = *truth.spec();
        let sight = |angle: &f64| Sight {
            origin_m: spec.centre(spec.cells() / 2),
            direction: [angle.cos(), angle.sin()],
            range_m: Some(0.1 * angle),
        };
        let [mut one, mut other] = [Sightings::new(&truth), Sightings::new(&truth)];
        angles.iter().for_each(|a| one.add(&sight(a)));
        angles.iter().rev().for_each(|a| other.add(&sight(a)));
        prop_assert_eq!(one.looks(), other.looks());
        prop_assert_eq!(one.nearest_m(), other.nearest_m());
        for region in Region::ALL {
            prop_assert_eq!(one.mask(region), other.mask(region));
        }
    }
}
