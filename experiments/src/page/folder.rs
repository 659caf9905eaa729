//! A folder of results, read back.

use std::fs;
use std::path::Path;

use clap::ValueEnum as _;
use mapper::Prior;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::part::Picture;
use crate::failure::Failure;
use crate::output::args::{Edges, Law, PriorOptions};
use crate::output::digest;
use crate::output::ledger::{Ledger, RECORD};
use crate::output::table::Table;

/// A folder of results to read from.
pub struct Folder<'a> {
    /// Where it is.
    pub path: &'a Path,
}

impl Folder<'_> {
    /// What is wrong with a file of the folder.
    pub fn refuse(&self, file: &str, why: &str) -> Failure {
        Failure::BadInput(format!("{}: {why}", self.path.join(file).display()))
    }

    /// A file of the folder.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn read(&self, file: &str) -> Result<Vec<u8>, Failure> {
        fs::read(self.path.join(file)).map_err(|e| {
            self.refuse(
                file,
                &format!("cannot be read: {e}; give a folder that 'room', 'compare' or 'score' left whole"),
            )
        })
    }

    /// A file of the folder as the run left it.
    ///
    /// # Errors
    /// A file that cannot be read, that the record does not list, or that somebody has changed.
    pub fn proved(&self, file: &str) -> Result<Vec<u8>, Failure> {
        let left = match Ledger::read(self.path) {
            Ledger::Ours(record) => record.files.into_iter().find(|entry| entry.name == file),
            _ => None,
        };
        let Some(entry) = left else {
            let why = "is needed for the page, and is not among the files of the record; run the command again";
            return Err(self.refuse(file, why));
        };
        let bytes = self.read(file)?;
        if entry.sha256 == digest::hex(&digest::sha256(&bytes)) {
            return Ok(bytes);
        }
        Err(self.refuse(file, "has changed since the run that wrote it; run the command again"))
    }

    /// What the folder was made from, with the names of all files alone under `files`.
    ///
    /// # Errors
    /// No record, or something else in its place.
    pub fn record(&self) -> Result<Value, Failure> {
        let mut record: Value = serde_json::from_slice(&self.read(RECORD)?)
            .map_err(|e| self.refuse(RECORD, &format!("is no record of a run: {e}")))?;
        let files = record["files"].as_array().into_iter().flatten();
        let names = files.filter_map(|file| file["name"].as_str()).chain([RECORD]);
        let mut names: Vec<String> = names.map(str::to_owned).collect();
        names.sort();
        record["files"] = names.into();
        Ok(record)
    }

    /// The parts of a record that `T` names.
    ///
    /// # Errors
    /// Parts that are missing, or of another form.
    pub fn understand<T: DeserializeOwned>(&self, record: &Value) -> Result<T, Failure> {
        T::deserialize(record)
            .map_err(|e| self.refuse(RECORD, &format!("is not understood: {e}; run the command again")))
    }

    /// What the mappers assumed.
    ///
    /// # Errors
    /// Names of another program.
    pub fn prior(&self, prior: &Prior, reconciliation: &str) -> Result<PriorOptions, Failure> {
        let law = serde_json::to_value(prior.correlation_law).map_err(Failure::internal)?;
        let law = Law::from_str(law.as_str().unwrap_or_default(), false);
        let (Ok(correlation_law), Ok(reconciliation)) = (law, Edges::from_str(reconciliation, false)) else {
            return Err(self.refuse(RECORD, "names a reconciliation that this program does not know"));
        };
        let Prior { occupancy, correlation, .. } = *prior;
        Ok(PriorOptions { occupancy, correlation, correlation_law, reconciliation })
    }

    /// Refuses a record that would now be another: the scene or the program may have changed since.
    ///
    /// # Errors
    /// The first difference.
    pub fn same_configuration(&self, record: &Value, now: &impl serde::Serialize) -> Result<(), Failure> {
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

    /// Refuses a `metrics.csv` whose first rows, but for those of the programs and for columns that are added for them,
    /// are not these.
    ///
    /// # Errors
    /// The first difference.
    pub fn same_numbers(&self, csv: &[u8], metrics: &Table, programs: &[&str]) -> Result<(), Failure> {
        let unread = |error: csv::Error| self.refuse("metrics.csv", &format!("is no table: {error}"));
        let mut reader = csv::Reader::from_reader(csv);
        let columns = metrics.columns();
        let heads = reader.headers().map_err(unread)?.clone();
        let differs = |line: u64, was: &[&str], now: &[&str]| {
            let (was, now) = (was.join(","), now.join(","));
            let why = format!("line {line} is {was:?}, but this program finds {now:?}; run the command again");
            self.refuse("metrics.csv", &why)
        };
        let heads: Vec<&str> = heads.iter().take(columns.len()).collect();
        if heads != columns {
            return Err(differs(1, &heads, columns));
        }
        let mapper = columns.iter().position(|name| *name == "mapper");
        let mut rows = reader.records();
        for now in metrics.fields() {
            let row = loop {
                let row = rows.next().transpose().map_err(unread)?.unwrap_or_default();
                let own = mapper.and_then(|mapper| row.get(mapper)).is_some_and(|name| programs.contains(&name));
                if !own {
                    break row;
                }
            };
            let was: Vec<&str> = row.iter().take(columns.len()).collect();
            if was != now {
                let line = row.position().map_or(0, csv::Position::line);
                return Err(differs(line, &was, &now.iter().map(String::as_str).collect::<Vec<_>>()));
            }
        }
        Ok(())
    }

    /// The pictures that the record lists.
    ///
    /// # Errors
    /// A picture that cannot be read.
    pub fn pictures(&self, record: &Value, known: &[(&str, &str)]) -> Result<Vec<Picture>, Failure> {
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
