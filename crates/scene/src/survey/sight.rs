//! Which cells of the floor are seen.

use grid::{DigitalLine, GridSpec, Raster};
use rayon::prelude::*;

use super::plan::SurveyOptions;
use crate::drive::course;

/// Looks over the grid. What is not free hides what is behind it.
pub(super) struct Sight<'a> {
    cells: &'a Raster<Option<bool>>,
    floor: &'a Raster<bool>,
    range_m: f64,
    /// Directions all round, so close that no cell within the range is passed by.
    around: Vec<[f64; 2]>,
}

/// What a look all round needs: a line to trace, and which look a cell was last seen in.
pub(super) struct Looker {
    line: DigitalLine,
    looked: Vec<u32>,
    looks: u32,
}

impl<'a> Sight<'a> {
    pub(super) fn new(cells: &'a Raster<Option<bool>>, floor: &'a Raster<bool>, options: &SurveyOptions) -> Self {
        /// Beyond this many directions a look takes long, and the camera has fewer.
        const MOST: f64 = 2000.0;
        let range_m = options.range_m;
        let directions = (std::f64::consts::TAU * range_m / cells.spec().cell_m).ceil().clamp(64.0, MOST);
        let direction = |k: usize| {
            let (sin, cos) = libm::sincos((k as f64 + 0.5) * std::f64::consts::TAU / directions);
            [cos, sin]
        };
        Self { cells, floor, range_m, around: (0..directions as usize).map(direction).collect() }
    }

    pub(super) fn range_m(&self) -> f64 {
        self.range_m
    }

    /// How many cells there are to see.
    pub(super) fn floor_cells(&self) -> usize {
        self.floor.values().iter().filter(|&&v| v).count()
    }

    pub(super) fn looker(&self) -> Looker {
        Looker { line: DigitalLine::default(), looked: vec![0; self.cells.spec().cells()], looks: 0 }
    }

    /// The cells of the floor seen all round from the centre of a cell, each once.
    pub(super) fn around(&self, from: usize, looker: &mut Looker) -> Vec<usize> {
        let Looker { line, looked, looks } = looker;
        *looks += 1;
        let mut found = Vec::new();
        for &direction in &self.around {
            self.along(self.spec().centre(from), direction, line, |cell| {
                if looked[cell] != *looks {
                    looked[cell] = *looks;
                    found.push(cell);
                }
            });
        }
        found
    }

    /// The cells of the floor that the camera's rays cross in the scans of a drive along `stops_m`.
    pub(super) fn seen_on(&self, stops_m: &[[f64; 2]], options: &SurveyOptions) -> Vec<bool> {
        let poses = course::undisturbed(stops_m, &options.robot);
        let bearings_rad = options.camera.bearings_rad();
        let nothing = || (DigitalLine::default(), vec![false; self.spec().cells()]);
        let chunks = poses.par_chunks(poses.len().div_ceil(rayon::current_num_threads()).max(1));
        let seen = chunks.map(|poses| {
            let (mut line, mut seen) = nothing();
            for at in poses {
                for &bearing in &bearings_rad {
                    let direction = at.pose.direction(bearing);
                    self.along(at.pose.position_m(), direction, &mut line, |cell| seen[cell] = true);
                }
            }
            seen
        });
        seen.reduce(
            || vec![false; self.spec().cells()],
            |mut a, b| {
                a.iter_mut().zip(b).for_each(|(a, b)| *a |= b);
                a
            },
        )
    }

    fn spec(&self) -> &GridSpec {
        self.cells.spec()
    }

    /// Tells of every cell of the floor on a ray, up to the range or to what is not free.
    fn along(&self, from_m: [f64; 2], direction: [f64; 2], line: &mut DigitalLine, mut tell: impl FnMut(usize)) {
        line.trace(self.spec(), from_m, direction, self.range_m);
        for &cell in line.cells().iter().take_while(|&&cell| self.cells[cell] == Some(false)) {
            if self.floor[cell] {
                tell(cell);
            }
        }
    }
}
