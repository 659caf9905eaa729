//! The paper's room experiment: simulate, map, score, show.

mod again;
mod document;
mod options;
mod outputs;
mod plan;
mod programs;
mod record;
mod recording;
mod sensors;
mod summary;

pub use again::page as renewed_page;
pub use options::RoomOptions;

use std::path::Path;
use std::time::Instant;

use mapper::Model;
use mapper::catalogue::Entry;
use rayon::prelude::*;

use self::plan::RoomPlan;
use self::record::Parts;
use crate::failure::Failure;
use crate::jobs::interruption;
use crate::jobs::progress::Progress;
use crate::jobs::threads;
use crate::output::args::Format;
use crate::output::folder::{self, Purpose, Staging};
use crate::output::record::Record;
use crate::output::{note, warn};
use crate::programs::times;
use crate::worlds::claims::{self, Claim};
use crate::worlds::faults;
use crate::worlds::ground::Ground;
use crate::worlds::run::{Keep, Trial};
use crate::worlds::suspects;

/// Runs the experiment.
///
/// # Errors
/// Bad input before any work, I/O, and claims that do not hold.
pub fn run(options: &RoomOptions) -> Result<(), Failure> {
    let start = Instant::now();
    interruption::watch();
    threads::limit(options.threads.count)?;
    let seeds = seeds(options)?;
    let RoomPlan { ground, mappers, setup, frames } = RoomPlan::of(options)?;
    plan::refuse_too_large(options, &ground, &mappers, &setup, frames.len())?;
    let usual = || folder::for_scene(&Path::new("results").join(&ground.scene.name), &options.scene);
    let out = options.out.clone().unwrap_or_else(usual);
    plan::claimable(&ground, options)?;
    warn(&ground.scene.warnings);
    warn(scene::enclosure(&ground.scene, &ground.world, &ground.drive).warning(&options.scene).as_slice());
    let columns = outputs::metrics(&ground, &[], &[]);
    options.order.check(options.format, &summary::heads(&ground), columns.columns())?;
    let files = outputs::names(&ground, &mappers, &options.paper);
    options.recording.check(&[&options.scene])?;
    let mut staging = Staging::open(&out, &Purpose::new("room", &[&options.scene], files))?;
    let trials = trials(&ground, &seeds, &mappers, &setup, &frames)?;
    for line in suspects::lines(&suspects::of_drive(&setup, &ground.scene, &trials[0].simulation)?) {
        note(format_args!("warning: {}: {line}", options.scene.display()));
    }
    let stages = ground.stages(&trials[0]);
    let all_readings = options.cut.max_range_m.is_none();
    let claimed = ground.scene.regions.iter().filter(|region| region.claims && all_readings);
    let claims: Vec<Claim> = claimed.flat_map(|region| claims::judge(&trials, &region.name)).collect();
    let record = Record::new("room", Parts::of(options, &ground, &mappers, &stages, &claims));
    let metrics = outputs::metrics(&ground, &trials, &stages);
    let outcome = outputs::Outcome { ground: &ground, trials: &trials, stages: &stages, frames: &frames };
    outputs::write(&mut staging, outcome, &metrics, &record, &options.paper)?;
    staging.publish()?;
    options.recording.save(&[&options.scene], |recorder| {
        recording::record(recorder, &outcome);
        Ok(())
    })?;

    let text = || summary::text(&ground, &trials, &stages, &claims, &options.order);
    options.order.of(metrics, &[]).print(options.format, text)?;
    mixing(&trials);
    times::tell();
    let place = out.join("report.html");
    options.open.show(&place);
    if options.format == Format::Text {
        note(format_args!("{} in {:.1} s", place.display(), start.elapsed().as_secs_f64()));
    }
    if claims.is_empty() && ground.scene.regions.iter().any(|region| region.claims) {
        let note = match all_readings {
            true => "note: the scene's claims compare visibility with conventional; without both they are not judged",
            false => "note: the scene's claims are about all readings; with --max-range they are not judged",
        };
        crate::output::note(note);
    }
    claims::all_hold(&claims)?;
    faults::none(&programs::faults(&trials, &stages))
}

/// Says how well the draws of mappers that sample agree at the end of the drive.
fn mixing(trials: &[Trial]) {
    for (trial, run) in trials.iter().flat_map(|trial| trial.runs.iter().map(move |run| (trial, run))) {
        if let Some(mixing) = run.mixing {
            note(format_args!("{}: seed {}: {mixing}", run.mapper, trial.seed));
        }
    }
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
    setup: &Model,
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
