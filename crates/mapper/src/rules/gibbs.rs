//! The posterior over whole maps, by sampling.
//!
//! Merali and Barfoot, "Occupancy grid mapping with Markov chain Monte Carlo Gibbs sampling", ICRA 2013: every reading is explained
//! by the map, not by each cell, and marginals are averages over maps.

mod chain;
pub mod field;
mod moves;
mod rays;
mod tally;
mod walk;
mod weights;

use grid::Raster;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use sensor::Scan;

use crate::belief::prior::Prior;
use crate::belief::probability::{bounded, log_odds};
use crate::fast::visibility::FastVisibility;
use crate::fit::{Fitted, Setting, numbers};
use crate::mapper::{Mapper, Mixing, Work};
use crate::memory::Held as _;
use crate::model::Model;
use crate::ray::worth::Reading;
use crate::rules::readings::Readings;

use self::chain::Chain;
use self::field::BlockField;
use self::rays::Rays;
use self::tally::{Tally, agreement};
use self::walk::Walk;

/// What becomes of a map whose chains do not agree, see [`Mixing::is_enough`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unmixed {
    /// There is no map, and [`Mapper::fault`] says why.
    Refused,
    /// It is shown all the same; [`Mapper::mixing`] says how far to trust it.
    Shown,
}

/// How the posterior is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// Weight of a reading's log likelihood, above 0: readings of consecutive scans repeat each other's errors, and cells that a wall covers in part
    /// are not what the model takes them for.
    pub weight: f64,
    /// Share of rays that pass the first occupied cell, of which they see a part, and end in one of the next two.
    pub leak: f64,
    /// Times that the log weights of the fitted field count.
    pub strength: f64,
    /// Shift of every cell's log odds, nats.
    pub shift: f64,
    /// Number of chains, at least 2: half of them begin at draws of the prior, half at draws of the map of `visibility`.
    pub chains: usize,
    /// Sweeps of the warm-up and of the first stage; a multiple of 10. Every stage has twice as many as the one before.
    pub sweeps: usize,
    /// No stage has more sweeps than this.
    pub most: usize,
    /// What all draws follow from.
    pub seed: u64,
    /// What becomes of a map whose chains do not agree.
    pub unmixed: Unmixed,
}

impl Sampling {
    /// Chosen on tuning worlds of all families: `cargo run -p experiments --features fitting --example gibbs_parameters`.
    pub const TUNED: Self = Self {
        weight: 0.2,
        leak: 0.1,
        strength: 0.7,
        shift: -0.2,
        chains: 4,
        sweeps: 100,
        most: 6400,
        seed: 1,
        unmixed: Unmixed::Refused,
    };

    /// The same with short stages, shown whether or not the chains agree.
    pub const UNCHECKED: Self = Self { most: 400, unmixed: Unmixed::Shown, ..Self::TUNED };

    /// The prior over maps of a model: the fitted field, in which a cell is as much more likely as the model's prior is more than the default one. It knows
    /// nothing of the prior's correlation.
    pub fn field(&self, model: &Model) -> BlockField {
        let more = log_odds(model.prior.marginal()) - log_odds(Prior::default().marginal());
        BlockField::fitted(model.grid.cell_m).scaled(self.strength).shifted(self.shift + more)
    }
}

impl Fitted for Sampling {
    fn parameters(&self) -> Vec<(&'static str, Setting)> {
        let Self { weight, leak, strength, shift, .. } = *self;
        numbers([("weight", weight), ("leak", leak), ("strength", strength), ("shift", shift)])
    }

    fn label(&self) -> String {
        let Self { weight, leak, strength, shift, .. } = self;
        format!("weight {weight}, leak {leak}, strength {strength}, shift {shift}")
    }

    fn mapper(&self, model: &Model) -> Box<dyn Mapper> {
        Box::new(Gibbs::new(model, *self))
    }
}

/// Every reading, and after [`settle`](Mapper::settle) the marginals of the posterior over maps. Batch.
pub struct Gibbs {
    sampling: Sampling,
    field: BlockField,
    empty: Readings,
    readings: Readings,
    /// The map of `visibility`, at draws of which half of the chains begin.
    start: Box<dyn Mapper>,
    prior: f64,
    solved: usize,
    mixing: Option<Mixing>,
    occupancy: Raster<f64>,
}

impl Gibbs {
    /// The unseen map.
    pub fn new(model: &Model, sampling: Sampling) -> Self {
        let prior = model.prior.marginal();
        Self {
            sampling,
            field: sampling.field(model),
            empty: Readings::new(model),
            readings: Readings::new(model),
            start: Box::new(FastVisibility::visibility(model)),
            prior,
            solved: 0,
            mixing: None,
            occupancy: Raster::filled(model.grid, prior),
        }
    }

