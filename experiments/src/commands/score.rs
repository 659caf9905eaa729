//! `score MAP.. --truth TRUTH`: maps of any maker against the truth.

mod alignment;
mod candidate;
mod document;
mod driven;
mod drives;
mod figures;
mod options;
mod outputs;
mod profiles;
mod regions;
mod rows;
mod scored;
mod text;
mod truth;
mod viewed;

pub use document::renewed_page;
pub use options::ScoreOptions;

use std::path::PathBuf;

use rayon::prelude::*;

use self::candidate::{Candidate, names};
use self::drives::Drives;
use self::regions::Regions;
use self::rows::Difference;
use self::scored::{Scored, ScoredMap};
use self::truth::Truth;
use crate::failure::Failure;
use crate::jobs::{interruption, threads};
use crate::output::args::{Format, OpenOption};
use crate::output::folder::Staging;
use crate::output::{note, warn};
use crate::worlds::map_file::extension;

/// Scores the maps and prints the table.
///
/// # Errors
/// Bad input, and a stdout that cannot be written.
pub fn run(options: &ScoreOptions) -> Result<(), Failure> {
    interruption::watch();
    threads::limit(options.threads.count)?;
    let names = names(&options.maps)?;
    options.order.check(options.print.format, &text::heads(options), rows::table(&[]).columns())?;
    effective(options)?;
    let truth = Truth::read(options)?;
    let regions = match &options.scans {
        Some(scans) => Regions::seen(scans, &truth)?,
        None => Regions::whole(&truth),
    };
    let read = options.maps.par_iter().zip(&names).map(|(path, name)| Candidate::read(path, name, &truth, options));
    let candidates = read.collect::<Vec<_>>().into_iter().collect::<Result<Vec<_>, _>>()?;
    candidates.iter().for_each(|candidate| warn(&candidate.warnings));
    let sources: Vec<PathBuf> = truth
        .sources
        .iter()
        .chain(&options.scans)
        .chain(candidates.iter().flat_map(|candidate| &candidate.sources))
        .cloned()
        .collect();
    let open =
        |out: &PathBuf| Staging::open(out, &outputs::purpose(&sources.iter().collect::<Vec<_>>(), &options.paper));
    let staging = options.out.as_ref().map(open).transpose()?;
    let drives = Drives::of(&truth, options);
    let judged = candidates.into_par_iter().map(|candidate| {
        let mut map = scored(&candidate, &truth, &regions, options)?;
        map.rows.extend(drives.as_ref().map_or(Ok(Vec::new()), |drives| drives.rows(&map.name, &map.map))?);
        Ok(map)
    });
    let maps = judged.collect::<Vec<_>>().into_iter().collect::<Result<Vec<_>, Failure>>()?;
    warn(&maps.iter().flat_map(|map| &map.warnings).collect::<Vec<_>>());
    let differences = against_first(&maps, &truth, &regions, options)?;
    let scored = Scored { differences, maps, shown: regions.shown(), drives };
    if let Some(mut staging) = staging {
        outputs::write(&mut staging, &scored, &truth, &regions, options)?;
        staging.publish()?;
    }
    let table = options.order.of(rows::table(&scored.rows()), &[]);
    table.print(options.print.format, || text::text(&scored, &truth, options))?;
    if let Some(page) = options.out.as_ref().map(|out| out.join("report.html")) {
        OpenOption { open: options.open }.show(&page);
        if options.print.format == Format::Text {
            note(page.display());
        }
    }
    Ok(())
}

/// A map in the cells of the truth, with its scores.
fn scored(
    candidate: &Candidate,
    truth: &Truth,
    regions: &Regions,
    options: &ScoreOptions,
) -> Result<ScoredMap, Failure> {
    let name = candidate.name.as_str();
    let alignment = alignment::best(candidate, truth, options)?;
    let frame = alignment.map_or(candidate.frame, |alignment| alignment.of(&candidate.frame));
    let map = candidate.in_cells_of(truth, &frame, options)?;
    let mut rows = rows::scores(name, &map, truth, regions, options.unknown)?;
    if let Some(alignment) = &alignment {
        let before = candidate.in_cells_of(truth, &candidate.frame, options)?;
        let before = rows::scores(name, &before, truth, regions, options.unknown)?;
        rows.extend(alignment::rows(name, alignment, &before));
    }
    let judged = |cell: &usize| truth.cells[*cell].is_some() && map.known[*cell];
    let blank = !(0..truth.cells.spec().cells()).any(|cell| judged(&cell));
    let profiles = profiles::of(&map, truth, regions, options.unknown)?;
    let mut warnings = alignment::doubts(candidate, &frame, alignment.as_ref(), truth, options)?;
    if blank {
        let path = candidate.path.display();
        warnings.push(format!(
            "{path}: knows nothing of any cell of the truth, so that --unknown alone decides its scores"
        ));
    }
    Ok(ScoredMap {
        name: name.to_owned(),
        how: map.how,
        map,
        assumed: candidate.assumed,
        rows,
        profiles,
        alignment: alignment.map(|alignment| (candidate.frame, alignment)),
        warnings,
    })
}

/// Every map but the first, less the first.
fn against_first(
    maps: &[ScoredMap],
    truth: &Truth,
    regions: &Regions,
    options: &ScoreOptions,
) -> Result<Vec<Difference>, Failure> {
    let Some((first, others)) = maps.split_first() else { return Ok(Vec::new()) };
    let mut found = Vec::new();
    for other in others {
        let pair = [(other.name.as_str(), &other.map), (first.name.as_str(), &first.map)];
        found.extend(rows::differences(pair, truth, regions, options.unknown)?);
        found.extend(driven::differences([other, first]));
    }
    Ok(found)
}

/// Refuses options that would have no effect.
fn effective(options: &ScoreOptions) -> Result<(), Failure> {
    let files = || options.maps.iter().chain([&options.truth]).map(|path| extension(path));
    let images = files().any(|form| ["pgm", "png"].contains(&form.as_str()));
    let arrays = options.maps.iter().any(|path| extension(path) == "npy");
    let placeless = images || files().any(|form| form == "npy");
    let refused =
        |name: &str, what: &str| Err(Failure::BadInput(format!("{name}: must stand with {what}; leave it out")));
    if options.read_as.is_some() && !images {
        return refused("--read-as", "an image without YAML");
    }
    if options.row_order.is_some() && !arrays {
        return refused("--row-order", "an .npy file among the maps");
    }
    if (options.resolution.is_some() || options.origin.is_some()) && !placeless {
        return refused("--resolution and --origin", "an .npy file or an image, which may say no place");
    }
    if options.resolution.is_some() != options.origin.is_some() {
        let message = "--resolution and --origin: must stand together, since a place is both; give the other one too";
        return Err(Failure::BadInput(message.to_owned()));
    }
    Ok(())
}
