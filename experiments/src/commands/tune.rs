//! `tune`: parameters of mappers, fitted on worlds that no result is reported on.

pub mod candidates;
pub mod clamps;
mod figure;
pub mod fit;
mod options;
pub mod outputs;

pub use options::TuneOptions;

use std::path::{Path, PathBuf};
use std::time::Instant;

use mapper::Candidate;
use scene::Set;

use self::candidates::Tuned;
use self::fit::TunedFit;
use crate::failure::Failure;
use crate::jobs::engine;
use crate::jobs::interruption;
use crate::jobs::progress::Count;
use crate::jobs::threads;
use crate::output::folder::{Purpose, Staging};
use crate::output::note;
use crate::worlds::condition::AS_BELIEVED;
use crate::worlds::scenes::families;
use crate::worlds::site::WorldId;

/// Mappers that take all scans at once are fitted on so many worlds of each family: they cost ten times as much.
pub const BATCH_SEEDS: u32 = 3;

/// Scores every candidate on the tuning set and prints the best.
///
/// # Errors
/// Bad input before any work, and I/O.
pub fn run(options: &TuneOptions) -> Result<(), Failure> {
    let start = Instant::now();
    interruption::watch();
    let families = families(&options.families)?;
    let mappers = distinct(&options.mappers)?;
    let reads: Vec<&Path> = options.families.iter().map(PathBuf::as_path).collect();
    let mut staging = Staging::open(&options.out, &Purpose::new("tune", &reads, options.paper.files(&outputs::FILES)))?;
    threads::limit(options.threads.count)?;

    let grids: Vec<Vec<Candidate>> = mappers.iter().map(|tuned| tuned.candidates()).collect();
    let tasks = tasks(&mappers, u64::from(options.seeds), families.len());
    let progress = Count::worlds(tasks.len());
    let errors = engine::each(&tasks, rayon::current_num_threads(), |task| {
        let family = &families[task.family];
        let (family_name, condition) = (family.name.clone(), AS_BELIEVED.name.to_owned());
        let world = WorldId { family: family_name, condition, cell_um: None, seed: task.seed };
        let errors = fit::errors(&world, family, &grids[task.mapper])?;
        progress.step();
        Ok(errors)
    });
    progress.finish();
    let errors = errors?;
    let fit = |(number, &tuned): (usize, &Tuned)| {
        let worlds = tasks.iter().zip(&errors).filter(|(task, _)| task.mapper == number);
        TunedFit::new(tuned, &grids[number], &worlds.map(|(_, errors)| errors.as_slice()).collect::<Vec<_>>())
    };
    let fits: Vec<TunedFit> = mappers.iter().enumerate().map(fit).collect();
    outputs::write(&mut staging, &fits, options)?;
    staging.publish()?;

    let place = options.out.join("tuning.csv");
    note(format_args!("{} in {:.0} s", place.display(), start.elapsed().as_secs_f64()));
    outputs::table(&fits).print(options.format, || outputs::text(&fits, options))
}

/// A world for the candidates of one mapper.
struct Task {
    mapper: usize,
    family: usize,
    seed: u64,
}

/// All worlds of all mappers, the long ones first so that no thread begins one at the end.
fn tasks(mappers: &[Tuned], seeds: u64, families: usize) -> Vec<Task> {
    let mut tasks = Vec::new();
    for (mapper, tuned) in mappers.iter().enumerate() {
        let seeds = if tuned.is_batch() { seeds.min(u64::from(BATCH_SEEDS)) } else { seeds };
        for seed in Set::Tuning.seeds(seeds) {
            tasks.extend((0..families).map(|family| Task { mapper, family, seed }));
        }
    }
    tasks.sort_by_key(|task| !mappers[task.mapper].is_batch());
    tasks
}

/// The mappers in the order of tables; all where none is named.
fn distinct(mappers: &[Tuned]) -> Result<Vec<Tuned>, Failure> {
    if mappers.is_empty() {
        return Ok(Tuned::all());
    }
    let twice = mappers.iter().enumerate().find(|(k, tuned)| mappers[..*k].contains(tuned));
    match twice {
        Some((_, name)) => Err(Failure::BadInput(format!("--mappers: '{name}' is given twice; name each mapper once"))),
        None => Ok(Tuned::all().into_iter().filter(|tuned| mappers.contains(tuned)).collect()),
    }
}
