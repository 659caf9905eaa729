//! What the page's viewer shows: worlds with the maps that grew in them.

use std::collections::BTreeSet;

use grid::{GridSpec, Raster};
use scene::Shape;
use score::{MovingRegion, Region};

use super::scans::{Scans, SensorScans};
use crate::failure::Failure;
use crate::worlds::film::{self, Frame};
use crate::worlds::ground::Ground;
use crate::worlds::run::{RegionScore, Run, Stage, StageMap, Trial};
use crate::worlds::witness::Witness;

/// Moments of a drive besides the ends of its stages, where a page shows several worlds: enough to see a map grow.
pub const FRAMES: usize = 24;

/// Most moments of a drive that a page shows, where there is one world: the scans of a long drive.
const MOST_FRAMES: usize = 1000;

/// Most bytes that the levels of all maps may take while they are made.
const FRAME_BYTES: usize = 256 << 20;

/// Worlds to choose from.
#[derive(Debug, Clone, Default)]
pub struct Viewer {
    /// At least one, with names of their own.
    pub worlds: Vec<ViewedWorld>,
    /// Most that they may add to a page, bytes.
    pub budget: usize,
}

/// One scene, one seed, every mapper.
#[derive(Debug, Clone)]
pub struct ViewedWorld {
    /// Name of the scene.
    pub name: String,
    /// The seed of the readings, of simulated ones.
    pub seed: Option<u64>,
    /// The cells.
    pub grid: GridSpec,
    /// Occupancy of an unseen cell: what is painted light grey.
    pub prior: f64,
    /// The robot's radius, m.
    pub robot_radius_m: f64,
    /// The truth: occupied, free, or not known; none where nothing is known of it at all.
    pub truth: Option<Raster<Option<bool>>>,
    /// Where the sensor went, m, where that is not where the scans were taken.
    pub route_m: Vec<[f64; 2]>,
    /// The scans; moments are numbers of them.
    pub scans: Option<Scans>,
    /// What each sensor read beside the camera, or of a log of several sensors, each; nothing where there is one sensor.
    pub sensors: Vec<SensorScans>,
    /// Moments to step through, rising; the ends of all stages are among them.
    pub moments: Vec<Moment>,
    /// The stages, in order of time.
    pub stages: Vec<Stage>,
    /// The scene's regions by name; those that follow from rays are in the moments.
    pub regions: Vec<(String, Raster<bool>)>,
    /// Name and unit of the metrics that regions are scored by, in the order of tables: those that every region has, then those that only regions
    /// of a world that moves have.
    pub metrics: Vec<(String, String)>,
    /// The mappers, in the order of tables.
    pub mappers: Vec<Mapped>,
}

/// A moment of a drive, and what its rays could have seen so far.
#[derive(Debug, Clone)]
pub struct Moment {
    /// After so many scans.
    pub scans: usize,
    /// The part of the map that each cell belongs to: visible, surface, shell or hidden; none where
    /// the truth is not known. Nothing at all of a world without a truth.
    pub parts: Option<Raster<Option<Region>>>,
    /// How the world stands, where it moves.
    pub scenery: Option<Scenery>,
}

/// A world that moves, at a moment.
#[derive(Debug, Clone)]
pub struct Scenery {
    /// The truth of the moment.
    pub truth: Raster<Option<bool>>,
    /// What everything that moves covers, the same things in the same order at every moment.
    pub things: Vec<Shape>,
    /// The regions of [`MovingRegion::ALL`] that each cell belongs to: bit k for the k-th.
    pub regions: Raster<u8>,
}

/// One mapper's maps and scores.
#[derive(Debug, Clone)]
pub struct Mapped {
    /// Its name.
    pub name: String,
    /// Maps at moments of the world, rising. A batch mapper has them at the ends of stages only.
    pub frames: Vec<Frame>,
    /// At the end of every stage the values of [`ViewedWorld::metrics`] by region, as the tables have them.
    pub scores: Vec<Vec<(String, Vec<Option<f64>>)>>,
    /// The cells that the map says anything of, where it does not say it of all that were seen.
    pub known: Option<Raster<bool>>,
}

/// The numbers of scans for [`Keep::frames`](crate::worlds::run::Keep): about `count`, evenly over the
/// drive, and the ends of all stages.
pub fn moments(ground: &Ground, count: usize) -> Vec<usize> {
    let scans = ground.scans();
    let even = (1..=count).map(|k| (k * scans).div_ceil(count));
    let ends = ground.drive.stage_ends.iter().map(|(_, end)| *end);
    even.chain(ends).filter(|scan| (1..=scans).contains(scan)).collect::<BTreeSet<_>>().into_iter().collect()
}

