//! What a run was made from: `run.json`.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::Value;

use crate::failure::Failure;

/// The form of every record.
const SCHEMA_VERSION: u32 = 1;

/// What a run was made from, and the versions that its numbers depend on. Nothing in it changes from one run to the next.
#[derive(Debug, Serialize)]
pub struct Record<P> {
    schema_version: u32,
    command: &'static str,
    /// What this command records: its configuration at least.
    #[serde(flatten)]
    pub parts: P,
    versions: BTreeMap<String, String>,
}

impl<P: Serialize> Record<P> {
    /// The record of a run; its files are added where it is written.
    pub fn new(command: &'static str, parts: P) -> Self {
        Self { schema_version: SCHEMA_VERSION, command, parts, versions: versions() }
    }

    /// The record as JSON, with the names of all files of the run.
    ///
    /// # Errors
    /// None but a defect.
    pub fn json(&self, files: &[String]) -> Result<Value, Failure> {
        let mut json = serde_json::to_value(self).map_err(Failure::internal)?;
        json["files"] = files.into();
        Ok(json)
    }
}

/// Packages whose version can move a number.
const DECISIVE: [&str; 6] = ["libm", "parry2d-f64", "rand", "rand_chacha", "rand_distr", "rapier2d-f64"];

/// The versions of this program and of the packages that decide its numbers, from the lock file it
/// was built with.
fn versions() -> BTreeMap<String, String> {
    let mut versions = BTreeMap::from([("experiments".to_owned(), env!("CARGO_PKG_VERSION").to_owned())]);
    let lock: toml::Table = include_str!("../../../Cargo.lock").parse().unwrap_or_default();
    for package in lock.get("package").and_then(|p| p.as_array()).into_iter().flatten() {
        let text = |key: &str| package.get(key).and_then(toml::Value::as_str);
        if let (Some(name), Some(version)) = (text("name"), text("version"))
            && DECISIVE.contains(&name)
        {
            versions.insert(name.to_owned(), version.to_owned());
        }
    }
    versions
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_lock_file_names_every_decisive_package() {
        assert_eq!(super::versions().len(), super::DECISIVE.len() + 1, "{:?}", super::versions());
    }
}
