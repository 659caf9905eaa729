//! `report DIR`: the page of a folder of results, made anew.
//!
//! Numbers come from the folder. The maps that the page shows on the way are no files, so the first
//! seed is simulated again, and must give the numbers that stand in `metrics.csv`.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::ValueEnum as _;
use mapper::Prior;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::cli::{Belief, Edges, Format, Law, ReportOptions, RoomOptions};
use crate::failure::Failure;
use crate::report::{self, Picture, Viewer, World};
use crate::room::{self, Plan, page};
use crate::staging::RECORD;
use crate::table::Table;

/// Makes the page.
///
/// # Errors
/// A folder that no command of ours left, or whose numbers this program does not find again; I/O.
pub fn run(options: &ReportOptions) -> Result<(), Failure> {
    let folder = Folder { path: &options.folder };
    let record = folder.record()?;
    let html = match record["command"].as_str() {
        Some("room") => room(&folder, &record)?,
        Some(other) => {
            return Err(
                folder.refuse(RECORD, &format!("the command {other:?} leaves no page; give a folder of 'room'"))
            );
        }
        None => return Err(folder.refuse(RECORD, "names no command; give a folder that 'room' left")),
    };
    let out = options.out.clone().unwrap_or_else(|| options.folder.join("report.html"));
    replace(&out, html.as_bytes())?;
    let _ = writeln!(std::io::stderr(), "{}", out.display());
    Ok(())
}

/// What the page of a room needs of its record.
#[derive(Deserialize)]
struct Made {
    seed: u64,
    configuration: Configuration,
    grid: grid::GridSpec,
}

#[derive(Deserialize)]
struct Configuration {
    scene: PathBuf,
    layout: Option<u64>,
    seeds: u32,
    mappers: Vec<String>,
    prior: Prior,
    reconciliation: String,
}

impl Made {
    /// The options that lead to the same run.
    fn options(self, law: Law, reconciliation: Edges) -> RoomOptions {
        let Configuration { scene, layout, seeds, mappers, prior, .. } = self.configuration;
        let belief =
            Belief { prior: prior.occupancy, correlation: prior.correlation, correlation_law: law, reconciliation };
        let (seed, grid) = (self.seed, Some(self.grid.cell_m));
        RoomOptions {
            scene,
            layout,
            seed,
            seeds,
            grid,
            mappers,
            belief,
            out: None,
            format: Format::Text,
            threads: None,
        }
    }
}

fn room(folder: &Folder, record: &Value) -> Result<String, Failure> {
    let made: Made = folder.understand(record)?;
    let name = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let law = Law::from_str(&name(&record["configuration"]["prior"]["correlation_law"]), false);
    let edges = Edges::from_str(&made.configuration.reconciliation, false);
    let (Ok(law), Ok(edges)) = (law, edges) else {
        return Err(folder.refuse(RECORD, "names a correlation law or reconciliation that this program does not know"));
    };
    let options = made.options(law, edges);
    let plan = Plan::of(&options)?;
    let (trial, metrics) = room::first_seed(&plan, &options)?;
    let stages = room::stages(&plan.ground, &trial);
    folder.same_configuration(record, &room::record(&options, &plan.ground, &plan.mappers, &stages, &[]))?;
    let csv = folder.read("metrics.csv")?;
    folder.same_numbers(&csv, &metrics)?;
    let rows = page::rows(&csv).map_err(|e| folder.refuse("metrics.csv", &e.to_string()))?;
    let viewer = Viewer { worlds: vec![World::new(&plan.ground, &trial, &stages, &plan.frames)] };
    let pictures = folder.pictures(record, &page::PICTURES)?;
    report::page(&page::page(&plan.ground, &stages, record, &rows, pictures, viewer)?)
}

/// A folder of results to read from.
struct Folder<'a> {
    path: &'a Path,
}

