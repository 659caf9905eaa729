//! The likelihood field of a map's surfaces round a scan, with upper bounds over squares of cells.

use mapper::Mapper;

use crate::surfaces::Surfaces;

/// A surface is asked for in the cell of a point and in the eight around it.
const NEAR: usize = 1;

/// Bounds are kept over squares of 1, 2, 4 and 8 cells on a side.
pub(crate) const LEVELS: usize = 4;

/// A bound in steps of this share of the most that a point can be worth.
const STEPS: f64 = 255.0;

/// What is worth matching to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sharpness {
    /// Standard deviation of where a reading ends to where the surface is, m; above 0.
    pub sigma_m: f64,
    /// Surfaces in cells that the map holds occupied with less than this probability are none any more.
    pub occupied: f64,
    /// What the readings of a scan are worth of as many independent ones, against the odometry; above 0 and at most 1.
    pub power: f64,
}

impl Default for Sharpness {
    /// 0.07 m, surfaces that are at least as likely as three in ten, and every reading: chosen by hand on a few runs of one particle through
    /// ACES, which hardly tell 0.05 from 0.1 m.
    fn default() -> Self {
        Self { sigma_m: 0.07, occupied: 0.3, power: 1.0 }
    }
}

/// The surfaces in a window of the map, cell by cell.
pub(crate) struct Field {
    sigma_m: f64,
    cell_m: f64,
    origin_m: [f64; 2],
    width: usize,
    height: usize,
    /// Place of the surface of every cell from the window's corner, m; NaN where there is none.
    means: Vec<[f32; 2]>,
    /// On every level, the most that a point in the square from a cell on can be worth, in [`STEPS`].
    bounds: [Vec<u8>; LEVELS],
    /// Number of surfaces.
    pub(crate) surfaces: usize,
}

impl Field {
    /// Of the surfaces between two corners, m, that the map still holds occupied. Bounds are made where they are wanted.
    pub(crate) fn new(
        surfaces: &Surfaces,
        map: &dyn Mapper,
        sharpness: Sharpness,
        [low, high]: [[f64; 2]; 2],
        bounds: bool,
    ) -> Self {
        let spec = surfaces.spec();
        let index = |at: f64, k: usize| libm::floor((at - spec.origin_m[k]) / spec.cell_m).max(0.0) as usize;
        let most = [spec.width, spec.height];
        let from = [0, 1].map(|k| index(low[k], k).saturating_sub(NEAR).min(most[k]));
        let until = [0, 1].map(|k| (index(high[k], k) + 1 + NEAR).min(most[k]).max(from[k]));
        let [width, height] = [0, 1].map(|k| until[k] - from[k]);
        let origin_m = [0, 1].map(|k| spec.origin_m[k] + spec.cell_m * from[k] as f64);
        let mut field = Self {
            sigma_m: sharpness.sigma_m,
            cell_m: spec.cell_m,
            origin_m,
            width,
            height,
            means: vec![[f32::NAN; 2]; width * height],
            bounds: Default::default(),
            surfaces: 0,
        };
        surfaces.each(from[0]..until[0], from[1]..until[1], |column, row, at| {
            if map.occupied(row * spec.width + column) >= sharpness.occupied {
                let place = (row - from[1]) * width + column - from[0];
                field.means[place] = [0, 1].map(|k| (at[k] - origin_m[k]) as f32);
                field.surfaces += 1;
            }
        });
        if bounds {
            field.bound();
        }
        field
    }

    /// Column and row of a point, m, from the window's corner on; they may lie outside.
    #[inline(always)]
    pub(crate) fn place(&self, at_m: [f64; 2]) -> [i32; 2] {
        [0, 1].map(|k| libm::floor((at_m[k] - self.origin_m[k]) / self.cell_m) as i32)
    }

    /// Side of a cell, m.
    pub(crate) fn cell_m(&self) -> f64 {
        self.cell_m
    }

    /// The window's corner, m.
    #[cfg(test)]
    pub(crate) fn origin_m(&self) -> [f64; 2] {
        self.origin_m
    }

