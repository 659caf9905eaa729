//! `compare`: which mapper is better, where, by how much and how surely.
//!
//! Every mapper maps the same readings of the same generated worlds ([`world`]); finished worlds are kept
//! until all are done ([`journal`]); then the scores are paired and judged ([`judgement`]).

mod again;
mod answer;
mod at_rest;
mod board;
pub mod claims;
pub mod document;
mod efficiency;
pub mod figures;
pub mod findings;
pub mod forest;
pub mod journal;
pub mod judgement;
pub mod options;
pub mod outputs;
pub mod plan;
pub mod repeats;
pub mod rows;
mod sensors;
pub mod sheets;
pub mod showcase;
pub mod tables;
pub mod text;
pub mod world;
pub mod worlds;

pub use again::page as renewed_page;
pub use options::CompareOptions;

use std::path::{Path, PathBuf};
use std::time::Instant;

use self::board::Board;
use self::findings::Findings;
use self::journal::Journal;
use self::options::Worlds;
use self::outputs::Parts;
use self::plan::{Plan, REFERENCE};
use self::world::{MapScores, WorldJob, WorldScores};
use crate::failure::Failure;
use crate::jobs::engine;
use crate::jobs::interruption;
use crate::jobs::progress::{Count, Doing};
use crate::jobs::threads;
use crate::output::args::Format;
use crate::output::folder::{Purpose, Staging};
use crate::output::note;
use crate::output::record::Record;
use crate::programs::times;
use crate::worlds::claims as claim;
use crate::worlds::faults;
use crate::worlds::ranked::Head;

/// Runs the comparison, or the rest of one that was interrupted.
///
/// # Errors
/// Bad input before any work, I/O, and claims that do not hold.
pub fn run(options: &CompareOptions) -> Result<(), Failure> {
    let start = Instant::now();
    interruption::watch();
    let plan = Plan::new(options)?;
    options.order.check(
        options.format,
        &text::heads(&plan).iter().map(|head| Head::titled(head)).collect::<Vec<_>>(),
        tables::differences(&[], REFERENCE).columns(),
    )?;
    let out = options.out.clone().unwrap_or_else(|| default_folder(&plan, options.quick));
    let reads: Vec<&Path> = options.families.iter().map(PathBuf::as_path).collect();
    let mut staging = Staging::open(&out, &Purpose::new("compare", &reads, outputs::names(&plan, &options.paper)))?;
    threads::limit(options.threads.count)?;
    let record = outputs::record(&plan);
    let worlds = map_worlds(&plan, &out, &configuration(&plan, &record)?)?;
    let doing = Doing::new("mapping repeated scans, and judging");
    let findings = judge(&plan, worlds)?;
    doing.next("mapping the world that the page shows");
    let (viewer, _) = showcase::look(&plan)?;
    doing.next("drawing figures and writing the page");
    let rows = outputs::rows(&plan, &findings)?;
    outputs::write(&mut staging, &plan, &findings, &rows, record, viewer, &options.paper)?;
    staging.publish()?;
    drop(doing);
    Journal::clear(&out);

    let differences = tables::differences(&findings.judgements, REFERENCE);
    let text = || text::summary(&plan, &rows, &findings.claims, &options.order);
    options.order.of(differences, &[]).print(options.format, text)?;
    let place = out.join("report.html");
    options.open.show(&place);
    if options.format == Format::Text {
        note(format_args!("{} in {:.0} s", place.display(), start.elapsed().as_secs_f64()));
    }
    times::tell();
    claim::all_hold(&findings.claims)?;
    faults::none(&without_maps(&findings.worlds))
}

/// Maps that programs did not give.
fn without_maps(worlds: &[WorldScores]) -> Vec<String> {
    let of_world = |world: &WorldScores| -> Vec<String> {
        let fault = |map: &MapScores| Some(format!("{}: {}: {}", map.mapper, world.job.world, map.fault.as_ref()?));
        world.maps.iter().filter_map(fault).collect()
    };
    worlds.iter().flat_map(of_world).collect()
}

fn default_folder(plan: &Plan, quick: bool) -> PathBuf {
    let set = if plan.set == Worlds::Test { String::new() } else { format!("-{}", plan.set.name()) };
    Path::new("results").join(format!("compare{set}{}", if quick { "-quick" } else { "" }))
}

/// All that decides the scores of a world. The record names the families' files; what they say may change
/// between an interruption and its continuation.
fn configuration(plan: &Plan, record: &Record<Parts>) -> Result<String, Failure> {
    let record = serde_json::to_string(record).map_err(Failure::internal)?;
    Ok(format!("{record}\n{:?}", plan.families))
}

/// Maps and scores every world that is not yet finished.
fn map_worlds(plan: &Plan, out: &Path, configuration: &str) -> Result<Vec<WorldScores>, Failure> {
    let jobs = plan.jobs();
    let journal = Journal::open(out, configuration)?;
    let (kept, all, place) = (journal.clone(), jobs.clone(), out.display().to_string());
    interruption::keeps(move || {
        let (done, all) = (kept.kept(&all), all.len());
        let kept =
            format!("{done} of {all} worlds are finished and kept in {place}; run the same command again to go on");
        (done > 0).then_some(kept)
    });
    let (progress, board) = (Count::worlds(jobs.len()), Board::default());
    let worlds = engine::each(&jobs, rayon::current_num_threads(), |job| {
        let world = match journal.read(job) {
            Some(world) => world,
            None => {
                let site = plan.site(job)?;
                let trial = job.trial(&site, &plan.mappers)?;
                let at_rest = at_rest::of(plan, job, &site.ground, &trial)?;
                let world = WorldScores { at_rest, ..job.score(&site.ground, &trial)? };
                journal.keep(&world)?;
                world
            }
        };
        progress.step();
        if progress.is_seen() {
            progress.say(&board.with(&world));
        }
        Ok(world)
    });
    progress.finish();
    worlds
}

/// Repeats scans, and judges everything.
fn judge(plan: &Plan, worlds: Vec<WorldScores>) -> Result<Findings, Failure> {
    let firsts: Vec<WorldJob> = plan.jobs().into_iter().take(plan.families.len()).collect();
    let repeated = match plan.repeats.is_empty() {
        true => Vec::new(),
        false => engine::each(&firsts, rayon::current_num_threads(), |job| {
            let family = plan.family(job);
            repeats::repeat(job, family, &plan.assumed, &plan.mappers, plan.repeated_scans, &plan.repeats)
        })?,
    };
    let scopes = judgement::scopes(&worlds);
    let judgements = judgement::judge(&worlds, &scopes, &plan.names(), REFERENCE)?;
    let claims = claims::judge(plan, &judgements);
    Ok(Findings { worlds, scopes, judgements, repeated: repeated.into_iter().flatten().collect(), claims })
}
