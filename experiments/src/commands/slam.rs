//! `slam`: trajectory and map together, from scans and odometry.

mod along;
mod document;
mod figure;
mod metrics;
mod mounts;
mod options;
mod outputs;
mod read;
mod recorded;
mod returns;
mod scores;
mod sensors;
mod source;

pub use options::SlamOptions;

use std::sync::Arc;
use std::time::Instant;

use slam::features::Association;
use slam::{Slam, Update};

use self::outputs::Told;
use self::scores::Scores;
use self::source::Source;
use crate::failure::Failure;
use crate::jobs::interruption;
use crate::jobs::progress::Count;
use crate::jobs::threads;
use crate::output::args::Format;
use crate::output::folder::{Purpose, Staging};
use crate::output::note;
use crate::page::cloud::Moment;
use crate::worlds::mappers::entries;
use crate::worlds::reading;

/// Finds where the robot went and what lies there.
///
/// # Errors
/// Bad input before any work, a log that is refused or has no odometry, I/O.
pub fn run(mut options: SlamOptions) -> Result<(), Failure> {
    let start = Instant::now();
    interruption::watch();
    threads::limit(options.threads.count)?;
    let noise = options.noise();
    let entry = entries(std::slice::from_ref(&options.mapper), &Default::default())?[0];
    let Some(source) = Source::of(&mut options)? else { return Ok(()) };
    let Source { place, scans, model, sensors, truth, camera, report } = source;
    let options = &options;
    if let Some((report, sensor)) = &report {
        reading::tell_before_mapping(&place, report);
        reading::tell_idle(&options.given, &place, report, *sensor);
    }
    let references = scores::References::of(options, truth)?;
    let out = options.out(&place);
    let reads = [Some(&options.source), options.truth.as_ref(), options.relations.as_ref()];
    let reads: Vec<&std::path::PathBuf> = reads.into_iter().flatten().collect();
    let read: Vec<&std::path::Path> = reads.iter().map(|path| path.as_path()).collect();
    options.recording.check(&read)?;
    let mut staging = Staging::open(&out, &Purpose::new("slam", &reads, outputs::names(&options.paper)))?;

    let refused = |error: slam::SlamError| Failure::BadInput(format!("--mapper {}: {error}", entry.name));
    let mut filter = Slam::new(entry.mapper(&model), &model, Arc::new(noise), options.filter_of(report.is_some()))
        .map_err(refused)?;
    if let Some(camera) = camera {
        filter = filter.beside(camera, Association::default()).map_err(Failure::internal)?;
    }
    let progress = Count::scans(scans.len() as u64);
    let mapping = Instant::now();
    let mut away: Vec<Update> = Vec::new();
    let mut moments: Vec<Moment> = Vec::new();
    for taken in &scans {
        if let Some(update) = filter.take_together(&taken.mounted(), &taken.features, taken.odometry) {
            away.extend(Some(update).filter(|update| update.carried_away));
            let Update { time_s, effective, resampled, .. } = update;
            moments.push(Moment { time_s, effective, resampled, returned: false, particles: filter.particles() });
        }
        progress.step();
    }
    progress.finish();
    let seconds = mapping.elapsed().as_secs_f64();
    let bytes = filter.bytes();
    let outcome = filter.finish();
    outputs::tell_carried_away(&place, &away);
    outputs::tell_passed_over(&place, &outcome.passed_over);
    outputs::tell_outside(&place, &outcome, &model.grid)?;
    let scores = Scores::of(&outcome.trajectory, &scans, &moments, &references)?;
    let went: Vec<(f64, [f64; 2])> =
        outcome.updates.iter().map(|update| (update.time_s, update.pose.position_m())).collect();
    let (map, seen) = outputs::cropped(&scans, &outcome, &model);
    let told = Told {
        options,
        entry,
        place: &place,
        scans: &scans,
        model: &model,
        sensors: &sensors,
        camera,
        sensor: report.as_ref().map(|(_, sensor)| *sensor),
        outcome: &outcome,
        map: &map,
        seen: &seen,
        scores: &scores,
        away: &away,
        moments: &moments,
        returns: &returns::returns(&went),
        references: &references,
    };
    outputs::write(&mut staging, &told)?;
    staging.publish()?;
    options.recording.save(&read, |recorder| {
        recorded::record(recorder, &told);
        Ok(())
    })?;
    scores.table().print(options.print.format, || outputs::text(&told))?;
    if options.print.format == Format::Text {
        note(format_args!(
            "{} in {:.1} s; {:.1} s of matching and mapping for {:.0} s of the robot, {:.1} MB a particle",
            out.display(),
            start.elapsed().as_secs_f64(),
            seconds,
            scans.last().map_or(0.0, |last| last.time_s()) - scans[0].time_s(),
            bytes.iter().sum::<usize>() as f64 / bytes.len() as f64 / 1e6,
        ));
    }
    scores.hold(&options.at_most)
}
