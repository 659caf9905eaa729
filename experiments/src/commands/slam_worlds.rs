//! `slam-worlds`: `slam` on generated worlds, where the truth is known.

mod options;
mod table;
mod world;

pub use options::SlamWorldsOptions;

use self::options::Sensing;
use self::world::{Drive, Outcome};
use crate::failure::Failure;
use crate::jobs::engine;
use crate::jobs::interruption;
use crate::jobs::progress::Count;
use crate::jobs::threads;
use crate::worlds::mappers::entries;
use crate::worlds::scenes::families;

/// Drives through worlds of families with odometry that drifts, finds ways and maps, and scores both.
///
/// # Errors
/// Bad input before any work, a world that cannot be made.
pub fn run(options: &SlamWorldsOptions) -> Result<(), Failure> {
    interruption::watch();
    threads::limit(options.threads.count)?;
    let entry = entries(std::slice::from_ref(&options.mapper), &Default::default())?[0];
    let families = families(&options.families)?;
    let weighed = options.weighed();
    let mut tasks: Vec<(usize, Sensing, u64)> = Vec::new();
    for family in 0..families.len() {
        for sensing in &options.sensors {
            tasks.extend(options.numbers().map(|seed| (family, *sensing, seed)));
        }
    }
    let progress = Count::worlds(tasks.len());
    let outcomes = engine::each(&tasks, rayon::current_num_threads(), |(family, sensing, seed)| {
        let drive = Drive::of(&families[*family], *seed, *sensing)?;
        let outcomes = drive.outcomes(entry, &weighed, options)?;
        progress.step();
        Ok(outcomes)
    });
    progress.finish();
    let outcomes: Vec<Outcome> = outcomes?.into_iter().flatten().collect();
    table::table(&outcomes).print(options.print.format, || table::text(&outcomes, options.particles))
}