impl Folder<'_> {
    fn refuse(&self, file: &str, why: &str) -> Failure {
        Failure::BadInput(format!("{}: {why}", self.path.join(file).display()))
    }

    fn read(&self, file: &str) -> Result<Vec<u8>, Failure> {
        fs::read(self.path.join(file))
            .map_err(|e| self.refuse(file, &format!("cannot be read: {e}; give a folder that 'room' left whole")))
    }

    fn record(&self) -> Result<Value, Failure> {
        serde_json::from_slice(&self.read(RECORD)?)
            .map_err(|e| self.refuse(RECORD, &format!("is no record of a run: {e}")))
    }

    fn understand<T: DeserializeOwned>(&self, record: &Value) -> Result<T, Failure> {
        T::deserialize(record)
            .map_err(|e| self.refuse(RECORD, &format!("is not understood: {e}; run the command again")))
    }

    /// The scene or the program may have changed since.
    fn same_configuration(&self, record: &Value, now: &impl serde::Serialize) -> Result<(), Failure> {
        let now = serde_json::to_value(now).map_err(Failure::internal)?;
        for part in ["configuration", "grid", "stages"] {
            if let Some((place, was, is)) = difference(part, &record[part], &now[part]) {
                let why =
                    format!("{place} was {was} and would now be {is}: the scene has changed; run the command again");
                return Err(self.refuse(RECORD, &why));
            }
        }
        Ok(())
    }

    /// The first rows of `csv` are those of the first seed.
    fn same_numbers(&self, csv: &[u8], metrics: &Table) -> Result<(), Failure> {
        let mut now = Vec::new();
        metrics.write_csv(&mut now).map_err(Failure::internal)?;
        let (was, now) = (String::from_utf8_lossy(csv), String::from_utf8_lossy(&now));
        let mut lines = was.lines();
        for (i, now) in now.lines().enumerate() {
            let was = lines.next().unwrap_or_default();
            if was != now {
                let why = format!("line {} is {was:?}, but this program finds {now:?}; run the command again", i + 1);
                return Err(self.refuse("metrics.csv", &why));
            }
        }
        Ok(())
    }

    /// The pictures that the record lists.
    fn pictures(&self, record: &Value, known: &[(&str, &str)]) -> Result<Vec<Picture>, Failure> {
        let listed = |name: &str| record["files"].as_array().into_iter().flatten().any(|file| file == name);
        let picture = |(name, caption): &(&str, &str)| {
            let bytes = self.read(name)?;
            Ok(Picture { name: (*name).to_owned(), caption: (*caption).to_owned(), bytes })
        };
        known.iter().filter(|(name, _)| listed(name)).map(picture).collect()
    }
}

/// The first place at which two values differ.
fn difference(place: &str, was: &Value, is: &Value) -> Option<(String, Value, Value)> {
    if let (Value::Object(old), Value::Object(new)) = (was, is) {
        let keys = old.keys().chain(new.keys());
        return keys.into_iter().find_map(|key| difference(&format!("{place}.{key}"), &was[key], &is[key]));
    }
    (was != is).then(|| (place.to_owned(), was.clone(), is.clone()))
}

/// Writes a file whole or not at all.
fn replace(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let mut partial = path.as_os_str().to_owned();
    partial.push(format!(".partial-{}", std::process::id()));
    let partial = PathBuf::from(partial);
    fs::write(&partial, bytes).and_then(|()| fs::rename(&partial, path)).map_err(|e| {
        let _ = fs::remove_file(&partial);
        Failure::BadInput(format!("{}: cannot be written: {e}; choose another file with --out", path.display()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_difference_is_named_by_its_place() {
        let (was, is) = (json!({"a": {"b": 1, "c": [1]}}), json!({"a": {"b": 1, "c": [2]}}));
        assert_eq!(difference("x", &was, &was), None);
        assert_eq!(difference("x", &was, &is), Some(("x.a.c".to_owned(), json!([1]), json!([2]))));
        let added = difference("x", &json!({}), &json!({"d": 1}));
        assert_eq!(added, Some(("x.d".to_owned(), Value::Null, json!(1))));
    }
}
