//! Rows of a sweep's table.

use serde_json::json;

use super::job::Job;
use super::parameters::Value as Setting;
use super::regions::{RANGE_BY_LOOKS, of_movement, range_by_looks};
use crate::failure::Failure;
use crate::output::table::{field, optional};
use crate::worlds::aligned::{self, ALIGNED};
use crate::worlds::criteria::{CRITERIA, Criterion, MOVING};
use crate::worlds::ground::Ground;
use crate::worlds::run::Trial;

/// A map in a region, or what went wrong instead.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepRow {
    /// Name of the mapper; empty where the world was not made.
    pub mapper: String,
    /// Name of the region; empty with an error.
    pub region: String,
    /// Number of cells of the region.
    pub cells: usize,
    /// The metrics in the order of their columns; none where a metric is not defined, and none of those that are left out at the end.
    pub values: Vec<Option<f64>>,
    /// What went wrong; empty if nothing.
    pub error: String,
}

impl SweepRow {
    /// What stands for a mapper's rows when it failed.
    pub fn failed(mapper: &str, error: &str) -> Self {
        let error = error.split_whitespace().collect::<Vec<_>>().join(" ");
        Self { mapper: mapper.to_owned(), region: String::new(), cells: 0, values: Vec::new(), error }
    }

    /// Its log loss, for who watches.
    pub fn told(&self) -> Option<String> {
        let metric = CRITERIA.iter().position(|criterion| criterion.metric == "log_loss")?;
        let loss = self.values.get(metric).copied().flatten()?;
        Some(format!("last: {} in {}, log loss {loss:.3}", self.mapper, self.region))
    }

    /// The row as fields, in the order of [`columns`].
    pub fn fields(&self, id: u64, job: &Job, keys: &[String]) -> Vec<String> {
        let setting = |key: &String| match job.settings.get(key) {
            Some(Setting::Number(number)) => field(&json!(number)),
            Some(Setting::Word(word)) => word.clone(),
            None => String::new(),
        };
        let mut fields = vec![format!("{id:016x}"), job.file.clone(), job.seed.to_string()];
        fields.extend(keys.iter().map(setting));
        fields.extend([self.mapper.clone(), self.region.clone()]);
        fields.push(if self.error.is_empty() { self.cells.to_string() } else { String::new() });
        let values = self.values.iter().copied().chain(std::iter::repeat(None));
        fields.extend(metrics(of_movement(&job.regions)).zip(values).map(|(_, value)| field(&optional(value))));
        fields.push(self.error.clone());
        fields
    }
}

/// The metrics of a table, with those of worlds that move or without.
fn metrics(of_movement: bool) -> impl Iterator<Item = &'static Criterion> {
    CRITERIA.iter().chain(MOVING.iter().filter(move |_| of_movement))
}

/// The columns of a table with the given parameters, with the metrics of worlds that move or without.
pub fn columns(keys: &[String], of_movement: bool) -> Vec<String> {
    let names = ["id", "scene", "seed"].into_iter().chain(keys.iter().map(String::as_str));
    let names = names.chain(["mapper", "region", "cells"]);
    let names = names.chain(metrics(of_movement).map(|criterion| criterion.metric));
    names.chain(["error"]).map(str::to_owned).collect()
}

/// The scores of a trial at the end of the drive. `moved` has a trial for every mapper where aligned maps are asked for.
///
/// # Errors
/// A map that holds something else than probabilities.
pub fn rows(job: &Job, ground: &Ground, trial: &Trial, moved: &[Option<Trial>]) -> Result<Vec<SweepRow>, Failure> {
    let mut rows = Vec::new();
    for (number, run) in trial.runs.iter().enumerate() {
        let Some(last) = run.stages.len().checked_sub(1) else {
            return Err(Failure::Internal(format!("{} was never scored", run.mapper)));
        };
        if let Some(fault) = &run.stages[last].fault {
            rows.push(SweepRow::failed(run.mapper, fault));
            continue;
        }
        let metric = |region: &str, name: &str| match region {
            ALIGNED => moved.get(number)?.as_ref()?.metric(run.mapper, last, aligned::REGION.name(), name),
            _ => trial.metric(run.mapper, last, region, name),
        };
        let row = |region: String, cells, values| SweepRow {
            mapper: run.mapper.to_owned(),
            region,
            cells,
            values,
            error: String::new(),
        };
        for region in &job.regions {
            if region == RANGE_BY_LOOKS {
                for bin in range_by_looks(ground, trial, &run.stages[last].occupancy)? {
                    rows.push(row(bin.name, bin.cells, bin.errors.to_vec()));
                }
                continue;
            }
            let cells = metric(region, "log_loss").map_or(0, |metric| metric.support);
            let values =
                metrics(of_movement(&job.regions)).map(|c| metric(region, c.metric).and_then(|metric| metric.value));
            rows.push(row(region.clone(), cells, values.collect()));
        }
    }
    Ok(rows)
}
