//! `sweep`: many settings over many worlds, in shards that can run anywhere, and one table of all of them.

pub mod engine;
pub mod estimate;
pub mod file;
mod held;
pub mod job;
pub mod manifest;
pub mod merge;
mod options;
mod outcome;
pub mod parameters;
pub mod plots;
pub mod regions;
pub mod row;
mod schema;
pub mod shard;
mod slurm;
pub mod source;

pub use held::held;
pub use options::SweepOptions;
pub use schema::schema;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde_json::json;

use self::manifest::{Manifest, Replace};
use self::options::{Part, PlanOptions, RunOptions, StatusOptions};
use self::shard::State;
use crate::failure::Failure;
use crate::figures::Paper;
use crate::jobs::interruption;
use crate::jobs::threads;
use crate::output::folder;
use crate::output::note;
use crate::output::table::{self, Table};
use crate::programs::times;

/// Does what the options ask for.
///
/// # Errors
/// Bad input before any work; shards that cannot be written; gaps in what is to be merged.
pub fn run(options: &SweepOptions) -> Result<(), Failure> {
    interruption::watch();
    match (&options.part, &options.file) {
        (Some(Part::Plan(options)), _) => plan(options),
        (Some(Part::Run(options)), _) => run_shards(options),
        (Some(Part::Status(options)), _) => status(options),
        (Some(Part::Missing(options)), _) => missing(&Manifest::open(&options.folder)?),
        (Some(Part::Merge(options)), _) => outcome::merge(options),
        (Some(Part::Plot(options)), _) => outcome::plot(options),
        (Some(Part::Slurm(options)), _) => slurm::run(options),
        (None, Some(file)) => all(file, options),
        (None, None) => Err(Failure::BadInput("sweep: name a sweep file; see sweep --help".to_owned())),
    }
}

/// The folder of a sweep file if none is given.
fn default_folder(file: &Path) -> PathBuf {
    let name = file.file_stem().unwrap_or_default().to_string_lossy();
    Path::new("results").join(format!("sweep-{name}"))
}

fn plan(options: &PlanOptions) -> Result<(), Failure> {
    let sweep = file::load(&options.file)?.with(&options.programs)?;
    let folder = options.out.clone().unwrap_or_else(|| default_folder(&options.file));
    folder::check(&folder, &outcome::purpose(&sweep.mappers, &Paper::default()))?;
    let manifest = manifest::plan(
        &sweep,
        &folder,
        options.shards,
        if options.replace { Replace::Always } else { Replace::Never },
    )?;
    let place = folder.join(manifest::MANIFEST);
    note(format_args!("{}: {} jobs in {} shards", place.display(), manifest.head.jobs, manifest.head.shards));
    Ok(())
}

fn run_shards(options: &RunOptions) -> Result<(), Failure> {
    let manifest = Manifest::open(&options.folder)?;
    if let Some(shard) = options.shard.iter().find(|shard| **shard >= manifest.head.shards) {
        let last = manifest.head.shards.saturating_sub(1);
        return Err(Failure::BadInput(format!("--shard {shard}: must be 0 to {last}, as the manifest has them")));
    }
    let named = Some(&options.shard).filter(|shards| !shards.is_empty());
    work(&manifest, named, options.threads.count)
}

/// Runs the shards named, or all that are not done.
fn work(manifest: &Manifest, named: Option<&Vec<u32>>, threads: Option<u32>) -> Result<(), Failure> {
    let start = Instant::now();
    let place = manifest.folder.display().to_string();
    interruption::keeps(move || {
        Some(format!("what is finished is kept in {place}; run the same command again to go on"))
    });
    if let Err(failure) = manifest.confirm() {
        // Whoever runs single shards on other machines looks here for what went wrong.
        named.into_iter().flatten().for_each(|shard| shard::note_failure(manifest, *shard, &failure.to_string()));
        return Err(failure);
    }
    threads::limit(threads)?;
    shard::remove_leftovers(&manifest.folder);
    let not_done = |shard: &u32| !shard::is_done(manifest, *shard);
    let shards =
        named.map_or_else(|| shard::missing(manifest), |named| named.iter().copied().filter(not_done).collect());
    let threads = rayon::current_num_threads();
    if named.is_none()
        && let Some(estimate) = estimate::sample(manifest, &shards, threads)?
        && let Some(announcement) = estimate.announce(manifest)?
    {
        note(announcement);
    }
    let ran = engine::run(manifest, &shards, threads)?;
    let failed = if ran.failed > 0 { format!(", {} with an error", counted(ran.failed, "row")) } else { String::new() };
    let (place, time) = (manifest.folder.display(), start.elapsed().as_secs_f64());
    note(format_args!(
        "{place}: {} in {} in {time:.0} s{failed}",
        counted(ran.jobs, "job"),
        counted(shards.len() as u64, "shard")
    ));
    times::tell();
    Ok(())
}

fn status(options: &StatusOptions) -> Result<(), Failure> {
    let manifest = Manifest::open(&options.folder)?;
    let (mut counts, mut jobs, mut rows) = ([0u64; 3], 0, 0);
    for number in 0..manifest.head.shards {
        match shard::state(&manifest, number) {
            State::Done { rows: more } => {
                counts[0] += 1;
                jobs += manifest.jobs_of(number);
                rows += more;
            }
            State::Missing => counts[1] += 1,
            State::Invalid => counts[2] += 1,
        }
    }
    let tries = fs::read_dir(shard::failures(&options.folder)).map_or(0, Iterator::count);
    let shards = Some(u64::from(manifest.head.shards));
    let rows = [
        ("shards done", counts[0], shards),
        ("shards missing", counts[1], shards),
        ("shards not whole, or of another manifest", counts[2], shards),
        ("jobs done", jobs, Some(manifest.head.jobs)),
        ("rows", rows, None),
        ("tries that failed", tries as u64, None),
    ];
    let table =
        Table::of(&rows, &[("what", &|row| json!(row.0)), ("count", &|row| json!(row.1)), ("of", &|row| json!(row.2))]);
    table.print(options.print.format, || table::aligned(table.columns(), &table.fields()))
}

/// Nothing is printed where nothing is missing.
fn missing(manifest: &Manifest) -> Result<(), Failure> {
    match shard::ranges(&shard::missing(manifest)) {
        ranges if ranges.is_empty() => Ok(()),
        ranges => table::print(&format!("{ranges}\n")),
    }
}

/// Plans, runs, merges and plots a sweep on this machine.
fn all(file: &Path, options: &SweepOptions) -> Result<(), Failure> {
    let sweep = file::load(file)?.with(&options.programs)?;
    let folder = options.out.clone().unwrap_or_else(|| default_folder(file));
    folder::check(&folder, &outcome::purpose(&sweep.mappers, &options.paper))?;
    let former = Manifest::open(&folder).ok();
    let manifest = manifest::plan(
        &sweep,
        &folder,
        options.shards,
        if options.replace { Replace::Always } else { Replace::OtherBuild },
    )?;
    if former.is_some_and(|former| former.digest != manifest.digest) {
        note(format_args!(
            "{}: another build, or another sweep, has planned it before: all of it runs again",
            folder.display()
        ));
    }
    work(&manifest, None, options.threads.count)?;
    outcome::conclude(&manifest, Some(&sweep), &options.paper)
}

fn counted(count: u64, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
