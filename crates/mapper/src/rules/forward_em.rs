//! The most likely map under the forward model, by expectation maximisation.
//!
//! Thrun, "Learning Occupancy Grid Maps with Forward Sensor Models", Autonomous Robots 15, 2003 (the
//! paper cites it as 2002a).

use grid::Raster;
use sensor::Scan;

use crate::belief::probability::{from_log_odds, log_odds};
use crate::mapper::{Mapper, Work};
use crate::memory::Held as _;
use crate::model::Model;
use crate::rules::climb::{Climb, Values};
use crate::rules::readings::Readings;

/// At most so many expectation and maximisation steps.
const ITERATIONS: usize = 50;

/// A climb may flip each cell so often on average.
const FLIPS_PER_CELL: usize = 20;

/// Likelihood of a correct match, as a share of that of a false one, below which all cells explain a
/// reading equally badly: seven standard deviations off for the paper's sensor. It changes the
/// likelihood of a reading by less than this share, and keeps logarithms finite.
const LEAST: f64 = 1e-9;

/// The map that maximises prior times likelihood of all readings, and how sure each cell of it is. Batch;
/// O(cells on the ray) per ray and iteration, at most 50 iterations.
///
/// What is hidden is which obstacle caused each reading: under the model of Eq. (21) the first occupied
/// cell of its ray, or none (a false match).
///
/// - *Expectation:* the probability `e` that a reading came from the first occupied cell of the map so far.
///   Before there is a map it is `P(T)`.
/// - *Maximisation:* from the map so far, the cell whose flip gains most is flipped until none gains, where
///   the gain is that of the expected log likelihood `sum e ln P(T) g_k(o)` and of the log prior of
///   independent cells. Prior times likelihood never falls from then on.
/// - *End:* when a maximisation flips nothing, flips are tried that let the causes change with the map;
///   the final map is then a local maximum of prior times likelihood: no single flip raises it.
/// - *Residual uncertainty:* `P(E_j)` given all readings and that every other cell is as in the final map,
///   from the ratio of prior times likelihood with and without the cell. A cell that no reading depends on
///   keeps the prior.
///
/// Correlation of neighbours is not part of the method. Every call of [`settle`](Mapper::settle) starts from
/// the empty map, so that the result does not depend on how often it was called.
#[derive(Clone)]
pub struct ForwardEm {
    readings: Readings,
    prior: f64,
    solved: usize,
    map: Raster<bool>,
    objectives: Vec<f64>,
    occupancy: Raster<f64>,
}

impl ForwardEm {
    /// The unseen map.
    pub fn new(model: &Model) -> Self {
        let prior = model.prior.marginal();
        Self {
            readings: Readings::new(model),
            prior,
            solved: 0,
            map: Raster::filled(model.grid, false),
            objectives: Vec::new(),
            occupancy: Raster::filled(model.grid, prior),
        }
    }

    /// The most likely map found.
    pub fn map(&self) -> &Raster<bool> {
        &self.map
    }

    /// Log of prior times likelihood of all readings after each maximisation, up to a constant; nats.
    pub fn objectives(&self) -> &[f64] {
        &self.objectives
    }
}

/// The log likelihoods of a reading if its first occupied cell is known, for every entry and for rays without one.
struct Explained {
    /// Likelihood of each reading as a false match, which no map changes.
    false_match: Vec<f64>,
    /// `ln` of the likelihood of a correct match.
    correct: Values,
    /// `ln` of the likelihood of either.
    either: Values,
}

impl Explained {
    fn new(readings: &Readings) -> Self {
        let false_match = readings.false_match().to_vec();
        let correct = |l: f64, false_match: f64| (l - false_match).max((LEAST * false_match).max(1e-15));
        let logs = |f: &dyn Fn(f64, f64) -> f64| {
            let rays = || false_match.iter().enumerate();
            let along = |(ray, &false_match): (usize, &f64)| {
                readings.likelihood()[readings.span(ray)].iter().map(move |&l| libm::log(f(l, false_match)))
            };
            Values {
                entry: rays().flat_map(along).collect(),
                none: rays().map(|(ray, &false_match)| libm::log(f(readings.none(ray), false_match))).collect(),
            }
        };
        let either = |l: f64, false_match: f64| correct(l, false_match) + false_match;
        let (correct, either) = (logs(&correct), logs(&either));
        Self { false_match, correct, either }
    }

    /// The expectation: whether each reading came from the first occupied cell of its ray.
    fn causes(&self, climb: &Climb) -> Vec<f64> {
        let logs = self.correct.none.iter().enumerate();
        let logs = logs.map(|(ray, none)| climb.first(ray).map_or(*none, |entry| self.correct.entry[entry]));
        logs.zip(&self.false_match).map(|(log, false_match)| 1.0 / (1.0 + false_match * libm::exp(-log))).collect()
    }

    /// What the maximisation climbs, given the causes.
    fn expected(&self, readings: &Readings, causes: &[f64]) -> Values {
        let mut entry = self.correct.entry.clone();
        for (ray, cause) in causes.iter().enumerate() {
            entry[readings.span(ray)].iter_mut().for_each(|log| *log *= cause);
        }
        Values { entry, none: self.correct.none.iter().zip(causes).map(|(log, cause)| log * cause).collect() }
    }

    /// Log of prior times likelihood.
    fn objective(&self, climb: &Climb, log_odds: f64) -> f64 {
        let either = self.either.none.iter().enumerate();
        let readings = either.map(|(ray, none)| climb.first(ray).map_or(*none, |entry| self.either.entry[entry]));
        readings.sum::<f64>() + log_odds * climb.occupied().iter().filter(|on| **on).count() as f64
    }
}

impl Mapper for ForwardEm {
    fn integrate(&mut self, scan: &Scan) {
        self.readings.add(scan);
    }

    fn settle(&mut self) {
        if self.solved == self.readings.rays() {
            return;
        }
        self.solved = self.readings.rays();
        let cells = self.map.spec().cells();
        let (log_odds, most) = (log_odds(self.prior), FLIPS_PER_CELL * cells);
        let model = Explained::new(&self.readings);
        let mut climb = Climb::new(&self.readings, cells, log_odds);
        let mut causes = self.readings.correct_match().to_vec();
        self.objectives.clear();
        for _ in 0..ITERATIONS {
            let mut flips = climb.climb(&model.expected(&self.readings, &causes), most);
            if flips == 0 {
                flips = climb.climb(&model.either, most);
            }
            self.objectives.push(model.objective(&climb, log_odds));
            if flips == 0 {
                break;
            }
            causes = model.causes(&climb);
        }
        climb.climb(&model.either, most);
        self.map.values_mut().copy_from_slice(climb.occupied());
        for ((p, &gain), &on) in self.occupancy.values_mut().iter_mut().zip(climb.gain()).zip(climb.occupied()) {
            *p = from_log_odds(if on { -gain } else { gain });
        }
    }

    fn occupancy(&self) -> &Raster<f64> {
        &self.occupancy
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(self.clone()))
    }

    /// Does not count cells; keeps every reading.
    fn work(&self) -> Work {
        Work { cells: 0, bytes: self.occupancy.held() + self.map.held() + self.readings.held() }
    }
}
