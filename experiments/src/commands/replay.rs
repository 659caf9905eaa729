//! `replay`: what a robot recorded, mapped by several rules, and how well each map predicts scans that it has not seen.

mod along_time;
mod extent;
mod figure;
mod kept_back;
mod mapping;
mod options;
mod outputs;
mod predictions;
mod recalibrated;
mod recorded;
mod recording;
mod viewed;

pub use options::ReplayOptions;

use std::path::{Path, PathBuf};
use std::time::Instant;

use mapper::Model;
use mapper::catalogue::MAPPERS;

use self::extent::Survey;
use self::mapping::Turns;
use self::predictions::Predictions;
use self::recalibrated::FOLDS;
use self::recording::Recording;
use crate::failure::Failure;
use crate::jobs::interruption;
use crate::jobs::memory;
use crate::jobs::threads;
use crate::output::args::Format;
use crate::output::folder::{Purpose, Staging};
use crate::output::note;
use crate::worlds::faults;
use crate::worlds::kernels;
use crate::worlds::mappers::entries;
use crate::worlds::reading;
use crate::worlds::suspects;

/// What makes the map of a log fit.
const TOO_LARGE: &str = "use larger cells (--grid), a shorter --reach, a part of the log (--window) or fewer mappers";

/// Maps a log and scores the maps by the scans that were kept back.
///
/// # Errors
/// Bad input before any work, a log that is refused, I/O.
pub fn run(mut options: ReplayOptions) -> Result<(), Failure> {
    let start = Instant::now();
    interruption::watch();
    let entries = entries(&options.mappers, &options.programs)?;
    options.order.check(
        options.print.format,
        &[outputs::heads(true), outputs::heads(false)].concat(),
        &predictions::COLUMNS,
    )?;
    let Some(recording) = Recording::of(&mut options)? else { return Ok(()) };
    let options = &options;
    threads::limit(options.threads.count)?;
    let survey = Survey::of(&recording, options.reach, &|event| options.sensor_of(event))?;
    kernels::refuse_no_ranges(&options.depth.depth, &recording.place(), &survey.report)?;
    reading::tell_before_mapping(&recording.place(), &survey.report);
    options.tell_idle(&recording.place(), &survey.report, survey.sensor);
    if survey.kept == 0 {
        let left_out: Vec<String> =
            outputs::left_out(&survey.report).into_iter().map(|(what, count)| format!("{count} {what}")).collect();
        return Err(Failure::BadInput(format!(
            "{}: none of its {} scans is in use: {}; give another window, trajectory or gap",
            recording.place(),
            survey.report.scans,
            left_out.join(", ")
        )));
    }
    if survey.kept <= options.hold_out {
        return Err(Failure::BadInput(format!(
            "--hold-out {}: keeps every so-many-th scan back, and the log has {}; lower it, or give a longer log",
            options.hold_out, survey.kept
        )));
    }
    let grid = survey.grid(options.grid)?;
    let setup = Model {
        prior: options.prior.prior(),
        reconciliation: options.prior.reconciliation(),
        repeats: options.repeats(),
        max_range_m: options.map_range.unwrap_or(f64::INFINITY),
        sensors: survey.models(),
        ..Model::new(grid, options.sensor(survey.sensor)?)
    };
    let copies = 1 + FOLDS;
    let apart = vec![&MAPPERS[0]; if survey.arrays.len() > 1 { survey.arrays.len() } else { 0 }];
    let bytes = memory::of_mapping(&setup.grid, &entries, &setup, copies)
        + memory::of_mapping(&setup.grid, &apart, &setup, 2)
        + memory::besides(&setup.grid);
    memory::refuse(&recording.place(), &setup.grid, bytes, TOO_LARGE)?;
    let out = options.out();
    let reads: Vec<&Path> =
        [Some(&options.log), options.trajectory.as_ref()].into_iter().flatten().map(PathBuf::as_path).collect();
    options.recording.check(&reads)?;
    let mut staging = Staging::open(&out, &Purpose::new("replay", &reads, outputs::names(&entries, &options.paper)))?;

    let mapping = Instant::now();
    let turns = if options.timing { Turns::Timed } else { Turns::Together };
    let maps = mapping::map(&recording, &survey, options.hold_out, &entries, &setup, turns)?;
    let seconds = mapping.elapsed().as_secs_f64();
    let predictions =
        Predictions::of(&recording, (options.hold_out, &survey), &maps, &setup, &|kind| options.spread(kind))?;
    let suspects = suspects(&recording, &survey, &setup, options.hold_out)?;
    outputs::tell_agreement(&recording.place(), &survey, &predictions, &suspects, &setup);
    let told = outputs::Told {
        options,
        survey: &survey,
        setup: &setup,
        maps: &maps,
        predictions: &predictions,
        suspects: &suspects,
    };
    outputs::write(&mut staging, &recording, &told)?;
    staging.publish()?;
    options.recording.save(&reads, |recorder| recorded::record(recorder, &recording, &told))?;

    options.order.of(predictions.table(), &[]).print(options.print.format, || outputs::text(&told))?;
    let place = out.join("report.html");
    options.open.show(&place);
    if options.print.format == Format::Text {
        let mapped = survey.kept - survey.kept / options.hold_out;
        note(format_args!(
            "{} in {:.1} s; {:.0} scans/s by {} mappers {}{}",
            place.display(),
            start.elapsed().as_secs_f64(),
            mapped as f64 / seconds,
            entries.len(),
            if options.timing { "in turns" } else { "at once" },
            pace(&survey, start.elapsed().as_secs_f64())
        ));
    }
    faults::none(&mapping::lines(&maps.faults))
}

/// Every sensor of a log of several, against its own map and those of the others.
fn suspects(
    recording: &Recording,
    survey: &Survey,
    setup: &Model,
    hold_out: u64,
) -> Result<Vec<suspects::Suspect>, Failure> {
    let named = |(first, numbers): (&usize, &Vec<usize>)| {
        let called = kernels::called(survey.sensors.get(first)?.kind).to_owned();
        Some(suspects::Named { numbers: numbers.clone(), called })
    };
    let sensors: Vec<suspects::Named> = survey.arrays.iter().filter_map(named).collect();
    suspects::suspects(setup, &sensors, hold_out, &mut |each| {
        for scan in recording.scans()? {
            each(&scan.map_err(recording::refused)?);
        }
        Ok(())
    })
}

/// How much faster than it was recorded.
fn pace(survey: &Survey, seconds: f64) -> String {
    match survey.duration_s() {
        duration if duration > 0.0 => format!("; recorded in {duration:.0} s, {:.0} times as long", duration / seconds),
        _ => String::new(),
    }
}
