//! One world, mapped by every mapper and scored: plain values that can be kept and read again.

use grid::Raster;
use mapper::Mixing;
use mapper::catalogue::{Entry, Kind};
use score::{
    ErrorProfile, LOOK_EDGES, MovingRegion, PROBABILITY_EDGES, ProbabilityBin, RANGE_EDGES_M, Region, error_profile,
    probability_bins,
};
use serde::{Deserialize, Serialize};

use crate::failure::Failure;
use crate::worlds::criteria::{CRITERIA, Criterion, MOVING};
use crate::worlds::ground::Ground;
use crate::worlds::run::{Keep, Run, Trial};
use crate::worlds::sensed;
use crate::worlds::site::{Site, WorldId};

/// A world to map and score.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct WorldJob {
    /// Which world.
    pub world: WorldId,
    /// Whether batch mappers run on it.
    pub batch: bool,
}

/// What every mapper made of a world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorldScores {
    /// Which world.
    pub job: WorldJob,
    /// One per mapper that ran on it, in the order asked for.
    pub maps: Vec<MapScores>,
    /// How they fare in the same world at rest, of the condition people.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub at_rest: Vec<AtRest>,
}

/// How many cells a mapper holds right in a world that moves, and in the same world at rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AtRest {
    /// Its name.
    pub mapper: String,
    /// The cells that are judged: static where people walk, and seen at rest.
    pub cells: usize,
    /// Those held right where people walk: p > 0.5 where occupied, p < 0.5 where free.
    pub moving: usize,
    /// Those held right at rest.
    pub rest: usize,
}

/// The scores of a map at the end of the drive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MapScores {
    /// Name of the mapper.
    pub mapper: String,
    /// One per region, in the order of [`Region::ALL`] and, where the world moves, of [`MovingRegion::ALL`]; of suites of sensors, [`sensed::REGIONS`] too.
    pub regions: Vec<RegionScores>,
    /// Reliability over the observable region, see [`score::PROBABILITY_EDGES`].
    pub reliability: Vec<ProbabilityBin>,
    /// Error over the observable region against [`RANGE_EDGES_M`] ...
    pub range: Vec<ErrorSum>,
    /// ... and against [`LOOK_EDGES`].
    pub looks: Vec<ErrorSum>,
    /// How well its draws agree, of a mapper that samples.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mixing: Option<Mixing>,
    /// Why there is no map, of a program that gave none or of draws that do not agree; all else is then without values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fault: Option<String>,
}

/// The metrics of a map over a region.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RegionScores {
    /// Name of the region.
    pub region: String,
    /// Number of its cells.
    pub cells: usize,
    /// The metrics in the order of [`CRITERIA`] and, where the world moves, of [`MOVING`]; none where a metric is not defined.
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

