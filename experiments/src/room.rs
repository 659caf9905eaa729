//! The paper's room experiment: simulate, map, score, show.

mod outputs;
pub(crate) mod page;

use std::io::Write as _;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use mapper::catalogue::{Entry, Setup};
use rayon::prelude::*;

use crate::claims::{self, Claim};
use crate::cli::{Format, RoomOptions};
use crate::failure::{self, Failure};
use crate::interruption;
use crate::mappers::entries;
use crate::progress::Progress;
use crate::record::{Configuration, Record, Robot, Stage, versions};
use crate::staging::Staging;
use crate::trial::{Ground, Keep, Trial};
use crate::{report, summary, table, threads};

/// Runs the experiment.
///
/// # Errors
/// Bad input before any work, I/O, and claims that do not hold.
pub fn run(options: &RoomOptions) -> Result<(), Failure> {
    let start = Instant::now();
    interruption::watch();
    let seeds = seeds(options)?;
    let Plan { ground, mappers, setup, frames } = Plan::of(options)?;
    failure::warn(&ground.scene.warnings);
    let out = options.out.clone().unwrap_or_else(|| Path::new("results").join(&ground.scene.name));
    claimable(&ground, options)?;
    let mut staging = Staging::open(&out)?;
    threads::limit(options.threads)?;
    failure::warn(scene::enclosure(&ground.scene, &ground.world, &ground.drive).warning(&options.scene).as_slice());
    let trials = trials(&ground, &seeds, &mappers, &setup, &frames)?;
    let stages = stages(&ground, &trials[0]);
    let claimed = ground.scene.regions.iter().filter(|region| region.claims);
    let claims: Vec<Claim> = claimed.flat_map(|region| claims::judge(&trials, &region.name)).collect();
    let mut record = record(options, &ground, &mappers, &stages, &claims);
    let metrics = outputs::metrics(&ground, &trials, &stages);
    outputs::write(&mut staging, &ground, &trials, &stages, &frames, &metrics, &mut record)?;
    staging.publish()?;

    match options.format {
        Format::Text => {
            table::print(&summary::text(&ground, &trials, &stages, &claims))?;
            let place = out.join("report.html");
            let _ = writeln!(std::io::stderr(), "{} in {:.1} s", place.display(), start.elapsed().as_secs_f64());
        }
        Format::Csv => metrics.print(false)?,
        Format::Json => metrics.print(true)?,
    }
    if claims.is_empty() && ground.scene.regions.iter().any(|region| region.claims) {
        let note = "note: the scene's claims compare visibility with conventional; without both they are not judged";
        let _ = writeln!(std::io::stderr(), "{note}");
    }
    claims::all_hold(&claims)
}

/// Everything that a trial needs, from the options.
pub(crate) struct Plan {
    pub(crate) ground: Ground,
    pub(crate) mappers: Vec<&'static Entry>,
    pub(crate) setup: Setup,
    /// Scans after which the report shows the maps.
    pub(crate) frames: Vec<usize>,
}

impl Plan {
    pub(crate) fn of(options: &RoomOptions) -> Result<Self, Failure> {
        let mappers = entries(&options.mappers)?;
        let ground = Ground::new(scene::load(&options.scene, options.grid, options.layout)?, options.belief.prior)?;
        let setup = Setup {
            prior: options.belief.prior(),
            reconciliation: options.belief.reconciliation(),
            ..Setup::new(ground.scene.grid, Arc::new(ground.scene.matcher.stereo))
        };
        Ok(Self { frames: report::moments(&ground, report::FRAMES), ground, mappers, setup })
    }
}

/// The metrics of the first seed alone, as `metrics.csv` has them, and the trial.
pub(crate) fn first_seed(plan: &Plan, options: &RoomOptions) -> Result<(Trial, table::Table), Failure> {
    let keep = Keep { timeline: false, frames: plan.frames.clone() };
    let trial = plan.ground.trial(options.seed, &plan.mappers, &plan.setup, &keep, &|_, _| ())?;
    let stages = stages(&plan.ground, &trial);
    let metrics = outputs::metrics(&plan.ground, std::slice::from_ref(&trial), &stages);
    Ok((trial, metrics))
}

/// Claims are made about free cells: a region without any is a mistake in the scene.
fn claimable(ground: &Ground, options: &RoomOptions) -> Result<(), Failure> {
    for region in ground.scene.regions.iter().filter(|region| region.claims) {
        let mask = region.mask(ground.truth.spec());
        if !mask.values().iter().zip(ground.truth.values()).any(|(inside, truth)| *inside && *truth == Some(false)) {
            return Err(Failure::BadInput(format!(
                "{}: region {}: has claims = true but no free cell of {} m; make it larger, move it, or leave the claims out",
                options.scene.display(),
                region.name,
                ground.scene.grid.cell_m
            )));
        }
    }
    Ok(())
}

fn seeds(options: &RoomOptions) -> Result<Vec<u64>, Failure> {
    let count = u64::from(options.seeds);
    let last = options.seed.checked_add(count - 1).ok_or_else(|| {
        Failure::BadInput(format!(
            "--seed {}: {count} seeds from there on pass {}; begin lower",
            options.seed,
            u64::MAX
        ))
    })?;
    Ok((options.seed..=last).collect())
}

/// One trial per seed; all but the first keep only their scores.
fn trials(
    ground: &Ground,
    seeds: &[u64],
    mappers: &[&Entry],
    setup: &Setup,
    frames: &[usize],
) -> Result<Vec<Trial>, Failure> {
    let names: Vec<&str> = mappers.iter().map(|entry| entry.name).collect();
    let progress = Progress::new(ground.scans() * mappers.len() * seeds.len(), &names);
    let trials = seeds
        .par_iter()
        .map(|&seed| {
            let frames = if seed == seeds[0] { frames.to_vec() } else { Vec::new() };
            let keep = Keep { timeline: true, frames };
            let trial = ground.trial(seed, mappers, setup, &keep, &|mapper, moment| {
                progress.step(mapper, moment.and_then(|moment| moment.log_loss));
            })?;
            Ok(if seed == seeds[0] { trial } else { trial.without_maps() })
        })
        .collect();
    progress.finish();
    trials
}

pub(crate) fn stages(ground: &Ground, trial: &Trial) -> Vec<Stage> {
    let plans = ground.scene.stages.iter().zip(&trial.simulation.stages);
    plans.map(|(plan, done)| Stage { name: plan.name.clone(), label: plan.label.clone(), scans: done.scans }).collect()
}

pub(crate) fn record(
    options: &RoomOptions,
    ground: &Ground,
    mappers: &[&Entry],
    stages: &[Stage],
    claims: &[Claim],
) -> Record {
    Record {
        schema_version: 1,
        command: "room",
        seed: options.seed,
        configuration: Configuration {
            scene: options.scene.display().to_string(),
            layout: ground.scene.layout,
            seeds: options.seeds,
            mappers: mappers.iter().map(|entry| entry.name).collect(),
            prior: options.belief.prior(),
            reconciliation: options.belief.reconciliation(),
            sensor: ground.scene.matcher,
            columns: ground.scene.camera.columns,
            field_of_view_rad: ground.scene.camera.field_of_view_rad,
            robot: Robot::of(&ground.scene),
        },
        grid: ground.scene.grid,
        stages: stages.to_vec(),
        claims: claims.to_vec(),
        versions: versions(),
        files: Vec::new(),
    }
}
