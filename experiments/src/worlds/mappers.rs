//! Mappers by the names that a user gives.

use mapper::catalogue::{self, Entry};
use strict::nearest;

use crate::failure::Failure;

/// The mappers of the given names.
///
/// # Errors
/// A name that does not exist, with those that do and the nearest; a name given twice; no name.
pub fn entries(names: &[String]) -> Result<Vec<&'static Entry>, Failure> {
    let known = || catalogue::MAPPERS.iter().map(|entry| entry.name);
    let mut entries: Vec<&'static Entry> = Vec::new();
    for name in names.iter().map(|name| name.trim()) {
        if name.is_empty() {
            let all = known().collect::<Vec<_>>().join(", ");
            return Err(Failure::BadInput(format!("--mappers: a name is empty; name one or more of: {all}")));
        }
        let Some(entry) = catalogue::find(name) else {
            return Err(Failure::BadInput(format!(
                "--mappers: there is no mapper {name:?}; the nearest is '{}', all are: {}",
                nearest(name, known()),
                known().collect::<Vec<_>>().join(", ")
            )));
        };
        if entries.iter().any(|e| e.name == entry.name) {
            return Err(Failure::BadInput(format!("--mappers: '{name}' is given twice; name each mapper once")));
        }
        entries.push(entry);
    }
    Ok(entries)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blanks_about_names_do_not_count_and_empty_names_do() {
        let named = |names: &[&str]| entries(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>());
        let known = named(&["visibility", " conventional ", "\tprior"]).expect("known");
        assert_eq!(known.iter().map(|entry| entry.name).collect::<Vec<_>>(), ["visibility", "conventional", "prior"]);
        assert!(named(&["visibility", " visibility"]).is_err() && named(&["visibility", " "]).is_err());
    }
}