impl WorldJob {
    /// Those of `mappers` that run on this world.
    pub fn mappers(&self, mappers: &[&'static Entry]) -> Vec<&'static Entry> {
        mappers.iter().copied().filter(|entry| self.batch || entry.kind != Kind::Batch).collect()
    }

    /// Maps the world, which is built.
    ///
    /// # Errors
    /// A mapper that gives something else than probabilities.
    pub fn trial(&self, site: &Site, mappers: &[&'static Entry]) -> Result<Trial, Failure> {
        let Site { ground, setup } = site;
        ground.trial(self.world.seed, &self.mappers(mappers), setup, &Keep::default(), &|_, _| {})
    }

    /// The scores of a finished trial; of the same world at rest, none yet.
    ///
    /// # Errors
    /// A mapper that gives something else than probabilities.
    pub fn score(&self, ground: &Ground, trial: &Trial) -> Result<WorldScores, Failure> {
        let observable = trial.seen.mask(Region::Observable);
        let looks = trial.seen.looks().map(|&looks| f64::from(looks));
        let score = |run: &Run| {
            let Some(end) = run.stages.last() else {
                return Err(Failure::Internal(format!("{}: {} was never scored", self.world, run.mapper)));
            };
            let map = &end.occupancy;
            let profile = |covariate: &Raster<f64>, edges: &[f64]| -> Result<Vec<ErrorSum>, Failure> {
                Ok(sums(&error_profile(map, &ground.truth, &observable, covariate, edges)?))
            };
            let (names, metrics) = judged(ground.moves(), ground.sensed.is_some());
            let regions = names.iter().map(|region| region_scores(trial, run, region, &metrics)).collect();
            if let Some(fault) = &end.fault {
                return Ok(MapScores { mixing: run.mixing, ..MapScores::without_map(run.mapper, regions, fault) });
            }
            Ok(MapScores {
                mapper: run.mapper.to_owned(),
                regions,
                reliability: probability_bins(map, &ground.truth, &observable)?,
                range: profile(trial.seen.nearest_m(), &RANGE_EDGES_M)?,
                looks: profile(&looks, &LOOK_EDGES)?,
                mixing: run.mixing,
                fault: None,
            })
        };
        let maps = trial.runs.iter().map(score).collect::<Result<_, _>>()?;
        Ok(WorldScores { job: self.clone(), maps, at_rest: Vec::new() })
    }
}

impl MapScores {
    /// What there is of a mapper that gave no map.
    fn without_map(mapper: &str, regions: Vec<RegionScores>, fault: &str) -> Self {
        let none = |edges: &[f64]| vec![ErrorSum::default(); edges.len() - 1];
        Self {
            mapper: mapper.to_owned(),
            regions,
            reliability: vec![ProbabilityBin::default(); PROBABILITY_EDGES.len() - 1],
            range: none(&RANGE_EDGES_M),
            looks: none(&LOOK_EDGES),
            mixing: None,
            fault: Some(fault.to_owned()),
        }
    }
}

/// The regions that maps are scored in and the metrics that they are scored by: where nothing moves or where something does, and of suites of sensors.
fn judged(moves: bool, suites: bool) -> (Vec<&'static str>, Vec<&'static Criterion>) {
    let (regions, metrics) = if moves { (&MovingRegion::ALL[..], &MOVING[..]) } else { (&[][..], &[][..]) };
    let of_suites = if suites { &sensed::REGIONS[..] } else { &[] };
    let names = Region::ALL.iter().map(|region| region.name()).chain(regions.iter().map(|region| region.name()));
    (names.chain(of_suites.iter().copied()).collect(), CRITERIA.iter().chain(metrics).collect())
}

/// The regions and metrics of these worlds: those of worlds that move, and of suites of sensors, where any is one.
pub fn judged_in(worlds: &[WorldScores]) -> (Vec<&'static str>, Vec<&'static Criterion>) {
    let maps = || worlds.iter().flat_map(|world| &world.maps);
    let any = |region: &str| maps().any(|map| map.regions.iter().any(|scores| scores.region == region));
    judged(any(MovingRegion::Static.name()), any(sensed::IN_REACH))
}

impl WorldScores {
    /// The value of a metric, by its place among those of [`judged_in`], of a mapper in a region.
    pub fn value(&self, mapper: &str, region: &str, criterion: usize) -> Option<f64> {
        let map = self.maps.iter().find(|map| map.mapper == mapper)?;
        *map.regions.iter().find(|scores| scores.region == region)?.values.get(criterion)?
    }
}

/// The scores of the last stage.
fn region_scores(trial: &Trial, run: &Run, region: &str, metrics: &[&Criterion]) -> RegionScores {
    let last = run.stages.len() - 1;
    let metric = |name: &str| trial.metric(run.mapper, last, region, name);
    RegionScores {
        region: region.to_owned(),
        cells: metric("log_loss").map_or(0, |metric| metric.support),
        values: metrics.iter().map(|c| metric(c.metric).and_then(|metric| metric.value)).collect(),
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
