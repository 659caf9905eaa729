//! What the page's viewer shows: worlds with the maps that grew in them.

use std::collections::BTreeSet;

use grid::{GridSpec, Raster};
use score::{Region, Sight, Sightings};
use sensor::Pose;

use crate::worlds::run::Stage;
use crate::worlds::run::{Frame, Ground, Run, StageMap, Trial};

/// Moments of a drive besides the ends of its stages: enough to see a map grow, few enough for a page.
pub const FRAMES: usize = 24;

/// Worlds to choose from.
#[derive(Debug, Clone, Default)]
pub struct Viewer {
    /// At least one, with names of their own.
    pub worlds: Vec<ViewedWorld>,
}

/// One scene, one seed, every mapper.
#[derive(Debug, Clone)]
pub struct ViewedWorld {
    /// Name of the scene.
    pub name: String,
    /// The seed of the readings.
    pub seed: u64,
    /// The cells.
    pub grid: GridSpec,
    /// Occupancy of an unseen cell: what is painted light grey.
    pub prior: f64,
    /// The robot's radius, m.
    pub robot_radius_m: f64,
    /// The truth: occupied, free, or not known.
    pub truth: Raster<Option<bool>>,
    /// Where the camera stood at every scan, m.
    pub route_m: Vec<[f64; 2]>,
    /// Moments to step through, rising; the ends of all stages are among them.
    pub moments: Vec<Moment>,
    /// The stages, in order of time.
    pub stages: Vec<Stage>,
    /// The scene's regions by name; those that follow from rays are in the moments.
    pub regions: Vec<(String, Raster<bool>)>,
    /// Name and unit of the metrics that regions are scored by, in the order of tables.
    pub metrics: Vec<(String, String)>,
    /// The mappers, in the order of tables.
    pub mappers: Vec<Mapped>,
}

/// A moment of a drive, and what its rays could have seen so far.
#[derive(Debug, Clone)]
pub struct Moment {
    /// After so many scans.
    pub scans: usize,
    /// Since the start, s.
    pub time_s: f64,
    /// Where the camera stands.
    pub pose: Pose,
    /// How many rays have looked at each cell.
    pub looks: Raster<u32>,
    /// The part of the map that each cell belongs to: visible, surface, shell or hidden; none where
    /// the truth is not known.
    pub parts: Raster<Option<Region>>,
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
}

/// The numbers of scans for [`Keep::frames`](crate::worlds::run::Keep): about `count`, evenly over the
/// drive, and the ends of all stages.
pub fn moments(ground: &Ground, count: usize) -> Vec<usize> {
    let scans = ground.scans();
    let even = (1..=count).map(|k| (k * scans).div_ceil(count));
    let ends = ground.drive.stage_ends.iter().map(|(_, end)| *end);
    even.chain(ends).filter(|scan| (1..=scans).contains(scan)).collect::<BTreeSet<_>>().into_iter().collect()
}

impl ViewedWorld {
    /// The world of a trial that still has its scans, and frames at `scans` as [`moments`] gives them.
    pub fn new(ground: &Ground, trial: &Trial, stages: &[Stage], scans: &[usize]) -> Self {
        Self {
            name: ground.scene.name.clone(),
            seed: trial.seed,
            grid: ground.scene.grid,
            prior: ground.prior,
            robot_radius_m: ground.scene.robot.radius_m,
            truth: ground.truth.clone(),
            route_m: ground.drive.poses.iter().map(|timed| timed.pose.position_m()).collect(),
            moments: replay(ground, trial, scans),
            stages: stages.to_vec(),
            regions: ground.scene.regions.iter().map(|r| (r.name.clone(), r.mask(&ground.scene.grid))).collect(),
            metrics: metrics(trial),
            mappers: trial.runs.iter().map(mapped).collect(),
        }
    }
}

fn mapped(run: &Run) -> Mapped {
    let by_region = |stage: &StageMap| {
        let regions = stage.scores.chunk_by(|a, b| a.region == b.region);
        regions.map(|of| (of[0].region.clone(), of.iter().map(|score| score.metric.value).collect())).collect()
    };
    Mapped {
        name: run.mapper.to_owned(),
        frames: run.frames.clone(),
        scores: run.stages.iter().map(by_region).collect(),
    }
}

/// Every region has the same metrics.
fn metrics(trial: &Trial) -> Vec<(String, String)> {
    let Some(stage) = trial.runs.first().and_then(|run| run.stages.first()) else { return Vec::new() };
    let first = stage.scores.chunk_by(|a, b| a.region == b.region).next().unwrap_or_default();
    first.iter().map(|score| (score.metric.name.to_owned(), score.metric.unit.to_owned())).collect()
}

/// Casts no ray anew: the trial kept the true range of each.
fn replay(ground: &Ground, trial: &Trial, scans: &[usize]) -> Vec<Moment> {
    let mut seen = Sightings::new(&ground.truth);
    let mut moments = Vec::with_capacity(scans.len());
    for (i, simulated) in trial.simulation.scans.iter().enumerate() {
        for (ray, &range_m) in simulated.scan.rays().zip(&simulated.true_ranges_m) {
            seen.add(&Sight { origin_m: ray.origin_m, direction: ray.direction, range_m });
        }
        if scans.contains(&(i + 1)) {
            moments.push(Moment {
                scans: i + 1,
                time_s: simulated.scan.time_s,
                pose: simulated.scan.pose,
                looks: seen.looks().clone(),
                parts: parts(&seen, &ground.scene.grid),
            });
        }
    }
    moments
}

fn parts(seen: &Sightings, grid: &GridSpec) -> Raster<Option<Region>> {
    let four = [Region::Visible, Region::Surface, Region::Shell, Region::Hidden];
    let part = |cell| four.into_iter().find(|region| seen.contains(*region, cell));
    Raster::new(*grid, (0..grid.cells()).map(part).collect())
}
