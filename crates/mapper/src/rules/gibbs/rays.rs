//! All rays, as a map's changes see them: by ray and by cell.

use grid::DigitalLine;

use crate::memory::Held;
use crate::rules::gibbs::surface::{self, Course};
use crate::rules::readings::{Crossings, Readings};

/// A likelihood below this share of the ray's largest counts as this: it keeps logarithms finite.
const LEAST: f64 = 1e-12;

/// Chance that a ray that has passed its first occupied cell passes the next one too.
const GOES_ON: f64 = 0.7;

/// What a reading says, beyond the likelihood of its sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reading {
    /// Weight of its log likelihood, above 0.
    pub(super) weight: f64,
    /// Share of rays that pass the first occupied cell, 0 up to but not including 1.
    pub(super) leak: f64,
}

/// The log likelihoods of all readings by the first occupied cell of their rays, times the weight of a reading.
///
/// A cell is occupied where a wall covers it in part, and rays pass it then, most of all those that graze the wall: with the chance `leak` the
/// ray ends in one of the cells behind, in the next with the chance 0.3, in the one after that with 0.7 times 0.3, and so on, whatever stands there.
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
    pub(super) fn new(readings: &'a Readings, cells: usize, Reading { weight, leak }: Reading) -> Self {
        let mut log = Vec::with_capacity(readings.cells().len());
        let mut none = Vec::with_capacity(readings.rays());
        let (mut line, mut met) = (DigitalLine::default(), Vec::new());
        let spec = readings.spec();
        for ray in 0..readings.rays() {
            let likelihood = &readings.likelihood()[readings.span(ray)];
            let most = likelihood.iter().copied().fold(readings.none(ray), f64::max);
            // A reading that no map explains says nothing.
            let of = |l: f64| if most > 0.0 { weight * libm::log((l / most).max(LEAST)) } else { 0.0 };
            // What a ray ends in that passes its first occupied cell: most likely one of the next.
            let mut after = readings.none(ray);
            let begin = log.len();
            let column = |cell: usize| spec.column_row(readings.cells()[readings.span(ray)][cell] as usize).0;
            let (ranges_m, direction) = readings.trace(ray, &mut line);
            let course = Course { ranges_m, direction, cell_m: spec.cell_m };
            let is_beside = |cell: usize| column(cell) != column(cell - 1);
            surface::likelihoods(&course, is_beside, likelihood, readings.none(ray), &mut met);
            for (&l, &m) in likelihood.iter().zip(&met).rev() {
                log.push(of((1.0 - leak) * m + leak * after));
                after = GOES_ON * after + (1.0 - GOES_ON) * l;
            }
            log[begin..].reverse();
            none.push(of(readings.none(ray)));
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
