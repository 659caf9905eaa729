//! The files that `score` leaves behind where `--out` names a folder.

use std::io::Write as _;
use std::path::PathBuf;

use clap::ValueEnum as _;
use grid::Raster;
use serde_json::{Value, json};

use super::document::Tables;
use super::drives::Drives;
use super::options::ScoreOptions;
use super::regions::Regions;
use super::scored::Scored;
use super::truth::Truth;
use super::{document, drives, figures, profiles, rows, viewed};
use crate::failure::Failure;
use crate::figures::Paper;
use crate::output::folder::{Purpose, Staging};
use crate::output::ledger::RECORD;
use crate::output::record::Record;
use crate::output::table::Table;
use crate::page::{self, Picture, Viewer};

/// What the page shows of the maps, so that it can be laid anew without them.
pub(super) const VIEWER: &str = "viewer.json";

/// What a run means to do with its folder.
pub(super) fn purpose(sources: &[&PathBuf], paper: &Paper) -> Purpose {
    let pictures = figures::CAPTIONS.map(|(name, _)| name);
    Purpose::new(
        "score",
        sources,
        ["metrics.csv", "differences.csv", "profiles.csv", VIEWER, "report.html"]
            .map(str::to_owned)
            .into_iter()
            .chain(paper.files(&pictures)),
    )
}

/// Writes everything.
pub(super) fn write(
    staging: &mut Staging,
    scored: &Scored,
    truth: &Truth,
    regions: &Regions,
    options: &ScoreOptions,
) -> Result<(), Failure> {
    let mut csv = |name: &str, table: Table| -> Result<Vec<u8>, Failure> {
        table.save(staging, name)?;
        table.csv()
    };
    let profiles = || scored.maps.iter().filter_map(|map| Some((map.name.as_str(), map.profiles.as_ref()?)));
    let tables = Tables {
        metrics: csv("metrics.csv", rows::table(&scored.rows()))?,
        differences: (scored.maps.len() > 1)
            .then(|| csv("differences.csv", rows::differences_table(&scored.differences)))
            .transpose()?,
        profiles: profiles().next().map(|_| csv("profiles.csv", profiles::table(profiles()))).transpose()?,
    };
    let pictures = pictures(staging, scored, truth, regions.first(), options)?;
    let [free, occupied, unknown] = truth.counts();
    let viewed = page::viewed(&Viewer {
        worlds: vec![viewed::world(&document::name_of(&options.truth), scored, truth, regions, options.prior)],
        budget: page::WORLD_BYTES,
    });
    if let Some(viewed) = &viewed {
        staging.write(VIEWER, |out| out.write_all(viewed.as_bytes()))?;
    }
    let mut parts = json!({
        "configuration": configuration(scored, truth, options),
        "grid": truth.frame,
        "truth": { "free": free, "occupied": occupied, "unknown": unknown },
        "shown": scored.shown,
        "driven": scored.drives.as_ref().map(Drives::worded),
    });
    if let Some(pictures) = options.paper.asked() {
        parts["pictures"] = json!(pictures);
    }
    let record = Record::new("score", parts);
    let html = document::page(&record.json(&staging.files_and(&["report.html", RECORD]))?, &tables, pictures, viewed)?;
    staging.write("report.html", |out| out.write_all(html.as_bytes()))?;
    staging.record(&record)
}

fn pictures(
    staging: &mut Staging,
    scored: &Scored,
    truth: &Truth,
    mask: &Raster<bool>,
    options: &ScoreOptions,
) -> Result<Vec<Picture>, Failure> {
    let (paper, mut pictures) = (&options.paper, Vec::new());
    for (name, caption) in figures::CAPTIONS {
        let drawing = match name {
            "errors.png" => figures::errors(scored, truth, options.prior, paper),
            "profiles.png" if scored.maps.iter().any(|map| map.profiles.is_some()) => figures::profiles(scored, paper),
            "profiles.png" => continue,
            _ => figures::reliabilities(scored, truth, mask, paper)?,
        };
        let bytes = paper.save(staging, name, &drawing)?;
        pictures.push(Picture { name: name.to_owned(), caption: caption.to_owned(), bytes });
    }
    Ok(pictures)
}

/// What the scores were made from.
fn configuration(scored: &Scored, truth: &Truth, options: &ScoreOptions) -> Value {
    let place = options.resolution.zip(options.origin);
    let mut configuration = json!({
        "truth": options.truth.display().to_string(),
        "scans": options.scans.as_ref().map(|path| path.display().to_string()),
        "layout": options.layout,
        "cell_m": options.grid,
        "maps": options.maps.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
        "resampling": scored.maps.iter().map(|map| json!(map.how)).collect::<Vec<_>>(),
        "unknown": options.unknown.name(),
        "prior": options.prior,
        "finer": score::Finer::from(options.finer),
        "drives": drives::planning(truth, options),
        "align": options.align.name(),
        "align_bound_m": options.align_bound,
        "align_bound_deg": options.align_turn,
        "alignments": scored.maps.iter().map(|map| map.alignment.map(|(_, moved)| json!(moved))).collect::<Vec<_>>(),
        "row_order_top": options.row_order == Some(crate::worlds::map_file::RowOrder::Top),
        "place": place.map(|(cell_m, at)| json!({ "cell_m": cell_m, "origin_m": at.corner_m, "yaw_rad": at.yaw_rad })),
    });
    if let Some(shading) = options.read_as {
        configuration["read_as"] = json!(shading.to_possible_value().map(|value| value.get_name().to_owned()));
    }
    configuration
}
