//! One drive, mapped by several rules from the same readings, and scored at every stage.

use std::sync::Arc;

use grid::Raster;
use mapper::catalogue::{Entry, Kind};
use mapper::{Mapper, Mixing, Model};
use rayon::prelude::*;
use scene::{SimulatedScan, Simulation};
use score::{Alignment, Lag, Metric, MovingRegion, Region, Retention, Scorer, Sightings, log_loss};
use sensor::{Device, Scan, Stereo};
use serde::Serialize;

use super::drives;
use super::film::{self, Frame, Judge};
use super::ground::{Driven, Ground};
use super::poses;
use super::site::sensors;
use super::witness::Witness;
use crate::failure::Failure;

/// What is kept of a trial besides the scores and maps of its stages.
#[derive(Debug, Clone, Default)]
pub struct Keep {
    /// How the maps were doing after every scan.
    pub timeline: bool,
    /// The maps after these numbers of scans, rising.
    pub frames: Vec<usize>,
}

/// One seed: its readings and what became of them.
pub struct Trial {
    /// The seed.
    pub seed: u64,
    /// The readings.
    pub simulation: Simulation,
    /// What the rays of the whole drive could see.
    pub seen: Sightings,
    /// At the end of every stage, the cells that a ray has crossed or hit first: the others are unseen.
    pub reached: Vec<Raster<bool>>,
    /// At the end of every stage, the regions of a world that moves, see [`film::moving_regions`]; nothing of a world at rest.
    pub moving: Vec<Raster<u8>>,
    /// One per mapper, in the order asked for.
    pub runs: Vec<Run>,
}

/// One mapper's way through the readings.
pub struct Run {
    /// Name of the mapper.
    pub mapper: &'static str,
    /// The map at each stage.
    pub stages: Vec<StageMap>,
    /// One per scan, if asked for; none of a batch mapper.
    pub timeline: Vec<Moment>,
    /// The maps asked for; of a batch mapper those at the end of a stage.
    pub frames: Vec<Frame>,
    /// How well its draws agreed at the last stage, of a mapper that samples.
    pub mixing: Option<Mixing>,
    /// What became of the program that did the work, of a mapper that works in another process.
    pub program: Option<ProgramRun>,
}

/// What became of a program that works as a mapper.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ProgramRun {
    /// What it wrote to standard error, stage by stage, as far as that is kept.
    pub stderr: Vec<String>,
}

/// A moment at which the maps were looked at.
#[derive(Debug, Clone, Serialize)]
pub struct Stage {
    /// Short name.
    pub name: String,
    /// What figures call it.
    pub label: String,
    /// After so many scans.
    pub scans: usize,
}

/// A map at the end of a stage, with its scores.
pub struct StageMap {
    /// Occupancy, 0 to 1; that of the prior where there is no map.
    pub occupancy: Raster<f64>,
    /// Every metric of every region, without values where there is no map.
    pub scores: Vec<RegionScore>,
    /// Why there is no map, of a program that gave none or of draws that do not agree.
    pub fault: Option<String>,
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
    /// The moments of a trial at which the maps were looked at.
    pub fn stages(&self, trial: &Trial) -> Vec<Stage> {
        let planned = self.scene.stages.iter().zip(&trial.simulation.stages);
        planned
            .map(|(plan, done)| Stage { name: plan.name.clone(), label: plan.label.clone(), scans: done.scans })
            .collect()
    }

    /// Runs every mapper on the readings of one seed. Mappers run in parallel; the result does not
    /// depend on how. `watch` is told of every update: number of the mapper, and how it was doing if
    /// `keep` asks for that.
    ///
    /// # Errors
    /// A mapper that gives something else than probabilities.
    pub fn trial(
        &self,
        seed: u64,
        mappers: &[&Entry],
        setup: &Model,
        keep: &Keep,
        watch: &(impl Fn(usize, Option<&Moment>) + Sync),
    ) -> Result<Trial, Failure> {
        self.trial_moved(seed, mappers, setup, keep, None, watch)
    }

