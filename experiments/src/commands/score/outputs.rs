//! The files that `score` leaves behind where `--out` names a folder.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use grid::Raster;
use serde_json::{Value, json};

use super::options::ScoreOptions;
use super::scored::Scored;
use super::truth::Truth;
use super::{driven, drives, figures, rows, text};
use crate::failure::Failure;
use crate::output::folder::{Purpose, Staging};
use crate::output::ledger::RECORD;
use crate::output::record::Record;
use crate::output::table::Table;
use crate::page::{self, Page, Part, Picture, Section, Sheet};

/// What a run means to do with its folder.
pub(super) fn purpose(sources: &[&PathBuf]) -> Purpose {
    let pictures = figures::CAPTIONS.map(|(name, _)| name);
    Purpose::new("score", sources, ["metrics.csv", "differences.csv", "report.html"].into_iter().chain(pictures))
}

/// Writes everything.
pub(super) fn write(
    staging: &mut Staging,
    scored: &Scored,
    truth: &Truth,
    first_region: &Raster<bool>,
    options: &ScoreOptions,
) -> Result<(), Failure> {
    let metrics = rows::table(&scored.rows());
    metrics.save(staging, "metrics.csv")?;
    let differences = rows::differences_table(&scored.differences);
    if scored.maps.len() > 1 {
        differences.save(staging, "differences.csv")?;
    }
    let pictures = pictures(staging, scored, truth, first_region, options.prior)?;
    let configuration = configuration(scored, truth, options);
    let page = Page {
        title: format!("Maps against {}", name(&options.truth)),
        lead: LEAD.to_owned(),
        facts: facts(truth),
        claims: Vec::new(),
        viewer: None,
        sections: vec![
            section("Scores", SCORES, sheets(scored, &metrics, &differences)),
            section("Pictures", "", pictures.into_iter().map(Part::Picture).collect()),
        ],
        configuration: serde_json::to_string_pretty(&configuration).map_err(Failure::internal)?,
        files: staging.files_and(&["report.html", RECORD]),
    };
    let html = page::page(&page)?;
    staging.write("report.html", |out| out.write_all(html.as_bytes()))?;
    staging.record(&Record::new("score", json!({ "configuration": configuration, "grid": truth.frame })))
}

const LEAD: &str = "Maps of any maker against the truth, on the same cells.";
const SCORES: &str = "Log loss, Brier score, calibration error (ece), phantom and missed area and collisions are better when lower, the others when higher; a dash \
    is a metric that is not defined there. Differences are over the cells that both maps are scored on; their intervals are 95 % by a bootstrap of \
    tiles of this one world, and say nothing of other worlds.";

fn section(heading: &str, lead: &str, parts: Vec<Part>) -> Section {
    Section { heading: heading.to_owned(), lead: lead.to_owned(), parts }
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn facts(truth: &Truth) -> String {
    let [free, occupied, unknown] = truth.counts();
    let spec = &truth.frame.spec;
    format!(
        "{} x {} cells of {} m: {free} free, {occupied} occupied, {unknown} not known",
        spec.width, spec.height, spec.cell_m
    )
}

/// What the terminal shows, and everything behind a line.
fn sheets(scored: &Scored, metrics: &Table, differences: &Table) -> Vec<Part> {
    let mut parts: Vec<Part> = scored.shown.iter().map(|region| Part::Sheet(text::sheet(scored, region))).collect();
    let fold = |summary: &str, table: &Table| Part::Fold {
        summary: summary.to_owned(),
        open: false,
        parts: vec![Sheet::of("", table)],
    };
    parts.extend(scored.drives.as_ref().map(|drives| Part::Sheet(driven::sheet(scored, drives))));
    if scored.maps.len() > 1 {
        let caption = format!("Differences from {}", scored.maps[0].name);
        parts.push(fold(&caption, differences));
    }
    parts.push(fold("Every metric of every region", metrics));
    parts
}

fn pictures(
    staging: &mut Staging,
    scored: &Scored,
    truth: &Truth,
    mask: &Raster<bool>,
    prior: f64,
) -> Result<Vec<Picture>, Failure> {
    let mut pictures = Vec::new();
    for (name, caption) in figures::CAPTIONS {
        let bytes = match name {
            "errors.png" => figures::errors(scored, truth, prior)?,
            _ => figures::reliabilities(scored, truth, mask)?,
        };
        staging.write(name, |out| out.write_all(&bytes))?;
        pictures.push(Picture { name: name.to_owned(), caption: caption.to_owned(), bytes });
    }
    Ok(pictures)
}

/// What the scores were made from.
fn configuration(scored: &Scored, truth: &Truth, options: &ScoreOptions) -> Value {
    let place = options.resolution.zip(options.origin);
    json!({
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
    })
}
