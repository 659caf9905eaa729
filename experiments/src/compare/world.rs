//! One world, mapped by every mapper and scored: plain values that can be kept and read again.

use std::sync::Arc;

use grid::Raster;
use mapper::catalogue::{Entry, Kind};
use mapper::{Model, Prior, Reconciliation};
use scene::{Family, Variation};
use score::{ErrorProfile, LOOK_EDGES, ProbabilityBin, RANGE_EDGES_M, Region, error_profile, probability_bins};
use serde::{Deserialize, Serialize};

use super::conditions::{Condition, condition};
use super::criteria::CRITERIA;
use crate::failure::Failure;
use crate::trial::{Ground, Keep, Run, Trial};

/// Which world: a layout of a family and its readings, both of one seed, under a condition.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Job {
    /// Name of the family.
    pub family: String,
    /// Name of the condition.
    pub condition: String,
    /// Seed of layout and readings.
    pub seed: u64,
    /// Whether batch mappers run on it.
    pub batch: bool,
}

/// What every mapper made of a world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct World {
    /// Which world.
    pub job: Job,
    /// One per mapper that ran on it, in the order asked for.
    pub maps: Vec<MapScores>,
}

/// The scores of a map at the end of the drive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MapScores {
    /// Name of the mapper.
    pub mapper: String,
    /// One per region, in the order of [`Region::ALL`].
    pub regions: Vec<RegionScores>,
    /// Reliability over the observable region, see [`score::PROBABILITY_EDGES`].
    pub reliability: Vec<ProbabilityBin>,
    /// Error over the observable region against [`RANGE_EDGES_M`] ...
    pub range: Vec<ErrorSum>,
    /// ... and against [`LOOK_EDGES`].
    pub looks: Vec<ErrorSum>,
}

/// The metrics of a map over a region.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RegionScores {
    /// Name of the region.
    pub region: String,
    /// Number of its cells.
    pub cells: usize,
    /// The metrics in the order of [`CRITERIA`]; none where a metric is not defined.
    pub values: Vec<Option<f64>>,
}

/// Errors in a bin, which add up over maps.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ErrorSum {
    /// Number of cells.
    pub cells: u64,
    /// Sum of their log loss, nats.
    pub log_loss: f64,
    /// Sum of their squared errors.
    pub squared_error: f64,
}

impl ErrorSum {
    /// Takes in the same bin of another map.
    pub fn merge(&mut self, other: &Self) {
        self.cells += other.cells;
        self.log_loss += other.log_loss;
        self.squared_error += other.squared_error;
    }

    /// Mean log loss, nats per cell; none of an empty bin.
    pub fn mean_log_loss(&self) -> Option<f64> {
        (self.cells > 0).then(|| self.log_loss / self.cells as f64)
    }
}

/// What the mappers believe before the first reading.
#[derive(Debug, Clone, Copy)]
pub struct Belief {
    /// Occupancy and continuity.
    pub prior: Prior,
    /// Edges on no ray.
    pub reconciliation: Reconciliation,
}

impl Job {
    /// Where the world is, for messages.
    pub fn place(&self) -> String {
        format!("{} {} seed {}", self.family, self.condition, self.seed)
    }

    /// Those of `mappers` that run on this world.
    pub fn mappers(&self, mappers: &[&'static Entry]) -> Vec<&'static Entry> {
        mappers.iter().copied().filter(|entry| self.batch || entry.kind != Kind::Batch).collect()
    }

    /// Builds the world: its ground, and what the mappers believe of it. They believe the camera of the
    /// family's file, whatever the condition makes of it.
    ///
    /// # Errors
    /// A condition that does not exist; a layout that cannot be made.
    pub fn ground(&self, family: &Family, belief: &Belief) -> Result<(Ground, Model), Failure> {
        let unknown = || Failure::Internal(format!("there is no condition {:?}", self.condition));
        let Condition { size_factor, camera, .. } = *condition(&self.condition).ok_or_else(unknown)?;
        let mut scene = family.scene(self.seed, None, &Variation { size_factor })?;
        let Belief { prior, reconciliation } = *belief;
        let setup = Model { prior, reconciliation, ..Model::new(scene.grid, Arc::new(scene.matcher.stereo)) };
        camera(&mut scene.matcher);
        Ok((Ground::new(scene, belief.prior.occupancy)?, setup))
    }

    /// Maps and scores the world.
    ///
    /// # Errors
    /// As [`Job::ground`]; a mapper that gives something else than probabilities.
    pub fn run(&self, family: &Family, belief: &Belief, mappers: &[&'static Entry]) -> Result<World, Failure> {
        let (ground, setup) = self.ground(family, belief)?;
        let trial = ground.trial(self.seed, &self.mappers(mappers), &setup, &Keep::default(), &|_, _| {})?;
        self.score(&ground, &trial)
    }

    /// The scores of a finished trial.
    ///
    /// # Errors
    /// A mapper that gives something else than probabilities.
    pub fn score(&self, ground: &Ground, trial: &Trial) -> Result<World, Failure> {
        let observable = trial.seen.mask(Region::Observable);
        let looks = trial.seen.looks().map(|&looks| f64::from(looks));
        let score = |run: &Run| {
            let Some(end) = run.stages.last() else {
                return Err(Failure::Internal(format!("{}: {} was never scored", self.place(), run.mapper)));
            };
            let map = &end.occupancy;
            let profile = |covariate: &Raster<f64>, edges: &[f64]| -> Result<Vec<ErrorSum>, Failure> {
                Ok(sums(&error_profile(map, &ground.truth, &observable, covariate, edges)?))
            };
            Ok(MapScores {
                mapper: run.mapper.to_owned(),
                regions: Region::ALL.iter().map(|region| region_scores(trial, run, region.name())).collect(),
                reliability: probability_bins(map, &ground.truth, &observable)?,
                range: profile(trial.seen.nearest_m(), &RANGE_EDGES_M)?,
                looks: profile(&looks, &LOOK_EDGES)?,
            })
        };
        Ok(World { job: self.clone(), maps: trial.runs.iter().map(score).collect::<Result<_, _>>()? })
    }
}

impl World {
    /// The value of a metric, by its place among [`CRITERIA`], of a mapper in a region.
    pub fn value(&self, mapper: &str, region: &str, criterion: usize) -> Option<f64> {
        let map = self.maps.iter().find(|map| map.mapper == mapper)?;
        *map.regions.iter().find(|scores| scores.region == region)?.values.get(criterion)?
    }
}

/// The scores of the last stage.
fn region_scores(trial: &Trial, run: &Run, region: &str) -> RegionScores {
    let last = run.stages.len() - 1;
    let metric = |name: &str| trial.metric(run.mapper, last, region, name);
    RegionScores {
        region: region.to_owned(),
        cells: metric("log_loss").map_or(0, |metric| metric.support),
        values: CRITERIA.iter().map(|c| metric(c.metric).and_then(|metric| metric.value)).collect(),
    }
}

fn sums(profile: &ErrorProfile) -> Vec<ErrorSum> {
    let sum = |metric: &score::Metric| metric.value.unwrap_or(0.0) * metric.support as f64;
    let bin = |bin: &score::ErrorBin| ErrorSum {
        cells: bin.log_loss.support as u64,
        log_loss: sum(&bin.log_loss),
        squared_error: sum(&bin.brier),
    };
    profile.bins.iter().map(bin).collect()
}