    /// Square of the distance of a point, m, to the nearest surface of its cell and of the eight around it, in sigmas; infinite where
    /// these have none.
    #[inline(always)]
    pub(crate) fn squared(&self, at_m: [f64; 2]) -> f64 {
        let [column, row] = self.place(at_m);
        let near = NEAR as i32;
        if column < near || row < near || column + near >= self.width as i32 || row + near >= self.height as i32 {
            return f64::INFINITY;
        }
        let at = [0, 1].map(|k| (at_m[k] - self.origin_m[k]) as f32);
        let mut least = f32::INFINITY;
        for r in row - near..=row + near {
            let first = (r as usize) * self.width + (column - near) as usize;
            for [x, y] in &self.means[first..=first + 2 * NEAR] {
                let squared = (x - at[0]) * (x - at[0]) + (y - at[1]) * (y - at[1]);
                // Of no surface it is NaN, which is not less.
                if squared < least {
                    least = squared;
                }
            }
        }
        f64::from(least) / (self.sigma_m * self.sigma_m)
    }

    /// What a point is worth, 0 to 1: `exp(-d^2 / 2 sigma^2)`.
    #[inline(always)]
    pub(crate) fn worth(&self, at_m: [f64; 2]) -> f64 {
        let squared = self.squared(at_m);
        if squared < 60.0 { libm::exp(-0.5 * squared) } else { 0.0 }
    }

    /// At least what any point in the square of `2^level` cells from a cell on is worth.
    #[inline(always)]
    pub(crate) fn bound_of(&self, [column, row]: [i32; 2], level: usize) -> f64 {
        // Squares that begin before the window reach into it.
        let before = (1 << level) - 1;
        let [column, row] = [column + before, row + before];
        let [width, height] = self.size_of_bounds();
        if column < 0 || row < 0 || column as usize >= width || row as usize >= height {
            return 0.0;
        }
        f64::from(self.bounds[level][row as usize * width + column as usize]) / STEPS
    }

    /// Bounds begin so many cells before the window as the largest square is long.
    fn size_of_bounds(&self) -> [usize; 2] {
        [self.width, self.height].map(|cells| cells + (1 << (LEVELS - 1)) - 1)
    }

    fn bound(&mut self) {
        let [width, height] = self.size_of_bounds();
        // Level 0: the point of a cell that lies nearest to each surface around it.
        let mut one = vec![0u8; width * height];
        let cell = self.cell_m as f32;
        let scale = -0.5 / (self.sigma_m * self.sigma_m);
        for (place, [x, y]) in self.means.iter().enumerate().filter(|(_, [x, _])| !x.is_nan()) {
            let (column, row) = (place % self.width, place / self.width);
            for r in row.saturating_sub(NEAR)..=(row + NEAR).min(self.height - 1) {
                for c in column.saturating_sub(NEAR)..=(column + NEAR).min(self.width - 1) {
                    let apart = |at: f32, index: usize| {
                        let low = index as f32 * cell;
                        f64::from((low - at).max(at - low - cell).max(0.0))
                    };
                    let (dx, dy) = (apart(*x, c), apart(*y, r));
                    // A little more, for a place that rounding puts into the next cell.
                    let worth = (STEPS * libm::exp(scale * (dx * dx + dy * dy)) + 0.01).ceil().min(STEPS) as u8;
                    let bound = &mut one[r * width + c];
                    *bound = worth.max(*bound);
                }
            }
        }
        self.bounds[0] = one;
        // Level l is stored 2^l - 1 cells on, so that squares that begin before the window are there: each is the most of four of the level
        // below, which end where it ends.
        let mut across = vec![0u8; width * height];
        for level in 1..LEVELS {
            let half = 1usize << (level - 1);
            let finer = &self.bounds[level - 1];
            for (from, into) in finer.chunks_exact(width).zip(across.chunks_exact_mut(width)) {
                into[..half].copy_from_slice(&from[..half]);
                let pairs = from.iter().zip(&from[half..]);
                into[half..].iter_mut().zip(pairs).for_each(|(into, (a, b))| *into = *a.max(b));
            }
            let mut coarser = across.clone();
            let pairs = across.iter().zip(&across[half * width..]);
            coarser[half * width..].iter_mut().zip(pairs).for_each(|(into, (a, b))| *into = *a.max(b));
            self.bounds[level] = coarser;
        }
    }
}
