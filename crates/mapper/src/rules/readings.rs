//! The readings of all scans, kept for mappers that solve for all of them at once.

use grid::{DigitalLine, GridSpec};
use sensor::Scan;

use crate::memory::Held;
use crate::model::{Model, Sensors};
use crate::ray::likelihood::RayLikelihood;

/// Every ray with a reading: its cells and what each of them would explain. 12 bytes per cell of a ray.
#[derive(Clone)]
pub(crate) struct Readings {
    spec: GridSpec,
    sensors: Sensors,
    onset: f64,
    ray: RayLikelihood,
    /// Cells of all rays, one ray after the other, nearest first.
    cells: Vec<u32>,
    /// `P(o | F_k)`, one per entry of `cells`, per unit of the reading.
    likelihood: Vec<f64>,
    /// `P(T)` of the sensor, one per ray.
    correct_match: Vec<f64>,
    /// `P(o, not T)`, the likelihood of the reading as a false match, one per ray: what no map changes.
    false_match: Vec<f64>,
    /// `P(o | no cell of the ray is occupied)`, one per ray.
    none: Vec<f64>,
    /// Where every ray begins, m, and its direction.
    lines: Vec<[[f64; 2]; 2]>,
    /// End of every ray in `cells`.
    ends: Vec<usize>,
}

impl Readings {
    /// No reading yet.
    pub(crate) fn new(model: &Model) -> Self {
        Self {
            spec: model.grid,
            sensors: model.sensors.clone(),
            onset: model.prior.onset(model.grid.cell_m),
            ray: RayLikelihood::default(),
            cells: Vec::new(),
            likelihood: Vec::new(),
            correct_match: Vec::new(),
            false_match: Vec::new(),
            none: Vec::new(),
            lines: Vec::new(),
            ends: Vec::new(),
        }
    }

    /// Keeps the rays of a scan that have a reading and cross the map. O(cells on the ray) per ray.
    pub(crate) fn add(&mut self, scan: &Scan) {
        let sensor = &**self.sensors.of(scan);
        for ray in scan.rays() {
            let Some(reading) = ray.reading.filter(|_| self.ray.take(&ray, &self.spec, sensor, self.onset)) else {
                continue;
            };
            // GridSpec::MAX_CELLS fits a u32.
            self.cells.extend(self.ray.line.cells().iter().map(|&cell| cell as u32));
            self.likelihood.extend(&self.ray.likelihood);
            self.none.push(self.ray.none);
            self.lines.push([ray.origin_m, ray.direction]);
            self.ends.push(self.cells.len());
            self.correct_match.push(sensor.correct_match());
            // A bin of width 1: the density of false matches, which is uniform.
            let false_match = sensor.false_match_probability(reading, 0.5);
            self.false_match.push((1.0 - sensor.correct_match()) * false_match);
        }
    }

    /// The cells of the map.
    pub(crate) fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// Number of rays.
    pub(crate) fn rays(&self) -> usize {
        self.ends.len()
    }

    /// Entries of a ray in [`cells`](Self::cells) and [`likelihood`](Self::likelihood).
    pub(crate) fn span(&self, ray: usize) -> std::ops::Range<usize> {
        let start = if ray == 0 { 0 } else { self.ends[ray - 1] };
        start..self.ends[ray]
    }

    /// Cells of all rays.
    pub(crate) fn cells(&self) -> &[u32] {
        &self.cells
    }

    /// `P(o | F_k)` of all entries.
    pub(crate) fn likelihood(&self) -> &[f64] {
        &self.likelihood
    }

    /// `P(T)` of the sensor of every ray.
    pub(crate) fn correct_match(&self) -> &[f64] {
        &self.correct_match
    }

    /// `P(o, not T)`, the likelihood of every ray's reading as a false match.
    pub(crate) fn false_match(&self) -> &[f64] {
        &self.false_match
    }

    /// `P(o | no cell of the ray is occupied)`.
    pub(crate) fn none(&self, ray: usize) -> f64 {
        self.none[ray]
    }

    /// Traces a ray anew into a buffer, and tells its direction.
    pub(crate) fn trace(&self, ray: usize, line: &mut DigitalLine) -> [f64; 2] {
        let [origin_m, direction] = self.lines[ray];
        line.trace(&self.spec, origin_m, direction, f64::INFINITY);
        direction
    }

    /// The rays through each of so many cells. O(entries).
    pub(crate) fn crossings(&self, cells: usize) -> Crossings {
        let mut starts = vec![0; cells + 1];
        for &cell in &self.cells {
            starts[cell as usize + 1] += 1;
        }
        for cell in 0..cells {
            starts[cell + 1] += starts[cell];
        }
        let mut next = starts.clone();
        let mut all = vec![(0, 0); self.cells.len()];
        for ray in 0..self.rays() {
            for entry in self.span(ray) {
                let slot = &mut next[self.cells[entry] as usize];
                all[*slot] = (ray as u32, entry as u32);
                *slot += 1;
            }
        }
        Crossings { starts, all }
    }
}

/// The rays through every cell, with the entry that it is of each.
pub(crate) struct Crossings {
    /// Begin of each cell's rays in `all`.
    starts: Vec<usize>,
    /// Ray and entry, cell by cell, rays rising.
    all: Vec<(u32, u32)>,
}

impl Crossings {
    /// Numbers of a cell's rays, for [`ray`](Self::ray).
    pub(crate) fn numbers(&self, cell: usize) -> std::ops::Range<usize> {
        self.starts[cell]..self.starts[cell + 1]
    }

    /// The ray of a number, and the entry that the cell is of it.
    pub(crate) fn ray(&self, number: usize) -> (u32, u32) {
        self.all[number]
    }

    /// Rays through a cell with the entry that it is of each, rays rising.
    pub(crate) fn of(&self, cell: usize) -> &[(u32, u32)] {
        &self.all[self.numbers(cell)]
    }
}

impl Held for Crossings {
    fn held(&self) -> usize {
        self.starts.held() + self.all.held()
    }
}

impl Held for Readings {
    fn held(&self) -> usize {
        let rays = self.correct_match.held() + self.false_match.held() + self.none.held() + self.lines.held();
        self.ray.held() + self.cells.held() + self.likelihood.held() + self.ends.held() + rays
    }
}
