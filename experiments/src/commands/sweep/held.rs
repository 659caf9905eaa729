//! What a sweep file holds.

use std::path::Path;

use serde_json::{Value, json};

use super::file::{Axis, load};
use super::source::SourceFile;
use crate::failure::Failure;

/// What a sweep holds: items with values and units.
///
/// # Errors
/// All that is wrong with the file, or with the scenes and families that it names.
pub fn held(path: &Path) -> Result<Vec<(String, Value, &'static str)>, Failure> {
    let sweep = load(path)?;
    let wrong = |site: &std::path::PathBuf| SourceFile::load(site, sweep.of_families).err();
    let wrong: Vec<String> = sweep.sites.iter().filter_map(wrong).map(|failure| failure.to_string()).collect();
    if !wrong.is_empty() {
        return Err(Failure::BadInput(wrong.join("\nerror: ")));
    }
    let sites = if sweep.of_families { "families" } else { "scenes" };
    let mut facts = vec![
        (sites.to_owned(), json!(sweep.sites.len()), "1"),
        ("mappers".to_owned(), json!(sweep.mappers.len()), "1"),
        ("seeds".to_owned(), json!(sweep.seeds), "1"),
        ("regions".to_owned(), json!(sweep.regions.len()), "1"),
        ("parameters set".to_owned(), json!(sweep.set.len()), "1"),
        ("settings".to_owned(), json!(sweep.settings_count()), "1"),
        ("jobs".to_owned(), json!(sweep.jobs()), "1"),
    ];
    let values = |axis: &Axis| (format!("values of {}", axis.keys.join(", ")), json!(axis.steps.len()), "1");
    facts.extend(sweep.axes.iter().map(values));
    Ok(facts)
}
