//! `features`: landmarks, and with them where the robot went, from point features.

mod drives;
mod field;
mod figure;
mod filter;
mod metrics;
mod options;
mod outputs;
mod scores;
mod source;
mod track;

pub use options::FeaturesOptions;

use std::time::Instant;

use self::outputs::Told;
use self::scores::Scores;
use self::source::Recording;
use self::track::Found;
use crate::failure::Failure;
use crate::jobs::interruption;
use crate::jobs::progress::Count;
use crate::jobs::threads;
use crate::output::args::Format;
use crate::output::folder::{Purpose, Staging};
use crate::output::note;

/// Finds landmarks by every filter that is asked for.
///
/// # Errors
/// Bad input before any work; a table without what a filter needs; I/O.
pub fn run(options: &FeaturesOptions) -> Result<(), Failure> {
    let start = Instant::now();
    interruption::watch();
    threads::limit(options.threads.count)?;
    let filters = options.filters();
    let place = options.place();
    let first = Recording::of(options, options.seed)?;
    first.tell_idle(options, &place);
    filters.iter().try_for_each(|filter| first.serves(*filter, options, &place))?;
    let out = options.out(&place);
    let reads: Vec<&std::path::PathBuf> = options.source.iter().collect();
    let mut staging = Staging::open(&out, &Purpose::new("features", &reads, outputs::names(&options.paper)))?;

    let scans = first.scans.len() * filters.len() * options.runs as usize;
    let progress = Count::scans(scans as u64);
    let mut scores = Scores::default();
    let mut shown: Option<(Recording, Found)> = None;
    let mut next = Some(first);
    for run in 0..u64::from(options.runs) {
        let seed = options.seed + run;
        let recording = match next.take() {
            Some(first) => first,
            None => Recording::of(options, seed)?,
        };
        scores.odometry(seed, &recording)?;
        let mut kept = None;
        for filter in &filters {
            let found = track::track(*filter, &recording, options, seed, || progress.step())?;
            scores.add(*filter, seed, &recording, &found, options.gate)?;
            kept = kept.or(Some(found));
        }
        if let Some(found) = kept.filter(|_| shown.is_none()) {
            shown = Some((recording, found));
        }
    }
    progress.finish();
    let Some((recording, found)) = shown else { return Err(Failure::Internal("no run".to_owned())) };
    let told =
        Told { options, place: &place, filters: &filters, recording: &recording, found: &found, scores: &scores };
    outputs::write(&mut staging, &told)?;
    staging.publish()?;
    scores.table(&filters).print(options.print.format, || outputs::text(&told))?;
    if options.print.format == Format::Text {
        note(format_args!(
            "{} in {:.1} s: {:.2} ms a scan of each filter",
            out.display(),
            start.elapsed().as_secs_f64(),
            1e3 * start.elapsed().as_secs_f64() / scans as f64,
        ));
    }
    scores.hold(filters[0], &options.at_most)
}
