//! The files that `compare` leaves behind.

use std::collections::BTreeMap;
use std::io::{self, Write as _};

use mapper::{Prior, Reconciliation};
use serde::Serialize;

use super::options::CompareOptions;
use super::plan::{Plan, REFERENCE};
use super::{Findings, tables};
use crate::claims::Claim;
use crate::failure::Failure;
use crate::record::versions;
use crate::staging::{RECORD, Staging};
use crate::table::Table;

/// What a comparison was made from: `run.json`.
#[derive(Debug, Serialize)]
pub struct Record {
    schema_version: u32,
    command: &'static str,
    configuration: Configuration,
    claims: Vec<Claim>,
    versions: BTreeMap<String, String>,
    files: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Configuration {
    set: &'static str,
    families: Vec<String>,
    conditions: Vec<&'static str>,
    seeds: u64,
    batch_seeds: u64,
    mappers: Vec<&'static str>,
    reference: &'static str,
    prior: Prior,
    reconciliation: Reconciliation,
    repeats: Vec<usize>,
    repeated_scans: usize,
}

/// The record of a plan, before anything is known of its outcome.
pub fn record(plan: &Plan, options: &CompareOptions) -> Record {
    Record {
        schema_version: 1,
        command: "compare",
        configuration: Configuration {
            set: plan.set.name(),
            families: options.families.iter().map(|path| path.display().to_string()).collect(),
            conditions: plan.conditions.clone(),
            seeds: plan.seeds,
            batch_seeds: plan.batch_seeds,
            mappers: plan.names(),
            reference: REFERENCE,
            prior: plan.belief.prior,
            reconciliation: plan.belief.reconciliation,
            repeats: plan.repeats.clone(),
            repeated_scans: plan.repeated_scans,
        },
        claims: Vec::new(),
        versions: versions(),
        files: Vec::new(),
    }
}

/// Writes everything.
pub fn write(staging: &mut Staging, plan: &Plan, findings: &Findings, mut record: Record) -> Result<(), Failure> {
    let Findings { worlds, scopes, judgements, repeated, claims } = findings;
    let names = plan.names();
    let mut csv = |name: &str, table: Table| staging.write(name, |out| table.write_csv(out).map_err(io::Error::other));
    csv("scores.csv", tables::scores(worlds))?;
    csv("summary.csv", tables::summary(worlds, scopes, &names))?;
    csv("differences.csv", tables::differences(judgements, REFERENCE))?;
    csv("reliability.csv", tables::reliability(worlds, scopes, &names))?;
    csv("profiles.csv", tables::profiles(worlds, scopes, &names))?;
    if !repeated.is_empty() {
        csv("repeats.csv", tables::repeats(repeated))?;
    }
    record.claims.clone_from(claims);
    record.files = staging.files();
    record.files.push(RECORD.to_owned());
    record.files.sort();
    staging.write(RECORD, |out| -> io::Result<()> {
        serde_json::to_writer_pretty(&mut *out, &record)?;
        writeln!(out)
    })
}