    /// As [`trial`](Self::trial), with the poses of all scans moved as an alignment moves a map.
    ///
    /// # Errors
    /// As [`trial`](Self::trial).
    pub fn trial_moved(
        &self,
        seed: u64,
        mappers: &[&Entry],
        setup: &Model,
        keep: &Keep,
        by: Option<&Alignment>,
        watch: &(impl Fn(usize, Option<&Moment>) + Sync),
    ) -> Result<Trial, Failure> {
        let mut simulation = scene::simulate(&self.scene, &self.world, &self.drive, seed);
        self.poses.mistake(&mut simulation, &self.drive, seed);
        if let Some(by) = by {
            poses::moved(&mut simulation, by);
        }
        let mut witness = Witness::new(self);
        let (mut reached, mut moving) = (Vec::new(), Vec::new());
        let sharp = Model { sensors: sensors(Arc::new(self.sharp()), &self.scene, Device::sharp), ..setup.clone() };
        let setup = |entry: &Entry| if entry.kind == Kind::NoiseFree { &sharp } else { setup };
        let mut walks: Vec<Walk> = mappers.iter().map(|entry| Walk::new(entry, setup(entry), self)).collect();
        let noise_free = mappers.iter().any(|entry| entry.kind == Kind::NoiseFree);
        let named: Vec<_> = self.scene.regions.iter().map(|region| region.mask(self.truth.spec())).collect();
        for (i, simulated) in simulation.scans.iter().enumerate() {
            witness.look(self, i, simulated)?;
            let seen = &witness.seen;
            let stages = simulation.stages.iter().filter(|stage| stage.scans == i + 1).count();
            let is_kept = keep.frames.binary_search(&(i + 1)).is_ok();
            let movement = witness.movement.as_ref().filter(|_| is_kept || stages > 0);
            let together = if simulated.beside.is_empty() { Vec::new() } else { simulated.together() };
            let now = Now {
                scans: i + 1,
                time_s: simulated.scan.time_s,
                read: if together.is_empty() { std::slice::from_ref(&simulated.scan) } else { &together },
                noise_free: noise_free.then(|| self.noise_free(simulated)),
                witness: &witness,
                truth: witness.truth(self),
                observable: keep.timeline.then(|| seen.mask(Region::Observable)),
                stages,
                reached: (stages > 0).then(|| seen.looks().map(|looks| *looks > 0)),
                parts: is_kept.then(|| film::parts(seen)),
                moving: movement.map(|movement| film::moving_regions(&movement.moving)),
                named: &named,
                last: i + 1 == simulation.scans.len(),
            };
            walks.par_iter_mut().enumerate().try_for_each(|(number, walk)| {
                watch(number, walk.step(self, &now)?.as_ref());
                Ok::<(), Failure>(())
            })?;
            reached.extend(now.reached.iter().flat_map(|reached| vec![reached.clone(); stages]));
            moving.extend(now.moving.iter().flat_map(|regions| vec![regions.clone(); stages]));
        }
        let runs = walks.into_iter().map(|walk| walk.run).collect();
        Ok(Trial { seed, simulation, seen: witness.seen, reached, moving, runs })
    }

    /// The camera that gives noise-free readings, as nearly as a mapper can assume it: not so sharp that a
    /// wall on a grid line falls between two cells.
    fn sharp(&self) -> Stereo {
        Stereo { disparity_sigma: 0.05, correct_match: 0.99, ..self.scene.matcher.stereo }
    }

    /// The scans that perfect sensors would have read: every column, no noise.
    fn noise_free(&self, simulated: &SimulatedScan) -> Vec<Scan> {
        let read = |(&bearing, range): (&f64, &Option<f64>)| self.scene.matcher.noise_free((*range)?, bearing);
        let readings = simulated.scan.bearings_rad.iter().zip(&simulated.true_ranges_m).map(read).collect();
        let camera = Scan { readings, ..simulated.scan.clone() };
        let beside = simulated.beside.iter().map(|beside| {
            let device = &self.scene.sensors[beside.scan.sensor - 1].device;
            let rays = beside.scan.bearings_rad.iter().zip(&beside.true_ranges_m);
            let readings = rays.map(|(bearing_rad, range_m)| device.noise_free(*range_m, *bearing_rad)).collect();
            Scan { readings, ..beside.scan.clone() }
        });
        [camera].into_iter().chain(beside).collect()
    }

