//! One drive, mapped by several rules from the same readings, and scored at every stage.

use grid::Raster;
use mapper::catalogue::{Entry, Setup};
use rayon::prelude::*;
use scene::{Drive, Scene, Simulation, World};
use score::{Metric, Region, Retention, Scorer, Sight, Sightings, log_loss};

use crate::failure::Failure;
use crate::progress::Progress;

/// What does not depend on the seed: the scene, the way through it, and the truth.
pub struct Ground {
    /// The scene.
    pub scene: Scene,
    /// What rays are cast in.
    pub world: World,
    /// The robot's poses.
    pub drive: Drive,
    /// The truth: occupied, free, or not known and not scored.
    pub truth: Raster<Option<bool>>,
    /// Occupancy that the mappers expect of an unseen cell: what pictures show as not known.
    pub prior: f64,
}

/// One seed: its readings and what became of them.
pub struct Trial {
    /// The seed.
    pub seed: u64,
    /// The readings.
    pub simulation: Simulation,
    /// One per mapper, in the order asked for.
    pub runs: Vec<Run>,
}

/// One mapper's way through the readings.
pub struct Run {
    /// Name of the mapper.
    pub mapper: &'static str,
    /// The map at each stage.
    pub stages: Vec<StageMap>,
    /// One per scan.
    pub timeline: Vec<Moment>,
}

/// A map at the end of a stage, with its scores.
pub struct StageMap {
    /// Occupancy, 0 to 1.
    pub occupancy: Raster<f64>,
    /// Every metric of every region.
    pub scores: Vec<RegionScore>,
}

/// A metric over a region.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionScore {
    /// Name of the region.
    pub region: String,
    /// The metric.
    pub metric: Metric,
}

/// How a map was doing after a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Time of the scan, s.
    pub time_s: f64,
    /// Log loss over what was observable so far, nats per cell.
    pub log_loss: Option<f64>,
    /// Free-space retention so far.
    pub retention: Option<f64>,
}

impl Ground {
    /// Loads the scene's world, drives the route, and rasters the truth.
    ///
    /// # Errors
    /// A route that is blocked.
    pub fn new(scene: Scene, prior: f64) -> Result<Self, Failure> {
        let drive = scene::drive(&scene)?;
        Ok(Self { world: World::new(&scene), truth: scene::truth(&scene), drive, scene, prior })
    }

    /// Number of scans of one drive.
    pub fn scans(&self) -> usize {
        self.drive.poses.len()
    }

    /// Runs every mapper on the readings of one seed. Mappers run in parallel; the result does not
    /// depend on how.
    ///
    /// # Errors
    /// A mapper that gives something else than probabilities.
    pub fn trial(&self, seed: u64, mappers: &[&Entry], setup: &Setup, progress: &Progress) -> Result<Trial, Failure> {
        let simulation = scene::simulate(&self.scene, &self.world, &self.drive, seed);
        let runs = mappers
            .par_iter()
            .enumerate()
            .map(|(i, entry)| self.run(&simulation, entry, setup, |moment| progress.step(i, moment.log_loss)))
            .collect::<Result<_, _>>()?;
        Ok(Trial { seed, simulation, runs })
    }

    fn run(
        &self,
        simulation: &Simulation,
        entry: &Entry,
        setup: &Setup,
        mut watch: impl FnMut(&Moment),
    ) -> Result<Run, Failure> {
        let mut mapper = (entry.build)(setup);
        let mut sightings = Sightings::new(&self.truth);
        let mut retention = Retention::new(&self.truth);
        let mut run = Run { mapper: entry.name, stages: Vec::new(), timeline: Vec::new() };
        for (i, simulated) in simulation.scans.iter().enumerate() {
            for (ray, &range_m) in simulated.scan.rays().zip(&simulated.true_ranges_m) {
                sightings.add(&Sight { origin_m: ray.origin_m, direction: ray.direction, range_m });
            }
            mapper.integrate(&simulated.scan);
            let map = mapper.occupancy();
            retention.observe(sightings.visible(), map)?;
            let moment = Moment {
                time_s: simulated.scan.time_s,
                log_loss: log_loss(map, &self.truth, &sightings.mask(Region::Observable))?.value,
                retention: retention.metric(None)?.value,
            };
            watch(&moment);
            run.timeline.push(moment);
            for _ in simulation.stages.iter().filter(|stage| stage.scans == i + 1) {
                let scores = self.score(map, &sightings, &retention)?;
                run.stages.push(StageMap { occupancy: map.clone(), scores });
            }
        }
        Ok(run)
    }

    /// Every metric over every region: those that follow from the rays, and those the scene names.
    fn score(&self, map: &Raster<f64>, seen: &Sightings, retention: &Retention) -> Result<Vec<RegionScore>, Failure> {
        let scorer = Scorer::new(&self.truth, seen.surface())?;
        let by_rays = Region::ALL.iter().map(|region| (region.name().to_owned(), seen.mask(*region)));
        let by_name = self.scene.regions.iter().map(|region| (region.name.clone(), region.mask(self.truth.spec())));
        let mut scores = Vec::new();
        for (region, mask) in by_rays.chain(by_name) {
            let metrics = scorer.scores(map, &mask)?.metrics();
            for metric in metrics.into_iter().chain([retention.metric(Some(&mask))?]) {
                scores.push(RegionScore { region: region.clone(), metric });
            }
        }
        Ok(scores)
    }
}

impl Trial {
    /// The metric of the given mapper, stage, region and name.
    pub fn metric(&self, mapper: &str, stage: usize, region: &str, name: &str) -> Option<Metric> {
        let run = self.runs.iter().find(|run| run.mapper == mapper)?;
        let scores = run.stages.get(stage)?.scores.iter();
        scores.filter(|score| score.region == region).map(|score| score.metric).find(|metric| metric.name == name)
    }

    /// Forgets readings and maps, and keeps the scores.
    pub fn without_maps(mut self) -> Self {
        self.simulation.scans.clear();
        for run in &mut self.runs {
            run.timeline.clear();
            for stage in &mut run.stages {
                let spec = grid::GridSpec { width: 0, height: 0, ..*stage.occupancy.spec() };
                stage.occupancy = Raster::new(spec, Vec::new());
            }
        }
        self
    }
}
