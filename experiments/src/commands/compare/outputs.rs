//! The files that `compare` leaves behind.

use std::io::Write as _;

use mapper::{Prior, Reconciliation};
use serde::Serialize;

use super::at_rest;
use super::efficiency;
use super::findings::Findings;
use super::plan::{Plan, REFERENCE};
use super::rows::{self, Rows};
use super::{document, figures, forest, sensors, tables};
use crate::failure::Failure;
use crate::figures::Paper;
use crate::output::folder::Staging;
use crate::output::ledger::RECORD;
use crate::output::record::Record;
use crate::output::table::Table;
use crate::page::{self, Viewer};
use crate::programs::options::ProgramRecord;
use crate::worlds::claims::Claim;
use crate::worlds::drives::DriveOptions;

/// What the record of a comparison holds.
#[derive(Debug, Serialize)]
pub struct Parts {
    configuration: Configuration,
    claims: Vec<Claim>,
    /// How pictures were made, where that was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pictures: Option<Paper>,
}

#[derive(Debug, Serialize)]
struct Configuration {
    set: &'static str,
    families: Vec<String>,
    conditions: Vec<&'static str>,
    seeds: u64,
    batch_seeds: u64,
    mappers: Vec<&'static str>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    programs: Vec<ProgramRecord>,
    reference: &'static str,
    prior: Prior,
    reconciliation: Reconciliation,
    drives: DriveOptions,
    #[serde(skip_serializing_if = "Option::is_none")]
    max_range_m: Option<f64>,
    repeats: Vec<usize>,
    repeated_scans: usize,
}

/// The record of a plan, before anything is known of its outcome.
pub fn record(plan: &Plan) -> Record<Parts> {
    let configuration = Configuration {
        set: plan.set.name(),
        families: plan.paths.iter().map(|path| path.display().to_string()).collect(),
        conditions: plan.conditions.clone(),
        seeds: plan.seeds,
        batch_seeds: plan.batch_seeds,
        mappers: plan.names(),
        programs: plan.programs.clone(),
        reference: REFERENCE,
        prior: plan.assumed.prior,
        reconciliation: plan.assumed.reconciliation,
        drives: plan.drives,
        max_range_m: plan.assumed.max_range_m,
        repeats: plan.repeats.clone(),
        repeated_scans: plan.repeated_scans,
    };
    Record::new("compare", Parts { configuration, claims: Vec::new(), pictures: None })
}

/// The tables as their files hold them.
///
/// # Errors
/// A defect of ours.
pub fn rows(plan: &Plan, findings: &Findings) -> Result<Rows, Failure> {
    Ok(Rows {
        means: rows::of(&tables::summary(&findings.worlds, &findings.scopes, &plan.names()))?,
        differences: rows::of(&tables::differences(&findings.judgements, REFERENCE))?,
        repeats: rows::of(&tables::repeats(&findings.repeated))?,
        at_rest: rows::of(&tables::at_rest(&at_rest::rows(&findings.worlds, &plan.names())))?,
        sensors: rows::of(&sensors::table(&sensors::rows(plan, &findings.worlds)?))?,
        efficiency: efficiency::rows(&findings.worlds, &findings.scopes, &plan.names()),
    })
}

/// The file with the scores of a mapper: a change of one mapper rewrites one file.
pub fn scores_of(mapper: &str) -> String {
    format!("scores-{mapper}.csv")
}

/// Every file that may come of a plan, beside the record.
pub fn names(plan: &Plan, paper: &Paper) -> Vec<String> {
    let kept = plan.programs.iter().map(|program| page::kept::name(&program.name));
    paper.files(&FILES).into_iter().chain(plan.names().into_iter().map(scores_of)).chain(kept).collect()
}

const FILES: [&str; 15] = [
    "at-rest.csv",
    "sensors.csv",
    "efficiency.csv",
    "mixing.csv",
    "summary.csv",
    "differences.csv",
    "reliability.csv",
    "profiles.csv",
    "repeats.csv",
    "differences.png",
    "reliability.png",
    "profiles.png",
    "repeats.png",
    "summary.md",
    "report.html",
];

/// Writes everything.
///
/// # Errors
/// Whatever the system reports; a drawing that fails.
pub fn write(
    staging: &mut Staging,
    plan: &Plan,
    findings: &Findings,
    rows: &Rows,
    mut record: Record<Parts>,
    viewer: Viewer,
    paper: &Paper,
) -> Result<(), Failure> {
    let Findings { worlds, scopes, judgements, repeated, claims } = findings;
    let names = plan.names();
    let mut csv = |name: &str, table: Table| table.save(staging, name);
    names.iter().try_for_each(|mapper| csv(&scores_of(mapper), tables::scores(worlds, mapper)))?;
    csv("summary.csv", tables::summary(worlds, scopes, &names))?;
    csv("differences.csv", tables::differences(judgements, REFERENCE))?;
    csv("reliability.csv", tables::reliability(worlds, scopes, &names))?;
    csv("profiles.csv", tables::profiles(worlds, scopes, &names))?;
    if !repeated.is_empty() {
        csv("repeats.csv", tables::repeats(repeated))?;
    }
    if !rows.at_rest.is_empty() {
        csv("at-rest.csv", tables::at_rest(&rows.at_rest))?;
    }
    if !rows.sensors.is_empty() {
        csv("sensors.csv", sensors::table(&rows.sensors))?;
    }
    if worlds.iter().flat_map(|world| &world.maps).any(|map| map.mixing.is_some()) {
        csv("mixing.csv", tables::mixing(worlds))?;
    }
    if !rows.efficiency.is_empty() {
        csv("efficiency.csv", tables::efficiency(&rows.efficiency))?;
    }
    let pictures = document::pictures(|name| {
        let drawing = match name {
            "differences.png" => forest::draw(rows, &names, &["log_loss", "brier"], paper),
            "reliability.png" => figures::reliability(findings, &scopes[0], &names, paper),
            "profiles.png" => figures::profiles(findings, &scopes[0], &names, paper),
            "repeats.png" if !repeated.is_empty() => figures::repeats(rows, &names, paper),
            _ => return Ok(None),
        };
        paper.save(staging, name, &drawing).map(Some)
    })?;
    let markdown = document::markdown(plan, claims, &document::sections(plan, rows, &pictures));
    staging.write("summary.md", |out| out.write_all(markdown.as_bytes()))?;
    record.parts.claims.clone_from(claims);
    record.parts.pictures = paper.asked();
    plan.programs.iter().try_for_each(|program| page::kept::save(staging, &viewer, &program.name))?;
    let json = record.json(&staging.files_and(&["report.html", RECORD]))?;
    let scores: Vec<Vec<_>> =
        names.iter().map(|mapper| rows::of(&tables::scores(worlds, mapper))).collect::<Result<_, _>>()?;
    let html = page::page(&document::page(plan, rows, &scores.concat(), &json, &pictures, viewer)?)?;
    staging.write("report.html", |out| out.write_all(html.as_bytes()))?;
    staging.record(&record)
}