    /// Every metric over every region: those that follow from the rays, those the scene names, and those of a world that moves; and of drives.
    fn score(&self, walk: &Walk, now: &Now) -> Result<Vec<RegionScore>, Failure> {
        let (map, seen) = (walk.mapper.occupancy(), &now.witness.seen);
        let driven = self.planning.pairs > 0 && (now.last || self.driven == Driven::EveryStage);
        let scorer = Scorer::new(now.truth, seen.surface())?;
        let by_rays = Region::ALL.iter().map(|region| (region.name().to_owned(), seen.mask(*region)));
        let by_name = self.scene.regions.iter().map(|region| (region.name.clone(), region.mask(self.truth.spec())));
        let moving = now.witness.movement.as_ref().map(|movement| &movement.moving);
        let by_movement = moving
            .into_iter()
            .flat_map(|moving| MovingRegion::ALL.iter().map(|region| (region.name().to_owned(), moving.mask(*region))));
        let of_map = moving.map(|moving| moving.scores(map)).transpose()?;
        let mut of_movement = of_map.map_or_else(Vec::new, |scores| scores.by_region().to_vec());
        let lags = walk.lag.iter().flat_map(Lag::metrics);
        of_movement.extend(lags.map(|lag| (MovingRegion::Changed.name(), lag)));
        let mut scores = Vec::new();
        for (region, mask) in by_rays.chain(by_name).chain(by_movement) {
            let metrics = scorer.scores(map, &mask)?.metrics();
            let driven = driven && region == drives::REGION.name();
            let of_drives = match &now.reached {
                Some(reached) if driven => self.drives(&*walk.mapper, now.scans, reached)?,
                _ => Vec::new(),
            };
            let of_movement = of_movement.iter().filter(|(of, _)| *of == region).map(|(_, metric)| *metric);
            let retention = walk.retention.metric(Some(&mask))?;
            for metric in metrics.into_iter().chain([retention]).chain(of_drives).chain(of_movement) {
                scores.push(RegionScore { region: region.clone(), metric });
            }
        }
        if let Some(sensed) = &self.sensed {
            let scorer = Scorer::new(now.truth, &sensed.surface)?;
            for (region, mask) in sensed.by_name() {
                let retention = walk.retention.metric(Some(mask))?;
                let metrics = scorer.scores(map, mask)?.metrics().into_iter().chain([retention]);
                scores.extend(metrics.map(|metric| RegionScore { region: region.to_owned(), metric }));
            }
        }
        Ok(scores)
    }

    /// The metrics of drives planned on a map that knows the cells that some ray reached, after so many scans.
    fn drives(&self, mapper: &dyn Mapper, scans: usize, reached: &Raster<bool>) -> Result<Vec<Metric>, Failure> {
        let yard = self.yards.after(scans, &self.scene, &self.drive, self.planning);
        let (map, pairs) = (mapper.occupancy(), mapper.pairwise());
        Ok(drives::metrics(
            &yard.navigation,
            yard.stopped.as_ref().unwrap_or(&self.world),
            map,
            pairs.as_ref(),
            reached,
        )?)
    }
}

/// A scan and what is to be done after it.
struct Now<'a> {
    scans: usize,
    time_s: f64,
    /// What all sensors read at that time.
    read: &'a [Scan],
    noise_free: Option<Vec<Scan>>,
    witness: &'a Witness,
    /// The truth of the moment.
    truth: &'a Raster<Option<bool>>,
    observable: Option<Raster<bool>>,
    /// Number of stages that end with this scan.
    stages: usize,
    /// The cells that a ray has crossed or hit, where a stage ends.
    reached: Option<Raster<bool>>,
    /// The part of every cell, where the map is to be kept.
    parts: Option<Raster<Option<Region>>>,
    /// The regions that the scene names.
    named: &'a [Raster<bool>],
    /// Those of a world that moves, where the map is to be kept or a stage ends.
    moving: Option<Raster<u8>>,
    /// Whether it is the last scan of the drive.
    last: bool,
}

/// Metrics that follow from the maps after every scan.
const OF_EVERY_SCAN: [&str; 5] = ["retention", "lag_looks", "lag_open", "followed_3", "cleared_3"];

/// A mapper on its way.
struct Walk {
    kind: Kind,
    mapper: Box<dyn Mapper>,
    retention: Retention,
    /// How long it takes to follow changes, in a world that moves.
    lag: Option<Lag>,
    run: Run,
}

impl Walk {
    fn new(entry: &Entry, setup: &Model, ground: &Ground) -> Self {
        let mapper = entry.mapper(setup);
        let run = Run {
            mapper: entry.name,
            stages: Vec::new(),
            timeline: Vec::new(),
            frames: Vec::new(),
            mixing: None,
            program: mapper.outside().map(|_| ProgramRun::default()),
        };
        let truth = ground.still();
        let lag = ground.moves().then(|| Lag::new(truth));
        Self { kind: entry.kind, mapper, retention: Retention::new(truth), lag, run }
    }

