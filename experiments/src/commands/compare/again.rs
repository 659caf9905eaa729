//! The page of a folder that `compare` left, made anew.

use std::collections::BTreeSet;
use std::path::PathBuf;

use clap::ValueEnum as _;
use mapper::Prior;
use serde::Deserialize;
use serde_json::Value;

use super::figures::CAPTIONS;
use super::options::{CompareOptions, Worlds};
use super::plan::Plan;
use super::rows::{self, Rows};
use super::{document, outputs, showcase, tables};
use crate::failure::Failure;
use crate::figures::Paper;
use crate::output::args::{CutOption, Format, OpenOption, ThreadsOption};
use crate::output::ledger::RECORD;
use crate::page::{self, Folder};
use crate::programs::options::{ProgramOptions, ProgramRecord};
use crate::worlds::drives::DriveOptions;
use crate::worlds::ranked::SortOption;

/// What the page of a comparison needs of its record.
#[derive(Deserialize)]
struct Made {
    configuration: Configuration,
}

#[derive(Deserialize)]
struct Configuration {
    set: String,
    families: Vec<PathBuf>,
    #[serde(default)]
    conditions: Vec<String>,
    seeds: u32,
    batch_seeds: u32,
    mappers: Vec<String>,
    #[serde(default)]
    programs: Vec<ProgramRecord>,
    prior: Prior,
    reconciliation: String,
    #[serde(default)]
    drives: DriveOptions,
    #[serde(default)]
    max_range_m: Option<f64>,
    repeats: Vec<usize>,
    repeated_scans: usize,
}

/// The page, from the folder's tables; the worlds to look into are mapped again. Programs are not started: what they
/// gave is in the folder.
///
/// # Errors
/// A folder that `compare` did not leave, or whose numbers this program does not find again.
pub fn page(folder: &Folder, record: &Value) -> Result<String, Failure> {
    let Made { configuration: made } = folder.understand(record)?;
    let plan = plan(folder, made)?;
    folder.same_configuration(record, &outputs::record(&plan))?;
    let programs: Vec<&str> = plan.programs.iter().map(|program| program.name.as_str()).collect();
    let built_in = Plan {
        mappers: plan.mappers.iter().copied().filter(|entry| !programs.contains(&entry.name)).collect(),
        ..plan.clone()
    };
    let (mut viewer, worlds) = showcase::look(&built_in)?;
    for mapper in built_in.names() {
        holds(folder, &outputs::scores_of(mapper), &tables::scores(&worlds, mapper).csv()?)?;
    }
    page::kept::add(folder, &mut viewer, &programs, &plan.names())?;
    let rows = Rows {
        means: table(folder, "summary.csv")?,
        differences: table(folder, "differences.csv")?,
        repeats: if plan.repeats.is_empty() { Vec::new() } else { table(folder, "repeats.csv")? },
        at_rest: if has(record, "at-rest.csv") { table(folder, "at-rest.csv")? } else { Vec::new() },
        sensors: if has(record, "sensors.csv") { table(folder, "sensors.csv")? } else { Vec::new() },
        efficiency: if has(record, "efficiency.csv") { table(folder, "efficiency.csv")? } else { Vec::new() },
    };
    let pictures = folder.pictures(record, &CAPTIONS)?;
    let scores: Vec<Vec<_>> =
        plan.names().iter().map(|mapper| table(folder, &outputs::scores_of(mapper))).collect::<Result<_, _>>()?;
    page::page(&document::page(&plan, &rows, &scores.concat(), record, &pictures, viewer)?)
}

fn plan(folder: &Folder, made: Configuration) -> Result<Plan, Failure> {
    let prior = folder.prior(&made.prior, &made.reconciliation)?;
    let Ok(set) = Worlds::from_str(&made.set, false) else {
        return Err(folder.refuse(RECORD, &format!("names a set {:?} that this program does not know", made.set)));
    };
    let options = CompareOptions {
        set,
        families: made.families,
        conditions: if set == Worlds::Robustness { made.conditions } else { Vec::new() },
        seeds: Some(made.seeds),
        batch_seeds: Some(made.batch_seeds),
        mappers: made.mappers,
        programs: ProgramOptions::recorded(&made.programs)?,
        quick: false,
        prior,
        drives: made.drives,
        cut: CutOption { max_range_m: made.max_range_m },
        out: None,
        paper: Paper::default(),
        format: Format::Text,
        order: SortOption::default(),
        open: OpenOption::default(),
        threads: ThreadsOption::default(),
    };
    // Programs as they were: their files may have changed since.
    Ok(Plan {
        programs: made.programs,
        repeats: made.repeats,
        repeated_scans: made.repeated_scans,
        ..Plan::new(&options)?
    })
}

/// Whether the record, as [`Folder::record`] gives it, lists a file.
fn has(record: &Value, name: &str) -> bool {
    record["files"].as_array().is_some_and(|files| files.iter().any(|file| file == name))
}

fn table<T: serde::de::DeserializeOwned>(folder: &Folder, name: &str) -> Result<Vec<T>, Failure> {
    rows::parse(&folder.read(name)?).map_err(|e| folder.refuse(name, &format!("is no table of 'compare': {e}")))
}

/// Every line of `now` stands in the file.
fn holds(folder: &Folder, name: &str, now: &[u8]) -> Result<(), Failure> {
    let (was, now) = (folder.read(name)?, String::from_utf8_lossy(now));
    let was = String::from_utf8_lossy(&was);
    let lines: BTreeSet<&str> = was.lines().collect();
    match now.lines().find(|line| !lines.contains(line)) {
        None => Ok(()),
        Some(line) => {
            Err(folder.refuse(name, &format!("has no line {line:?}, which this program finds; run the command again")))
        }
    }
}
