//! What a file of gates holds.

use std::collections::BTreeSet;
use std::path::Path;

use mapper::catalogue::MAPPERS;
use serde_json::{Value, json};

use super::file::load;
use crate::failure::Failure;

/// What a file of gates holds: items with values and units.
///
/// # Errors
/// All that is wrong with the file; a mapper of one's own is not known here.
pub fn held(path: &Path) -> Result<Vec<(String, Value, &'static str)>, Failure> {
    let gates = load(path, MAPPERS)?;
    let mappers: BTreeSet<&str> = gates.gates.iter().map(|gate| gate.mapper.as_str()).collect();
    let worlds: BTreeSet<_> =
        gates.gates.iter().flat_map(|gate| &gate.worlds).map(|world| format!("{world:?}")).collect();
    let based = gates.gates.iter().filter(|gate| gate.needs_baseline()).count();
    let facts = [
        ("gates", json!(gates.gates.len())),
        ("gates with a baseline", json!(based)),
        ("mappers", json!(mappers.len())),
        ("families and scenes", json!(gates.sites.len())),
        ("worlds", json!(worlds.len())),
    ];
    Ok(facts.into_iter().map(|(item, value)| (item.to_owned(), value, "1")).collect())
}