    /// One more scan. A batch mapper has a map, and so retention, at the ends of stages only.
    fn step(&mut self, ground: &Ground, now: &Now) -> Result<Option<Moment>, Failure> {
        let noise_free = now.noise_free.as_deref().filter(|_| self.kind == Kind::NoiseFree);
        self.mapper.integrate_together(noise_free.unwrap_or(now.read));
        let has_map = self.kind != Kind::Batch || now.stages > 0;
        if has_map {
            self.mapper.settle();
        }
        let fault = self.account(now.stages);
        if let Some(movement) = &now.witness.movement {
            self.retention.leave_out(&movement.covered)?;
        }
        if !has_map {
            return Ok(None);
        }
        if fault.is_none() {
            self.follow(now)?;
        }
        let map = self.mapper.occupancy();
        for _ in 0..now.stages {
            let mut scores = ground.score(self, now)?;
            let batch_program = self.run.program.is_some() && self.kind == Kind::Batch;
            for metric in scores.iter_mut().map(|score| &mut score.metric) {
                if fault.is_some() || batch_program && OF_EVERY_SCAN.contains(&metric.name) {
                    metric.value = None;
                }
            }
            self.run.stages.push(StageMap { occupancy: map.clone(), scores, fault: fault.clone() });
        }
        if fault.is_some() {
            return Ok(None);
        }
        if let Some(parts) = &now.parts {
            let judge = Judge { truth: now.truth, parts, named: now.named, moving: now.moving.as_ref() };
            let online = self.kind != Kind::Batch;
            self.run.frames.push(Frame {
                scans: now.scans,
                levels: film::in_levels(map, self.run.frames.last().map(|frame| &frame.levels)),
                fine: (now.stages > 0).then(|| film::in_fine_steps(map)),
                exact: judge.exact(map, online.then_some(&self.retention)),
            });
        }
        let Some(observable) = now.observable.as_ref().filter(|_| self.kind != Kind::Batch) else { return Ok(None) };
        let moment = Moment {
            time_s: now.time_s,
            log_loss: log_loss(map, now.truth, observable)?.value,
            retention: self.retention.metric(None)?.value,
        };
        self.run.timeline.push(moment);
        Ok(Some(moment))
    }

    /// Takes note of the map after a scan, for the metrics that have a history. A batch mapper has no map after most scans, and so no lag.
    fn follow(&mut self, now: &Now) -> Result<(), Failure> {
        let map = self.mapper.occupancy();
        self.retention.observe(now.witness.seen.visible(), map)?;
        let movement = now.witness.movement.as_ref().filter(|_| self.kind != Kind::Batch);
        if let (Some(lag), Some(movement)) = (&mut self.lag, movement) {
            lag.observe(now.truth, &movement.near, map)?;
        }
        Ok(())
    }

    /// Takes down what became of a program that works for the mapper, and how well draws agree; gives why there is no map, if there is none.
    fn account(&mut self, stages: usize) -> Option<String> {
        if let (Some(program), Some(outside)) = (self.run.program.as_mut(), self.mapper.outside()) {
            program.stderr.extend((0..stages).map(|_| outside.stderr.clone()));
        }
        self.run.mixing = self.mapper.mixing().copied();
        self.mapper.fault()
    }
}

impl Trial {
    /// Why a mapper, by its place among the runs, has no map at the end of the drive, if it has none.
    pub fn fault(&self, run: usize) -> Option<&str> {
        self.runs.get(run)?.stages.last()?.fault.as_deref()
    }

    /// The metric of the given mapper, stage, region and name.
    pub fn metric(&self, mapper: &str, stage: usize, region: &str, name: &str) -> Option<Metric> {
        let run = self.runs.iter().find(|run| run.mapper == mapper)?;
        let scores = run.stages.get(stage)?.scores.iter();
        scores.filter(|score| score.region == region).map(|score| score.metric).find(|metric| metric.name == name)
    }

    /// Forgets readings and maps, and keeps the scores.
    pub fn without_maps(mut self) -> Self {
        self.simulation.scans.clear();
        self.reached.clear();
        for run in &mut self.runs {
            run.timeline.clear();
            run.frames.clear();
            for stage in &mut run.stages {
                let spec = grid::GridSpec { width: 0, height: 0, ..*stage.occupancy.spec() };
                stage.occupancy = Raster::new(spec, Vec::new());
            }
        }
        self
    }
}