/// All scans of a drive, or as many as there is room for with so many mappers.
pub fn every_moment(ground: &Ground, mappers: usize) -> Vec<usize> {
    let room = FRAME_BYTES / (ground.scene.grid.cells() * mappers.max(1)).max(1);
    moments(ground, ground.scans().min(MOST_FRAMES).min(room.max(FRAMES)))
}

impl ViewedWorld {
    /// The world of a trial that still has its scans, and frames at `scans` as [`moments`] gives them.
    ///
    /// # Errors
    /// Scans of another ground.
    pub fn new(ground: &Ground, trial: &Trial, stages: &[Stage], scans: &[usize]) -> Result<Self, Failure> {
        let simulated = &trial.simulation.scans;
        Ok(Self {
            name: ground.scene.name.clone(),
            seed: Some(trial.seed),
            grid: ground.scene.grid,
            prior: ground.prior,
            robot_radius_m: ground.scene.robot.radius_m,
            truth: Some(ground.truth.clone()),
            route_m: Vec::new(),
            scans: Some(Scans::simulated(simulated, ground)),
            sensors: SensorScans::simulated(simulated, ground),
            moments: replay(ground, trial, scans)?,
            stages: stages.to_vec(),
            regions: ground.scene.regions.iter().map(|r| (r.name.clone(), r.mask(&ground.scene.grid))).collect(),
            metrics: metrics(trial),
            mappers: trial.runs.iter().map(|run| mapped(run, &metrics(trial))).collect(),
        })
    }
}

/// Whether it is the name of a region that only a world that moves has.
fn is_moving(region: &str) -> bool {
    MovingRegion::ALL.iter().any(|moving| moving.name() == region)
}

/// Scores in the order of `metrics`, as far as they go.
fn mapped(run: &Run, metrics: &[(String, String)]) -> Mapped {
    let values = |of: &[RegionScore]| {
        let value = |name: &str| of.iter().find(|score| score.metric.name == name).map(|score| score.metric.value);
        let found = metrics.iter().map(|(name, _)| value(name));
        // What only regions of a world that moves have comes last.
        if is_moving(&of[0].region) { found.map(Option::flatten).collect() } else { found.flatten().collect() }
    };
    let by_region = |stage: &StageMap| {
        let regions = stage.scores.chunk_by(|a, b| a.region == b.region);
        regions.map(|of| (of[0].region.clone(), values(of))).collect()
    };
    Mapped {
        name: run.mapper.to_owned(),
        frames: run.frames.clone(),
        scores: run.stages.iter().map(by_region).collect(),
        known: None,
    }
}

/// Those of the first region, which every region has, and those that regions of a world that moves have besides.
fn metrics(trial: &Trial) -> Vec<(String, String)> {
    let Some(stage) = trial.runs.first().and_then(|run| run.stages.first()) else { return Vec::new() };
    let first = stage.scores.chunk_by(|a, b| a.region == b.region).next().unwrap_or_default();
    let mut metrics: Vec<(String, String)> = Vec::new();
    for RegionScore { metric, .. } in first.iter().chain(stage.scores.iter().filter(|score| is_moving(&score.region))) {
        if metrics.iter().all(|(name, _)| name != metric.name) {
            metrics.push((metric.name.to_owned(), metric.unit.to_owned()));
        }
    }
    metrics
}

/// Casts no ray anew: the trial kept the true range of each.
fn replay(ground: &Ground, trial: &Trial, scans: &[usize]) -> Result<Vec<Moment>, Failure> {
    let mut witness = Witness::new(ground);
    let mut moments = Vec::with_capacity(scans.len());
    for (i, simulated) in trial.simulation.scans.iter().enumerate() {
        witness.look(ground, i, simulated)?;
        if scans.binary_search(&(i + 1)).is_ok() {
            let scenery = witness.movement.as_ref().map(|movement| Scenery {
                truth: movement.moving.truth().clone(),
                things: ground.drive.motion.shapes_at(i).map(|(_, shape)| shape.clone()).collect(),
                regions: film::moving_regions(&movement.moving),
            });
            moments.push(Moment { scans: i + 1, parts: Some(film::parts(&witness.seen)), scenery });
        }
    }
    Ok(moments)
}