    fn solve(&mut self) {
        let spec = *self.occupancy.spec();
        let rays =
            Rays::new(&self.readings, spec.cells(), Reading { weight: self.sampling.weight, leak: self.sampling.leak });
        let base = ChaCha8Rng::seed_from_u64(self.sampling.seed);
        let begin = |number: usize| {
            let mut rng = base.clone();
            rng.set_stream(number as u64);
            let map = if number.is_multiple_of(2) { self.of_prior(&mut rng) } else { self.of_start(&mut rng) };
            (map, rng)
        };
        let starts: Vec<_> = (0..self.sampling.chains).map(begin).collect();
        let (field, mut sweeps) = (&self.field, self.sampling.sweeps);
        let warm = |(map, rng)| {
            let mut chain = Chain::new(spec, Walk::new(spec, &rays, field, map), rng);
            chain.warm_up(sweeps);
            chain
        };
        let mut chains: Vec<Chain> = starts.into_par_iter().map(warm).collect();
        loop {
            let tallies: Vec<Tally> = chains.par_iter_mut().map(|chain| chain.stage(sweeps)).collect();
            let mixing = mixing(&tallies, spec.cells(), sweeps);
            if mixing.is_enough() || 2 * sweeps > self.sampling.most {
                let is_shown = mixing.is_enough() || self.sampling.unmixed == Unmixed::Shown;
                for (cell, p) in self.occupancy.values_mut().iter_mut().enumerate() {
                    *p = if is_shown { bounded(agreement(&tallies, cell).mean) } else { self.prior };
                }
                self.mixing = Some(mixing);
                return;
            }
            sweeps *= 2;
        }
    }

    /// A draw of the field alone.
    fn of_prior(&self, rng: &mut ChaCha8Rng) -> Vec<bool> {
        let spec = *self.occupancy.spec();
        let rays = Rays::new(&self.empty, spec.cells(), Reading { weight: 1.0, leak: 0.0 });
        let map = (0..spec.cells()).map(|_| rng.random::<f64>() < 0.1).collect();
        let mut chain = Chain::new(spec, Walk::new(spec, &rays, &self.field, map), rng.clone());
        chain.warm_up(20);
        let map = chain.occupied().to_vec();
        *rng = chain.rng();
        map
    }

    /// Independent draws of the cells of the map of `visibility`.
    fn of_start(&self, rng: &mut ChaCha8Rng) -> Vec<bool> {
        self.start.occupancy().values().iter().map(|p| rng.random::<f64>() < *p).collect()
    }
}

fn mixing(tallies: &[Tally], cells: usize, sweeps: usize) -> Mixing {
    let of_posterior = agreement(tallies, cells);
    let unsure = (0..cells).map(|cell| agreement(tallies, cell)).filter(|of| of.mean > 0.1 && of.mean < 0.9);
    let (mut r_hats, mut effective): (Vec<f64>, Vec<f64>) = unsure.map(|of| (of.r_hat, of.effective)).unzip();
    r_hats.sort_by(f64::total_cmp);
    effective.sort_by(f64::total_cmp);
    let mixed = r_hats.iter().filter(|r_hat| **r_hat < Mixing::R_HAT).count();
    Mixing {
        chains: tallies.len(),
        sweeps,
        log_posterior: of_posterior.r_hat,
        cells: r_hats.len(),
        share: if r_hats.is_empty() { 1.0 } else { mixed as f64 / r_hats.len() as f64 },
        effective_log_posterior: of_posterior.effective,
        effective: effective.get(effective.len() / 2).copied().unwrap_or(of_posterior.effective),
    }
}

impl Mapper for Gibbs {
    fn integrate(&mut self, scan: &Scan) {
        self.readings.add(scan);
        self.start.integrate(scan);
    }

    fn integrate_together(&mut self, scans: &[Scan]) {
        scans.iter().for_each(|scan| self.readings.add(scan));
        self.start.integrate_together(scans);
    }

    fn settle(&mut self) {
        if self.solved != self.readings.rays() {
            self.solved = self.readings.rays();
            self.solve();
        }
    }

    fn occupancy(&self) -> &Raster<f64> {
        &self.occupancy
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(Self {
            sampling: self.sampling,
            field: self.field.clone(),
            empty: self.empty.clone(),
            readings: self.readings.clone(),
            start: self.start.fork()?,
            prior: self.prior,
            solved: self.solved,
            mixing: self.mixing,
            occupancy: self.occupancy.clone(),
        }))
    }

    fn mixing(&self) -> Option<&Mixing> {
        self.mixing.as_ref()
    }

    fn fault(&self) -> Option<String> {
        let mixing = self.mixing.filter(|mixing| !mixing.is_enough() && self.sampling.unmixed == Unmixed::Refused)?;
        Some(format!(
            "the chains do not agree: {mixing}; at most {} of R-hat of the log posterior and {} % of the cells are asked for: map fewer cells or scans, or \
             name gibbs-unchecked, which shows such maps too",
            Mixing::R_HAT,
            100.0 * Mixing::SHARE
        ))
    }

    /// Does not count cells; keeps every reading.
    fn work(&self) -> Work {
        Work { cells: 0, bytes: self.occupancy.held() + self.readings.held() + self.start.work().bytes }
    }
}
