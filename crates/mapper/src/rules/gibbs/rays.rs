//! All rays, as a map's changes see them: by ray and by cell.

use grid::DigitalLine;

use crate::memory::Held;
use crate::ray::worth::{Explained, Reading, Worth};
use crate::rules::readings::{Crossings, Readings};

/// The log likelihoods of all readings by the first occupied cell of their rays, times the weight of a reading, as [`Worth`] has them.
///
/// Entries number the cells of all rays as in [`Readings::cells`].
pub(super) struct Rays<'a> {
    readings: &'a Readings,
    /// What a ray is worth if its first occupied cell is this entry, nats.
    log: Vec<f64>,
    /// What a ray is worth if none of its cells is occupied, nats.
    none: Vec<f64>,
    crossings: Crossings,
}

impl<'a> Rays<'a> {
    /// Indexes the readings of a map of so many cells. O(entries).
    pub(super) fn new(readings: &'a Readings, cells: usize, reading: Reading) -> Self {
        let mut log = Vec::with_capacity(readings.cells().len());
        let mut none = Vec::with_capacity(readings.rays());
        let (mut line, mut worth, mut of_ray) = (DigitalLine::default(), Worth::default(), Vec::new());
        for ray in 0..readings.rays() {
            let direction = readings.trace(ray, &mut line);
            let likelihood = &readings.likelihood()[readings.span(ray)];
            let explained = Explained { line: &line, direction, likelihood, none: readings.none(ray) };
            none.push(worth.of(&reading, readings.spec(), &explained, 0.0, &mut of_ray));
            log.extend(&of_ray);
        }
        Self { readings, log, none, crossings: readings.crossings(cells) }
    }

    /// Number of rays.
    pub(super) fn count(&self) -> usize {
        self.readings.rays()
    }

    /// Entries of a ray.
    pub(super) fn span(&self, ray: usize) -> std::ops::Range<usize> {
        self.readings.span(ray)
    }

    /// Cell of an entry.
    pub(super) fn cell(&self, entry: usize) -> usize {
        self.readings.cells()[entry] as usize
    }

    /// Cells of entries.
    pub(super) fn cells(&self, entries: std::ops::Range<usize>) -> &[u32] {
        &self.readings.cells()[entries]
    }

    /// What the entries of a ray are worth, nats.
    pub(super) fn logs(&self, entries: std::ops::Range<usize>) -> &[f64] {
        &self.log[entries]
    }

    /// What a ray is worth if this entry is its first occupied cell, or none is at the end of its span, nats.
    pub(super) fn value(&self, ray: usize, entry: usize) -> f64 {
        if entry < self.readings.span(ray).end { self.log[entry] } else { self.none[ray] }
    }

    /// Rays through a cell with the entry that it is of each, rays rising.
    pub(super) fn through(&self, cell: usize) -> &[(u32, u32)] {
        self.crossings.of(cell)
    }
}

impl Held for Rays<'_> {
    fn held(&self) -> usize {
        self.log.held() + self.none.held() + self.crossings.held()
    }
}
