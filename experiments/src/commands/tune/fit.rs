//! Every candidate on the same readings, and the one with the least log loss.

use grid::Raster;
use mapper::{Candidate, ConventionalRule};
use scene::{Family, SimulatedScan};
use score::{Region, Scorer};
use sensor::Scan;

use super::candidates::{Tuned, rule};
use super::clamps;
use crate::failure::Failure;
use crate::worlds::estimate::Moments;
use crate::worlds::site::{Assumptions, Site, WorldId};
use crate::worlds::witness::Witness;

/// The error of a map over the observable region at the end of the drive.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors {
    /// Log loss, nats per cell.
    pub log_loss: f64,
    /// Brier score.
    pub brier: f64,
    /// The ends of the 95 % interval of a mean log loss over worlds.
    pub interval: Option<(f64, f64)>,
}

/// How the candidates of a mapper did.
#[derive(Debug, Clone, PartialEq)]
pub struct TunedFit {
    /// The mapper.
    pub tuned: Tuned,
    /// Number of worlds.
    pub worlds: usize,
    /// The candidates in the order of their grid, with their mean errors over the worlds.
    pub candidates: Vec<(Candidate, Errors)>,
}

/// Maps a world by every candidate and scores the maps.
///
/// # Errors
/// As [`Site::of_family`]; a mapper that gives something else than probabilities; a world in which nothing
/// could be seen.
pub fn errors(world: &WorldId, family: &Family, candidates: &[Candidate]) -> Result<Vec<Errors>, Failure> {
    let Site { ground, setup } = Site::of_family(family, world, &Assumptions::default())?;
    let simulation = scene::simulate(&ground.scene, &ground.world, &ground.drive, world.seed);
    let mut witness = Witness::new(&ground);
    simulation.scans.iter().enumerate().try_for_each(|(scan, simulated)| witness.look(&ground, scan, simulated))?;
    let seen = witness.seen;
    let mask = seen.mask(Region::Observable);
    let scorer = Scorer::new(&ground.truth, seen.surface())?;
    let score = |map: &Raster<f64>| {
        let scores = scorer.scores(map, &mask)?;
        let (Some(log_loss), Some(brier)) = (scores.log_loss.value, scores.brier.value) else {
            return Err(Failure::Internal(format!("{world}: nothing could be seen")));
        };
        Ok(Errors { log_loss, brier, interval: None })
    };
    let moments: Vec<Vec<Scan>> = simulation.scans.iter().map(SimulatedScan::together).collect();
    let mut errors = Vec::with_capacity(candidates.len());
    let bin = |candidate: &Candidate| rule(candidate).map(|rule| rule.half_width.to_bits());
    for alike in candidates.chunk_by(|a, b| bin(a).is_some() && bin(a) == bin(b)) {
        let rules: Vec<ConventionalRule> = alike.iter().filter_map(rule).collect();
        if rules.is_empty() {
            let mut mapper = alike[0].build(&setup);
            moments.iter().for_each(|scans| mapper.integrate_together(scans));
            mapper.settle();
            errors.push(score(mapper.occupancy())?);
        }
        for map in clamps::maps(&setup, &rules, moments.iter().flatten()) {
            errors.push(score(&map)?);
        }
    }
    Ok(errors)
}

impl TunedFit {
    /// The means over worlds, each of which has the errors of every candidate in order.
    pub fn new(tuned: Tuned, candidates: &[Candidate], worlds: &[&[Errors]]) -> Self {
        let mean = |number: usize| {
            let mean = |of: fn(&Errors) -> f64| {
                worlds.iter().map(|errors| of(&errors[number])).sum::<f64>() / worlds.len() as f64
            };
            let losses = Moments::of(worlds.iter().map(|errors| (errors[number].log_loss, 1.0)));
            let interval = losses.estimate().and_then(|estimate| estimate.interval);
            Errors { log_loss: mean(|e| e.log_loss), brier: mean(|e| e.brier), interval }
        };
        let candidates =
            candidates.iter().enumerate().map(|(number, candidate)| (candidate.clone(), mean(number))).collect();
        Self { tuned, worlds: worlds.len(), candidates }
    }

    /// The candidates from the least log loss to the largest; equals in the order of the grid.
    pub fn ranking(&self) -> Vec<(Candidate, Errors)> {
        let mut ranking = self.candidates.clone();
        ranking.sort_by(|a, b| a.1.log_loss.total_cmp(&b.1.log_loss)); // keeps equals in order
        ranking
    }

    /// The first of the ranking.
    ///
    /// # Panics
    /// If there are no candidates.
    pub fn best(&self) -> Candidate {
        self.ranking()[0].0.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_mean_wins_and_of_equals_the_first() {
        let mrf = Tuned::parse("mrf").expect("known");
        let candidates = &mrf.candidates()[..4];
        let errors =
            |losses: [f64; 4]| losses.map(|log_loss| Errors { log_loss, brier: 2.0 * log_loss, interval: None });
        let [first, second] = [errors([0.5, 0.125, 0.25, 0.875]), errors([0.125, 0.5, 0.25, 0.125])];
        let fit = TunedFit::new(mrf, candidates, &[&first, &second]);
        assert_eq!(fit.worlds, 2);
        let expected = [0.3125, 0.3125, 0.25, 0.5];
        for ((_, errors), expected) in fit.candidates.iter().zip(expected) {
            assert!((errors.log_loss - expected).abs() < 1e-15 && (errors.brier - 2.0 * expected).abs() < 1e-15);
        }
        assert_eq!(fit.best(), candidates[2]);
        let order: Vec<Candidate> = fit.ranking().into_iter().map(|(candidate, _)| candidate).collect();
        assert_eq!(order, [2, 0, 1, 3].map(|k: usize| candidates[k].clone()));
    }
}
