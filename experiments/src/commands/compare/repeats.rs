//! A robot that stands: how often may evidence be counted that is not new, and is what is new still used?

use grid::Raster;
use mapper::Mapper;
use mapper::catalogue::{Entry, Kind};
use scene::{Drive, Family, Motion, SimulatedScan, TimedPose};
use score::{Region, Scorer};
use sensor::Scan;
use serde::{Deserialize, Serialize};

use super::world::WorldJob;
use crate::failure::Failure;
use crate::worlds::site::{Assumptions, Site};
use crate::worlds::witness::Witness;

/// What a robot that stands reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Readings {
    /// One scan again and again, with its time and all.
    Same,
    /// What a real camera gives: mismatches that stay, fresh noise, times that go on, and a pose that jitters by 2 mm and 0.1 degrees.
    Standing,
    /// Readings that are drawn anew each time, mismatches too.
    Fresh,
}

impl Readings {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Same, Self::Standing, Self::Fresh];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Same => "same",
            Self::Standing => "standing",
            Self::Fresh => "fresh",
        }
    }
}

/// By how much the pose of a robot that stands jitters: standard deviations, m and degrees.
const JITTER: (f64, f64) = (0.002, 0.1);

/// A map after so many repeats of one scan, over what that scan could see.
#[derive(Debug, Clone, PartialEq)]
pub struct Repeated {
    /// Family of the world.
    pub family: String,
    /// Its seed.
    pub seed: u64,
    /// Number of the scan, from 0.
    pub scan: usize,
    /// What the robot reads there.
    pub readings: Readings,
    /// Name of the mapper.
    pub mapper: &'static str,
    /// How often the scan is in the map.
    pub repeats: usize,
    /// Log loss over the observable region of the scan, nats per cell.
    pub log_loss: Option<f64>,
    /// Share of its free cells held free.
    pub free_known: Option<f64>,
    /// Area of its free cells held occupied, m².
    pub phantom_area: Option<f64>,
    /// Area of its surface cells held free, m².
    pub missed_area: Option<f64>,
}

/// Stands at `scans` places of a world, evenly spread over the drive, and maps what is read at each alone, up to the last of `counts` times,
/// by every mapper that takes scans one by one.
///
/// # Errors
/// As [`Site::of_family`]; a mapper that gives something else than probabilities.
pub fn repeat(
    job: &WorldJob,
    family: &Family,
    assumed: &Assumptions,
    mappers: &[&'static Entry],
    scans: usize,
    counts: &[usize],
) -> Result<Vec<Repeated>, Failure> {
    let site = Site::of_family(family, &job.world, assumed)?;
    let simulation = scene::simulate(&site.ground.scene, &site.ground.world, &site.ground.drive, job.world.seed);
    let mut repeated = Vec::new();
    for number in (0..scans).map(|k| k * simulation.scans.len() / scans) {
        let simulated = &simulation.scans[number];
        let mut witness = Witness::new(&site.ground);
        witness.look(&site.ground, number, simulated)?;
        let mask = witness.seen.mask(Region::Observable);
        let scorer = Scorer::new(witness.truth(&site.ground), witness.seen.surface())?;
        for readings in Readings::ALL {
            let stand = stand(&site, simulated, readings, job.world.seed, counts.last().copied().unwrap_or(0));
            for entry in mappers.iter().filter(|entry| entry.kind == Kind::Online) {
                let at = Repeated::unscored(job, number, readings, entry.name);
                repeated.extend(scored(entry.mapper(&site.setup), (&scorer, &mask), &stand, counts, &at)?);
            }
        }
    }
    Ok(repeated)
}

/// The scans of a robot that stands where a scan was made.
fn stand(site: &Site, first: &SimulatedScan, readings: Readings, seed: u64, count: usize) -> Vec<Scan> {
    let ground = &site.ground;
    let interval_s = ground.scene.robot.scan_interval_s;
    let drive = |count: usize| {
        let pose = |k: usize| TimedPose { time_s: k as f64 * interval_s, pose: first.scan.pose };
        Drive { poses: (0..count).map(pose).collect(), stage_ends: Vec::new(), motion: Motion::default() }
    };
    let mut scene = ground.scene.clone();
    (scene.robot.jitter_m, scene.robot.jitter_rad) = (JITTER.0, JITTER.1.to_radians());
    let read = |count: usize, seed: u64| scene::simulate(&scene, &ground.world, &drive(count), seed).scans;
    match readings {
        Readings::Same => vec![first.scan.clone(); count],
        Readings::Standing => read(count, seed).into_iter().map(|simulated| simulated.scan).collect(),
        // Two scans of one stand share their mismatches: each is a stand of its own, with a seed of its own.
        Readings::Fresh => (0..count)
            .flat_map(|k| {
                let seed = seed ^ (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
                read(1, seed).into_iter().map(move |one| Scan { time_s: k as f64 * interval_s, ..one.scan })
            })
            .collect(),
    }
}

/// A mapper's maps of these scans, over what the first could see.
fn scored(
    mut mapper: Box<dyn Mapper>,
    (scorer, mask): (&Scorer, &Raster<bool>),
    scans: &[Scan],
    counts: &[usize],
    at: &Repeated,
) -> Result<Vec<Repeated>, Failure> {
    let mut done = 0;
    let mut rows = Vec::new();
    for &repeats in counts {
        scans[done..repeats].iter().for_each(|scan| mapper.integrate(scan));
        done = repeats;
        mapper.settle();
        // A program that gives no map has no values.
        let has_map = mapper.outside().is_none_or(|outside| outside.fault.is_none());
        let scores = has_map.then(|| scorer.scores(mapper.occupancy(), mask)).transpose()?;
        rows.push(Repeated {
            repeats,
            log_loss: scores.as_ref().and_then(|scores| scores.log_loss.value),
            free_known: scores.as_ref().and_then(|scores| scores.free_known.value),
            phantom_area: scores.as_ref().and_then(|scores| scores.phantom_area.value),
            missed_area: scores.as_ref().and_then(|scores| scores.missed_area.value),
            ..at.clone()
        });
    }
    Ok(rows)
}

impl Repeated {
    /// A row without its scores.
    fn unscored(job: &WorldJob, scan: usize, readings: Readings, mapper: &'static str) -> Self {
        Self {
            family: job.world.family.clone(),
            seed: job.world.seed,
            scan,
            readings,
            mapper,
            repeats: 0,
            log_loss: None,
            free_known: None,
            phantom_area: None,
            missed_area: None,
        }
    }
}
